//! Transport links, packed.
//!
//! A link says what a receiver gets from unit scalar irradiance at one sender (paper, Eq. 16 and 17, with the
//! 1/π of the Lambertian reflectance and the sender's mean reflectance folded in, so that a closed room of albedo
//! ρ sums to ρ). Its colour is the sender's ([`Point::tint`](crate::rbn::bulk::Point::tint)): one amount
//! serves all channels.
//!
//! ```text
//! Link: 4 bytes        bits  0..19  the sender's index
//!                      bits 20..25  mantissa m
//!                      bits 26..30  exponent e: amount = (1 + m / 64) · 2^(e - 30), and 0 for e = m = 0
//!                      bit  31      sign
//! VectorLink: 8 bytes  a Link, and in bits 0..15 of the second word the direction, octahedral snorm8x2
//! LaterLink: 8 bytes   the sender's index, and a colour (rgb9e5)
//! ```
//!
//! The senders of a row ascend.

use crate::octahedral;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// Most senders that links can name.
pub const MAX_SENDERS: usize = 1 << 20;
const MANTISSA_BITS: u32 = 6;
const EXPONENT_BIAS: i32 = 30;

/// A direction as links mean it: octahedral snorm8x2, decoded and rounded to [`DIRECTION_STEPS`] steps a component, so
/// that what the GPU reads ([`spread_direction`]) is the same number.
#[inline]
pub fn unpack_direction(bits: u16) -> Vec3 {
    (octahedral::unpack_snorm8(bits) * DIRECTION_STEPS).round() / DIRECTION_STEPS
}

/// The direction as three 10-bit two's complement numbers, x low: cheaper to decode than the octahedral map.
pub fn spread_direction(bits: u16) -> u32 {
    let steps = (octahedral::unpack_snorm8(bits) * DIRECTION_STEPS).round().as_ivec3();
    let [x, y, z] = steps.to_array().map(|c| c as u32 & 1023);
    x | y << 10 | z << 20
}

/// Steps from 0 to 1 of a direction's component.
pub const DIRECTION_STEPS: f32 = 511.0;

/// Whatever names a sender.
pub trait Sent: Copy {
    /// The sender's index.
    fn sender(self) -> usize;
}

/// A link of irradiance along the receiver's normal; the module's head gives the bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub struct Link(pub u32);

/// A link of vector irradiance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct VectorLink {
    /// Sender and amount.
    pub link: Link,
    /// Direction, octahedral snorm8x2, in the low half.
    pub direction: u32,
}

/// A link between points of the coarse levels: all further bounces of the sender's irradiance, by channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct LaterLink {
    /// The sender's index.
    pub sender: u32,
    /// Irradiance at the receiver per unit irradiance at the sender: rgb9e5.
    pub colour: u32,
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
    /// Packs a signed amount: 6 bits of mantissa, at most 3.96. Amounts under 2⁻³⁰ become zero.
    pub fn pack(sender: u32, amount: f32) -> Self {
        debug_assert!((sender as usize) < MAX_SENDERS);
        let size = amount.abs().min(3.96);
        // Rounds to the last bit kept; a carry goes into the exponent.
        let rounded = (size.to_bits() + (1 << (22 - MANTISSA_BITS))) >> (23 - MANTISSA_BITS);
        let least = ((127 - EXPONENT_BIAS) as u32) << MANTISSA_BITS;
        let code = rounded.saturating_sub(least).min((1 << (5 + MANTISSA_BITS)) - 1);
        let sign = if code > 0 && amount < 0.0 { 1 << 31 } else { 0 };
        Self(sender | code << 20 | sign)
    }

    /// Signed amount.
    #[inline]
    pub fn amount(self) -> f32 {
        let code = (self.0 >> 20) & 0x7ff;
        if code == 0 {
            return 0.0;
        }
        let size = (code << (23 - MANTISSA_BITS)) + (((127 - EXPONENT_BIAS) as u32) << 23);
        f32::from_bits(size | (self.0 & 1 << 31))
    }

    /// The same amount from another sender.
    #[inline]
    pub fn at(self, sender: u32) -> Self {
        Self((self.0 & !(MAX_SENDERS as u32 - 1)) | sender)
    }
}

impl Sent for Link {
    #[inline]
    fn sender(self) -> usize {
        self.0 as usize & (MAX_SENDERS - 1)
    }
}

impl VectorLink {
    /// Packs a vector: its length as the amount, its direction.
    pub fn pack(sender: u32, vector: Vec3) -> Self {
        let length = vector.length();
        if length < 1e-20 {
            return Self { link: Link::pack(sender, 0.0), direction: 0 };
        }
        let direction = octahedral::pack_snorm8(vector / length);
        // The part along the rounded direction.
        let along = unpack_direction(direction).dot(vector);
        Self { link: Link::pack(sender, along), direction: direction as u32 }
    }

    /// The vector: towards the sender, or away from it where the link takes light back.
    #[inline]
    pub fn vector(self) -> Vec3 {
        unpack_direction(self.direction as u16) * self.link.amount()
    }
}

impl Sent for VectorLink {
    #[inline]
    fn sender(self) -> usize {
        self.link.sender()
    }
}

impl LaterLink {
    /// Packs a colour that is not negative: six bits of its largest channel.
    pub fn pack(sender: u32, colour: Vec3) -> Self {
        Self { sender, colour: crate::colour::pack_rounded(colour, 8) }
    }

    /// Irradiance per unit irradiance, by channel.
    #[inline]
    pub fn colour(self) -> Vec3 {
        crate::colour::unpack_rgb9e5(self.colour)
    }
}

impl Sent for LaterLink {
    #[inline]
    fn sender(self) -> usize {
        self.sender as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amounts_keep_six_bits_and_their_signs() {
        for k in 0..2000 {
            let amount = 2f32.powf(-29.0 + 30.9 * k as f32 / 2000.0) * if k % 2 == 0 { 1.0 } else { -1.0 };
            let link = Link::pack(k * 524, amount);
            assert!(
                (link.amount() - amount).abs() <= amount.abs() / 127.0,
                "{amount} became {}",
                link.amount()
            );
            assert_eq!(link.sender(), k as usize * 524);
            assert_eq!(link.at(7), Link::pack(7, amount));
        }
        assert_eq!(Link::pack(MAX_SENDERS as u32 - 1, 0.0).amount(), 0.0);
        assert_eq!(Link::pack(3, -1e-12).amount(), 0.0);
        assert!(Link::pack(3, -50.0).amount() < -3.9);
    }

    #[test]
    fn vectors_survive() {
        for v in [Vec3::new(0.3, -0.5, 0.8), Vec3::NEG_Z * 1e-4, Vec3::new(-2e-3, 1e-3, 0.0)] {
            let back = VectorLink::pack(5, v).vector();
            assert!(back.distance(v) < 0.02 * v.length(), "{v} became {back}");
        }
        assert_eq!(VectorLink::pack(5, Vec3::ZERO).vector(), Vec3::ZERO);
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
}
