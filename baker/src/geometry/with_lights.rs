//! Surfaces with the rectangles, disks and spheres of area lights among them.

use super::{Emitters, Gloss, Hit, HitEmitter, Ray, Surfaces};
use glam::Vec3;
use rebounce_shared::light::{LightKind, LightSource};

/// Share of a sphere's radius within which a place counts as on the sphere.
const ON_SPHERE: f32 = 1e-4;

/// Intersection of a ray with the surface of an area light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaHit {
    /// Distance from the ray's origin, scene units.
    pub distance: f32,
    /// Unit normal on the front, the side that shines.
    pub normal: Vec3,
}

/// Returns the nearest intersection of a line from `origin` in a unit `direction` with an area light's surface, at a
/// distance above 0; `None` for lights of other kinds.
pub fn meet(light: &LightSource, origin: Vec3, direction: Vec3) -> Option<AreaHit> {
    let offset = light.position - origin;
    match light.kind {
        LightKind::Sphere => {
            let (offset, direction) = (offset.as_dvec3(), direction.as_dvec3());
            let along = offset.dot(direction);
            let radius = f64::from(light.size);
            let half = (radius * radius - (offset - along * direction).length_squared()).sqrt();
            // NaN where the line misses the sphere.
            let distance = [along - half, along + half].into_iter().find(|distance| *distance > 0.0)?;
            let normal = ((direction * distance - offset) / radius).as_vec3();
            Some(AreaHit { distance: distance as f32, normal })
        }
        LightKind::Rectangle | LightKind::Disk => {
            let across = light.direction.dot(direction);
            let distance = light.direction.dot(offset) / across;
            let place = direction * distance - offset;
            let inside = match light.kind {
                LightKind::Disk => place.length_squared() <= light.size * light.size,
                _ => {
                    let right = light.up.cross(light.direction);
                    2.0 * place.dot(right).abs() <= light.extent[0]
                        && 2.0 * place.dot(light.up).abs() <= light.extent[1]
                }
            };
            (distance > 0.0 && distance.is_finite() && inside)
                .then_some(AreaHit { distance, normal: light.direction })
        }
        _ => None,
    }
}

/// Returns whether a place is on an area light's surface, within `epsilon` scene units.
fn is_on(light: &LightSource, place: Vec3, epsilon: f32) -> bool {
    let offset = place - light.position;
    match light.kind {
        LightKind::Sphere => (offset.length() - light.size).abs() <= (ON_SPHERE * light.size).max(epsilon),
        _ => offset.dot(light.direction).abs() <= epsilon,
    }
}

/// Returns the minimum and maximum corner of an area light's surface.
fn bounds(light: &LightSource) -> (Vec3, Vec3) {
    let around = match light.kind {
        LightKind::Rectangle => {
            let right = light.up.cross(light.direction);
            0.5 * (right.abs() * light.extent[0] + light.up.abs() * light.extent[1])
        }
        LightKind::Disk => {
            light.size * (Vec3::ONE - light.direction * light.direction).max(Vec3::ZERO).map(f32::sqrt)
        }
        _ => Vec3::splat(light.size),
    };
    (light.position - around, light.position + around)
}

/// Surfaces, and area lights among them: black, opaque on both sides, with the light's radiance on the front. A visible
/// light is visible to cameras from both sides.
pub struct WithLights<'a, S: ?Sized> {
    surfaces: &'a S,
    lights: Vec<LightSource>,
    low: Vec3,
    high: Vec3,
}

impl<'a, S: Surfaces + ?Sized> WithLights<'a, S> {
    /// Places the area lights of a list, local space, among `surfaces`. A hit's [`HitEmitter::Light`] counts the area
    /// lights alone.
    pub fn new(surfaces: &'a S, lights: &[LightSource]) -> Self {
        let lights: Vec<LightSource> = lights.iter().filter(|light| light.kind.is_area()).copied().collect();
        let (low, high) = lights
            .iter()
            .map(bounds)
            .fold(surfaces.bounds(), |(low, high), (least, most)| (low.min(least), high.max(most)));
        Self { surfaces, lights, low, high }
    }

