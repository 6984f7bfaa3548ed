//! Footprints: places on the surface around a point at which direct light is sampled, by
//! [the law](rebounce_shared::footprint::samples) that files whose nodes move share.

use super::Points;
use super::around::{Around, supported};
use crate::geometry::Surfaces;
use crate::job::watch::{Stopped, Watch};
use crate::random::mix;
use rayon::prelude::*;
use rebounce_shared::footprint::samples;

/// Computes the missing samples of direct light of the points up to `end`: samples above the point's own surface, in
/// sight of the point and within the clip planes. The same points have the same samples. A unit of `watch` is a point.
///
/// # Errors
/// [`Stopped`].
pub fn footprint<S: Surfaces + ?Sized>(
    surfaces: &S,
    points: &mut Points,
    end: usize,
    watch: &dyn Watch,
) -> Result<(), Stopped> {
    let radii = points.support_radii();
    let found = (points.samples.len()..end).into_par_iter().map(|i| {
        watch.step(1)?;
        let point = supported(surfaces, &points.points[i], radii[i]);
        Ok(samples(&Around(surfaces), &point, points.cuts_of(i), mix(i as u64) as u32))
    });
    let found: Vec<u8> = found.collect::<Result<_, Stopped>>()?;
    points.samples.extend(found);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::mesh::TriangleSurfaces;
    use crate::sampling::{PointLevel, SurfacePoint, cut};
    use glam::{DVec3, Vec3, dvec3};
    use rebounce_shared::footprint::SAMPLES;

    /// Number of samples of a floor point with a support of 40 cm, world space.
    fn on_the_floor(name: &str, place: DVec3) -> u32 {
        let scene = crate::io::load(name).unwrap();
        let surfaces = TriangleSurfaces::from_scene(&scene);
        let position = (place - DVec3::from(scene.origin)).as_vec3();
        let point = SurfacePoint { position, normal: Vec3::Y, geometric_normal: Vec3::Y, group: 0 };
        let level = PointLevel { first: 0, count: 1, disk_radius: 0.2, support_radius: 0.4 };
        let mut points = Points { levels: vec![level], points: vec![point], ..Points::default() };
        cut(&surfaces, &mut points, 1, &()).unwrap();
        footprint(&surfaces, &mut points, 1, &()).unwrap();
        points.samples[0].count_ones()
    }

    #[test]
    fn all_samples_belong_to_an_open_floor_and_those_behind_a_wall_do_not() {
        assert_eq!(on_the_floor("builtin:two-rooms", dvec3(-2.0, 0.0, 2.0)), SAMPLES);
        let beside = on_the_floor("builtin:two-rooms", dvec3(-0.04, 0.0, 2.0));
        assert!((2..=6).contains(&beside), "{beside}");
    }
}
