//! Pictures read back, for tests and for saving.

use super::Renderer;
use crate::error::ViewerError;
use crate::gpu::LIMITS;
use crate::gpu::bindings::target as texture_target;
use crate::gpu::readback::Readback;
use crate::gpu::scope::Scope;
use crate::passes::composite::{self, Shading};
use crate::passes::settings::Mode;
use crate::scene::upload::MAX_BUFFER;
use crate::scene::view::Sample;
use wgpu::TextureFormat;

/// Number of pictures averaged by [`Renderer::read_indirect`].
const PICTURES: u32 = 16;
/// Maximum pixels of one of these pictures.
const MOST_PIXELS: u64 = 1 << 22;

/// What bounced light is read without.
#[cfg(feature = "radiosity")]
const LOOKS: u32 = composite::DETAILED | composite::GLOSSY;
/// What bounced light is read without.
#[cfg(not(feature = "radiosity"))]
const LOOKS: u32 = composite::DETAILED;

impl Renderer {
    /// Begins to read the bounced light for the present camera and lights at this size: RGBA 32-bit floats, linear
    /// radiance albedo/π·E. A pixel is the mean over 64 places, or 16 in pictures of over a million pixels. Alpha
    /// is the share covered by surfaces: blended surfaces are composited over the surfaces behind, with their
    /// reflected bounced light, as on the CPU, where the share 1 − alpha of the rays passes. Surfaces are
    /// Lambertian, without normal maps, as in the bake.
    ///
    /// # Errors
    /// [`ViewerError::NoScene`]; [`ViewerError::BadArgument`] for a size that the device cannot draw.
    pub fn read_indirect(&mut self, width: u32, height: u32) -> Result<Readback, ViewerError> {
        self.read_linear(width, height, Mode::Indirect)
    }

    /// As [`Self::read_indirect`], of all light, with normal maps, highlights and reflections, and the sky.
    ///
    /// # Errors
    /// As [`Self::read_indirect`].
    #[cfg(feature = "radiosity")]
    pub fn read_radiance(&mut self, width: u32, height: u32) -> Result<Readback, ViewerError> {
        self.read_linear(width, height, Mode::All)
    }

    fn read_linear(&mut self, width: u32, height: u32, mode: Mode) -> Result<Readback, ViewerError> {
        let scene = self.scene.clone().ok_or(ViewerError::NoScene)?;
        self.check_size(width, height)?;
        let bytes = 16 * width as u64 * height as u64;
        if bytes > MAX_BUFFER {
            return Err(ViewerError::BadArgument(format!(
                "a picture of {width} x {height} pixels takes {bytes} bytes, at most {MAX_BUFFER} can be read"
            )));
        }
        let limit = LIMITS.max_texture_dimension_2d;
        let fits = 2 * width.max(height) <= limit && 4 * width as u64 * height as u64 <= MOST_PIXELS;
        let scale = if fits { 2 } else { 1 };
        let mut target = self.new_target(&scene, [width * scale, height * scale], 1);
        let own = Scope::new(&self.gpu);
        let average = |label| texture_target(&own, label, TextureFormat::Rgba32Float, width, height);
        let [mut before, mut out] = [average("indirect before"), average("indirect")];
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let picture_size = (mode != Mode::Indirect).then_some(target.size);
        #[cfg(feature = "antiradiance")]
        self.prepare_antiradiance(&scene, usize::MAX);
        self.update_lights(&mut encoder, &scene, picture_size, mode);
        #[cfg(feature = "radiosity")]
        self.solve_all(&mut encoder, &scene);
        // One submission per picture: uniforms differ.
        for picture in 0..PICTURES {
            std::mem::swap(&mut before, &mut out);
            self.draw_view(&mut encoder, &scene, &mut target, Sample::of_count(picture, PICTURES), false);
            // Lambertian surfaces, as in the CPU's picture.
            let shading = Shading { scale, ..self.shading(1.0 / (picture + 1) as f32) };
            let shading = match mode {
                Mode::Indirect => {
                    let flags = shading.flags & !LOOKS;
                    Shading { direct: 0.0, indirect: 1.0, flags, skies: 0, ..shading }
                }
                _ => Shading { direct: 1.0, indirect: 1.0, ..shading },
            };
            self.pipelines.composite.set_shading(&self.gpu, &target.picture, &shading);
            self.draw_blended(&mut encoder, &scene, &target, false);
            let group = self.shadows.group();
            self.pipelines.composite.indirect(
                &self.gpu,
                &mut encoder,
                &target.picture,
                group,
                [&before, &out],
            );
            self.gpu.queue.submit([encoder.finish()]);
            encoder = self.gpu.device.create_command_encoder(&Default::default());
        }
        Ok(Readback::texture(&self.gpu, &out, 16))
    }

    /// Begins to read the work counts of the last picture of [`Renderer::draw`]: returns the picture's size, and
    /// the bytes for [`Counts::new`](crate::renderer::stats::Counts::new).
    ///
    /// # Errors
    /// [`ViewerError::NoScene`] before a picture is drawn.
    pub fn read_counts(&self) -> Result<([u32; 2], Readback), ViewerError> {
        let target = self.target.as_ref().ok_or(ViewerError::NoScene)?;
        Ok((target.size, Readback::buffer(&self.gpu, &target.display.slots.counts)))
    }

    /// Begins to read the tone-mapped picture at this size, without handles: RGBA bytes.
    ///
    /// # Errors
    /// As [`Renderer::read_indirect`].
    pub fn read_pixels(&mut self, width: u32, height: u32) -> Result<Readback, ViewerError> {
        let scene = self.scene.clone().ok_or(ViewerError::NoScene)?;
        self.check_size(width, height)?;
        let mut target = self.new_target(&scene, [width, height], 1);
        let format = TextureFormat::Rgba8Unorm;
        let own = Scope::new(&self.gpu);
        let out = texture_target(&own, "pixels", format, width, height);
        let view = out.create_view(&Default::default());
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        #[cfg(feature = "antiradiance")]
        self.prepare_antiradiance(&scene, usize::MAX);
        self.update_lights(&mut encoder, &scene, Some([width, height]), self.mode);
        #[cfg(feature = "radiosity")]
        self.solve_all(&mut encoder, &scene);
        // One submission per picture: uniforms differ.
        for picture in 0..self.still_pictures {
            self.draw_view(&mut encoder, &scene, &mut target, Sample::of(picture), false);
            let blended = self.update_key(&mut encoder, &scene, &target, false);
            self.shade(&mut encoder, &scene, &target, picture, !blended, false);
            self.gpu.queue.submit([encoder.finish()]);
            encoder = self.gpu.device.create_command_encoder(&Default::default());
        }
        self.pipelines.composite.present(&self.gpu, &mut encoder, &target.picture.present, &view, format);
        self.gpu.queue.submit([encoder.finish()]);
        Ok(Readback::texture(&self.gpu, &out, 4))
    }
}
