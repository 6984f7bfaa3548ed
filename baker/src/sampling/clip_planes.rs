//! Clip planes: supports end at walls.
//!
//! The support of a function reaches through geometry within the support: a floor's function under a wall into the next
//! room, a cushion's function through the cloth above. The paper admits leaks of this kind (section 5.2). Here, rays
//! along the surface of each point find the obstacles around the point. If nearly all of the support behind an obstacle
//! is out of sight, the plane of the obstacle cuts the support off. So the weights themselves keep rooms apart –
//! weights of senders, of parents and in pictures alike.

use super::{Points, SurfacePoint};
use crate::geometry::{Hit, Ray, Surfaces};
use crate::job::watch::{Stopped, Watch};
use crate::random::mix;
use glam::Vec3;
use rayon::prelude::*;
use rebounce_shared::elementary::Elementary;
use rebounce_shared::kernel::SQUASH;
use rebounce_shared::rbn::bulk::{Cut, MAX_CUTS};

/// Rays along the surface.
const RAYS: usize = 24;
/// Places sampled along each ray, at equal areas.
const PLACES: usize = 8;
/// Height of the rays, over the support radius: lower obstacles cause no cut.
const LIFT: f32 = 0.08;
/// Maximum cosine between an obstacle's normal and the point's normal. Surfaces that turn up more are the point's own,
/// curved surface, unless [the own surface runs on](runs_on) behind the hit.
const STANDING: f32 = 0.35;
/// Distance behind a leaning surface, over the support radius, at which the point's own surface must be found to run
/// on, and minimum cosine between the normals there.
const BEHIND: f32 = 0.1;
const LEVEL: f32 = 0.98;
/// Depth of the plane behind a sheet, over the distance to the surface behind: sheets bend.
const BACK: f32 = 0.1;
/// Rays around a point in search of surfaces behind a sheet.
const BACK_RAYS: usize = 8;
/// Distance from the point at which a sheet is probed for bending, and minimum depth of a bend below the plane, both
/// over the support radius.
const BENT_AT: f32 = 0.5;
const FLAT: f32 = 0.02;
/// Minimum cosine between the normals of surfaces that share functions.
const TURNED: f32 = 0.5;
/// Minimum share of the places behind a plane that must be out of sight for a cut.
const HIDDEN: f32 = 0.75;
/// Minimum number of hidden places (of RAYS · PLACES) that a cut adds to the other cuts.
const LEAST_PLACES: usize = 4;
/// Distance of planes behind the surface, over the support radius.
const MARGIN: f32 = 2e-3;

/// Computes the missing clip planes of the points up to `end`. The same points have the same cuts. A unit of `watch` is
/// a point.
///
/// # Errors
/// [`Stopped`].
pub fn cut<S: Surfaces + ?Sized>(
    surfaces: &S,
    points: &mut Points,
    end: usize,
    watch: &dyn Watch,
) -> Result<(), Stopped> {
    let radii = points.support_radii();
    let found = (points.cuts.len()..end).into_par_iter().map(|i| {
        watch.step(1)?;
        Ok(cuts_of(surfaces, &points.points[i], radii[i], mix(i as u64) as u32))
    });
    let found: Vec<_> = found.collect::<Result<_, Stopped>>()?;
    points.cuts.extend(found);
    Ok(())
}

/// Visibility along a point's surface.
struct Sight {
    /// Unit directions of the rays.
    directions: [Vec3; RAYS],
    /// Free length of each ray, over the support radius; infinite without an obstacle.
    free: [f32; RAYS],
}

impl Sight {
    fn places(&self) -> impl Iterator<Item = (Vec3, bool)> + '_ {
        self.directions.iter().zip(&self.free).flat_map(|(direction, free)| {
            (0..PLACES).map(move |k| {
                let distance = ((k as f32 + 0.5) / PLACES as f32).sqrt();
                (*direction * distance, distance > *free)
            })
        })
    }
}

