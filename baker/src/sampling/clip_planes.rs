//! Clip planes of all points, by [the law](rebounce_shared::clip_planes) that files whose nodes move share.

use super::Points;
use super::around::{Around, supported};
use crate::geometry::Surfaces;
use crate::job::watch::{Stopped, Watch};
use crate::random::mix;
use rayon::prelude::*;
use rebounce_shared::clip_planes::clip_planes;

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
        let point = supported(surfaces, &points.points[i], radii[i]);
        Ok(clip_planes(&Around(surfaces), &point, mix(i as u64) as u32))
    });
    let found: Vec<_> = found.collect::<Result<_, Stopped>>()?;
    points.cuts.extend(found);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::mesh::TriangleSurfaces;
    use crate::sampling::SurfacePoint;
    use glam::{DVec3, Vec3, dvec3, vec3};
    use rebounce_shared::rbn::bulk::{Cut, MAX_CUTS};

    /// Cuts of a support on the floor at this place, world space.
    fn on_the_floor(name: &str, place: DVec3, radius: f32) -> Vec<Cut> {
        let scene = crate::io::load(name).unwrap();
        let surfaces = TriangleSurfaces::from_scene(&scene);
        let position = (place - DVec3::from(scene.origin)).as_vec3();
        let point = SurfacePoint { position, normal: Vec3::Y, geometric_normal: Vec3::Y, group: 0 };
        clip_planes(&Around(&surfaces), &supported(&surfaces, &point, radius), 1)
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
                let cuts = clip_planes(&Around(&surfaces), &supported(&surfaces, &point, radius), 1);
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
            let cuts = clip_planes(&Around(&surfaces), &supported(&surfaces, &point, 0.25), 1);
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
