//! Lights prepared for evaluation, and what they give to a place. The shaders' twin is lights.wgsl.

use super::kinds::{Light, LightKind, WIDEST_DEG};
use crate::elementary::Elementary;
use glam::{DVec3, Vec3};

/// Light prepared for evaluation in scene-local space (local = world − the file's origin); in the shaders' memory
/// layout, a multiple of 16 bytes.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::NoUninit)]
#[repr(C)]
pub struct LightSource {
    /// Local space; not used for lights that are infinitely far.
    pub position: Vec3,
    /// Kind of the light.
    pub kind: LightKind,
    /// Unit vector the way the light travels; down for a light that shines all around.
    pub direction: Vec3,
    /// KHR_lights_punctual's angular scale: `clamp(cos · scale + offset, 0, 1)²`.
    pub cone_scale: f32,
    /// Intensity times colour, per channel: W/sr; W/m² of directional lights; W/(sr m²) of lights with a surface; a
    /// factor of environments and of shining surfaces.
    pub intensity: Vec3,
    /// KHR_lights_punctual's angular offset.
    pub cone_offset: f32,
    /// Cosine of the outer half angle; −1 without a cone.
    pub cos_outer: f32,
    /// Radius of the emitting sphere or disk; of a directional light, the tangent of its disc's angular radius. 0
    /// for a point.
    pub size: f32,
    /// Width and height of a rectangle; zero otherwise.
    pub extent: [f32; 2],
    /// Unit vector along a rectangle's height, square to `direction`; zero otherwise.
    pub up: Vec3,
    /// Zero.
    pub padding: f32,
}

const _: () = assert!(size_of::<LightSource>().is_multiple_of(16));

/// Incident light at a point, before visibility.
#[derive(Clone, Copy, Debug)]
pub struct Incident {
    /// Unit vector from the point to the light.
    pub to_light: Vec3,
    /// Distance to the light; infinite for directional lights.
    pub distance: f32,
    /// Irradiance per channel on a surface that faces the light.
    pub irradiance: Vec3,
}

impl Light {
    /// Prepares the light for scene-local space; `origin` (world space) becomes zero.
    pub fn source(&self, origin: [f64; 3]) -> LightSource {
        let local = |p: [f64; 3]| (DVec3::from(p) - DVec3::from(origin)).as_vec3();
        let unit = |d: [f64; 3]| DVec3::from(d).try_normalize().unwrap_or(DVec3::NEG_Y).as_vec3();
        let all_around = LightSource {
            position: self.position().map_or(Vec3::ZERO, local),
            kind: self.kind(),
            direction: self.direction().map_or(Vec3::NEG_Y, unit),
            cone_scale: 0.0,
            intensity: self.strength(),
            cone_offset: 1.0,
            cos_outer: -1.0,
            size: self.size().max(0.0) as f32,
            extent: [0.0; 2],
            up: Vec3::ZERO,
            padding: 0.0,
        };
        match self {
            Light::Point { .. }
            | Light::Disk { .. }
            | Light::Sphere { .. }
            | Light::Environment { .. }
            | Light::Emissive { .. } => all_around,
            Light::Rectangle { direction, up, width, height, .. } => LightSource {
                extent: [*width as f32, *height as f32],
                up: upright(*direction, *up).as_vec3(),
                ..all_around
            },
            Light::Spot { outer_cone_deg, inner_cone_deg, .. } => {
                let outer = outer_cone_deg.clamp(0.01, 90.0);
                let cos_outer = outer.to_radians().cosine();
                let cos_inner =
                    inner_cone_deg.map_or(cos_outer, |d| d.min(outer).max(0.0).to_radians().cosine());
                // A hard edge is a very steep ramp that reaches 1 right inside the cone.
                let scale = 1.0 / (cos_inner - cos_outer).max(1e-5);
                LightSource {
                    cone_scale: scale as f32,
                    cone_offset: (-cos_outer * scale) as f32,
                    cos_outer: cos_outer as f32,
                    ..all_around
                }
            }
            Light::Directional { radius_deg, .. } => {
                let tangent = radius_deg.clamp(0.0, WIDEST_DEG).to_radians().tangent();
                LightSource { size: tangent as f32, ..all_around }
            }
        }
    }
}

/// Share of y in a direction above which the direction counts as nearly vertical.
const NEARLY_VERTICAL: f64 = 0.9;

