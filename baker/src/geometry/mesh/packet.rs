//! Ray packet: up to 64 rays of one octant and major axis, with their interval bounds for conservative slab tests.

use super::bvh8::{BEYOND, Node, SMALL, SlabRay, WIDTH};
use super::triangle::{ShearedRay, ShearedRays};
use crate::geometry::Ray;
use std::arch::x86_64::*;

/// Number of values per register.
pub(super) const LANES: usize = 8;
/// Number of registers for one value per ray.
const GROUPS: usize = 8;
/// Maximum number of rays of a packet: the number of bits of [`Rays`].
pub(super) const MOST: usize = LANES * GROUPS;

/// One value per ray, as registers.
type All = [__m256; GROUPS];
/// One value per ray, as an array.
type Each = [f32; MOST];
/// Bit mask of rays.
pub(super) type Rays = u64;

/// Rays of one octant and major axis.
pub(super) struct Packet {
    origin: [All; 3],
    inverse: [All; 3],
    /// By axis: 1 if the rays' directions are negative, otherwise 0.
    down: [usize; 3],
    /// By axis: the origins for a lower bound of the distance to a box's near side, and for an upper bound of the
    /// distance to the far side, over the rays.
    near_origin: [__m256; 3],
    far_origin: [__m256; 3],
    /// By axis: minimum and maximum of the inverse directions.
    least_inverse: [__m256; 3],
    most_inverse: [__m256; 3],
    /// Shear of the rays for triangle tests: see [`ShearedRay`].
    axes: [usize; 3],
    shear: [All; 3],
    /// Maximum hit distances of the rays.
    pub limits: Limits,
}

/// Maximum hit distances of a packet's rays.
pub(super) struct Limits {
    each: All,
    /// Maximum of the limits, a little [beyond](BEYOND), in every lane.
    farthest: __m256,
}

/// Returns the minimum and maximum of the values, in every lane.
#[target_feature(enable = "avx2")]
#[inline]
fn ends(of: &All) -> (__m256, __m256) {
    let (mut least, mut most) = (of[0], of[0]);
    for some in &of[1..] {
        (least, most) = (_mm256_min_ps(least, *some), _mm256_max_ps(most, *some));
    }
    // Swaps halves, then quarters, then neighbours.
    let swapped = |x| _mm256_permute2f128_ps::<1>(x, x);
    let (least, most) = (_mm256_min_ps(least, swapped(least)), _mm256_max_ps(most, swapped(most)));
    let swapped = |x| _mm256_permute_ps::<0b01_00_11_10>(x);
    let (least, most) = (_mm256_min_ps(least, swapped(least)), _mm256_max_ps(most, swapped(most)));
    let swapped = |x| _mm256_permute_ps::<0b10_11_00_01>(x);
    (_mm256_min_ps(least, swapped(least)), _mm256_max_ps(most, swapped(most)))
}

/// Returns `bvh8::inverse` of the eight values.
#[target_feature(enable = "avx2")]
#[inline]
fn inverses(of: __m256) -> __m256 {
    let sign = _mm256_set1_ps(-0.0);
    let size = _mm256_andnot_ps(sign, of);
    let is_small = _mm256_cmp_ps::<_CMP_LT_OQ>(size, _mm256_set1_ps(SMALL));
    let largest = _mm256_or_ps(_mm256_set1_ps(1.0 / SMALL), _mm256_and_ps(sign, of));
    _mm256_blendv_ps(_mm256_div_ps(_mm256_set1_ps(1.0), of), largest, is_small)
}

impl Limits {
    #[target_feature(enable = "avx2")]
    #[inline]
    fn new(each: Each) -> Self {
        let mut limits = Self { each: bytemuck::cast(each), farthest: _mm256_setzero_ps() };
        limits.find_farthest();
        limits
    }

    /// Returns the limit of a ray.
    #[inline]
    pub fn of(&self, ray: usize) -> f32 {
        bytemuck::cast_ref::<All, Each>(&self.each)[ray]
    }

