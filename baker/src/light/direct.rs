//! Direct irradiance with ray-cast visibility. Lambert's cosine law, inverse squares; the units
//! are those of [`rebounce_shared::light`].

use super::area::{self, AreaSample, FIXED, fixed};
use super::sized;
use crate::geometry::{Hit, Surfaces};
use crate::random::Stream;
use glam::{Vec2, Vec3};
use rebounce_shared::footprint;
use rebounce_shared::light::{Incident, LightSource};
use rebounce_shared::rbn::bulk::Point;

/// RGB irradiance on a surface element at `position` (local space) with unit normal `normal`. Shadow rays start at
/// `position` moved off the surface along the normal.
pub fn at_point(
    surfaces: &(impl Surfaces + ?Sized),
    lights: &[LightSource],
    position: Vec3,
    normal: Vec3,
) -> Vec3 {
    let origin = |_| position + normal * surfaces.epsilon_at(position);
    sum(surfaces, lights, position, normal, origin) + fixed_sum(surfaces, lights, position, normal, origin)
}

/// RGB irradiance of a basis function's point: the mean over the samples of the point's footprint. Area lights are
/// sampled [`FIXED`] times in all: the places share the samples.
pub fn at_footprint(surfaces: &(impl Surfaces + ?Sized), lights: &[LightSource], point: &Point) -> Vec3 {
    let (position, normal) = (point.position(), point.normal());
    let mut places = [Vec3::ZERO; footprint::SAMPLES as usize];
    let (mut total, mut count) = (Vec3::ZERO, 0);
    for sample in 0..footprint::SAMPLES {
        if point.has_sample(sample) {
            let place = position + footprint::offset(sample, normal, point.radius);
            total += sum(surfaces, lights, place, normal, |_| place);
            places[count] = place;
            count += 1;
        }
    }
    if count == 0 {
        return at_point(surfaces, lights, position, normal);
    }
    // The places are off the surface by themselves.
    let mut areas = Vec3::ZERO;
    if lights.iter().any(|light| light.kind.is_area()) {
        for (i, place) in (0..FIXED).zip(places[..count].iter().cycle()) {
            areas += area_sum(surfaces, lights, *place, normal, |_| *place, fixed(i));
        }
    }
    total / count as f32 + areas / FIXED as f32
}

/// RGB irradiance at a ray hit, with lamps as points and [`FIXED`] samples of area lights.
pub fn at_hit(surfaces: &(impl Surfaces + ?Sized), lights: &[LightSource], hit: &Hit) -> Vec3 {
    let (position, normal) = (hit.position, hit.normal);
    let origin = |to_light| hit.offset_origin(to_light, surfaces.epsilon_at(position));
    sum(surfaces, lights, position, normal, origin) + fixed_sum(surfaces, lights, position, normal, origin)
}

/// Single-sample estimate of the RGB irradiance at a hit: one random place per light with a size or surface.
pub fn toward_hit(
    surfaces: &(impl Surfaces + ?Sized),
    lights: &[LightSource],
    hit: &Hit,
    stream: &mut Stream,
) -> Vec3 {
    toward_hit_with(surfaces, lights, hit, stream, |irradiance, _| irradiance)
}

/// As [`toward_hit`], with the irradiance of each sample weighed: `weigh` takes it, RGB, and the unit vector to the light.
pub fn toward_hit_with(
    surfaces: &(impl Surfaces + ?Sized),
    lights: &[LightSource],
    hit: &Hit,
    stream: &mut Stream,
    weigh: impl Fn(Vec3, Vec3) -> Vec3,
) -> Vec3 {
    let origin = |to_light| hit.offset_origin(to_light, surfaces.epsilon_at(hit.position));
    let mut total = Vec3::ZERO;
    for light in lights {
        let Some(mut at) = light.incident(hit.position) else { continue };
        if light.size > 0.0 {
            let sample = sized::sample(light, &at, stream.square());
            at.irradiance *= sample.share;
            (at.to_light, at.distance) = (sample.to_light, sample.distance);
        }
        total += weigh(reaching(surfaces, light, &at, hit.position, hit.normal, origin), at.to_light);
    }
    for light in lights.iter().filter(|light| light.kind.is_area()) {
        let square = stream.square();
        let arriving = arriving(surfaces, light, hit.position, hit.normal, origin, square);
        total += arriving.map_or(Vec3::ZERO, |at| weigh(at.irradiance(), at.to_light));
    }
    total
}

/// A sample of an area light at a surface.
pub(super) struct Arriving {
    /// Unit vector to the place.
    pub to_light: Vec3,
    /// Linear RGB radiance, with visibility.
    pub radiance: Vec3,
    /// Cosine of the angle to the surface's normal, above 0.
    pub cosine: f32,
    /// Density of the sample, per steradian.
    pub density: f32,
}

impl Arriving {
    fn irradiance(&self) -> Vec3 {
        self.radiance * (self.cosine / self.density)
    }
}