/// Returns the unit vector square to a rectangle's normal that is nearest `up`; without `up`, nearest the y axis, or the
/// x axis for a normal that is nearly vertical.
fn upright(direction: [f64; 3], up: [f64; 3]) -> DVec3 {
    let normal = DVec3::from(direction).try_normalize().unwrap_or(DVec3::NEG_Y);
    let square = |up: DVec3| (up - normal * normal.dot(up)).try_normalize();
    let usual = if normal.y.abs() < NEARLY_VERTICAL { DVec3::Y } else { DVec3::X };
    // Along the normal, an up is none.
    let is_up = |up: &DVec3| up.cross(normal).length() > 1e-9;
    let up = DVec3::from(up).try_normalize().filter(is_up).unwrap_or(usual);
    square(up).unwrap_or_else(|| normal.any_orthonormal_vector())
}

impl LightSource {
    /// Returns true if the light is infinitely far: its rays are parallel, and do not weaken.
    #[inline]
    pub fn is_far(&self) -> bool {
        self.kind == LightKind::Directional
    }

    /// Returns the unoccluded light at the local point `position`; `None` outside the cone, and for lights that are not
    /// punctual.
    #[inline]
    pub fn incident(&self, position: Vec3) -> Option<Incident> {
        if !self.kind.is_punctual() {
            return None;
        }
        if self.is_far() {
            return Some(Incident {
                to_light: -self.direction,
                distance: f32::INFINITY,
                irradiance: self.intensity,
            });
        }
        let offset = self.position - position;
        let distance_squared = offset.length_squared();
        if distance_squared <= 0.0 {
            return None;
        }
        let distance = distance_squared.sqrt();
        let to_light = offset / distance;
        let ramp = (-to_light.dot(self.direction) * self.cone_scale + self.cone_offset).clamp(0.0, 1.0);
        (ramp > 0.0).then(|| Incident {
            to_light,
            distance,
            irradiance: self.intensity * (ramp * ramp / distance_squared),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_square_and_hard_cone() {
        let spot = Light::Spot {
            position: [1.0, 5.0, 0.0],
            direction: [0.0, -2.0, 0.0],
            outer_cone_deg: 45.0,
            inner_cone_deg: None,
            intensity: 8.0,
            color: [1.0, 0.5, 0.0],
            radius: 0.0,
        }
        .source([1.0, 0.0, 0.0]);
        let below = spot.incident(Vec3::new(0.0, 1.0, 0.0)).unwrap();
        assert!((below.irradiance - Vec3::new(0.5, 0.25, 0.0)).length() < 1e-6);
        assert!(spot.incident(Vec3::new(5.01, 0.0, 0.0)).is_none());
        let inside = spot.incident(Vec3::new(4.99, 0.0, 0.0)).unwrap();
        assert!(inside.irradiance.x > 0.0);
    }

    #[test]
    fn a_rectangle_stands_upright_unless_it_says_otherwise() {
        let up = |direction, up| {
            let (position, width, height, color) = ([0.0; 3], 2.0, 1.0, [1.0; 3]);
            Light::Rectangle { position, direction, up, width, height, intensity: 1.0, color }
                .source([0.0; 3])
                .up
        };
        let none = [0.0; 3];
        assert_eq!(up([0.0, 0.0, 3.0], none), Vec3::Y);
        assert_eq!(up([0.0, -2.0, 0.0], none), Vec3::X);
        assert_eq!(up([0.0, -2.0, 0.0], [0.0, 1.0, 5.0]), Vec3::Z);
        // Up along the normal is none.
        assert_eq!(up([0.0, -2.0, 0.0], [0.0, 1.0, 0.0]), Vec3::X);
        let tilted = up([1.0, -1.0, 0.0], none);
        assert!((tilted - Vec3::new(1.0, 1.0, 0.0).normalize()).length() < 1e-6, "{tilted}");
    }

    #[test]
    fn directional_light_is_the_same_everywhere() {
        let sun = Light::Directional {
            direction: [0.0, -1.0, 0.0],
            intensity: 3.0,
            color: [1.0; 3],
            radius_deg: 0.0,
        }
        .source([0.0; 3]);
        for p in [Vec3::ZERO, Vec3::splat(1e6)] {
            let at = sun.incident(p).unwrap();
            assert_eq!((at.to_light, at.irradiance), (Vec3::Y, Vec3::splat(3.0)));
        }
    }
}