    /// Sets the limit of a ray; requires [`Self::find_farthest`] afterwards.
    #[inline]
    pub fn set(&mut self, ray: usize, limit: f32) {
        bytemuck::cast_mut::<All, Each>(&mut self.each)[ray] = limit;
    }

    /// Updates the farthest limit.
    #[target_feature(enable = "avx2")]
    #[inline]
    pub fn find_farthest(&mut self) {
        self.farthest = _mm256_mul_ps(ends(&self.each).1, _mm256_set1_ps(BEYOND));
    }

    /// Returns the farthest limit: no ray has a hit beyond.
    #[target_feature(enable = "avx2")]
    #[inline]
    pub fn farthest(&self) -> f32 {
        _mm256_cvtss_f32(self.farthest)
    }
}

impl Packet {
    /// Builds a packet of 1 to [`MOST`] rays of one [class](Ray::octant_and_axis). Values are never NaN: a NaN would
    /// be a bound of the packet.
    #[target_feature(enable = "avx2")]
    #[inline]
    pub fn new<'a>(rays: impl Iterator<Item = &'a Ray>, class: u8) -> Self {
        let (mut origin, mut direction) = ([[0.0; MOST]; 3], [[0.0; MOST]; 3]);
        // An unused slot has no hit.
        let mut limits = [-1.0; MOST];
        let mut count = 0;
        for (i, ray) in rays.take(MOST).enumerate() {
            debug_assert!(Ray::octant_and_axis(ray.direction) == class && !ray.max_distance.is_nan());
            debug_assert!(ray.origin.is_finite() && ray.direction.is_finite());
            for axis in 0..3 {
                origin[axis][i] = ray.origin[axis];
                direction[axis][i] = ray.direction[axis];
            }
            limits[i] = ray.max_distance;
            count = i + 1;
        }
        // An unused slot repeats the first ray, so that no bound widens.
        for axis in 0..3 {
            let (of_origin, of_direction) = (origin[axis][0], direction[axis][0]);
            origin[axis][count..].fill(of_origin);
            direction[axis][count..].fill(of_direction);
        }
        let origin: [All; 3] = origin.map(bytemuck::cast);
        let direction: [All; 3] = direction.map(bytemuck::cast);
        let inverse: [All; 3] =
            std::array::from_fn(|axis| std::array::from_fn(|group| inverses(direction[axis][group])));

        let main = (class >> 3) as usize;
        let axes = [(main + 1) % 3, (main + 2) % 3, main];
        let over = |of: &All| -> All {
            std::array::from_fn(|group| _mm256_div_ps(of[group], direction[main][group]))
        };
        let one = [_mm256_set1_ps(1.0); GROUPS];

        let down: [usize; 3] = std::array::from_fn(|axis| (class >> axis & 1) as usize);
        let origin_ends: [(__m256, __m256); 3] = std::array::from_fn(|axis| ends(&origin[axis]));
        let inverse_ends: [(__m256, __m256); 3] = std::array::from_fn(|axis| ends(&inverse[axis]));
        let lies =
            |axis: usize, is_high: bool| if is_high { origin_ends[axis].1 } else { origin_ends[axis].0 };
        Self {
            near_origin: std::array::from_fn(|axis| lies(axis, down[axis] == 0)),
            far_origin: std::array::from_fn(|axis| lies(axis, down[axis] == 1)),
            least_inverse: inverse_ends.map(|(least, _)| least),
            most_inverse: inverse_ends.map(|(_, most)| most),
            shear: [over(&direction[axes[0]]), over(&direction[axes[1]]), over(&one)],
            limits: Limits::new(limits),
            origin,
            inverse,
            down,
            axes,
        }
    }

    /// Returns one ray, prepared for single-ray tests of nodes and triangles.
    #[inline]
    pub fn alone(&self, ray: usize) -> (SlabRay, ShearedRay) {
        let of = |all: &[All; 3]| -> [f32; 3] {
            std::array::from_fn(|axis| bytemuck::cast_ref::<All, Each>(&all[axis])[ray])
        };
        let (origin, axes) = (of(&self.origin), self.axes);
        let sheared = ShearedRay { axes, origin: axes.map(|axis| origin[axis]), shear: of(&self.shear) };
        (SlabRay { origin, inverse: of(&self.inverse), down: self.down }, sheared)
    }

    /// Removes up to [`LANES`] rays from `rays`; returns the indices of the rays, the number of rays, and the rays
    /// prepared for triangle tests.
    #[target_feature(enable = "avx2")]
    #[inline]
    pub fn take_eight(&self, rays: &mut Rays) -> ([usize; LANES], usize, ShearedRays) {
        let (mut names, mut count) = ([0; LANES], 0);
        let (mut origin, mut shear) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3]);
        while *rays != 0 && count < LANES {
            let ray = rays.trailing_zeros() as usize;
            *rays &= *rays - 1;
            names[count] = ray;
            for axis in 0..3 {
                let of = |all: &[All; 3], axis: usize| bytemuck::cast_ref::<All, Each>(&all[axis])[ray];
                origin[axis][count] = of(&self.origin, self.axes[axis]);
                shear[axis][count] = of(&self.shear, axis);
            }
            count += 1;
        }
        (names, count, ShearedRays::new(self.axes, origin, shear))
    }
}

