//! Light at patches beside two path-traced estimates of it.

use glam::Vec3;
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::geometry::{Ray, Surfaces};
use rebounce::light::direct::at_hit;
use rebounce_shared::antiradiance::Patch;
use rebounce_shared::light::LightSource;
use rebounce_shared::random::Stream;

/// Paths from a patch for one of two estimates.
const PATHS: u64 = 512;
/// Surfaces that a path meets at most.
const BOUNCES: u32 = 12;

/// A patch where the light is compared, with both estimates of it.
#[derive(Clone, Copy)]
pub struct Compared {
    pub patch: usize,
    pub area: f32,
    pub truth: [Vec3; 2],
}

/// Relative RMS without the noise of the estimates, and the bias as a share of the mean.
pub fn compared(places: &[Compared], found: &[Vec3]) -> [f32; 2] {
    let (mut off, mut power, mut sums) = (0.0, 0.0, [0.0, 0.0]);
    for place in places {
        let ([a, b], own) = (place.truth, found[place.patch]);
        off += place.area * (own - a).dot(own - b);
        power += place.area * a.dot(b);
        sums[0] += place.area * own.element_sum();
        sums[1] += 0.5 * place.area * (a + b).element_sum();
    }
    [(off.max(0.0) / power).sqrt(), sums[0] / sums[1] - 1.0]
}

/// Bounced irradiance of a patch by paths from places on it.
pub fn traced(surfaces: &TriangleSurfaces, lamps: &[LightSource], patch: &Patch, seed: u64) -> Vec3 {
    let id = patch.position().to_array().map(f32::to_bits);
    let mut stream = Stream::new(seed, u64::from(id[0]) << 32 ^ u64::from(id[1]) << 16 ^ u64::from(id[2]));
    let places = patch.sixty_fourths();
    let mut sum = Vec3::ZERO;
    for path in 0..PATHS {
        let mut origin = places[path as usize % places.len()] + surfaces.epsilon() * patch.normal;
        let (mut normal, mut weight) = (patch.normal, Vec3::ONE);
        for _ in 0..BOUNCES {
            let direction = stream.cosine_hemisphere(normal);
            let cast = (stream.unit() * u32::MAX as f32) as u32;
            let Some(hit) = surfaces.cast(&Ray::visibility(origin, direction), cast) else { break };
            weight *= hit.albedo;
            if weight == Vec3::ZERO {
                break;
            }
            sum += weight * at_hit(surfaces, lamps, &hit);
            (origin, normal) = (hit.offset_origin(-direction, surfaces.epsilon_at(hit.position)), hit.normal);
        }
    }
    sum / PATHS as f32
}
