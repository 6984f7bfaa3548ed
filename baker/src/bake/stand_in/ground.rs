//! Ground under an object in pictures: a level plane with the object's ambient shadow. Takes no part in light
//! transport.

use crate::geometry::{Ray, Surfaces};
use crate::random::Stream;
use glam::Vec3;
use rayon::prelude::*;
use rebounce_shared::rbn::shown::{Ground, SIDE};

/// Width of the shadow margin around the object, relative to the object's greatest side.
const BESIDE: f32 = 0.5;
/// Maximum distance of an occluder, relative to the object's diagonal; occlusion fades with distance.
const REACH: f32 = 0.6;
/// Rays per texel.
const RAYS: u64 = 256;

/// Returns the ground of an open scene with a single object; `None` for rooms and landscapes.
pub fn ground<S: Surfaces + ?Sized>(surfaces: &S, is_open: bool) -> Option<Ground> {
    let (low, high) = surfaces.bounds();
    let size = high - low;
    if !is_open || surfaces.main_part() != (low, high) || size.min_element() < 0.0 {
        return None;
    }
    let margin = BESIDE * size.max_element();
    let (least, most) = (low - margin, high + margin);
    let reach = REACH * size.length();
    // Equal directions for every texel prevent grain.
    let ways: Vec<Vec3> = (0..RAYS).map(|i| Stream::new(0x6772_6f75, i).cosine_hemisphere(Vec3::Y)).collect();
    let hidden = |place: usize| {
        let at = |i: usize| (i as f32 + 0.5) / SIDE as f32;
        let (x, z) = (at(place % SIDE), at(place / SIDE));
        let mut origin = least + (most - least) * Vec3::new(x, 0.0, z);
        origin.y = low.y - surfaces.epsilon();
        let of = |way: &Vec3| {
            let ray = Ray { max_distance: reach, ..Ray::visibility(origin, *way) };
            surfaces.cast(&ray, 0).map_or(0.0, |hit| 1.0 - hit.distance / reach)
        };
        let sum: f32 = ways.iter().map(of).sum();
        // The shadow fades to zero at the border of the plane.
        let inside = |x: f32| (6.0 * x.min(1.0 - x)).min(1.0);
        (255.0 * sum / RAYS as f32 * inside(x) * inside(z)).round() as u8
    };
    let shade = (0..SIDE * SIDE).into_par_iter().map(hidden).collect();
    Some(Ground { height: low.y, low: [least.x, least.z], high: [most.x, most.z], shade })
}
