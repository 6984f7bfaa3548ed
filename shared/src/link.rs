//! The packed transport link: 8 bytes.
//!
//! A link carries the vector irradiance that a receiver gets, per colour channel, from unit
//! scalar irradiance at one sender (paper, Eq. 16 and 17, with the 1/π of the Lambertian
//! reflectance folded in, so that a closed room of albedo ρ sums to ρ). It is stored as one
//! direction for all channels and a signed magnitude per channel:
//!
//! ```text
//! word 0   bits  0.. 8  red mantissa, 9-bit two's complement
//!          bits  9..17  green mantissa
//!          bits 18..26  blue mantissa
//!          bits 27..31  shared exponent E: magnitude = mantissa · 2^(E - 31 - 7)
//! word 1   bits  0..15  column: the sender's index, low 16 bits
//!          bits 16..31  direction, octahedral snorm8x2
//! ```
//!
//! The columns of a row ascend. A link whose word 0 is [`PAGE_MARK`] carries no light: its
//! column field is the page, the upper bits of the senders' indices that follow in that row.

use crate::octahedral;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// Mantissas of zero under the largest exponent: a page change, not a link.
pub const PAGE_MARK: u32 = 31 << 27;
const MANTISSA_MAX: f32 = 255.0;
const EXPONENT_BIAS: i32 = 31 + 7;

/// One packed link; the module's head gives the bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Link {
    /// Colour mantissas and shared exponent.
    pub colour: u32,
    /// Column (low half) and direction (high half).
    pub column_direction: u32,
}

/// Vector irradiance per colour channel: `rgb[c]` is a 3-vector pointing towards the light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VectorRgb {
    /// Red, green and blue 3-vectors.
    pub rgb: [Vec3; 3],
}

impl VectorRgb {
    /// No light.
    pub const ZERO: Self = Self { rgb: [Vec3::ZERO; 3] };

    /// `self += factor * other`.
    #[inline]
    pub fn add_scaled(&mut self, factor: f32, other: &Self) {
        for c in 0..3 {
            self.rgb[c] += factor * other.rgb[c];
        }
    }

    /// The vectors turned as the unit normal `from` turns into `to`, so that the irradiance along
    /// the normal stays.
    #[inline]
    pub fn turned(&self, from: Vec3, to: Vec3) -> Self {
        Self { rgb: self.rgb.map(|v| turn(v, from, to)) }
    }

    /// Irradiance per channel on a surface with this unit normal; not clamped.
    #[inline]
    pub fn irradiance(&self, normal: Vec3) -> Vec3 {
        Vec3::new(self.rgb[0].dot(normal), self.rgb[1].dot(normal), self.rgb[2].dot(normal))
    }

    /// Frobenius norm over channels, divided by √3: the length of a grey vector.
    #[inline]
    pub fn magnitude(&self) -> f32 {
        (self.rgb.iter().map(|v| v.length_squared()).sum::<f32>() / 3.0).sqrt()
    }
}

/// Turns `v` as the unit vector `from` turns into `to`, the short way: `turn(from, from, to)` is
/// `to`. Left as it is where the two are nearly opposite.
#[inline]
pub fn turn(v: Vec3, from: Vec3, to: Vec3) -> Vec3 {
    let axis = from.cross(to);
    let across = axis.cross(v);
    let cosine = 1.0 + from.dot(to);
    if cosine < 0.01 { v } else { v + across + axis.cross(across) / cosine }
}

impl Link {
    /// The page change that lets columns from `page << 16` on follow.
    pub fn page(page: u16) -> Self {
        Self { colour: PAGE_MARK, column_direction: page as u32 }
    }

    /// Packs one direction with a signed magnitude per channel. Magnitudes are clamped to
    /// ±2 and flushed to zero below 2⁻³⁹; the largest keeps 8 bits.
    pub fn pack(column: u16, direction: Vec3, magnitude: Vec3) -> Self {
        let direction = octahedral::pack_snorm8(direction) as u32;
        let largest = magnitude.abs().max_element().min(1.99);
        let mut exponent = 0;
        if largest > 0.0 {
            // The smallest exponent whose mantissas all fit: largest <= 255 * 2^(E - 38).
            exponent = ((largest / MANTISSA_MAX).log2().ceil() as i32 + EXPONENT_BIAS).clamp(0, 31);
        }
        let step = ((exponent - EXPONENT_BIAS) as f32).exp2();
        let mantissa = |x: f32| ((x / step).round().clamp(-MANTISSA_MAX, MANTISSA_MAX) as i32 as u32) & 511;
        let mantissas = mantissa(magnitude.x) | mantissa(magnitude.y) << 9 | mantissa(magnitude.z) << 18;
        let exponent = if mantissas == 0 { 0 } else { exponent as u32 };
        Self { colour: mantissas | exponent << 27, column_direction: column as u32 | direction << 16 }
    }

    /// Packs the best fit of one direction and three magnitudes to three vectors: the dominant
    /// right singular vector, by power iteration, and the projections of the channels onto it.
    pub fn pack_vectors(column: u16, vectors: &VectorRgb) -> Self {
        let [r, g, b] = vectors.rgb;
        let mut direction = r + g + b;
        if direction.length_squared() < 1e-3 * (r.length_squared() + g.length_squared() + b.length_squared())
        {
            direction = if r.length_squared() > g.length_squared() { r } else { g };
            direction = if b.length_squared() > direction.length_squared() { b } else { direction };
        }
        if direction.length_squared() == 0.0 {
            return Self::pack(column, Vec3::Z, Vec3::ZERO);
        }
        for _ in 0..3 {
            direction = direction.normalize();
            direction = r * r.dot(direction) + g * g.dot(direction) + b * b.dot(direction);
        }
        if direction.length_squared() < f32::MIN_POSITIVE {
            return Self::pack(column, Vec3::Z, Vec3::ZERO);
        }
        let direction = octahedral::unpack_snorm8(octahedral::pack_snorm8(direction.normalize()));
        Self::pack(column, direction, vectors.irradiance(direction))
    }

