//! Light of a fixed solution: section `LGRP`, bincode 2 standard configuration, and section `LVAL`, values of all points.
//! Files with both have no links: their lights stay in place, and change in strength and colour.
//!
//! A group of light is a light of section `META`. It has a column of values: the bounced irradiance of every point along
//! its normal, per unit strength of the light. What no lamp gives directly, the light of a sky and of emissive surfaces,
//! has a second column.
//!
//! A value counts steps from the mean of the point's parents ([`GroupValue`]). Steps are those of a binary logarithm,
//! linear within each power of two, as the bits of a float are: they are equal on every machine, and about as visible in
//! dark places as in bright ones.

#[cfg(feature = "radiosity")]
use super::limits::sane;
use super::limits::{LARGEST, MAX_BYTES};
use super::{RbnError, small};
use crate::interpolation::{Rows, mean};
use bincode::{Decode, Encode};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// Steps per power of two, as a power of two: a value is off by at most 1.6%.
const STEP_BITS: u32 = 5;
/// Bits of a float below a step.
const SHIFT: u32 = 23 - STEP_BITS;
/// Bits of the three numbers of steps.
const BITS: [u32; 3] = [11, 11, 10];

/// Steps of a point's irradiance from the mean of its parents' irradiance: green, then red and blue less green. 4 bytes.
///
/// ```text
/// bits  0..10  steps of green, signed
/// bits 11..21  steps of red less those of green, signed
/// bits 22..31  steps of blue less those of green, signed
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub struct GroupValue(pub u32);

impl GroupValue {
    /// Packs numbers of steps of red, green and blue; what does not fit becomes the nearest number that does.
    fn pack([red, green, blue]: [i32; 3]) -> Self {
        let fit = |steps: i32, bits: u32| steps.clamp(-(1 << (bits - 1)), (1 << (bits - 1)) - 1);
        let green = fit(green, BITS[0]);
        Self::join([green, fit(red - green, BITS[1]), fit(blue - green, BITS[2])])
    }

    /// Packs the three signed numbers.
    pub(crate) fn join(numbers: [i32; 3]) -> Self {
        let [first, second, third] = numbers.map(|number| number as u32);
        let masked = |number: u32, bits: u32| number & ((1 << bits) - 1);
        Self(
            masked(first, BITS[0])
                | masked(second, BITS[1]) << BITS[0]
                | masked(third, BITS[2]) << (BITS[0] + BITS[1]),
        )
    }

    /// Unpacks the three signed numbers.
    pub(crate) fn split(self) -> [i32; 3] {
        let word = self.0 as i32;
        let third = word >> (BITS[0] + BITS[1]);
        [word << (32 - BITS[0]) >> (32 - BITS[0]), word << BITS[2] >> (32 - BITS[1]), third]
    }

    /// Numbers of steps of red, green and blue.
    fn steps(self) -> [i32; 3] {
        let [green, red, blue] = self.split();
        [red + green, green, blue + green]
    }

    /// Returns the value nearest to an irradiance; `predicted` is the mean of the parents.
    pub fn nearest(irradiance: Vec3, predicted: Vec3, floor: f32) -> Self {
        Self::pack(std::array::from_fn(|channel| {
            let above =
                i64::from(bits(irradiance[channel], floor)) - i64::from(bits(predicted[channel], floor));
            ((above + (1 << (SHIFT - 1))) >> SHIFT) as i32
        }))
    }

    /// Returns the irradiance; `predicted` is the mean of the parents.
    pub fn irradiance(self, predicted: Vec3, floor: f32) -> Vec3 {
        if self == Self::default() {
            return predicted;
        }
        let mut irradiance = predicted.to_array();
        for (x, steps) in irradiance.iter_mut().zip(self.steps()) {
            // Neither is near the ends of 32 bits.
            let bits = bits(*x, floor) as i32 + (steps << SHIFT);
            let bits = bits.clamp(0, LARGEST.to_bits() as i32) as u32;
            *x = (f32::from_bits(bits) - floor).max(0.0);
        }
        irradiance.into()
    }
}