    /// Returns the nearest light on a ray, with its number.
    #[inline]
    fn nearest(&self, ray: &Ray) -> Option<(u32, AreaHit)> {
        let met = (0..)
            .zip(&self.lights)
            .filter_map(|(i, light)| Some((i, meet(light, ray.origin, ray.direction)?)));
        met.filter(|(_, at)| at.distance <= ray.max_distance)
            .min_by(|a, b| a.1.distance.total_cmp(&b.1.distance))
    }

    /// Returns the nearest hit; `of` casts a ray to the other surfaces.
    #[inline]
    fn first(&self, ray: &Ray, of: impl Fn(&Ray) -> Option<Hit>) -> Option<Hit> {
        let Some((number, AreaHit { distance, normal })) = self.nearest(ray) else { return of(ray) };
        let position = ray.origin + ray.direction * distance;
        // A light that lies on a surface is before it.
        let max_distance = (distance - self.surfaces.epsilon_at(position)).max(0.0);
        if let Some(hit) = of(&Ray { max_distance, ..*ray }) {
            return Some(hit);
        }
        let is_front = normal.dot(ray.direction) < 0.0;
        Some(Hit {
            distance,
            position,
            geometric_normal: if is_front { normal } else { -normal },
            normal,
            albedo: Vec3::ZERO,
            emission: if is_front { self.lights[number as usize].intensity } else { Vec3::ZERO },
            emitter: is_front.then_some(HitEmitter::Light(number)),
            is_unlit: false,
            group: 0,
            lightmap: None,
            gloss: Gloss::MATT,
        })
    }
}

