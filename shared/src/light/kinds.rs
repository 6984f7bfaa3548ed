//! The kinds of light: the table that the Rust types, the lists of numbers between the wasm module and the page,
//! SHOT.json, the .rbn file and the page's own table (`cargo xtask light-kinds`) follow from.
//!
//! A new kind is an entry at the end of [`KINDS`], with fields from above or fields of its own; what it sends to a
//! place is in source.rs. The order of the kinds and the places of the fields never change: files and pages hold them.

use super::field::{Absent, Field, LightDescription, Range, Stored, Value};
use super::table::{described, kinds};
use serde::{Deserialize, Serialize};

/// Largest angular radius of a directional light's disc, degrees.
pub const WIDEST_DEG: f64 = 30.0;

/// Numbers of a light as a list: its kind, then the fields by their places ([`Field::at`]).
pub const NUMBERS: usize = 17;

/// The basis of the fields: a number that must be there.
const NUMBER: Field = Field {
    name: "",
    row: "",
    at: 0,
    width: 1,
    absent: Absent::Refused,
    fresh: None,
    range: Range::Any,
    largest: 1e15,
    stored: Stored::Numbers,
};
/// The basis of the fields that are texts: lists of numbers do not carry them, and a light of a list of numbers is
/// without.
const TEXT: Field =
    Field { width: 0, absent: Absent::Nothing, largest: f64::INFINITY, stored: Stored::Text, ..NUMBER };
/// Of a light at a place; world space.
pub const POSITION: Field = Field { name: "position", row: "Position", at: 1, width: 3, ..NUMBER };
/// The way the light travels.
pub const DIRECTION: Field = Field {
    name: "direction",
    row: "Direction",
    at: 4,
    width: 3,
    fresh: Some(&[0.0, -1.0, 0.0]),
    range: Range::Direction,
    ..NUMBER
};
const OUTER_CONE: Field = Field {
    name: "outer_cone_deg",
    row: "Outer angle, degrees",
    at: 7,
    fresh: Some(&[40.0]),
    range: Range::HalfAngle,
    largest: f64::INFINITY,
    ..NUMBER
};
const INNER_CONE: Field = Field {
    name: "inner_cone_deg",
    row: "Inner angle, degrees",
    at: 8,
    absent: Absent::Nothing,
    fresh: Some(&[30.0]),
    range: Range::UpToField(OUTER_CONE.name, OUTER_CONE.at),
    stored: Stored::Optional,
    ..OUTER_CONE
};
/// How bright the light is.
pub const INTENSITY: Field =
    Field { name: "intensity", row: "Intensity", at: 9, range: Range::NotNegative, largest: 1e18, ..NUMBER };
/// Linear RGB; multiplies the intensity.
pub const COLOR: Field = Field {
    name: "color",
    row: "Colour",
    at: 10,
    width: 3,
    absent: Absent::Vector([1.0; 3]),
    range: Range::Color,
    largest: 1e18,
    ..NUMBER
};
/// How large the light is: a radius, scene units or degrees.
pub const SIZE: Field = Field {
    name: "radius",
    row: "Size: radius",
    at: 13,
    absent: Absent::Number(0.0),
    range: Range::NotNegative,
    stored: Stored::No,
    ..NUMBER
};
const ANGULAR_SIZE: Field =
    Field { name: "radius_deg", row: "Size: radius, degrees", range: Range::UpTo(WIDEST_DEG), ..SIZE };
/// Of a disk or sphere: a part of what the light is, so that files store it.
const RADIUS: Field = Field {
    row: "Radius",
    absent: Absent::Refused,
    fresh: Some(&[0.2]),
    range: Range::Positive,
    stored: Stored::Numbers,
    ..SIZE
};
/// Along a rectangle's height; zero for [`LightSource::up`](super::LightSource::up)'s choice.
const UP: Field =
    Field { name: "up", row: "Up", at: 14, width: 3, absent: Absent::Vector([0.0; 3]), ..NUMBER };
const WIDTH: Field =
    Field { name: "width", row: "Width", at: 7, fresh: Some(&[1.0]), range: Range::Positive, ..NUMBER };
const HEIGHT: Field = Field { name: "height", row: "Height", at: 8, ..WIDTH };
/// A factor of light that something else gives.
const FACTOR: Field = Field { row: "Factor", absent: Absent::Number(1.0), ..INTENSITY };
const FILE: Field = Field { name: "file", row: "File", ..TEXT };
/// Of an environment, about the y axis.
pub const ROTATION: Field =
    Field { name: "rotation_deg", row: "Rotation, degrees", at: 7, absent: Absent::Number(0.0), ..NUMBER };
const GROUP: Field = Field {
    name: "group",
    row: "Group",
    at: 7,
    absent: Absent::Number(0.0),
    largest: 65536.0,
    stored: Stored::Whole,
    ..NUMBER
};

