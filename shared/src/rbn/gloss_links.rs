//! Glossy links: where the light comes from that surfaces send to a point of a glossy surface.
//!
//! ```text
//! GlossLink: 8 bytes   the sender's index
//!                      bits  0..7   direction to the sender, octahedral: x, 127 for 0 and 254 for 1
//!                      bits  8..15  y, likewise
//!                      bits 16..23  amount a: 2^((a − 192) / 16), and 0 for a = 0
//!                      bits 24..31  mean resultant length of the light's directions, in 255ths
//! ```
//!
//! Senders are those of [`Link`](crate::link::Link), and beyond the points' indices the [groups](super::sources) of emissive
//! surfaces. A point's arriving radiance is the sum of its links: for unit light of a sender, the amount is the integral of
//! radiance over solid angle. The light of a point is what it [sends](crate::relight::sent), and the amount has reflectance
//! and 1/π in it; that of a group is its mean radiance.

use super::limits::{MAX_ROW, all_sane};
use super::{LinkMatrix, RbnError};
use crate::elementary::Elementary;
use crate::octahedral::{pack_bytes, unpack_bytes};
use crate::rbn::codec::columns::{Columns, Kind};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// Link of radiance; see the module's head for the bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct GlossLink {
    /// The sender's index.
    pub sender: u32,
    /// Direction, amount and mean resultant length.
    pub packed: u32,
}

impl Columns for GlossLink {
    const KINDS: &'static [Kind] = &[Kind::Number; 2];
}

/// Code of an amount of 1.
const ONE: f32 = 192.0;
/// Codes of an octave.
const OCTAVE: f32 = 16.0;

impl GlossLink {
    /// Packs a link: `direction` is the mean, not zero, `length` that of the mean of unit vectors. Amounts below the least code
    /// become zero; the baker carries the rounding error over to the next link of the row.
    pub fn pack(sender: u32, direction: Vec3, amount: f32, length: f32) -> Self {
        let code = match amount > 0.0 {
            true => (ONE + OCTAVE * amount.logarithm2()).round().clamp(0.0, 255.0),
            false => 0.0,
        };
        let length = (length.clamp(0.0, 1.0) * 255.0).round();
        let byte = |x: f32| x as u8 as u32;
        Self { sender, packed: pack_bytes(direction) | byte(code) << 16 | byte(length) << 24 }
    }

    /// Unit vector to the sender.
    pub fn direction(self) -> Vec3 {
        unpack_bytes(self.packed)
    }

    /// Integral of radiance over solid angle for unit light of the sender.
    pub fn amount(self) -> f32 {
        match self.packed >> 16 & 255 {
            0 => 0.0,
            code => ((code as f32 - ONE) / OCTAVE).exponential2(),
        }
    }

    /// Length of the mean of the light's unit directions: 1 where all are the same.
    pub fn mean_length(self) -> f32 {
        (self.packed >> 24) as f32 / 255.0
    }
}

/// Rows of links: one for each of the first points with glossy transfer.
pub type GlossLinks = LinkMatrix<GlossLink>;

/// Checks links of unknown origin: at most `rows` rows, for a file with so many points, senders and emissive groups.
///
/// # Errors
/// [`RbnError::Invalid`].
pub(crate) fn check(
    links: &GlossLinks,
    emission: &[[f32; 3]],
    rows: usize,
    [points, senders, groups]: [usize; 3],
) -> Result<(), RbnError> {
    let offsets = &links.offsets;
    let is_whole = offsets.first() == Some(&0)
        && links.len() <= rows
        && offsets.windows(2).all(|w| w[0] <= w[1] && (w[1] - w[0]) as usize <= MAX_ROW)
        && offsets.last().is_some_and(|end| *end as usize == links.links.len());
    if !is_whole {
        return Err(RbnError::invalid("GLLO", "rows do not follow each other, or do not fit the points"));
    }
    let is_positive = |radiance: &[f32; 3]| all_sane(radiance) && radiance.iter().all(|x| *x >= 0.0);
    if !emission.is_empty() && emission.len() != groups || !emission.iter().all(is_positive) {
        return Err(RbnError::invalid("GLSY", "radiance of emissive groups"));
    }
    let is_sender = |link: &GlossLink| {
        let sender = link.sender as usize;
        sender < senders || (points..points + emission.len()).contains(&sender)
    };
    if !links.links.iter().all(is_sender) {
        return Err(RbnError::invalid("GLLK", "a sender is out of range"));
    }
    if !links.iter().all(|row| row.windows(2).all(|pair| pair[0].sender <= pair[1].sender)) {
        return Err(RbnError::invalid("GLLK", "the senders of a row are out of order"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    #[test]
    fn a_link_holds_direction_amount_and_mean_length() {
        let mut stream = Stream::new(5, 5);
        for i in 0..2000 {
            let (direction, length) = (stream.sphere(), stream.unit());
            let amount = 2f32.powf(-11.0 + 14.5 * stream.unit());
            let link = GlossLink::pack(i, direction, amount, length);
            assert!(link.direction().angle_between(direction).to_degrees() < 0.9);
            assert!((link.amount() / amount - 1.0).abs() < 0.023, "{amount} became {}", link.amount());
            assert!((link.mean_length() - length).abs() < 0.002);
            assert_eq!(link.sender, i);
        }
        for axis in [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z] {
            assert_eq!(GlossLink::pack(0, axis, 1.0, 1.0).direction(), axis);
        }
        assert_eq!(GlossLink::pack(0, Vec3::X, 1.0, 1.0).amount(), 1.0);
        assert_eq!(GlossLink::pack(0, Vec3::X, 0.0, 1.0).amount(), 0.0);
    }
}