impl Node {
    /// Returns lower bounds of the rays' distances to the children's boxes, and a bit mask of the children possibly
    /// hit by a ray.
    #[target_feature(enable = "avx2")]
    #[inline]
    pub fn meet_any(&self, packet: &Packet) -> ([f32; WIDTH], u32) {
        let (mut near, mut far) = (_mm256_setzero_ps(), packet.limits.farthest);
        for axis in 0..3 {
            let sides = &self.sides[axis];
            // The product of an offset and an inverse direction is minimal and maximal at the bounds of the inverse.
            let along = |sides: &[f32; WIDTH], origin: __m256| {
                let offset = _mm256_sub_ps(bytemuck::cast(*sides), origin);
                let (least, most) = (packet.least_inverse[axis], packet.most_inverse[axis]);
                (_mm256_mul_ps(offset, least), _mm256_mul_ps(offset, most))
            };
            let (a, b) = along(&sides[packet.down[axis]], packet.near_origin[axis]);
            near = _mm256_max_ps(_mm256_min_ps(a, b), near);
            let (a, b) = along(&sides[1 - packet.down[axis]], packet.far_origin[axis]);
            far = _mm256_min_ps(_mm256_max_ps(a, b), far);
        }
        let met = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(near, far)) as u32;
        (bytemuck::cast(near), met)
    }

    /// Returns the rays of `rays` with a hit of a child's box, by the arithmetic of [`Node::meet`].
    #[target_feature(enable = "avx2")]
    #[inline]
    pub fn meet_child(&self, child: usize, packet: &Packet, rays: Rays) -> Rays {
        let side = |axis: usize, far: usize| _mm256_set1_ps(self.sides[axis][far][child]);
        let entry: [__m256; 3] = std::array::from_fn(|axis| side(axis, packet.down[axis]));
        let exit: [__m256; 3] = std::array::from_fn(|axis| side(axis, 1 - packet.down[axis]));
        let mut met = 0;
        for group in 0..GROUPS {
            if rays >> (LANES * group) & 0xff == 0 {
                continue;
            }
            let limit = _mm256_mul_ps(packet.limits.each[group], _mm256_set1_ps(BEYOND));
            let (mut near, mut far) = (_mm256_setzero_ps(), limit);
            for axis in 0..3 {
                let along = |side| {
                    let offset = _mm256_sub_ps(side, packet.origin[axis][group]);
                    _mm256_mul_ps(offset, packet.inverse[axis][group])
                };
                near = _mm256_max_ps(along(entry[axis]), near);
                far = _mm256_min_ps(along(exit[axis]), far);
            }
            let some = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(near, far));
            met |= (some as u8 as Rays) << (LANES * group);
        }
        met & rays
    }
}
