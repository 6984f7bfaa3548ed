//! Ray packet: up to 64 rays of one octant and major axis, with their interval bounds for conservative slab tests.

use super::triangle::{ShearedRay, ShearedRays};
use crate::geometry::Ray;
use crate::geometry::bvh8::{BEYOND, Node, SMALL, SlabRay, WIDTH};
use crate::lanes::{F32x8, LANES, Mask8};

/// Number of registers for one value per ray.
const GROUPS: usize = 8;
/// Maximum number of rays of a packet: the number of bits of [`Rays`].
pub(super) const MOST: usize = LANES * GROUPS;

/// One value per ray, as registers.
type All<V> = [V; GROUPS];
/// One value per ray, as an array.
type Each = [f32; MOST];
/// Bit mask of rays.
pub(super) type Rays = u64;

/// Rays of one octant and major axis.
pub(super) struct Packet<V> {
    origin: [All<V>; 3],
    inverse: [All<V>; 3],
    /// By axis: 1 if the rays' directions are negative, otherwise 0.
    down: [usize; 3],
    /// By axis: the origins for a lower bound of the distance to a box's near side, and for an upper bound of the
    /// distance to the far side, over the rays.
    near_origin: [V; 3],
    far_origin: [V; 3],
    /// By axis: minimum and maximum of the inverse directions.
    least_inverse: [V; 3],
    most_inverse: [V; 3],
    /// Shear of the rays for triangle tests: see [`ShearedRay`].
    axes: [usize; 3],
    shear: [All<V>; 3],
    /// Maximum hit distances of the rays.
    pub limits: Limits<V>,
}

/// Maximum hit distances of a packet's rays.
pub(super) struct Limits<V> {
    each: All<V>,
    /// Maximum of the limits, a little [beyond](BEYOND), in every lane.
    farthest: V,
}

/// Returns the minimum and maximum of the values, in every lane.
#[inline(always)]
fn ends<V: F32x8>(of: &All<V>) -> (V, V) {
    let (mut least, mut most) = (of[0], of[0]);
    for some in &of[1..] {
        (least, most) = (least.min(*some), most.max(*some));
    }
    (least.least(), most.greatest())
}

/// Returns `bvh8::inverse` of the eight values.
#[inline(always)]
fn inverses<V: F32x8>(of: V) -> V {
    let sign = V::splat(-0.0);
    let is_small = sign.and_not(of).lt(V::splat(SMALL));
    let largest = V::splat(1.0 / SMALL) | (sign & of);
    V::select(is_small, largest, V::splat(1.0) / of)
}

/// Returns the value of a ray.
#[inline(always)]
fn lane<V: F32x8>(of: &All<V>, ray: usize) -> f32 {
    bytemuck::cast_ref::<All<V>, Each>(of)[ray]
}

impl<V: F32x8> Limits<V> {
    #[inline(always)]
    fn new(each: Each) -> Self {
        let mut limits = Self { each: bytemuck::cast(each), farthest: V::splat(0.0) };
        limits.find_farthest();
        limits
    }

    /// Returns the limit of a ray.
    #[inline(always)]
    pub fn of(&self, ray: usize) -> f32 {
        lane(&self.each, ray)
    }

    /// Sets the limit of a ray; requires [`Self::find_farthest`] afterwards.
    #[inline(always)]
    pub fn set(&mut self, ray: usize, limit: f32) {
        bytemuck::cast_mut::<All<V>, Each>(&mut self.each)[ray] = limit;
    }

    /// Updates the farthest limit.
    #[inline(always)]
    pub fn find_farthest(&mut self) {
        self.farthest = ends(&self.each).1 * V::splat(BEYOND);
    }

    /// Returns the farthest limit: no ray has a hit beyond.
    #[inline(always)]
    pub fn farthest(&self) -> f32 {
        self.farthest.to_array()[0]
    }
}