/// Place on the logarithm's scale, in steps of 2^-`SHIFT`.
fn bits(irradiance: f32, floor: f32) -> u32 {
    (irradiance.clamp(0.0, LARGEST) + floor).to_bits()
}

/// A group of light.
#[derive(Clone, Debug, Default, PartialEq, Encode, Decode)]
pub struct LightGroup {
    /// Irradiance below which steps are of equal size, per unit strength. Above 0.
    pub floor: f32,
    /// Whether there is a column of light straight from the group, as of a sky and of emissive surfaces.
    pub has_direct: bool,
}

/// Groups of light of a file, and their values; empty where lights may move.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LightGroups {
    /// A group for each light of the file, in order.
    pub groups: Vec<LightGroup>,
    /// Values, column after column; a column has a value for each point, level after level. The columns are those of
    /// the groups' bounced light, then those of direct light.
    pub values: Vec<GroupValue>,
}

impl LightGroups {
    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.groups.len() + self.groups.iter().filter(|group| group.has_direct).count()
    }

    /// The group of each column, in the columns' order.
    pub fn column_groups(&self) -> impl Iterator<Item = usize> + '_ {
        let all = 0..self.groups.len();
        all.clone().chain(all.filter(|group| self.groups[*group].has_direct))
    }

    /// Returns the number of the column of a group's direct light; `None` for lamps.
    pub fn direct_column(&self, group: usize) -> Option<usize> {
        let before = self.groups[..group].iter().filter(|group| group.has_direct).count();
        self.groups[group].has_direct.then(|| self.groups.len() + before)
    }

    /// Returns the irradiance of all points by a column of a group, per unit strength, linear RGB. `push` has the
    /// parents of the points.
    pub fn irradiance(&self, group: usize, column: usize, push: Rows<'_>) -> Vec<Vec3> {
        let values = &self.values[column * push.len()..][..push.len()];
        let mut out: Vec<Vec3> = Vec::with_capacity(values.len());
        for (i, value) in values.iter().enumerate() {
            let predicted = mean(push.row(i), Vec3::ZERO, |parent| out[parent]).unwrap_or(Vec3::ZERO);
            out.push(value.irradiance(predicted, self.groups[group].floor));
        }
        out
    }

    /// Appends a column: the values nearest to the irradiance of the points. A point that is not `stored` has the mean of
    /// its parents.
    pub fn push_column(
        &mut self,
        irradiance: &[Vec3],
        floor: f32,
        push: Rows<'_>,
        stored: impl Fn(usize) -> bool,
    ) {
        let mut rounded: Vec<Vec3> = Vec::with_capacity(irradiance.len());
        for (i, irradiance) in irradiance.iter().enumerate() {
            let predicted = mean(push.row(i), Vec3::ZERO, |parent| rounded[parent]).unwrap_or(Vec3::ZERO);
            let value = match stored(i) {
                true => GroupValue::nearest(*irradiance, predicted, floor),
                false => GroupValue::default(),
            };
            rounded.push(value.irradiance(predicted, floor));
            self.values.push(value);
        }
    }
}

/// Encodes section `LGRP`; `None` without groups.
///
/// # Errors
/// [`RbnError::TooLarge`] past [`MAX_BYTES`].
pub fn encode(groups: &[LightGroup]) -> Result<Option<Vec<u8>>, RbnError> {
    if groups.is_empty() {
        return Ok(None);
    }
    let too_large = || format!("groups of light need over {MAX_BYTES} bytes: solve for fewer lights");
    small::encode(groups, too_large).map(Some)
}

/// Decodes section `LGRP`; the caller checks it.
///
/// # Errors
/// [`RbnError::Invalid`].
pub fn decode(bytes: &[u8]) -> Result<Vec<LightGroup>, RbnError> {
    let groups: Vec<LightGroup> = small::decode("LGRP", bytes)?;
    if groups.is_empty() { Err(RbnError::invalid("LGRP", "it has no group")) } else { Ok(groups) }
}

