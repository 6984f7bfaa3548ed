//! Tint and reflectance of each point: the mean albedo of the surface under the point's function, as a colour and an amount.
//!
//! A link holds the brightness of a sender as seen by a receiver, a single amount for all channels;
//! the colour is the sender's tint. Radiosity, which has no links, takes the amount from the point.

use crate::geometry::{Ray, Surfaces};
use crate::random::Stream;
use crate::sampling::Points;
use glam::{Vec3, Vec3A};
use rayon::prelude::*;
use rebounce_shared::colour::{pack_rounded, unpack_rgb9e5};
use rebounce_shared::elementary::Elementary;
use rebounce_shared::kernel::weight;

/// Rays per point: on the finest level, and at most.
const RAYS: [usize; 2] = [8, 64];
/// Height of the ray origins above the surface, in support radii.
const ABOVE: f32 = 0.1;
/// Height of the ray at the point itself, in safe offsets.
const NEAR: f32 = 4.0;
/// Surfaces of other groups that may stand before a point's, within [`ABOVE`].
const MOST_BEFORE: u32 = 4;
/// Mantissas are multiples of this unit: a channel is exact within a 256th of the largest channel.
const TINT_UNIT: u32 = 2;

/// What the surface under a point reflects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PointColour {
    /// Colour, rgb9e5 as in the file; the channels' mean is 1. That of a black surface is grey.
    pub tint: u32,
    /// Mean of the channels, in 255ths.
    pub reflectance: u8,
}

/// Computes the colour of point `i` of level `level`.
pub fn colour<S: Surfaces + ?Sized>(
    surfaces: &S,
    points: &Points,
    level: usize,
    i: usize,
    seed: u64,
) -> PointColour {
    // A function of the next coarser level covers four times the area.
    let rays = (RAYS[0] << (2 * (points.levels.len() - 1 - level)).min(16)).min(RAYS[1]);
    let (albedo, weight) =
        albedo_sum(surfaces, points, i, points.support_radius(&points.levels[level], i), rays, seed);
    let mean = albedo.element_sum() / 3.0;
    let tint = pack_rounded(if mean > 0.0 { albedo / mean } else { Vec3::ONE }, TINT_UNIT);
    PointColour { tint, reflectance: (255.0 * mean / weight.max(f32::MIN_POSITIVE)).round() as u8 }
}

/// Computes the tints of all points.
pub fn tints<S: Surfaces + ?Sized>(surfaces: &S, points: &Points, seed: u64) -> Vec<u32> {
    let of_level = |level: usize| {
        let range = points.levels[level].range().into_par_iter();
        range.map(move |i| colour(surfaces, points, level, i, seed).tint)
    };
    (0..points.levels.len()).into_par_iter().flat_map(of_level).collect()
}

/// Decodes tints to linear colours.
pub fn unpack(tints: &[u32]) -> Vec<Vec3> {
    tints.iter().map(|tint| unpack_rgb9e5(*tint)).collect()
}

/// Dual of each tint: tint over its squared length. The dot product of light and dual is the amount
/// of the tint that fits the light best.
pub fn duals(tints: &[u32]) -> Vec<Vec3A> {
    unpack(tints).into_iter().map(|tint| Vec3A::from(tint / tint.length_squared())).collect()
}

