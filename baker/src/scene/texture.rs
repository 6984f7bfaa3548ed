//! Textures: the scene's original picture and decoded texels.

use super::texture_size::{TEXELS_A_BYTE, check_size};
use super::{SceneError, basis_universal, foreign, orientation};
use glam::{Vec2, Vec3};
use rebounce_shared::elementary::Elementary;
use rebounce_shared::rbn::meta::{self, Wrap};
use std::sync::{Arc, LazyLock, OnceLock};

/// Linear value of each 8-bit sRGB value (IEC 61966-2-1).
static LINEAR: LazyLock<[f32; 256]> = LazyLock::new(|| {
    std::array::from_fn(|i| {
        let c = i as f64 / 255.0;
        (if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).power(2.4) }) as f32
    })
});

/// Linear colour of a texel.
#[inline]
pub(crate) fn linear([r, g, b, _]: [u8; 4]) -> Vec3 {
    let table = &*LINEAR;
    Vec3::new(table[r as usize], table[g as usize], table[b as usize])
}

/// 8-bit sRGB value with the nearest linear value.
fn nonlinear(x: f32) -> u8 {
    let table = &*LINEAR;
    let above = table.partition_point(|value| *value < x).min(255);
    if above > 0 && x - table[above - 1] < table[above] - x { above as u8 - 1 } else { above as u8 }
}

/// Decoded texels, row after row from the top: sRGB with linear alpha, 8 bits each.
#[derive(Debug, PartialEq)]
pub struct Texels {
    /// Texels per row.
    pub width: u32,
    /// Number of rows.
    pub height: u32,
    /// `width · height` texels.
    pub rgba: Vec<[u8; 4]>,
    /// Mip levels (halves, quarters and so on), computed on demand: plain means, and means weighted by alpha.
    coarser: [OnceLock<Vec<Texels>>; 2],
}

/// A texture: compressed bytes, sampling parameters, and texels if decoded.
#[derive(Clone, Debug)]
pub struct Texture {
    /// Name, picture type, size and wrapping; `offset` and `len` are not set before writing a file.
    pub meta: meta::Texture,
    /// The original PNG, JPEG or WebP picture, without the orientation in the metadata; a picture of another format as
    /// PNG.
    pub bytes: Arc<[u8]>,
    /// Decoded picture; `None` unless light or pictures need the texels.
    pub texels: Option<Arc<Texels>>,
}

/// MIME type by the first bytes of a picture, regardless of the file's declaration; the format's name as an error if
/// unsupported.
pub fn sniff(bytes: &[u8]) -> Result<&'static str, &'static str> {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => Ok("image/png"),
        [0xff, 0xd8, 0xff, ..] => Ok("image/jpeg"),
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => Ok("image/webp"),
        [0xab, b'K', b'T', b'X', ..] => Err("KTX"),
        [b'D', b'D', b'S', b' ', ..] => Err("DDS"),
        [_, _, _, _, b'f', b't', b'y', b'p', b'a', b'v', ..] => Err("AVIF"),
        [_, _, _, _, b'f', b't', b'y', b'p', ..] => Err("HEIC"),
        [b'8', b'B', b'P', b'S', ..] => Err("PSD"),
        [0x76, 0x2f, 0x31, 0x01, ..] => Err("OpenEXR"),
        [b'#', b'?', b'R', ..] => Err("Radiance HDR"),
        [b'<', b's' | b'?', ..] => Err("SVG"),
        _ => Err("unknown"),
    }
}

/// Width and height of a picture, from its header.
fn dimensions(bytes: &[u8]) -> Result<(u32, u32), String> {
    let reader = image::ImageReader::with_format(std::io::Cursor::new(bytes), format(bytes)?);
    reader.into_dimensions().map_err(|e| undecodable(&e))
}

fn format(bytes: &[u8]) -> Result<image::ImageFormat, String> {
    match sniff(bytes) {
        Ok("image/png") => Ok(image::ImageFormat::Png),
        Ok("image/webp") => Ok(image::ImageFormat::WebP),
        Ok(_) => Ok(image::ImageFormat::Jpeg),
        Err(kind) => Err(format!("its format is {kind}: convert it to PNG, JPEG, WebP or KTX2")),
    }
}

fn undecodable(error: &image::ImageError) -> String {
    format!("it cannot be decoded ({error}): save it again as PNG or JPEG")
}

/// Maximum number of texels of a scene's pictures together without a check of the pictures' bytes.
const MANY_TOGETHER: u64 = 1 << 26;

