//! Laws of wavelet radiosity, by closed forms.

mod convergence;
mod enclosures;
mod form_factors;
mod many_patches;
mod two_scale;

use super::{WaveletPatch, WaveletSettings, WaveletSolution, solve};
use crate::geometry::{Hit, Ray, Surfaces};
use glam::{DAffine3, DVec2, DVec3, Vec3};
use rebounce_cad::face::Face;
use rebounce_cad::frame::Frame;
use rebounce_cad::surface::Surface;
use rebounce_cad::trim::{TrimEdge, TrimLoop};
use rebounce_cad::virtual_mesh::VirtualMesh;
use rebounce_shared::elementary::Elementary;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

/// Nothing is in the way, but perhaps a disk at a height, about the y axis, or the walls of a box about the
/// origin.
struct Blockers {
    disk: Option<(f32, f32)>,
    room: Option<Vec3>,
}

const NOTHING: Blockers = Blockers { disk: None, room: None };

impl Surfaces for Blockers {
    fn cast(&self, _ray: &Ray, _seed: u32) -> Option<Hit> {
        None
    }

    fn see(&self, _ray: &Ray, _seed: u32) -> Option<Hit> {
        None
    }

    fn transmittance(&self, from: Vec3, to: Vec3) -> Vec3 {
        if self.room.is_some_and(|half| (from.abs().cmpgt(half) | to.abs().cmpgt(half)).any()) {
            return Vec3::ZERO;
        }
        let Some((height, radius)) = self.disk else { return Vec3::ONE };
        let t = (height - from.y) / (to.y - from.y);
        let there = from.lerp(to, t);
        let is_blocked = (0.0..1.0).contains(&t) && there.x.hypotenuse(there.z) < radius;
        Vec3::splat(if is_blocked { 0.0 } else { 1.0 })
    }

    fn bounds(&self) -> (Vec3, Vec3) {
        (Vec3::splat(-10.0), Vec3::splat(10.0))
    }

    fn epsilon(&self) -> f32 {
        1e-5
    }
}

fn polygon(points: &[DVec2]) -> TrimLoop {
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|(&from, &to)| TrimEdge::Segment { from, to }).collect()
}

fn rectangle(low: DVec2, high: DVec2) -> TrimLoop {
    polygon(&[low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)])
}

fn circle(radius: f64) -> TrimLoop {
    vec![TrimEdge::Arc { centre: DVec2::ZERO, radii: DVec2::splat(radius), angles: [0.0, TAU] }]
}

fn patch_of(surface: Surface, is_reversed: bool, loops: Vec<TrimLoop>) -> WaveletPatch {
    WaveletPatch {
        mesh: Arc::new(VirtualMesh::new(&Face { surface, is_reversed, loops }).unwrap()),
        world_from_part: DAffine3::IDENTITY,
        is_back: false,
        albedo: Vec3::ZERO,
        emission: Vec3::ZERO,
    }
}

/// A planar patch that faces a direction.
fn flat(origin: DVec3, normal: DVec3, loops: Vec<TrimLoop>) -> WaveletPatch {
    let frame = Frame::new(origin, normal, normal.any_orthonormal_vector()).unwrap();
    patch_of(Surface::Plane(frame), false, loops)
}

/// A whole sphere; reversed, it faces inward.
fn sphere(centre: DVec3, radius: f64, is_reversed: bool) -> WaveletPatch {
    let frame = Frame { origin: centre, ..Frame::default() };
    let whole = rectangle(DVec2::new(0.0, -FRAC_PI_2), DVec2::new(TAU, FRAC_PI_2));
    patch_of(Surface::Sphere { frame, radius }, is_reversed, vec![whole])
}

fn shining(patch: WaveletPatch) -> WaveletPatch {
    WaveletPatch { emission: Vec3::ONE, ..patch }
}

fn solved(patches: &[WaveletPatch], settings: &WaveletSettings) -> WaveletSolution {
    solve(patches, &NOTHING, |_, _| Vec3::ZERO, settings, |_| Ok(())).unwrap()
}

/// Real points of a patch on a grid, with the parts of the real area that they stand for.
fn real_points(patch: &WaveletPatch, count: u32) -> Vec<(DVec2, f64)> {
    let side = 1.0 / f64::from(count);
    let whole = patch.mesh.real_share([DVec2::ZERO, DVec2::ONE]);
    let cell = |i: u32| {
        let low = side * DVec2::new(f64::from(i % count), f64::from(i / count));
        (low + 0.5 * side, patch.mesh.real_share([low, low + side]) * side * side / whole)
    };
    (0..count * count).map(cell).filter(|(_, share)| *share > 0.0).collect()
}