/// Sum of reflectances around a point, weighted by the point's function, and of the weights; zero if no
/// surface reflects. Of a surface that every ray misses, such as the edge of a board, the reflectance at the point.
fn albedo_sum<S: Surfaces + ?Sized>(
    surfaces: &S,
    points: &Points,
    i: usize,
    radius: f32,
    rays: usize,
    seed: u64,
) -> (Vec3, f32) {
    let point = &points.points[i];
    let (first, second) = point.normal.any_orthonormal_pair();
    let mut stream = Stream::new(seed ^ 0x7469_6e74, i as u64);
    let (mut sum, mut total) = (Vec3::ZERO, 0.0);
    // The ray's width at the surface equals its share of the disk.
    let spread = (std::f32::consts::PI / rays as f32).sqrt() / ABOVE;
    for k in 0..rays {
        let (angle, share) =
            (std::f32::consts::TAU * stream.unit(), (k as f32 + stream.unit()) / rays as f32);
        let along = (first * angle.cosine() + second * angle.sine()) * share.sqrt();
        let origin = point.position + radius * (along + ABOVE * point.normal);
        let down = Ray { origin, direction: -point.normal, max_distance: 2.0 * ABOVE * radius, spread };
        // What stands before the surface is another group's, and may move away.
        if let Some(hit) = surfaces.cast_group(down, point.group, MOST_BEFORE, stream.bits() as u32)
            && hit.faces(down.direction)
        {
            let offset = hit.position - point.position;
            if !points.cuts_of(i).iter().any(|cut| cut.ends(offset)) {
                let weight = weight(offset, hit.normal, point.normal, radius);
                sum += hit.albedo * weight;
                total += weight;
            }
        }
    }
    if total == 0.0 {
        let height = NEAR * surfaces.epsilon_at(point.position);
        let origin = point.position + height * point.geometric_normal;
        let down =
            Ray { origin, direction: -point.geometric_normal, max_distance: 2.0 * height, spread: 0.0 };
        let hit = surfaces.cast_group(down, point.group, MOST_BEFORE, stream.bits() as u32);
        return hit.filter(|hit| hit.faces(down.direction)).map_or((sum, total), |hit| (hit.albedo, 1.0));
    }
    (sum, total)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::mesh::TriangleSurfaces;
    use crate::sampling::{PointLevel, SurfacePoint};

    #[test]
    fn surfaces_of_other_groups_have_no_part_in_a_points_colour() {
        let scene = crate::io::load("builtin:cornell-box").unwrap();
        let surfaces = TriangleSurfaces::from_scene(&scene);
        let middle = surfaces.bounds().0.lerp(surfaces.bounds().1, 0.5);
        let ray = Ray { origin: middle, direction: Vec3::Y, max_distance: f32::INFINITY, spread: 0.0 };
        let hit = surfaces.cast(&ray, 0).unwrap();
        let level = PointLevel { first: 0, count: 1, disk_radius: 0.02, support_radius: 0.04 };
        let point = SurfacePoint::at(&hit, &surfaces);
        let of = |group| {
            let points = vec![SurfacePoint { group, ..point }];
            let points = Points { levels: vec![level.clone()], points, ..Points::default() };
            colour(&surfaces, &points, 0, 0, 1).reflectance
        };
        assert!(of(point.group) > 100);
        assert_eq!(of(point.group + 1), 0);
    }

    #[test]
    fn a_red_wall_is_red_and_a_white_one_white() {
        let scene = crate::io::load("builtin:cornell-box").unwrap();
        let surfaces = TriangleSurfaces::from_scene(&scene);
        // Above the blocks.
        let middle = surfaces.bounds().0.lerp(surfaces.bounds().1, 0.5).with_y(0.8 * surfaces.bounds().1.y);
        let at = |direction: Vec3| {
            let ray = Ray { origin: middle, direction, max_distance: f32::INFINITY, spread: 0.0 };
            let hit = surfaces.cast(&ray, 0).unwrap();
            let level = PointLevel { first: 0, count: 1, disk_radius: 0.02, support_radius: 0.04 };
            let point = SurfacePoint::at(&hit, &surfaces);
            let points = Points { levels: vec![level], points: vec![point], ..Points::default() };
            (unpack(&tints(&surfaces, &points, 1))[0], hit.albedo)
        };
        let mut coloured = 0;
        for direction in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y] {
            let (tint, albedo) = at(direction);
            let wanted = albedo * 3.0 / albedo.element_sum();
            assert!((tint - wanted).abs().max_element() < 0.01, "{direction}: {tint}, not {wanted}");
            coloured += (wanted.max_element() > 1.5) as u32;
        }
        assert_eq!(coloured, 2);
    }
}
