//! Lamps with a size: spheres with the intensity of a point at their centre, and discs of suns.

use glam::{Vec2, Vec3};
use rebounce_shared::elementary::Elementary;
use rebounce_shared::light::{Incident, LightSource};
use std::f32::consts::TAU;

/// Sampled direction to a lamp.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Unit vector to the sample.
    pub to_light: Vec3,
    /// Length of the shadow ray, up to the disc through the sphere's centre; infinite for directional lights.
    pub distance: f32,
    /// Irradiance on a facing surface, relative to the irradiance from the light's centre.
    pub share: f32,
}

/// Samples the light with a random `square`, 0 to 1 each: uniform over the cone subtended by the sphere, from
/// anywhere outside the sphere. The mean over unoccluded samples equals the irradiance from the centre alone.
pub fn sample(light: &LightSource, at: &Incident, square: Vec2) -> Sample {
    let Incident { to_light, distance, .. } = *at;
    // The sphere's rim, or the disc's.
    let sine = match distance.is_finite() {
        true => (light.size / distance).min(1.0),
        false => light.size / (1.0 + light.size * light.size).sqrt(),
    };
    let cosine = (1.0 - sine * sine).sqrt();
    // 1 − cos, which is small for suns.
    let off = square.x * sine * sine / (1.0 + cosine);
    let (sin, cos) = (TAU * square.y).sine_cosine();
    let (right, up) = to_light.any_orthonormal_pair();
    let aside = (right * cos + up * sin) * (off * (2.0 - off)).sqrt();
    Sample {
        to_light: (to_light * (1.0 - off) + aside).normalize(),
        distance: distance * (1.0 - off),
        share: 2.0 / (1.0 + cosine),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;
    use rebounce_shared::light::Light;

    #[test]
    fn a_sphere_that_nothing_hides_gives_what_its_middle_gives() {
        let (position, color) = ([0.0, 2.0, 0.0], [1.0; 3]);
        let lights = [
            Light::Point { position, intensity: 5.0, color, radius: 0.8 },
            Light::Directional { direction: [0.0, -1.0, 0.0], intensity: 5.0, color, radius_deg: 20.0 },
        ];
        for light in lights {
            let light = light.source([0.0; 3]);
            let at = light.incident(Vec3::ZERO).unwrap();
            // Tilted, with the entire light in front of the surface.
            let normal = Vec3::new(0.5, 1.0, 0.0).normalize();
            let mut stream = Stream::new(3, 7);
            let n = 100_000;
            let mut sum = 0.0;
            for _ in 0..n {
                let sample = sample(&light, &at, stream.square());
                assert!((sample.to_light.length() - 1.0).abs() < 1e-5);
                sum += f64::from(sample.share * normal.dot(sample.to_light).max(0.0));
            }
            let expected = f64::from(normal.dot(at.to_light));
            assert!((sum / n as f64 / expected - 1.0).abs() < 2e-3, "{} of {expected}", sum / n as f64);
        }
    }

    #[test]
    fn rays_end_on_the_sphere_or_within_the_suns_disc() {
        let light = Light::Point { position: [0.0, 2.0, 0.0], intensity: 5.0, color: [1.0; 3], radius: 0.5 };
        let light = light.source([0.0; 3]);
        let at = light.incident(Vec3::ZERO).unwrap();
        let mut stream = Stream::new(3, 8);
        let mut farthest = 0f32;
        for _ in 0..1000 {
            let sample = sample(&light, &at, stream.square());
            let off = (sample.to_light * sample.distance - light.position).length();
            assert!(off <= 0.5 + 1e-5, "{off}");
            farthest = farthest.max(off);
        }
        assert!(farthest > 0.45, "{farthest}");
    }
}
