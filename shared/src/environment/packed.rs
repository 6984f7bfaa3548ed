//! The environment that travels in a file: at most 128 by 64 pixels of rgb9e5, 32 KiB.
//!
//! Bytes, little-endian: width and height (16 bits each), the scale (32-bit float, a power of two), then the pixels from
//! the top left, four bytes each. Radiance is the pixel times the scale: rgb9e5 ends at 65,408, and pictures may be in
//! any unit.

use super::picture::Environment;
use crate::colour::{pack_rgb9e5, unpack_rgb9e5};
use crate::elementary::Elementary;
use glam::Vec3;
use std::f32::consts::PI;

/// Largest width, pixels; the height is at most half of that.
pub const MAX_WIDTH: u32 = 128;
/// Bytes before the pixels.
const HEADER: usize = 8;
/// Largest radiance that the pixels have after scaling.
const LARGEST: f32 = 32768.0;
/// The scale is two to the power of at most this, and at least its negative.
const EXPONENT: i32 = 100;

/// Reason why bytes are no packed environment.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PackedEnvironmentError {
    /// The number of bytes does not fit the size.
    #[error("the environment has {found} bytes instead of {expected}: the file is damaged; bake again")]
    Length {
        /// Bytes that the size calls for.
        expected: usize,
        /// Bytes that are there.
        found: usize,
    },
    /// The size is outside the limits.
    #[error(
        "the environment has {width}x{height} pixels instead of 1x1 to 128x64: the file is damaged; bake again"
    )]
    Size {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// The scale is not a power of two within the limits.
    #[error("the environment's scale is {scale} instead of a power of two: the file is damaged; bake again")]
    Scale {
        /// The scale.
        scale: f32,
    },
}

/// An environment of rgb9e5 pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct PackedEnvironment {
    /// Pixels in a row; 1 to 128 in files.
    pub width: u32,
    /// Rows; 1 to 64 in files.
    pub height: u32,
    /// Radiance of a pixel of 1, W/(sr m²); a power of two.
    pub scale: f32,
    /// `width · height` pixels, rgb9e5.
    pub pixels: Vec<u32>,
}

impl PackedEnvironment {
    /// Reduces an environment to at most 128 by 64 pixels and packs it. Negative and NaN channels become 0.
    pub fn new(environment: &Environment) -> Self {
        let (width, height) = (environment.width.min(MAX_WIDTH), environment.height.min(MAX_WIDTH / 2));
        Self::whole(&environment.resized(width, height))
    }

    /// Packs all pixels, for textures: files have at most 128 by 64. Negative and NaN channels become 0.
    pub fn whole(environment: &Environment) -> Self {
        let scale = scale(&environment.pixels);
        let pixels =
            environment.pixels.iter().map(|&pixel| pack_rgb9e5(pixel.max(Vec3::ZERO) / scale)).collect();
        Self { width: environment.width, height: environment.height, scale, pixels }
    }

    /// The environment, as precise as the packed form.
    pub fn unpack(&self) -> Environment {
        let pixels = self.pixels.iter().map(|&bits| unpack_rgb9e5(bits) * self.scale).collect();
        Environment { width: self.width, height: self.height, pixels }
    }

    /// The environment in half the width and height, at least one pixel: the next mip level. Pixels weigh by solid
    /// angle; of an odd number the last column and row are left out.
    pub fn halved(&self) -> Self {
        let [width, height] = [self.width, self.height].map(|side| (side / 2).max(1));
        let mut pixels = Vec::with_capacity(width as usize * height as usize);
        for y in 0..height {
            let rows = [2 * y, (2 * y + 1).min(self.height - 1)];
            let sines = rows.map(|row| ((row as f32 + 0.5) / self.height as f32 * PI).sine());
            for x in 0..width {
                let columns = [2 * x, (2 * x + 1).min(self.width - 1)];
                let mut sum = Vec3::ZERO;
                for (row, sine) in rows.into_iter().zip(sines) {
                    for column in columns {
                        sum += unpack_rgb9e5(self.pixels[(row * self.width + column) as usize]) * sine;
                    }
                }
                pixels.push(pack_rgb9e5(sum / (2.0 * (sines[0] + sines[1]))));
            }
        }
        Self { width, height, scale: self.scale, pixels }
    }

    /// The bytes of the file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(HEADER + 4 * self.pixels.len());
        bytes.extend((self.width as u16).to_le_bytes());
        bytes.extend((self.height as u16).to_le_bytes());
        bytes.extend(self.scale.to_le_bytes());
        bytes.extend(self.pixels.iter().flat_map(|pixel| pixel.to_le_bytes()));
        bytes
    }

    /// Reads the bytes of a file. Every pixel's bits are a colour.
    ///
    /// # Errors
    /// [`PackedEnvironmentError`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, PackedEnvironmentError> {
        let Some((&[a, b, c, d, e, f, g, h], rest)) = bytes.split_first_chunk::<HEADER>() else {
            return Err(PackedEnvironmentError::Length { expected: HEADER, found: bytes.len() });
        };
        let (width, height) = (u32::from(u16::from_le_bytes([a, b])), u32::from(u16::from_le_bytes([c, d])));
        if !(1..=MAX_WIDTH).contains(&width) || !(1..=MAX_WIDTH / 2).contains(&height) {
            return Err(PackedEnvironmentError::Size { width, height });
        }
        let scale = f32::from_le_bytes([e, f, g, h]);
        let is_power = scale.to_bits() & 0x807f_ffff == 0 && scale.is_normal();
        if !is_power || !(power(-EXPONENT)..=power(EXPONENT)).contains(&scale) {
            return Err(PackedEnvironmentError::Scale { scale });
        }
        let expected = HEADER + 4 * width as usize * height as usize;
        if bytes.len() != expected {
            return Err(PackedEnvironmentError::Length { expected, found: bytes.len() });
        }
        let (pixels, _) = rest.as_chunks::<4>();
        let pixels = pixels.iter().map(|&pixel| u32::from_le_bytes(pixel)).collect();
        Ok(Self { width, height, scale, pixels })
    }
}

