//! A ray through what a cube map sees: correction by depth. The ray is followed over the map, a texel a step, until it passes
//! behind the surface that the map has there (Szirmay-Kalos et al., *Approximate Ray-Tracing on the GPU with Distance
//! Impostors*, 2005; McGuire et al., *Real-Time Global Illumination using Precomputed Light Field Probes*, 2017).
//!
//! In the plane of the map's place O, the ray's origin X and its direction d, let θ be the angle from OX to d. Seen from O,
//! the ray's point P at angle φ from OX has the distance
//!
//! ```text
//! |OP| = |OX| sin θ / sin(θ − φ)
//! ```

use super::cube::Cube;
use crate::elementary::Elementary;
use glam::Vec3;

/// Most steps of a ray.
const MOST_STEPS: u32 = 64;
/// Halvings of the step in which a ray passes behind a surface.
const HALVINGS: u32 = 4;
/// Least distance behind a surface that counts as behind, texels.
const BIAS: f32 = 1.0;
/// Share of its distance, and texels, that a surface is taken to be thick: farther behind, a ray may have passed unhurt.
const THICK: (f32, f32) = (0.03, 3.0);
/// Least sine of the angle at which a ray is seen from the side.
const RADIAL: f32 = 1e-3;

/// Distances from the place of a cube map to what it sees, scene units; infinite for the sky.
#[derive(Clone, Debug)]
pub struct Distances {
    /// The texels.
    pub cube: Cube,
    /// By texel.
    pub texels: Vec<f32>,
}

/// End of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayEnd {
    /// Direction from the cube map's place, not of unit length.
    pub seen_from_map: Vec3,
    /// Distance from the ray's origin, scene units; infinite in the sky.
    pub along: f32,
    /// Distance from the cube map's place, likewise.
    pub from_map: f32,
    /// Whether the map saw all of the way.
    pub is_sure: bool,
}

impl Distances {
    /// Distance in a direction, not of unit length.
    pub fn at(&self, direction: Vec3) -> f32 {
        self.texels[self.cube.nearest(direction)]
    }

    /// Whether a place, from that of the map, is not behind what the map sees.
    pub fn sees(&self, place: Vec3) -> bool {
        place.length() <= self.at(place) * (1.0 + THICK.0 + THICK.1 * self.cube.angle())
    }

    /// Follows a ray of unit direction from a place, which is from that of the map; adds what is read to `steps`.
    pub fn follow(&self, from: Vec3, direction: Vec3, steps: &mut u64) -> RayEnd {
        let way = SeenRay::new(from, direction);
        if way.sine < RADIAL {
            // Seen end on.
            *steps += 1;
            let from_map = self.at(direction);
            let along = (from_map - from.dot(direction)).max(0.0);
            return RayEnd { seen_from_map: direction, along, from_map, is_sure: true };
        }
        let angle = self.cube.angle();
        let count = ((way.whole / angle).ceil() as u32).clamp(1, MOST_STEPS);
        let step = way.whole / count as f32;
        let is_behind = |phi: f32| {
            let surface = self.at(way.toward(phi));
            (way.distance(phi) > surface * (1.0 + BIAS * angle)).then_some(surface)
        };
        let (mut was_behind, mut is_sure) = (is_behind(0.0).is_some(), self.sees(from));
        for i in 1..=count {
            *steps += 1;
            let phi = step * i as f32;
            let behind = is_behind(phi).is_some();
            if behind && !was_behind {
                let (mut low, mut high) = (phi - step, phi);
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (low + high);
                    if is_behind(middle).is_some() { high = middle } else { low = middle }
                }
                *steps += u64::from(HALVINGS);
                let seen_from_map = way.toward(high);
                let from_map = self.at(seen_from_map);
                // Before the last halving the ray was before the surface, or the surface is not that one.
                if way.distance(low) < from_map * (1.0 + THICK.0 + THICK.1 * angle) {
                    let along = (from_map * seen_from_map - from).dot(direction).max(0.0);
                    return RayEnd { seen_from_map, along, from_map, is_sure };
                }
                // It passes behind an edge.
                is_sure = false;
            }
            was_behind = behind;
        }
        let from_map = self.at(direction);
        let along =
            if from_map.is_finite() { (from_map - from.dot(direction)).max(0.0) } else { f32::INFINITY };
        RayEnd { seen_from_map: direction, along, from_map, is_sure: is_sure && !was_behind }
    }
}

