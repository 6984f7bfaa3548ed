//! Copies of textures and buffers back to the CPU.

use crate::error::ViewerError;
use crate::gpu::Gpu;
use crate::oneshot::{self, Receiver};
use crate::scope::Scope;

/// A copy that is under way.
pub struct Readback {
    own: Scope,
    buffer: wgpu::Buffer,
    done: Receiver<Result<(), wgpu::BufferAsyncError>>,
    row_bytes: usize,
    padded_row_bytes: usize,
}

impl Readback {
    /// Begins to copy a whole 2D texture of `bytes_per_pixel`; call after the work that fills it is submitted.
    pub fn texture(gpu: &Gpu, texture: &wgpu::Texture, bytes_per_pixel: u32) -> Self {
        let size = texture.size();
        let row_bytes = size.width * bytes_per_pixel;
        let padded = row_bytes.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let own = Scope::new(gpu);
        let buffer = staging(&own, padded as u64 * size.height as u64);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(padded),
                    rows_per_image: None,
                },
            },
            size,
        );
        gpu.queue.submit([encoder.finish()]);
        Self::begin(own, buffer, row_bytes as usize, padded as usize)
    }

    /// Begins to copy a whole buffer.
    pub fn buffer(gpu: &Gpu, source: &wgpu::Buffer) -> Self {
        let own = Scope::new(gpu);
        let buffer = staging(&own, source.size());
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(source, 0, &buffer, 0, source.size());
        gpu.queue.submit([encoder.finish()]);
        let bytes = source.size() as usize;
        Self::begin(own, buffer, bytes, bytes)
    }

    fn begin(own: Scope, buffer: wgpu::Buffer, row_bytes: usize, padded_row_bytes: usize) -> Self {
        let (sender, done) = oneshot::channel();
        buffer.slice(..).map_async(wgpu::MapMode::Read, move |result| sender.send(result));
        Self { own, buffer, done, row_bytes, padded_row_bytes }
    }

    /// The bytes, rows tightly packed.
    ///
    /// # Errors
    /// [`ViewerError::DeviceLost`] when the device went away meanwhile; [`ViewerError::Internal`].
    pub async fn wait(self) -> Result<Vec<u8>, ViewerError> {
        #[cfg(not(target_arch = "wasm32"))]
        self.own
            .device
            .poll(wgpu::PollType::wait_indefinitely())
            .map_err(|e| ViewerError::DeviceLost(e.to_string()))?;
        self.done.await.map_err(|e| ViewerError::DeviceLost(e.to_string()))?;
        let bytes = {
            let mapped =
                self.buffer.slice(..).get_mapped_range().map_err(|e| ViewerError::Internal(e.to_string()))?;
            let mut bytes = Vec::with_capacity(mapped.len());
            for row in mapped.chunks(self.padded_row_bytes.max(1)) {
                bytes.extend_from_slice(&row[..self.row_bytes]);
            }
            bytes
        };
        self.buffer.unmap();
        self.own.check()?;
        Ok(bytes)
    }
}

fn staging(own: &Scope, size: u64) -> wgpu::Buffer {
    own.buffer(&wgpu::BufferDescriptor {
        label: Some("readback"),
        size,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}