fn cuts_of<S: Surfaces + ?Sized>(surfaces: &S, point: &SurfacePoint, radius: f32, seed: u32) -> Vec<Cut> {
    let normal = point.normal;
    let epsilon = surfaces.epsilon_at(point.position);
    let margin = MARGIN * radius + epsilon;
    let floor = point.position + point.geometric_normal * epsilon;
    let mut cuts = Vec::new();
    // Straight up, to the top of the support: a lid ends the support everywhere.
    let height = radius / (1.0 + SQUASH);
    let lid = surfaces
        .cast(&Ray { origin: floor, direction: normal, max_distance: height, spread: Ray::VISIBILITY }, seed);
    if let Some(lid) = &lid {
        cuts.push(Cut::new(normal, lid.distance + margin));
    }
    if let Some(distance) = behind(surfaces, point, radius, epsilon, seed) {
        cuts.push(Cut::new(-normal, distance + margin));
    }
    let lift = (LIFT * radius).min(lid.map_or(f32::INFINITY, |lid| 0.5 * lid.distance));
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    let mut sight = Sight { directions: [Vec3::ZERO; RAYS], free: [f32::INFINITY; RAYS] };
    let mut planes: Vec<(Vec3, f32)> = Vec::new();
    for k in 0..RAYS {
        let (sin, cos) = (k as f32 / RAYS as f32 * std::f32::consts::TAU).sine_cosine();
        let direction = tangent * cos + bitangent * sin;
        sight.directions[k] = direction;
        let ray =
            Ray { origin: floor + normal * lift, direction, max_distance: radius, spread: Ray::VISIBILITY };
        let Some(hit) = surfaces.cast(&ray, seed) else { continue };
        let facing = hit.geometric_normal * -hit.geometric_normal.dot(direction).signum();
        if facing.dot(normal) > STANDING && !runs_on(surfaces, point, &ray, hit.distance, radius, seed) {
            continue;
        }
        sight.free[k] = hit.distance / radius;
        let distance = (point.position - hit.position).dot(facing);
        let is_known = |(n, d): &(Vec3, f32)| n.dot(facing) > 0.99 && (d - distance).abs() < margin;
        if !planes.iter().any(is_known) {
            planes.push((facing, distance));
        }
    }
    // Greedy selection: the plane with the largest gain first.
    let mut left: Vec<(Vec3, bool)> = sight.places().collect();
    while cuts.len() < MAX_CUTS {
        let behind = |(facing, distance): &(Vec3, f32), place: Vec3| -place.dot(*facing) * radius > *distance;
        let gain = |plane: &(Vec3, f32)| {
            let (mut hidden, mut all) = (0, 0);
            for (_, is_hidden) in left.iter().filter(|(place, _)| behind(plane, *place)) {
                all += 1;
                hidden += *is_hidden as usize;
            }
            if hidden as f32 >= HIDDEN * all as f32 { hidden } else { 0 }
        };
        let best = planes.iter().map(|plane| (gain(plane), plane)).max_by_key(|(gain, _)| *gain);
        let Some((_, plane)) = best.filter(|(gain, _)| *gain >= LEAST_PLACES) else { break };
        cuts.push(Cut::new(-plane.0, plane.1.max(0.0) + margin));
        left.retain(|(place, _)| !behind(plane, *place));
    }
    cuts
}

/// Distance of the plane that ends a function behind the point's thin sheet, if the support reaches a second surface
/// with a similar normal behind the sheet. `None` for sheets that bend, and if the surface behind is turned too far to
/// share the function.
fn behind<S: Surfaces + ?Sized>(
    surfaces: &S,
    point: &SurfacePoint,
    radius: f32,
    epsilon: f32,
    seed: u32,
) -> Option<f32> {
    let normal = point.normal;
    let is_covered = |hit: &Hit, ray: &Ray| {
        let turned = hit.geometric_normal.dot(normal) * -hit.geometric_normal.dot(ray.direction).signum();
        turned > TURNED && hit.faces(ray.direction)
    };
    let seen = |origin: Vec3, direction: Vec3, max_distance: f32| {
        let ray = Ray { origin, direction, max_distance, spread: Ray::VISIBILITY };
        surfaces.cast(&ray, seed).filter(|hit| is_covered(hit, &ray)).map(|hit| hit.distance)
    };
    let (height, lift) = (radius / (1.0 + SQUASH), LIFT * radius);
    let back = point.position - point.geometric_normal * epsilon;
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    let directions = (0..BACK_RAYS).map(|k| {
        let (sin, cos) = (k as f32 / BACK_RAYS as f32 * std::f32::consts::TAU).sine_cosine();
        tangent * cos + bitangent * sin
    });
    let straight = seen(back, -normal, height);
    let beside = || directions.clone().any(|along| seen(back - normal * lift, along, radius).is_some());
    let depth = straight.filter(|depth| *depth > lift).map(|depth| BACK * depth);
    let depth = depth.or_else(|| (straight.is_some() || beside()).then_some(0.0))?;
    // The point's own surface below the plane must stay in the support.
    let bends = |along: Vec3| {
        let above = point.position + (along * BENT_AT * radius) + normal * lift;
        seen(above, -normal, lift + height).is_some_and(|down| down > lift + depth + FLAT * radius)
    };
    (!directions.clone().any(bends)).then_some(depth)
}