/// A ray as it is seen from a cube map.
struct SeenRay {
    /// Distance of the ray's origin.
    start: f32,
    /// Unit vectors to the origin, and across it in the plane of the ray.
    axes: [Vec3; 2],
    /// Angle θ of the whole ray, and its sine.
    whole: f32,
    sine: f32,
}

impl SeenRay {
    fn new(from: Vec3, direction: Vec3) -> Self {
        let start = from.length();
        let first = from.try_normalize().unwrap_or(direction);
        let cosine = first.dot(direction).clamp(-1.0, 1.0);
        let across = direction - cosine * first;
        let sine = across.length();
        let second = across.try_normalize().unwrap_or(Vec3::ZERO);
        Self { start, axes: [first, second], whole: cosine.arc_cosine(), sine }
    }

    /// Direction at an angle.
    fn toward(&self, phi: f32) -> Vec3 {
        let (sine, cosine) = phi.sine_cosine();
        cosine * self.axes[0] + sine * self.axes[1]
    }

    fn rest(&self, phi: f32) -> f32 {
        (self.whole - phi).sine_cosine().0
    }

    /// Distance from the cube map at an angle.
    fn distance(&self, phi: f32) -> f32 {
        let rest = self.rest(phi);
        if rest > 1e-5 { self.start * self.sine / rest } else { f32::INFINITY }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    /// Distances within a sphere about the map's place.
    fn sphere(radius: f32, side: usize) -> Distances {
        let cube = Cube { side };
        Distances { cube, texels: vec![radius; cube.texels()] }
    }

    #[test]
    fn rays_within_a_sphere_end_on_it() {
        let distances = sphere(2.0, 64);
        let mut stream = Stream::new(4, 4);
        for _ in 0..500 {
            let (from, direction) = (stream.sphere() * (1.8 * stream.unit()), stream.sphere());
            let mut steps = 0;
            let met = distances.follow(from, direction, &mut steps);
            let (b, c) = (from.dot(direction), from.length_squared() - 4.0);
            let exact = -b + (b * b - c).sqrt();
            let place = from + exact * direction;
            let off = met.seen_from_map.normalize().distance(place / 2.0);
            assert!(met.is_sure && off < 3.0 * distances.cube.angle(), "{from} {direction}: {off}");
            assert!((1..=u64::from(MOST_STEPS + HALVINGS)).contains(&steps));
        }
    }

    #[test]
    fn rays_into_the_sky_end_nowhere() {
        let distances = sphere(f32::INFINITY, 8);
        let met = distances.follow(Vec3::new(0.3, 0.1, 0.0), Vec3::Y, &mut 0);
        assert_eq!((met.seen_from_map, met.along, met.is_sure), (Vec3::Y, f32::INFINITY, true));
    }

    #[test]
    fn a_ray_behind_an_edge_is_not_sure() {
        // A disk before the sky: what is behind it is not known.
        let cube = Cube { side: 64 };
        let of = |i: usize| if cube.direction(i).x > 0.9 { 1.0 } else { f32::INFINITY };
        let distances = Distances { cube, texels: (0..cube.texels()).map(of).collect() };
        let behind = distances.follow(Vec3::new(2.0, -3.0, 0.0), Vec3::Y, &mut 0);
        assert!(!behind.is_sure);
        let before = distances.follow(Vec3::new(0.5, -3.0, 0.0), Vec3::Y, &mut 0);
        assert!(before.is_sure && before.along.is_infinite());
    }
}
