//! Lights after KHR_lights_punctual, as in SHOT.json, with a size.

mod stored;

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

/// Light in world space. Point and spot intensity in candela (1 cd counts as 1 W/sr per channel), directional in lux;
/// colours linear RGB. A .rbn file does not store the size (light/stored.rs).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "lowercase")]
pub enum Light {
    /// Omnidirectional.
    Point {
        /// World space.
        position: [f64; 3],
        /// Candela.
        intensity: f64,
        /// Linear RGB.
        #[serde(default = "white")]
        color: [f64; 3],
        /// Radius of the emitting sphere, scene units; 0: a point.
        #[serde(default, skip_serializing_if = "is_zero")]
        radius: f64,
    },
    /// Shines within a cone.
    Spot {
        /// World space.
        position: [f64; 3],
        /// The cone's axis, the way the light travels; any length.
        direction: [f64; 3],
        /// Half angle of the cone, degrees.
        outer_cone_deg: f64,
        /// Half angle within which the light is full, degrees; absent: a hard edge.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        inner_cone_deg: Option<f64>,
        /// Candela.
        intensity: f64,
        /// Linear RGB.
        #[serde(default = "white")]
        color: [f64; 3],
        /// Radius of the emitting sphere, scene units; 0: a point.
        #[serde(default, skip_serializing_if = "is_zero")]
        radius: f64,
    },
    /// Shines from infinitely far.
    Directional {
        /// The way the light travels; any length.
        direction: [f64; 3],
        /// Lux on a surface that faces the light.
        intensity: f64,
        /// Linear RGB.
        #[serde(default = "white")]
        color: [f64; 3],
        /// Angular radius of the disc, degrees (the sun 0.27); 0: a point.
        #[serde(default, skip_serializing_if = "is_zero")]
        radius_deg: f64,
    },
}

/// Largest angular radius of a directional light's disc, degrees.
pub const WIDEST_DEG: f64 = 30.0;

fn white() -> [f64; 3] {
    [1.0; 3]
}

fn is_zero(size: &f64) -> bool {
    *size == 0.0
}

/// Kind of a [`LightSource`]; values match the shaders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum LightKind {
    /// All around.
    Point = 0,
    /// A cone.
    Spot = 1,
    /// From infinitely far.
    Directional = 2,
}

/// Light prepared for evaluation in scene-local space (local = world − the file's origin).
#[derive(Clone, Copy, Debug)]
pub struct LightSource {
    /// Point, spot or directional.
    pub kind: LightKind,
    /// Local space; not used for directional lights.
    pub position: Vec3,
    /// Unit vector the way the light travels.
    pub direction: Vec3,
    /// Intensity times colour: W/sr (point, spot) or W/m² (directional) per channel.
    pub intensity: Vec3,
    /// KHR_lights_punctual's angular scale: `clamp(cos · scale + offset, 0, 1)²`.
    pub cone_scale: f32,
    /// KHR_lights_punctual's angular offset.
    pub cone_offset: f32,
    /// Cosine of the outer half angle; −1 without a cone.
    pub cos_outer: f32,
    /// Radius of the emitting sphere; of a directional light, the tangent of its disc's angular radius. 0
    /// for a point.
    pub size: f32,
}

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
    /// Returns the position, world space; `None` for a directional light.
    pub fn position(&self) -> Option<[f64; 3]> {
        match self {
            Self::Point { position, .. } | Self::Spot { position, .. } => Some(*position),
            Self::Directional { .. } => None,
        }
    }

    /// Returns true if the light's numbers are finite and small enough for finite pictures: positions under 1e15
    /// units, intensities and colours under 1e18.
    pub fn is_usable(&self) -> bool {
        let far = |v: &[f64; 3]| v.iter().all(|x| x.abs() < 1e15);
        let (place, angles, intensity, color) = match self {
            Light::Point { position, intensity, color, .. } => (far(position), [0.0; 2], intensity, color),
            Light::Spot { position, direction, outer_cone_deg, inner_cone_deg, intensity, color, .. } => (
                far(position) && far(direction),
                [*outer_cone_deg, inner_cone_deg.unwrap_or_default()],
                intensity,
                color,
            ),
            Light::Directional { direction, intensity, color, .. } => {
                (far(direction), [0.0; 2], intensity, color)
            }
        };
        place
            && angles.iter().all(|angle| angle.is_finite())
            && self.size().abs() < 1e15
            && color.iter().chain([intensity]).all(|x| x.abs() < 1e18)
    }

    /// Returns the radius in scene units; for a directional light, degrees.
    pub fn size(&self) -> f64 {
        match self {
            Light::Point { radius, .. } | Light::Spot { radius, .. } => *radius,
            Light::Directional { radius_deg, .. } => *radius_deg,
        }
    }

    /// Prepares the light for scene-local space; `origin` (world space) becomes zero.
    pub fn source(&self, origin: [f64; 3]) -> LightSource {
        let local = |p: &[f64; 3]| (DVec3::from(*p) - DVec3::from(origin)).as_vec3();
        let unit = |d: &[f64; 3]| DVec3::from(*d).try_normalize().unwrap_or(DVec3::NEG_Y).as_vec3();
        let rgb = |color: &[f64; 3], intensity: f64| (DVec3::from(*color) * intensity).as_vec3();
        let size = match self {
            Light::Directional { radius_deg, .. } => radius_deg.clamp(0.0, WIDEST_DEG).to_radians().tan(),
            _ => self.size().max(0.0),
        } as f32;
        match self {
            Light::Point { position, intensity, color, .. } => LightSource {
                kind: LightKind::Point,
                position: local(position),
                direction: Vec3::NEG_Y,
                intensity: rgb(color, *intensity),
                cone_scale: 0.0,
                cone_offset: 1.0,
                cos_outer: -1.0,
                size,
            },
            Light::Spot { position, direction, outer_cone_deg, inner_cone_deg, intensity, color, .. } => {
                let outer = outer_cone_deg.clamp(0.01, 90.0);
                let cos_outer = outer.to_radians().cos();
                let cos_inner =
                    inner_cone_deg.map_or(cos_outer, |d| d.min(outer).max(0.0).to_radians().cos());
                // A hard edge is a very steep ramp that reaches 1 right inside the cone.
                let scale = 1.0 / (cos_inner - cos_outer).max(1e-5);
                LightSource {
                    kind: LightKind::Spot,
                    position: local(position),
                    direction: unit(direction),
                    intensity: rgb(color, *intensity),
                    cone_scale: scale as f32,
                    cone_offset: (-cos_outer * scale) as f32,
                    cos_outer: cos_outer as f32,
                    size,
                }
            }
            Light::Directional { direction, intensity, color, .. } => LightSource {
                kind: LightKind::Directional,
                position: Vec3::ZERO,
                direction: unit(direction),
                intensity: rgb(color, *intensity),
                cone_scale: 0.0,
                cone_offset: 1.0,
                cos_outer: -1.0,
                size,
            },
        }
    }
}

impl LightSource {
    /// Returns the unoccluded light at the local point `position`; `None` outside the cone.
    #[inline]
    pub fn incident(&self, position: Vec3) -> Option<Incident> {
        if self.kind == LightKind::Directional {
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