/// True if the point's surface runs on behind the hit of a ray along the surface: the fold of a curtain or a block
/// stands on the surface, at any inclination. Under a slope of the surface itself there is no surface.
fn runs_on<S: Surfaces + ?Sized>(
    surfaces: &S,
    point: &SurfacePoint,
    along: &Ray,
    distance: f32,
    radius: f32,
    seed: u32,
) -> bool {
    let lift = (along.origin - point.position).dot(point.normal);
    let origin = along.origin + along.direction * (distance + BEHIND * radius);
    let down = Ray { origin, direction: -point.normal, max_distance: 2.0 * lift, spread: Ray::VISIBILITY };
    surfaces.cast(&down, seed).is_some_and(|hit| hit.geometric_normal.dot(point.normal) > LEVEL)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::mesh::TriangleSurfaces;
    use glam::{DVec3, dvec3, vec3};

    /// Cuts of a support on the floor at this place, world space.
    fn on_the_floor(name: &str, place: DVec3, radius: f32) -> Vec<Cut> {
        let scene = crate::io::load(name).unwrap();
        let surfaces = TriangleSurfaces::from_scene(&scene);
        let position = (place - DVec3::from(scene.origin)).as_vec3();
        let point = SurfacePoint { position, normal: Vec3::Y, geometric_normal: Vec3::Y, group: 0 };
        cuts_of(&surfaces, &point, radius, 1)
    }

    fn ended(cuts: &[Cut], offset: Vec3) -> bool {
        cuts.iter().any(|cut| cut.ends(offset))
    }

    #[test]
    fn a_wall_ends_a_support_and_its_foot_does_not() {
        // The wall's face is 10 cm away, its back 15.
        for radius in [0.2, 0.5, 2.0] {
            let cuts = on_the_floor("builtin:two-rooms", dvec3(-0.125, 0.0, 2.0), radius);
            assert!(ended(&cuts, vec3(0.16, 0.0, 0.0)) && ended(&cuts, vec3(0.16, 0.0, 0.1)), "{radius}");
            assert!(!ended(&cuts, vec3(0.099, 0.0, 0.0)) && !ended(&cuts, vec3(-0.16, 0.0, 0.0)), "{radius}");
        }
    }

    #[test]
    fn corners_have_two_cuts_and_the_open_floor_has_none() {
        let cuts = on_the_floor("builtin:two-rooms", dvec3(-0.2, 0.0, 0.2), 0.4);
        assert!(ended(&cuts, vec3(0.3, 0.0, 0.1)) && ended(&cuts, vec3(-0.1, 0.0, -0.3)), "{cuts:?}");
        assert!(cuts.len() <= MAX_CUTS);
        assert_eq!(on_the_floor("builtin:two-rooms", dvec3(-2.0, 0.0, 2.0), 0.5), []);
    }

    #[test]
    fn a_fold_of_a_curtain_that_leans_ends_a_support() {
        let scene = crate::io::load("builtin:arcade").unwrap();
        let surfaces = TriangleSurfaces::from_scene(&scene);
        let position = |x: f64| (dvec3(x, 2.0, 9.05) - DVec3::from(scene.origin)).as_vec3();
        // On the side of a pillar, which a curtain meets at 45 degrees, 18 cm behind its front.
        for (from, to) in [(-0.05, -0.3), (-0.1, -0.26), (-0.02, -0.45)] {
            let point = SurfacePoint {
                position: position(from),
                normal: Vec3::Z,
                geometric_normal: Vec3::Z,
                group: 0,
            };
            for radius in [0.5, 0.8] {
                let cuts = cuts_of(&surfaces, &point, radius, 1);
                assert!(ended(&cuts, position(to) - position(from)), "from {from}, {radius}: {cuts:?}");
                assert!(!ended(&cuts, position(-0.17) - position(from)), "from {from}, {radius}: {cuts:?}");
            }
        }
    }

    #[test]
    fn a_curtain_ends_what_hangs_on_it_before_what_is_behind() {
        let scene = crate::io::load("builtin:arcade").unwrap();
        let surfaces = TriangleSurfaces::from_scene(&scene);
        let position = |x: f64, z: f64| (dvec3(x, 2.0, z) - DVec3::from(scene.origin)).as_vec3();
        // On the court's side of a fold that goes from (-0.18, 9.05) to (-0.32, 9.19), away from a pillar's side.
        let normal = vec3(0.14, 0.0, 0.1417).normalize();
        for share in [0.1, 0.3, 0.6] {
            let on_fold = |share: f64| position(-0.18 - 0.14 * share, 9.05 + 0.1417 * share);
            let point = SurfacePoint { position: on_fold(share), normal, geometric_normal: normal, group: 0 };
            let cuts = cuts_of(&surfaces, &point, 0.25, 1);
            assert!(ended(&cuts, position(-0.3, 9.05) - point.position), "{share}: {cuts:?}");
            assert!(!ended(&cuts, on_fold(0.9) - point.position), "{share}: {cuts:?}");
            assert!(!ended(&cuts, position(-0.1, 9.05) - point.position), "{share}: {cuts:?}");
        }
    }

    #[test]
    fn a_table_leg_ends_nothing_and_a_shelf_above_does() {
        // 20 cm before a leg of 5 cm.
        assert_eq!(on_the_floor("builtin:library", dvec3(3.2, 0.0, 2.48), 0.5), []);
        let cuts = on_the_floor("builtin:library", dvec3(1.0, 0.0, 0.15), 0.6);
        assert!(ended(&cuts, vec3(0.0, 0.11, 0.0)) && !ended(&cuts, vec3(0.0, 0.09, 0.0)), "{cuts:?}");
    }
}