impl<S: Surfaces + ?Sized> Surfaces for WithLights<'_, S> {
    fn cast(&self, ray: &Ray, seed: u32) -> Option<Hit> {
        self.first(ray, |ray| self.surfaces.cast(ray, seed))
    }

    fn see(&self, ray: &Ray, seed: u32) -> Option<Hit> {
        self.first(ray, |ray| self.surfaces.see(ray, seed))
    }

    fn transmittance(&self, from: Vec3, to: Vec3) -> Vec3 {
        if !self.lights.is_empty() {
            let offset = to.as_dvec3() - from.as_dvec3();
            let length = offset.length();
            let direction = (offset / length).as_vec3();
            let epsilon = self.surfaces.epsilon_at(to);
            let limit = length as f32 - epsilon;
            // A light that the way ends on does not hide that end: the rim of a sphere would, by rounding.
            let hides = |light: &LightSource| {
                meet(light, from, direction).is_some_and(|at| at.distance < limit)
                    && !is_on(light, to, epsilon)
            };
            if self.lights.iter().any(hides) {
                return Vec3::ZERO;
            }
        }
        self.surfaces.transmittance(from, to)
    }

    fn tint(&self, ray: &Ray, distance: f32, from_eye: bool) -> Vec3 {
        self.surfaces.tint(ray, distance, from_eye)
    }

    fn has_unlit(&self) -> bool {
        self.surfaces.has_unlit()
    }

    fn bounds(&self) -> (Vec3, Vec3) {
        (self.low, self.high)
    }

    fn main_part(&self) -> (Vec3, Vec3) {
        self.surfaces.main_part()
    }

    fn epsilon(&self) -> f32 {
        self.surfaces.epsilon()
    }

    #[inline]
    fn epsilon_at(&self, position: Vec3) -> f32 {
        self.surfaces.epsilon_at(position)
    }

    fn emitters(&self) -> Option<&dyn Emitters> {
        self.surfaces.emitters()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::mesh::TriangleSurfaces;
    use glam::DVec3;
    use rebounce_shared::light::Light;

    /// A rectangle, a disk and a sphere in the furnace, a room from −1 to 1.
    fn lights() -> Vec<LightSource> {
        let (direction, intensity, color) = ([0.0, -1.0, 0.0], 3.0, [1.0, 0.5, 0.25]);
        let rectangle = |position| Light::Rectangle {
            position,
            direction,
            up: [0.0, 0.0, 1.0],
            width: 0.5,
            height: 0.25,
            intensity,
            color,
        };
        let lights = [
            rectangle([0.0, 0.5, 0.0]),
            Light::Disk { position: [0.6, 0.5, 0.0], direction, radius: 0.2, intensity, color },
            Light::Sphere { position: [-0.6, 0.0, 0.0], radius: 0.25, intensity, color },
            // On the ceiling.
            rectangle([0.0, 1.0, 0.6]),
        ];
        lights.iter().map(|light| light.source([0.0; 3])).collect()
    }

    #[test]
    fn lights_are_seen_from_the_front_and_black_from_behind() {
        let scene = crate::io::load("builtin:furnace").unwrap();
        let room = TriangleSurfaces::from_scene(&scene);
        let surfaces = WithLights::new(&room, &lights());
        let cast = |origin: [f32; 3], direction: Vec3| {
            surfaces.cast(&Ray::visibility(origin.into(), direction), 0).unwrap()
        };
        let radiance = Vec3::new(3.0, 1.5, 0.75);
        for (number, x, z, y) in [(0, 0.2, 0.1, 0.5), (1, 0.5, 0.1, 0.5), (3, 0.2, 0.65, 1.0)] {
            let below = cast([x, 0.0, z], Vec3::Y);
            assert_eq!((below.emission, below.emitter), (radiance, Some(HitEmitter::Light(number))));
            assert!((below.distance - y).abs() < 1e-5 && below.faces(Vec3::Y) && below.albedo == Vec3::ZERO);
        }
        let above = cast([0.2, 0.9, 0.1], Vec3::NEG_Y);
        assert_eq!((above.emission, above.emitter, above.albedo), (Vec3::ZERO, None, Vec3::ZERO));
        assert!((above.distance - 0.4).abs() < 1e-6 && !above.faces(Vec3::NEG_Y));
        assert!(above.geometric_normal == Vec3::Y);
        // Beside the rectangle: the height is along z.
        assert!(
            cast([0.2, 0.0, 0.2], Vec3::Y).emitter.is_none()
                && cast([0.3, 0.0, 0.0], Vec3::Y).emitter.is_none()
        );
        let ball = cast([0.0, 0.0, 0.0], Vec3::NEG_X);
        assert!((ball.distance - 0.35).abs() < 1e-6 && ball.emission == radiance);
        let inside = cast([-0.6, 0.0, 0.0], Vec3::NEG_X);
        assert!((inside.distance - 0.25).abs() < 1e-6 && inside.emission == Vec3::ZERO);
    }

    #[test]
    fn lights_hide_others_and_not_themselves() {
        let scene = crate::io::load("builtin:furnace").unwrap();
        let room = TriangleSurfaces::from_scene(&scene);
        let surfaces = WithLights::new(&room, &lights());
        let is_open =
            |from: [f32; 3], to: [f32; 3]| surfaces.transmittance(from.into(), to.into()) == Vec3::ONE;
        assert!(is_open([0.0, -0.9, 0.0], [0.2, 0.5, 0.1]));
        assert!(!is_open([0.0, -0.9, 0.0], [0.0, 0.9, 0.0]) && !is_open([0.0, 0.9, 0.0], [0.0, -0.9, 0.0]));
        assert!(!is_open([0.0, 0.0, 0.0], [-0.95, 0.0, 0.0]));
        // To the sphere's front and rim.
        assert!(is_open([0.0, 0.0, 0.0], [-0.35, 0.0, 0.0]));
        let rim = DVec3::new(-0.6 + 0.25 * 0.25 / 0.6, 0.25 * (1.0 - (0.25f64 / 0.6).powi(2)).sqrt(), 0.0);
        assert!(is_open([0.0, 0.0, 0.0], rim.as_vec3().to_array()));
        // Beyond the walls, lights count for the bounds.
        let far = Light::Sphere { position: [5.0, 0.0, 0.0], radius: 1.0, intensity: 1.0, color: [1.0; 3] };
        let (low, high) = WithLights::new(&room, &[far.source([0.0; 3])]).bounds();
        assert!((high - Vec3::new(6.0, 1.0, 1.0)).length() < 1e-3 && (low + Vec3::ONE).length() < 1e-3);
    }
}