/// Number of texels after decoding, from the picture's header; 0 without decoding, or if the header is unreadable.
pub fn texels_said(bytes: &[u8], decoded: bool) -> u64 {
    let size = match (basis_universal::is_ktx2(bytes), decoded) {
        (true, _) => basis_universal::size(bytes),
        // Pictures of these formats are always decoded.
        (false, _) if foreign::format(bytes).is_some() => foreign::size(bytes),
        (false, true) => dimensions(bytes).ok().map(|(width, height)| (width as u64, height as u64)),
        (false, false) => None,
    };
    size.map_or(0, |(width, height)| width.saturating_mul(height))
}

/// Refuses pictures with headers that declare more texels, in total, than the pictures' bytes can encode.
pub fn check_together(texels: u64, bytes: u64) -> Result<(), String> {
    if texels <= MANY_TOGETHER.max(TEXELS_A_BYTE.saturating_mul(bytes)) {
        return Ok(());
    }
    Err(format!("its pictures' {bytes} bytes would become {texels} texels: make those of one colour smaller"))
}

impl Texels {
    /// Decodes a PNG, JPEG or WebP picture.
    ///
    /// # Errors
    /// A sentence with the problem.
    pub fn decode(bytes: &[u8]) -> Result<Self, String> {
        let (width, height) = dimensions(bytes)?;
        check_size(width as u64, height as u64, bytes.len())?;
        let picture = image::load_from_memory_with_format(bytes, format(bytes)?)
            .map_err(|e| undecodable(&e))?
            .into_rgba8();
        let (width, height) = picture.dimensions();
        // Without a copy, unless the decoder's buffer has spare capacity.
        let rgba = bytemuck::try_cast_vec(picture.into_raw())
            .unwrap_or_else(|(_, raw)| raw.as_chunks::<4>().0.to_vec());
        Ok(Self::new(width, height, rgba))
    }

    /// Creates a picture from `width · height` texels.
    pub fn new(width: u32, height: u32, rgba: Vec<[u8; 4]>) -> Self {
        Self { width, height, rgba, coarser: Default::default() }
    }

    /// Mip level with texels that are means of about `texels` texels of this picture.
    #[inline]
    fn averaged(&self, texels: f32, by_alpha: bool) -> &Self {
        if texels < 4.0 || texels.is_nan() {
            return self;
        }
        // A level has a quarter of the texels of the level before: the level is half the power of two.
        let level = ((texels.to_bits() >> 23) as usize - 127) >> 1;
        let coarser = self.coarser[by_alpha as usize].get_or_init(|| self.halves(by_alpha));
        coarser.get(level.min(coarser.len()).wrapping_sub(1)).unwrap_or(self)
    }

    /// Mip levels: halves, quarters and so on, down to one texel.
    fn halves(&self, by_alpha: bool) -> Vec<Self> {
        let mut levels: Vec<Self> = Vec::new();
        loop {
            let last = levels.last().unwrap_or(self);
            if last.width.max(last.height) == 1 {
                return levels;
            }
            levels.push(last.half(by_alpha));
        }
    }

    /// Next mip level: half as many texels along each axis, at least one; means of linear values, weighted by alpha if
    /// `by_alpha`.
    fn half(&self, by_alpha: bool) -> Self {
        let (width, height) = ((self.width / 2).max(1), (self.height / 2).max(1));
        // With an odd number of texels, spans of three texels overlap.
        let span = |i: u32, of: u32, size: u32| {
            let (i, of, all) = (i as u64, of as u64, size as u64);
            (i * all / of) as u32..((i + 1) * all).div_ceil(of).min(all) as u32
        };
        let mut rgba = Vec::with_capacity(width as usize * height as usize);
        for y in 0..height {
            for x in 0..width {
                let (mut sum, mut plain, mut alpha, mut count) = (Vec3::ZERO, Vec3::ZERO, 0.0, 0.0);
                for row in span(y, height, self.height) {
                    for column in span(x, width, self.width) {
                        let texel = self.at(column, row);
                        let (color, a) = (linear(texel), texel[3] as f32);
                        (sum, plain, alpha, count) = (sum + a * color, plain + color, alpha + a, count + 1.0);
                    }
                }
                let mean = if by_alpha && alpha > 0.0 { sum / alpha } else { plain / count };
                let [r, g, b] = mean.to_array().map(nonlinear);
                rgba.push([r, g, b, (alpha / count).round() as u8]);
            }
        }
        Self::new(width, height, rgba)
    }

    #[inline]
    fn at(&self, x: u32, y: u32) -> [u8; 4] {
        self.rgba[y as usize * self.width as usize + x as usize]
    }
}

/// [`f32::floor`] without a call into the system's library.
#[inline]
fn floor(x: f32) -> f32 {
    // From here on, f32 has no fractions.
    const WHOLE: f32 = (1u32 << 23) as f32;
    if x.abs() >= WHOLE {
        return x;
    }
    let towards_zero = x as i32 as f32;
    if towards_zero > x { towards_zero - 1.0 } else { towards_zero }
}