impl<V: F32x8> Packet<V> {
    /// Builds a packet of 1 to [`MOST`] rays of one [class](Ray::octant_and_axis). Values are never NaN: a NaN would
    /// be a bound of the packet.
    #[inline(always)]
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
        let origin: [All<V>; 3] = origin.map(bytemuck::cast);
        let direction: [All<V>; 3] = direction.map(bytemuck::cast);
        let mut inverse = direction;
        inverse.as_flattened_mut().iter_mut().for_each(|of| *of = inverses(*of));
        let main = (class >> 3) as usize;
        let axes = [(main + 1) % 3, (main + 2) % 3, main];
        let mut shear = [direction[axes[0]], direction[axes[1]], [V::splat(1.0); GROUPS]];
        for of in &mut shear {
            for group in 0..GROUPS {
                of[group] = of[group] / direction[main][group];
            }
        }
        let down: [usize; 3] = std::array::from_fn(|axis| (class >> axis & 1) as usize);
        let [x, y, z] = &origin;
        let origin_ends: [(V, V); 3] = [ends(x), ends(y), ends(z)];
        let [x, y, z] = &inverse;
        let inverse_ends: [(V, V); 3] = [ends(x), ends(y), ends(z)];
        let lies =
            |axis: usize, is_high: bool| if is_high { origin_ends[axis].1 } else { origin_ends[axis].0 };
        Self {
            near_origin: std::array::from_fn(|axis| lies(axis, down[axis] == 0)),
            far_origin: std::array::from_fn(|axis| lies(axis, down[axis] == 1)),
            least_inverse: inverse_ends.map(|(least, _)| least),
            most_inverse: inverse_ends.map(|(_, most)| most),
            shear,
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
        let of = |all: &[All<V>; 3]| -> [f32; 3] { std::array::from_fn(|axis| lane(&all[axis], ray)) };
        let (origin, axes) = (of(&self.origin), self.axes);
        let sheared = ShearedRay { axes, origin: axes.map(|axis| origin[axis]), shear: of(&self.shear) };
        (SlabRay { origin, inverse: of(&self.inverse), down: self.down }, sheared)
    }

    /// Removes up to [`LANES`] rays from `rays`; returns the indices of the rays, the number of rays, and the rays
    /// prepared for triangle tests.
    #[inline(always)]
    pub fn take_eight(&self, rays: &mut Rays) -> ([usize; LANES], usize, ShearedRays<V>) {
        let (mut names, mut count) = ([0; LANES], 0);
        let (mut origin, mut shear) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3]);
        while *rays != 0 && count < LANES {
            let ray = rays.trailing_zeros() as usize;
            *rays &= *rays - 1;
            names[count] = ray;
            for axis in 0..3 {
                origin[axis][count] = lane(&self.origin[self.axes[axis]], ray);
                shear[axis][count] = lane(&self.shear[axis], ray);
            }
            count += 1;
        }
        (names, count, ShearedRays::new(self.axes, origin, shear))
    }
}

impl Node {
    /// Returns lower bounds of the rays' distances to the children's boxes, and a bit mask of the children possibly
    /// hit by a ray.
    #[inline(always)]
    pub(super) fn meet_any<V: F32x8>(&self, packet: &Packet<V>) -> ([f32; WIDTH], u32) {
        let (mut near, mut far) = (V::splat(0.0), packet.limits.farthest);
        for axis in 0..3 {
            let (sides, down) = (&self.sides[axis], packet.down[axis]);
            // The product of an offset and an inverse direction is minimal and maximal at the bounds of the inverse.
            let (least, most) = (packet.least_inverse[axis], packet.most_inverse[axis]);
            let entry = V::from_array(sides[down]) - packet.near_origin[axis];
            near = (entry * least).min(entry * most).max(near);
            let exit = V::from_array(sides[1 - down]) - packet.far_origin[axis];
            far = (exit * least).max(exit * most).min(far);
        }
        (near.to_array(), near.le(far).movemask())
    }

    /// Returns the rays of `rays` with a hit of a child's box, by the arithmetic of [`SlabTest::meet`](crate::geometry::bvh8::SlabTest::meet).
    #[inline(always)]
    pub(super) fn meet_child<V: F32x8>(&self, child: usize, packet: &Packet<V>, rays: Rays) -> Rays {
        let (mut entry, mut exit) = ([V::splat(0.0); 3], [V::splat(0.0); 3]);
        for axis in 0..3 {
            entry[axis] = V::splat(self.sides[axis][packet.down[axis]][child]);
            exit[axis] = V::splat(self.sides[axis][1 - packet.down[axis]][child]);
        }
        let mut met = 0;
        for group in 0..GROUPS {
            if rays >> (LANES * group) & 0xff == 0 {
                continue;
            }
            let limit = packet.limits.each[group] * V::splat(BEYOND);
            let (mut near, mut far) = (V::splat(0.0), limit);
            for axis in 0..3 {
                let (origin, inverse) = (packet.origin[axis][group], packet.inverse[axis][group]);
                near = ((entry[axis] - origin) * inverse).max(near);
                far = ((exit[axis] - origin) * inverse).min(far);
            }
            met |= (near.le(far).movemask() as Rays) << (LANES * group);
        }
        met & rays
    }
}
