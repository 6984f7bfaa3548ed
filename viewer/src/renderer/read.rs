//! Pictures read back, for tests and for saving.

use super::Renderer;
use crate::bindings::target as texture_target;
use crate::composite::Shading;
use crate::error::ViewerError;
use crate::readback::Readback;
use wgpu::TextureFormat;

/// Pixels that [`Renderer::read_indirect`] draws at most to average.
const MOST_PIXELS: u64 = 1 << 22;

impl Renderer {
    /// Begins to read the bounced light of the present camera and lights at this size: RGBA 32-bit
    /// floats, linear radiance albedo/π·E; each pixel is the mean over up to 8 x 8 places. Alpha is
    /// the share that a surface covers.
    ///
    /// # Errors
    /// [`ViewerError::NoScene`]; [`ViewerError::BadArgument`] for a size that the device cannot draw.
    pub fn read_indirect(&mut self, width: u32, height: u32) -> Result<Readback, ViewerError> {
        let scene = self.scene.clone().ok_or(ViewerError::NoScene)?;
        self.check_size(width, height)?;
        let limit = self.gpu.device.limits().max_texture_dimension_2d;
        let fits = |k: &u32| {
            width.max(height) * k <= limit && width as u64 * height as u64 * (k * k) as u64 <= MOST_PIXELS
        };
        let scale = [8, 6, 4, 3, 2].into_iter().find(fits).unwrap_or(1);
        let size = [width * scale, height * scale];
        let target = self.new_target(&scene, size);
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.update_lights(&mut encoder, &scene);
        self.draw_view(&mut encoder, &scene, &target, 0, false);
        let shading = Shading { direct: 0.0, indirect: 1.0, scale, ..self.shading(1.0) };
        self.composite.set_shading(&self.gpu, &target.picture, &shading);
        let out = texture_target(&self.gpu, "indirect", TextureFormat::Rgba32Float, width, height);
        let view = out.create_view(&Default::default());
        self.composite.indirect(&mut encoder, &target.picture, &self.shadows.group, &view);
        self.gpu.queue.submit([encoder.finish()]);
        Ok(Readback::texture(&self.gpu, &out, 16))
    }

    /// Begins to read the tone-mapped picture at this size, without handles: RGBA bytes.
    ///
    /// # Errors
    /// As [`Renderer::read_indirect`].
    pub fn read_pixels(&mut self, width: u32, height: u32) -> Result<Readback, ViewerError> {
        let scene = self.scene.clone().ok_or(ViewerError::NoScene)?;
        self.check_size(width, height)?;
        let target = self.new_target(&scene, [width, height]);
        let format = TextureFormat::Rgba8Unorm;
        let out = texture_target(&self.gpu, "pixels", format, width, height);
        let view = out.create_view(&Default::default());
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.update_lights(&mut encoder, &scene);
        // One submission a picture: their uniforms differ.
        for picture in 0..self.still_pictures {
            self.draw_view(&mut encoder, &scene, &target, picture, false);
            if std::mem::take(&mut self.dirty.key) {
                self.measure_key(&mut encoder, &target);
            }
            self.shade(&mut encoder, &target, picture, false);
            self.gpu.queue.submit([encoder.finish()]);
            encoder = self.gpu.device.create_command_encoder(&Default::default());
        }
        self.composite.present(&self.gpu, &mut encoder, &target.picture, &view, format);
        self.gpu.queue.submit([encoder.finish()]);
        Ok(Readback::texture(&self.gpu, &out, 4))
    }
}
