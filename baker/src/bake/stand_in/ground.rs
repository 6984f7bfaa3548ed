//! What an object stands on in pictures: a level plane in the shadow of what is above it. No light falls on it and none
//! bounces off it.

use crate::geometry::{Ray, Surfaces};
use crate::random::Stream;
use glam::Vec3;
use rayon::prelude::*;
use rebounce_shared::rbn::shown::{Ground, SIDE};

/// How far the shadow reaches beside the object, over the object's greatest side.
const BESIDE: f32 = 0.5;
/// What is farther away than this casts no shadow, over the object's diagonal; what is nearer one that fades with distance.
const REACH: f32 = 0.6;
/// Rays from each place.
const RAYS: u64 = 256;

/// The ground of an open scene that is an object; none in rooms and landscapes.
pub fn ground<S: Surfaces>(surfaces: &S, is_open: bool) -> Option<Ground> {
    let (low, high) = surfaces.bounds();
    let size = high - low;
    if !is_open || surfaces.main_part() != (low, high) || size.min_element() < 0.0 {
        return None;
    }
    let margin = BESIDE * size.max_element();
    let (least, most) = (low - margin, high + margin);
    let reach = REACH * size.length();
    // The same for each place, or it would be grainy.
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
        // Nothing at the borders, beyond which there is none.
        let inside = |x: f32| (6.0 * x.min(1.0 - x)).min(1.0);
        (255.0 * sum / RAYS as f32 * inside(x) * inside(z)).round() as u8
    };
    let shade = (0..SIDE * SIDE).into_par_iter().map(hidden).collect();
    Some(Ground { height: low.y, low: [least.x, least.z], high: [most.x, most.z], shade })
}