kinds! {
    /// Shines all around.
    Point "point" called "Lamp" listed "point" in ["candela", "lumen"] {
        /// World space.
        position: [f64; 3] = POSITION,
        /// Candela.
        intensity: f64 = INTENSITY,
        /// Linear RGB; white when absent.
        #[serde(default = "white")]
        color: [f64; 3] = COLOR,
        /// Radius of the sphere that shines, scene units; 0, a point, when absent.
        #[serde(default, skip_serializing_if = "is_zero")]
        radius: f64 = SIZE,
    }
    /// Shines within a cone.
    Spot "spot" called "Spot" listed "spot" in ["candela", "lumen"] {
        /// World space.
        position: [f64; 3] = POSITION,
        /// The cone's axis, the way the light travels; any length.
        direction: [f64; 3] = DIRECTION,
        /// Half angle of the cone, degrees.
        outer_cone_deg: f64 = OUTER_CONE,
        /// Half angle within which the light is full, degrees; a hard edge when absent.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        inner_cone_deg: Option<f64> = INNER_CONE,
        /// Candela.
        intensity: f64 = INTENSITY,
        /// Linear RGB; white when absent.
        #[serde(default = "white")]
        color: [f64; 3] = COLOR,
        /// Radius of the sphere that shines, scene units; 0, a point, when absent.
        #[serde(default, skip_serializing_if = "is_zero")]
        radius: f64 = SIZE,
    }
    /// Shines from infinitely far.
    Directional "directional" called "Sun" listed "sun" in ["lux"] {
        /// The way the light travels; any length.
        direction: [f64; 3] = DIRECTION,
        /// Lux on a surface that faces the light.
        intensity: f64 = INTENSITY,
        /// Linear RGB; white when absent.
        #[serde(default = "white")]
        color: [f64; 3] = COLOR,
        /// Angular radius of the disc, degrees (the sun 0.27); 0, a point, when absent.
        #[serde(default, skip_serializing_if = "is_zero")]
        radius_deg: f64 = ANGULAR_SIZE,
    }
    /// Shines from the front of a rectangle, equally bright from everywhere.
    Rectangle "rectangle" called "Rectangle" listed "rectangle" in ["nit"] {
        /// The middle, world space.
        position: [f64; 3] = POSITION,
        /// The normal, the way the light travels; any length.
        direction: [f64; 3] = DIRECTION,
        /// Along the height, any length; y, or x where the direction is nearly vertical, when absent or zero.
        #[serde(default, skip_serializing_if = "is_zero_vector")]
        up: [f64; 3] = UP,
        /// Scene units.
        width: f64 = WIDTH,
        /// Scene units.
        height: f64 = HEIGHT,
        /// Radiance, nits.
        intensity: f64 = INTENSITY,
        /// Linear RGB; white when absent.
        #[serde(default = "white")]
        color: [f64; 3] = COLOR,
    }
    /// Shines from the front of a disk, equally bright from everywhere.
    Disk "disk" called "Disk" listed "disk" in ["nit"] {
        /// The middle, world space.
        position: [f64; 3] = POSITION,
        /// The normal, the way the light travels; any length.
        direction: [f64; 3] = DIRECTION,
        /// Scene units.
        radius: f64 = RADIUS,
        /// Radiance, nits.
        intensity: f64 = INTENSITY,
        /// Linear RGB; white when absent.
        #[serde(default = "white")]
        color: [f64; 3] = COLOR,
    }
    /// Shines from a sphere, equally bright from everywhere.
    Sphere "sphere" called "Sphere" listed "sphere" in ["nit"] {
        /// The middle, world space.
        position: [f64; 3] = POSITION,
        /// Scene units.
        radius: f64 = RADIUS,
        /// Radiance, nits.
        intensity: f64 = INTENSITY,
        /// Linear RGB; white when absent.
        #[serde(default = "white")]
        color: [f64; 3] = COLOR,
    }
    /// Shines from all directions, infinitely far: as a picture says, or equally.
    Environment "environment" called "Environment" listed "environment" in ["factor"] {
        /// Picture of the directions, relative to the file that names it; equal in all directions when absent.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        file: Option<String> = FILE,
        /// Turn about the y axis, counterclockwise seen from above, degrees; 0 when absent.
        #[serde(default, skip_serializing_if = "is_zero")]
        rotation_deg: f64 = ROTATION,
        /// Factor of the picture's radiance, or the radiance, nits; 1 when absent.
        #[serde(default = "one")]
        intensity: f64 = FACTOR,
        /// Linear RGB; white when absent.
        #[serde(default = "white")]
        color: [f64; 3] = COLOR,
    }
    /// Shines as a group of the scene's surfaces does.
    Emissive "emissive" called "Surfaces" listed "surfaces" in ["factor"] {
        /// Number of the group; 0 when absent.
        #[serde(default, skip_serializing_if = "is_first")]
        group: u32 = GROUP,
        /// Factor of the surfaces' emission; 1 when absent.
        #[serde(default = "one")]
        intensity: f64 = FACTOR,
        /// Linear RGB; white when absent.
        #[serde(default = "white")]
        color: [f64; 3] = COLOR,
    }
}

impl LightKind {
    /// Returns whether lights of the kind are those of KHR_lights_punctual.
    pub fn is_punctual(self) -> bool {
        matches!(self, Self::Point | Self::Spot | Self::Directional)
    }

    /// Returns whether lights of the kind are evaluated as lamps: not by links of a file.
    pub fn is_lamp(self) -> bool {
        !matches!(self, Self::Environment | Self::Emissive)
    }

    /// Returns whether lights of the kind have a surface of their own, which is seen and blocks light.
    pub fn is_area(self) -> bool {
        matches!(self, Self::Rectangle | Self::Disk | Self::Sphere)
    }
}

fn white() -> [f64; 3] {
    [1.0; 3]
}

fn one() -> f64 {
    1.0
}

fn is_zero(size: &f64) -> bool {
    *size == 0.0
}

fn is_zero_vector(vector: &[f64; 3]) -> bool {
    *vector == [0.0; 3]
}

fn is_first(group: &u32) -> bool {
    *group == 0
}