/// Samples an area light at a surface with unit `normal`; `None` for no light.
pub(super) fn arriving(
    surfaces: &(impl Surfaces + ?Sized),
    light: &LightSource,
    position: Vec3,
    normal: Vec3,
    origin: impl Fn(Vec3) -> Vec3,
    square: Vec2,
) -> Option<Arriving> {
    let AreaSample { position: place, to_light, density } = area::sample(light, position, square)?;
    let cosine = normal.dot(to_light);
    if cosine <= 0.0 {
        return None;
    }
    let left = surfaces.transmittance(origin(to_light), place);
    (left != Vec3::ZERO).then(|| Arriving { to_light, radiance: light.intensity * left, cosine, density })
}

/// Irradiance from the area lights by the sample of each at `square`.
fn area_sum(
    surfaces: &(impl Surfaces + ?Sized),
    lights: &[LightSource],
    position: Vec3,
    normal: Vec3,
    origin: impl Fn(Vec3) -> Vec3,
    square: Vec2,
) -> Vec3 {
    let areas = lights.iter().filter(|light| light.kind.is_area());
    let found = areas.filter_map(|light| arriving(surfaces, light, position, normal, &origin, square));
    found.map(|at| at.irradiance()).sum()
}

/// Irradiance from the area lights: the mean of the [`FIXED`] samples.
fn fixed_sum(
    surfaces: &(impl Surfaces + ?Sized),
    lights: &[LightSource],
    position: Vec3,
    normal: Vec3,
    origin: impl Fn(Vec3) -> Vec3,
) -> Vec3 {
    if !lights.iter().any(|light| light.kind.is_area()) {
        return Vec3::ZERO;
    }
    let of = |i| area_sum(surfaces, lights, position, normal, &origin, fixed(i));
    (0..FIXED).map(of).sum::<Vec3>() / FIXED as f32
}

#[inline]
fn sum(
    surfaces: &(impl Surfaces + ?Sized),
    lights: &[LightSource],
    position: Vec3,
    normal: Vec3,
    origin: impl Fn(Vec3) -> Vec3,
) -> Vec3 {
    let mut total = Vec3::ZERO;
    for light in lights {
        let Some(at) = light.incident(position) else { continue };
        total += reaching(surfaces, light, &at, position, normal, &origin);
    }
    total
}

/// Irradiance from `light` at `position` with normal `normal`, with visibility.
#[inline]
fn reaching(
    surfaces: &(impl Surfaces + ?Sized),
    light: &LightSource,
    at: &Incident,
    position: Vec3,
    normal: Vec3,
    origin: impl Fn(Vec3) -> Vec3,
) -> Vec3 {
    let Incident { to_light, distance, irradiance } = *at;
    let cosine = normal.dot(to_light);
    if cosine <= 0.0 {
        return Vec3::ZERO;
    }
    let to = if !distance.is_finite() {
        beyond(surfaces, position, to_light)
    } else if light.size > 0.0 {
        position + to_light * distance
    } else {
        light.position
    };
    irradiance * (surfaces.transmittance(origin(to_light), to) * cosine)
}

/// Returns a place in this direction from `position`, behind all surfaces.
pub(super) fn beyond(surfaces: &(impl Surfaces + ?Sized), position: Vec3, direction: Vec3) -> Vec3 {
    let (low, high) = surfaces.bounds();
    position + direction * (2.0 * (high - low).length() + 2.0 * (position - low).length())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::mesh::TriangleSurfaces;
    use rebounce_shared::light::Light;

    #[test]
    fn walls_of_the_furnace_get_the_inverse_square_law() {
        let scene = crate::io::load("builtin:furnace").unwrap();
        let surfaces = TriangleSurfaces::from_scene(&scene);
        let lights = [scene.lights[0].source(scene.origin)];
        for (x, y) in [(0.0, 0.0), (0.5, -0.7), (0.99, 0.99)] {
            let p = Vec3::new(x, y, -1.0);
            let expected = 1.0 / p.length().powi(3);
            let found = at_point(&surfaces, &lights, p, Vec3::Z);
            assert!((found - expected).length() < 1e-5, "{found} instead of {expected}");
        }
        // No light passes through the wall, and none reaches a surface facing away.
        assert_eq!(at_point(&surfaces, &lights, Vec3::new(0.1, 0.2, -1.5), Vec3::Z), Vec3::ZERO);
        assert_eq!(at_point(&surfaces, &lights, Vec3::new(0.1, 0.2, -1.0), -Vec3::Z), Vec3::ZERO);
    }

    #[test]
    fn the_sun_is_hidden_by_a_roof_and_only_by_it() {
        let scene = crate::io::load("builtin:furnace").unwrap();
        let surfaces = TriangleSurfaces::from_scene(&scene);
        let sun = Light::Directional {
            direction: [0.0, -3.0, 0.0],
            intensity: 5.0,
            color: [1.0, 0.5, 0.0],
            radius_deg: 0.0,
        };
        let lights = [sun.source(scene.origin)];
        let above = at_point(&surfaces, &lights, Vec3::new(0.2, 1.0, 0.1), Vec3::Y);
        assert_eq!(above, Vec3::new(5.0, 2.5, 0.0));
        assert_eq!(at_point(&surfaces, &lights, Vec3::new(0.2, -1.0, 0.1), Vec3::Y), Vec3::ZERO);
    }
}