/// Checks groups and values of unknown origin, for a file with so many lights and points.
///
/// # Errors
/// [`RbnError::Invalid`].
#[cfg(feature = "radiosity")]
pub(crate) fn check(all: &LightGroups, lights: usize, points: usize) -> Result<(), RbnError> {
    if all.groups.is_empty() && all.values.is_empty() {
        return Ok(());
    }
    if all.groups.len() != lights {
        return Err(RbnError::invalid("LGRP", format!("{} groups for {lights} lights", all.groups.len())));
    }
    if !all.groups.iter().all(|group| sane(group.floor) && group.floor.is_normal() && group.floor > 0.0) {
        return Err(RbnError::invalid("LGRP", "a floor is not above 0, or far too large"));
    }
    if all.columns().checked_mul(points) != Some(all.values.len()) {
        return Err(RbnError::invalid("LVAL", "it does not fit the groups and points"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interpolation::{Entry, pack_row};

    #[test]
    fn steps_of_all_channels_come_back() {
        for green in [-1024, -3, 0, 1, 1023] {
            for other in [-500, -1, 0, 7, 500] {
                let steps = [green + other, green, green - other];
                assert_eq!(GroupValue::pack(steps).steps(), steps);
            }
        }
        // What does not fit is as near as it can be.
        assert_eq!(GroupValue::pack([5000, 5000, 0]).steps(), [2046, 1023, 511]);
    }

    #[test]
    fn values_are_near_in_proportion_and_never_below_zero() {
        let floor = 1e-3;
        for k in 0..4000 {
            let irradiance = Vec3::new(1.0, 0.8, 0.3) * 2f32.powf(-14.0 + 24.0 * k as f32 / 4000.0);
            let predicted = Vec3::new(0.2, 0.3, 0.1) * 2f32.powf(-3.0 + (k % 7) as f32);
            let back = GroupValue::nearest(irradiance, predicted, floor).irradiance(predicted, floor);
            let off = (back - irradiance).abs() / (irradiance + floor);
            assert!(off.max_element() <= 0.5 / 32.0 + 1e-5, "{irradiance} became {back}");
            assert!(back.min_element() >= 0.0);
        }
    }

    #[test]
    fn rounding_does_not_add_up_along_the_levels() {
        // A chain of points, each the parent of the next.
        let (mut offsets, mut entries): (Vec<u32>, Vec<Entry>) = (vec![0, 0], Vec::new());
        for i in 1..40 {
            pack_row(&[(i - 1, 1.0)], &mut entries);
            offsets.push(entries.len() as u32);
        }
        let push = Rows { offsets: &offsets, entries: &entries };
        let truth: Vec<Vec3> = (0..40).map(|i| Vec3::splat(1.0 + 0.013 * i as f32)).collect();
        let mut all = LightGroups {
            groups: vec![LightGroup { floor: 1e-3, has_direct: false }],
            ..LightGroups::default()
        };
        all.push_column(&truth, 1e-3, push, |i| i % 10 != 9);
        let back = all.irradiance(0, 0, push);
        for (i, (back, truth)) in back.iter().zip(&truth).enumerate() {
            let most = if i % 10 == 9 { 0.04 } else { 0.025 };
            assert!((back.x - truth.x).abs() <= most, "point {i}: {back}, not {truth}");
        }
        // A point that is not stored is exactly its parents' mean.
        assert_eq!(back[9], back[8]);
    }

    #[test]
    fn values_of_any_bits_are_finite() {
        for word in
            [0, 1, 0x3ff, 0x400, 0xffff_ffff, 0x8000_0000, 0x7fff_ffff, 0x1ff << 22 | 0x3ff << 11 | 0x3ff]
        {
            for predicted in [0.0, 1e-20, 1.0, 9e14] {
                let value = GroupValue(word).irradiance(Vec3::splat(predicted), 1e-30);
                assert!(value.is_finite() && value.min_element() >= 0.0 && value.max_element() <= LARGEST);
            }
        }
    }
}