    /// The same link from the sender whose index has these low 16 bits.
    #[inline]
    pub fn at(self, column: u16) -> Self {
        Self { column_direction: (self.column_direction & 0xffff_0000) | column as u32, ..self }
    }

    /// True for a page change; false for a link.
    #[inline]
    pub fn is_page(self) -> bool {
        self.colour == PAGE_MARK
    }

    /// The low 16 bits of the sender's index, or the page.
    #[inline]
    pub fn column(self) -> u16 {
        self.column_direction as u16
    }

    /// Unit direction towards the sender (away from it where the link takes light back).
    #[inline]
    pub fn direction(self) -> Vec3 {
        octahedral::unpack_snorm8((self.column_direction >> 16) as u16)
    }

    /// Signed magnitude per channel.
    #[inline]
    pub fn magnitude(self) -> Vec3 {
        // 2^(E - 38), by its bits.
        let step = f32::from_bits(((self.colour >> 27) + 127 - EXPONENT_BIAS as u32) << 23);
        let mantissa = |shift: u32| (((self.colour >> shift) << 23) as i32 >> 23) as f32;
        Vec3::new(mantissa(0), mantissa(9), mantissa(18)) * step
    }

    /// The vectors that this link stands for.
    #[inline]
    pub fn vectors(self) -> VectorRgb {
        let (d, m) = (self.direction(), self.magnitude());
        VectorRgb { rgb: [d * m.x, d * m.y, d * m.z] }
    }
}

/// Number of links of a row or of many; page marks do not count.
pub fn count(links: &[Link]) -> usize {
    links.iter().filter(|link| !link.is_page()).count()
}

/// The links of one row, each with its full column index.
pub fn columns(row: &[Link]) -> impl Iterator<Item = (usize, Link)> + '_ {
    let mut base = 0;
    row.iter().filter_map(move |&link| {
        if link.is_page() {
            base = (link.column() as usize) << 16;
            None
        } else {
            Some((base + link.column() as usize, link))
        }
    })
}

/// Builds rows: adds the page marks where columns need them. Columns must ascend within a row.
#[derive(Debug, Default)]
pub struct RowWriter {
    page: u16,
}

impl RowWriter {
    /// Appends `link` for the sender `column` to `row`, with a page mark before it when the page changes.
    pub fn push(&mut self, row: &mut Vec<Link>, column: u32, link: Link) {
        let page = (column >> 16) as u16;
        if page != self.page {
            row.push(Link::page(page));
            self.page = page;
        }
        row.push(link.at(column as u16));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn magnitudes_keep_eight_bits_and_their_signs() {
        for k in 0..1000 {
            let scale = 2f32.powf(-25.0 + 25.9 * k as f32 / 1000.0);
            let m = Vec3::new(scale, -0.37 * scale, 0.011 * scale);
            let back = Link::pack(7, Vec3::X, m).magnitude();
            assert!((back - m).abs().max_element() <= scale / 250.0, "{m} became {back}");
        }
        assert_eq!(Link::pack(7, Vec3::X, Vec3::ZERO).magnitude(), Vec3::ZERO);
        assert_eq!(Link::pack(65535, Vec3::X, Vec3::ONE).column(), 65535);
    }

    #[test]
    fn no_link_looks_like_a_page() {
        for m in [0.0, 1e-30, 1e-9, 1.0, 5.0] {
            assert!(!Link::pack(3, Vec3::Y, Vec3::splat(m)).is_page());
            assert!(!Link::pack(3, Vec3::Y, Vec3::splat(-m)).is_page());
        }
    }

    #[test]
    fn rank_one_vectors_survive() {
        let d = Vec3::new(0.3, -0.5, 0.8).normalize();
        let v = VectorRgb { rgb: [d * 0.02, d * -0.01, d * 0.005] };
        let back = Link::pack_vectors(1, &v).vectors();
        for c in 0..3 {
            assert!(back.rgb[c].distance(v.rgb[c]) < 0.02 * 0.02);
        }
    }

    #[test]
    fn turning_keeps_lengths_and_irradiance() {
        let (a, b) = (Vec3::new(0.6, 0.8, 0.0), Vec3::new(0.0, 0.28, 0.96));
        let v = Vec3::new(0.3, -0.2, 0.9);
        assert!((turn(a, a, b) - b).length() < 1e-6);
        assert!((turn(v, a, b).length() - v.length()).abs() < 1e-6);
        assert!((turn(v, a, b).dot(b) - v.dot(a)).abs() < 1e-6);
        assert_eq!(turn(v, a, a), v);
    }

    #[test]
    fn pages_carry_columns_past_sixteen_bits() {
        let mut row = Vec::new();
        let mut writer = RowWriter::default();
        let wanted = [0u32, 5, 65535, 65536, 70000, 200_000, 262_144];
        for &column in &wanted {
            writer.push(&mut row, column, Link::pack(0, Vec3::X, Vec3::ONE));
        }
        let got: Vec<u32> = columns(&row).map(|(c, _)| c as u32).collect();
        assert_eq!(got, wanted);
    }
}