/// The power of two that brings the largest channel to between 16,384 and 32,768 where it is above that, or below 1; 1
/// otherwise.
pub fn scale<'a>(pixels: impl IntoIterator<Item = &'a Vec3>) -> f32 {
    let largest = pixels.into_iter().fold(0.0f32, |most, pixel| most.max(pixel.max_element()));
    let is_within = largest <= 0.0 || (1.0..=LARGEST).contains(&largest);
    if is_within || !largest.is_finite() {
        return 1.0;
    }
    power((largest / LARGEST).logarithm2().ceil().clamp(-EXPONENT as f32, EXPONENT as f32) as i32)
}

/// Two to a power within the range of normal floats, exactly.
fn power(exponent: i32) -> f32 {
    f32::from_bits(((exponent + 127) as u32) << 23)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    fn noise(width: u32, height: u32, scale: f32) -> Environment {
        let mut stream = Stream::new(4, u64::from(width));
        let pixels = (0..width * height).map(|_| stream.sphere().abs() * scale).collect();
        Environment { width, height, pixels }
    }

    #[test]
    fn environments_of_any_unit_come_back_to_nine_bits() {
        for scale in [1e-12, 1e-3, 1.0, 40.0, 5e4, 1e7, 1e20] {
            let picture = noise(64, 32, scale);
            let packed = PackedEnvironment::new(&picture);
            let back = PackedEnvironment::from_bytes(&packed.to_bytes()).unwrap();
            assert_eq!(back, packed);
            for (a, b) in back.unpack().pixels.iter().zip(&picture.pixels) {
                assert!((*a - *b).abs().max_element() <= b.max_element() / 500.0, "{a} {b}");
            }
        }
        assert_eq!(PackedEnvironment::new(&noise(8, 4, 3.0)).scale, 1.0);
    }

    #[test]
    fn large_environments_are_reduced_and_keep_their_energy() {
        for (width, height) in [(512, 256), (130, 65), (100, 100), (1, 2000), (1, 1)] {
            let picture = noise(width, height, 2.0);
            let packed = PackedEnvironment::new(&picture);
            assert!(packed.to_bytes().len() <= 32 * 1024 + HEADER);
            assert_eq!(PackedEnvironment::from_bytes(&packed.to_bytes()).unwrap(), packed);
            let ratio = packed.unpack().energy() / picture.energy();
            assert!((ratio - 1.0).abs().max_element() < 2e-3, "{width}x{height}: {ratio}");
        }
    }

    #[test]
    fn mip_levels_keep_the_energy_down_to_a_pixel() {
        let picture = noise(128, 64, 3.0);
        let (mut packed, mut widths) = (PackedEnvironment::new(&picture), Vec::new());
        while packed.width > 1 {
            packed = packed.halved();
            widths.push(packed.width);
            let ratio = packed.unpack().energy() / picture.energy();
            assert!((ratio - 1.0).abs().max_element() < 1e-2, "{}: {ratio}", packed.width);
        }
        assert_eq!(widths, [64, 32, 16, 8, 4, 2, 1]);
        let odd = PackedEnvironment::new(&noise(25, 13, 3.0)).halved();
        assert_eq!([odd.width, odd.height, odd.pixels.len() as u32], [12, 6, 72]);
    }

    #[test]
    fn darkness_and_unusable_numbers_are_black() {
        let pixels = vec![Vec3::ZERO, Vec3::splat(f32::NAN), Vec3::splat(-1.0), Vec3::ZERO];
        let packed = PackedEnvironment::new(&Environment { width: 2, height: 2, pixels });
        assert!(packed.unpack().pixels.iter().all(|&pixel| pixel == Vec3::ZERO));
    }

    #[test]
    fn damaged_bytes_are_refused() {
        let bytes = PackedEnvironment::new(&noise(16, 8, 1.0)).to_bytes();
        let damaged = |change: &dyn Fn(&mut Vec<u8>)| {
            let mut bytes = bytes.clone();
            change(&mut bytes);
            PackedEnvironment::from_bytes(&bytes).unwrap_err().to_string()
        };
        for length in [0, 3, HEADER, bytes.len() - 1] {
            assert!(damaged(&|b| b.truncate(length)).contains("bytes instead of"));
        }
        assert!(damaged(&|b| b.push(0)).contains("bytes instead of"));
        assert!(damaged(&|b| b[1] = 200).contains("1x1 to 128x64"));
        assert!(damaged(&|b| b[2] = 0).contains("16x0"));
        for scale in [0.0, -1.0, 3.0, f32::NAN, f32::INFINITY, 1e-40, f32::MIN_POSITIVE] {
            assert!(damaged(&|b| b[4..8].copy_from_slice(&f32::to_le_bytes(scale))).contains("power of two"));
        }
    }
}
