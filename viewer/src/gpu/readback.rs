//! Copies of textures and buffers back to the CPU.

use super::device::Gpu;
use super::oneshot::{self, Receiver, Sender};
use super::scope::Scope;
use crate::error::ViewerError;

/// The bytes of a buffer, or the reason for a failure.
pub type Read = Result<Vec<u8>, String>;

/// A copy in flight.
pub struct Readback {
    own: Scope,
    bytes: Receiver<Read>,
    row_bytes: usize,
    padded_row_bytes: usize,
}

impl Readback {
    /// Begins to copy a whole 2D texture of `bytes_per_pixel`; call after the work that fills the texture is
    /// submitted.
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
        Self { own, bytes: bytes(&buffer), row_bytes, padded_row_bytes }
    }

    /// Waits for the bytes, rows tightly packed.
    ///
    /// # Errors
    /// [`ViewerError::DeviceLost`] if the device is lost meanwhile; [`ViewerError::Internal`].
    pub async fn wait(self) -> Result<Vec<u8>, ViewerError> {
        #[cfg(not(target_arch = "wasm32"))]
        self.own
            .device
            .poll(wgpu::PollType::wait_indefinitely())
            .map_err(|e| ViewerError::DeviceLost(e.to_string()))?;
        let mut bytes = self.bytes.await.map_err(ViewerError::DeviceLost)?;
        self.own.check()?;
        let (row, padded) = (self.row_bytes, self.padded_row_bytes.max(1));
        let rows = bytes.len() / padded;
        for i in 1..rows {
            bytes.copy_within(i * padded..i * padded + row, i * row);
        }
        bytes.truncate(rows * row);
        Ok(bytes)
    }
}

/// The bytes of a mappable buffer, or the reason for a failure; the buffer can be reused afterwards.
pub fn bytes(buffer: &wgpu::Buffer) -> Receiver<Read> {
    let (sender, bytes) = oneshot::channel();
    send(buffer.clone(), sender);
    bytes
}

#[cfg(not(target_arch = "wasm32"))]
fn send(buffer: wgpu::Buffer, sender: Sender<Read>) {
    let held = buffer.clone();
    buffer.slice(..).map_async(wgpu::MapMode::Read, move |mapped| {
        let bytes = mapped.map_err(|e| e.to_string()).and_then(|()| {
            let bytes =
                held.slice(..).get_mapped_range().map(|range| range.to_vec()).map_err(|e| e.to_string());
            held.unmap();
            bytes
        });
        sender.send(bytes);
    });
}

#[cfg(target_arch = "wasm32")]
fn send(buffer: wgpu::Buffer, sender: Sender<Read>) {
    wasm_bindgen_futures::spawn_local(async move {
        let bytes = super::browser::bytes(buffer).await;
        sender.send(bytes.map_err(|error| js_sys::Object::from(error).to_string().into()));
    });
}

fn staging(own: &Scope, size: u64) -> wgpu::Buffer {
    own.buffer(&wgpu::BufferDescriptor {
        label: Some("readback"),
        size,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}