/// Folds a texture coordinate into [0, 1].
#[inline]
fn fold(t: f32, wrap: Wrap) -> f32 {
    match wrap {
        Wrap::Repeat => t - floor(t),
        Wrap::MirroredRepeat => 1.0 - (t - 2.0 * (t * 0.5).floor() - 1.0).abs(),
        Wrap::ClampToEdge => t.clamp(0.0, 1.0),
    }
}

/// Texels on both sides of a folded coordinate, and the weight of the second texel.
#[inline]
fn neighbours(t: f32, size: u32, wrap: Wrap) -> (u32, u32, f32) {
    let x = t * size as f32 - 0.5;
    let low = floor(x);
    let share = x - low;
    let last = size as i32 - 1;
    let (a, b) = (low as i32, low as i32 + 1);
    let border = |i: i32| match (i < 0, i > last, wrap) {
        (true, _, Wrap::Repeat) => last,
        (_, true, Wrap::Repeat) => 0,
        _ => i.clamp(0, last),
    };
    (border(a) as u32, border(b) as u32, share)
}

#[inline]
fn nearest(t: f32, size: u32) -> u32 {
    ((t * size as f32) as u32).min(size - 1)
}

/// Sampling parameters of a texture.
#[derive(Clone, Debug)]
pub struct Sampler {
    /// Texels.
    pub texels: Arc<Texels>,
    /// Horizontal wrap.
    pub wrap_u: Wrap,
    /// Vertical wrap.
    pub wrap_v: Wrap,
    /// False for nearest filtering.
    pub linear_filter: bool,
}

impl Sampler {
    /// Linear RGB around a texture coordinate, averaged over about this share of the texture. Texels are converted to
    /// linear values before filtering, and weighted by alpha if `by_alpha`.
    pub fn color(&self, uv: Vec2, share: f32, by_alpha: bool) -> Vec3 {
        let t = self.texels.averaged(share * (self.texels.width * self.texels.height) as f32, by_alpha);
        let (u, v) = (fold(uv.x, self.wrap_u), fold(uv.y, self.wrap_v));
        let linear = |x: u32, y: u32| linear(t.at(x, y));
        if !self.linear_filter {
            return linear(nearest(u, t.width), nearest(v, t.height));
        }
        let (x0, x1, fx) = neighbours(u, t.width, self.wrap_u);
        let (y0, y1, fy) = neighbours(v, t.height, self.wrap_v);
        linear(x0, y0).lerp(linear(x1, y0), fx).lerp(linear(x0, y1).lerp(linear(x1, y1), fx), fy)
    }

    /// Nearest texel: sRGB, and linear alpha.
    #[inline]
    pub fn nearest_texel(&self, uv: Vec2) -> [u8; 4] {
        let t = &*self.texels;
        let (u, v) = (fold(uv.x, self.wrap_u), fold(uv.y, self.wrap_v));
        t.at(nearest(u, t.width), nearest(v, t.height))
    }

    /// Alpha of the nearest texel, 0 to 1.
    pub fn alpha(&self, uv: Vec2) -> f32 {
        self.nearest_texel(uv)[3] as f32 / 255.0
    }
}

impl Texture {
    /// Creates a texture; without `decoded`, only the picture's header is read. Sets the picture type and size in
    /// `meta` from the bytes.
    ///
    /// # Errors
    /// [`SceneError::Texture`].
    pub fn new(
        file: &str,
        mut meta: meta::Texture,
        bytes: Vec<u8>,
        decoded: bool,
    ) -> Result<Self, SceneError> {
        let bad = |problem: String| SceneError::Texture {
            file: file.to_owned(),
            texture: meta.name.clone(),
            problem,
        };
        let mut bytes = match foreign::format(&bytes) {
            _ if basis_universal::is_ktx2(&bytes) => basis_universal::to_png(&bytes).map_err(bad)?,
            Some(format) => foreign::to_png(&bytes, format).map_err(bad)?,
            None => bytes,
        };
        orientation::straighten(&mut bytes);
        let texels = if decoded { Some(Arc::new(Texels::decode(&bytes).map_err(bad)?)) } else { None };
        let size = match &texels {
            Some(texels) => (texels.width, texels.height),
            None => dimensions(&bytes).map_err(bad)?,
        };
        meta.mime = sniff(&bytes).unwrap_or("image/png").to_owned();
        (meta.width, meta.height) = size;
        Ok(Self { meta, bytes: bytes.into(), texels })
    }

    /// Sampler of the texture; `None` if the texture is not decoded.
    pub fn sampler(&self) -> Option<Sampler> {
        Some(Sampler {
            texels: self.texels.clone()?,
            wrap_u: self.meta.wrap_u,
            wrap_v: self.meta.wrap_v,
            linear_filter: self.meta.linear_filter,
        })
    }
}

#[cfg(test)]
mod tests;
