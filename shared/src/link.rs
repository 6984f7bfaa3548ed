//! Transport links, packed.
//!
//! A link holds the irradiance at a receiver along its normal per unit irradiance at a sender (paper, Eq. 16 and 17,
//! with the 1/π of the Lambertian reflectance and the sender's mean reflectance folded in, so that a closed room of
//! albedo ρ sums to ρ). The direction of the light follows from the sender's position; its colour is the sender's
//! tint ([`Point::tint`](crate::rbn::bulk::Point::tint)), so that one amount serves every channel.
//!
//! ```text
//! Link: 4 bytes        bits  0..19  the sender's index
//!                      bits 20..22  mantissa m
//!                      bits 23..27  exponent e: amount = (1 + m / 8) · 2^(e - 30), and 0 for e = m = 0
//!                      bit  31      sign
//! LaterLink: 8 bytes   the sender's index, and a colour (rgb9e5)
//! SourceLink: 4 bytes  bits  0..12  the source's index
//!                      bits 13..31  signed steps: amount = steps · the step of the source
//! ```
//!
//! The senders of a row ascend.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// Maximum number of senders addressable by links.
pub const MAX_SENDERS: usize = 1 << 20;
const MANTISSA_BITS: u32 = 3;
const EXPONENT_BIAS: i32 = 30;

/// Entry with a sender.
pub trait Sent: Copy {
    /// The sender's index.
    fn sender(self) -> usize;
}

/// Link of irradiance along the receiver's normal; see the module's head for the bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub struct Link(pub u32);

/// Link between points of the coarse levels: further bounces of the sender's irradiance, by channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct LaterLink {
    /// The sender's index.
    pub sender: u32,
    /// Irradiance at the receiver per unit irradiance at the sender: rgb9e5.
    pub colour: u32,
}

/// Link from a [source](crate::rbn::sources): a number of equal steps. Rows of sources hold differences from a prediction
/// that may be far larger than the value itself, so that a relative rounding error would be too coarse.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub struct SourceLink(pub u32);

/// Maximum number of sources.
pub const MAX_SOURCES: usize = 1 << SOURCE_BITS;
/// Greatest magnitude of [`SourceLink::steps`].
pub const MAX_STEPS: i32 = u16::MAX as i32;
const SOURCE_BITS: u32 = 13;

impl SourceLink {
    /// Packs a number of steps, at most [`MAX_STEPS`] in magnitude.
    pub fn pack(source: u32, steps: i32) -> Self {
        debug_assert!((source as usize) < MAX_SOURCES && steps.abs() <= MAX_STEPS);
        Self(source | (steps as u32) << SOURCE_BITS)
    }

    /// Number of steps.
    #[inline]
    pub fn steps(self) -> i32 {
        self.0 as i32 >> SOURCE_BITS
    }
}

impl Sent for SourceLink {
    #[inline]
    fn sender(self) -> usize {
        self.0 as usize & (MAX_SOURCES - 1)
    }
}

impl Link {
    /// Packs a signed amount: 3 bits of mantissa, at most 3.7. Amounts under 2⁻³⁰ become zero. The baker carries the
    /// rounding error over to the next link of the row.
    pub fn pack(sender: u32, amount: f32) -> Self {
        debug_assert!((sender as usize) < MAX_SENDERS);
        let size = amount.abs().min(3.7);
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
        let code = (self.0 >> 20) & ((1 << (5 + MANTISSA_BITS)) - 1);
        if code == 0 {
            return 0.0;
        }
        let size = (code << (23 - MANTISSA_BITS)) + (((127 - EXPONENT_BIAS) as u32) << 23);
        f32::from_bits(size | (self.0 & 1 << 31))
    }

    /// Returns a link with the same amount from `sender`.
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

impl LaterLink {
    /// Packs a non-negative colour: five bits for its largest channel.
    pub fn pack(sender: u32, colour: Vec3) -> Self {
        Self { sender, colour: crate::colour::pack_rounded(colour, 16) }
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
    fn source_links_hold_source_and_steps() {
        for (source, steps) in [(0, 0), (8191, MAX_STEPS), (17, -1), (4095, -MAX_STEPS), (1, 300)] {
            let link = SourceLink::pack(source, steps);
            assert_eq!((link.sender(), link.steps()), (source as usize, steps));
        }
    }

    #[test]
    fn amounts_keep_their_signs_and_three_bits_of_mantissa() {
        for k in 0..2000 {
            let amount = 2f32.powf(-29.0 + 30.8 * k as f32 / 2000.0) * if k % 2 == 0 { 1.0 } else { -1.0 };
            let link = Link::pack(k * 524, amount);
            assert!(
                (link.amount() - amount).abs() <= amount.abs() / 15.0,
                "{amount} became {}",
                link.amount()
            );
            assert_eq!(link.sender(), k as usize * 524);
            assert_eq!(link.at(7), Link::pack(7, amount));
        }
        assert_eq!(Link::pack(MAX_SENDERS as u32 - 1, 0.0).amount(), 0.0);
        assert_eq!(Link::pack(3, -1e-12).amount(), 0.0);
        assert!(Link::pack(3, -50.0).amount() < -3.6);
    }
}
