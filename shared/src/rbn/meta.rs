//! The metadata of a .rbn file: section `META`, bincode 2 standard configuration, at most [`MAX_BYTES`].

use super::extras::Extras;
pub use super::limits::MAX_BYTES;
use super::shown::Shown;
#[cfg(feature = "radiosity")]
use super::specular::SpecularExtras;
pub use super::texture::DetailTexture;
use super::{RbnError, small};
use crate::{camera::Camera, light::Light};
use bincode::{Decode, Encode};

/// Metadata of a file: contents outside the bulk sections.
#[derive(Clone, Debug, Default, PartialEq, Encode, Decode)]
pub struct Meta {
    /// Program and version that baked the file.
    pub generator: String,
    /// The scene's name.
    pub scene_name: String,
    /// World space = local space + origin. All bulk positions are local.
    pub origin: [f64; 3],
    /// Least corner of the render geometry, local space.
    pub bounds_min: [f32; 3],
    /// Greatest corner.
    pub bounds_max: [f32; 3],
    /// Levels of points, coarsest first; levels are contiguous.
    pub levels: Vec<Level>,
    /// Number of sender levels, from the coarsest; their points are the senders.
    pub sender_levels: u32,
    /// Number of levels with later bounces, at most `sender_levels`.
    pub later_levels: u32,
    /// Number of levels with direct light samples, at least `sender_levels`.
    pub direct_levels: u32,
    /// Materials, by index.
    pub materials: Vec<Material>,
    /// Textures, by index.
    pub textures: Vec<Texture>,
    /// Draw calls, opaque ones first.
    pub draws: Vec<Draw>,
    /// The scene's own lights, world space.
    pub lights: Vec<Light>,
    /// The scene's own cameras, world space; the viewer starts with the first. Never empty.
    pub cameras: Vec<Camera>,
    /// Animations of the scene's own lights.
    pub animations: Vec<Animation>,
    /// Settings and cost of the bake.
    pub bake: BakeInfo,
    /// Names of lights and cameras, and the ground; not in section `META`.
    pub shown: Shown,
}

impl Meta {
    /// Returns true if a material has a normal map.
    pub fn is_bumpy(&self) -> bool {
        self.materials.iter().any(|m| m.normal_texture.is_some())
    }
}

/// Level of points.
#[derive(Clone, Debug, Default, PartialEq, Encode, Decode)]
pub struct Level {
    /// Index of its first point.
    pub first: u32,
    /// Number of its points.
    pub count: u32,
    /// Poisson-disk radius `R`, scene units.
    pub disk_radius: f32,
    /// Support radius `C·R`, scene units.
    pub support_radius: f32,
}

/// glTF's alphaMode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Encode, Decode)]
pub enum Alpha {
    /// Alpha is ignored.
    #[default]
    Opaque,
    /// Cut out below the alpha cutoff.
    Mask {
        /// 0 to 1.
        cutoff: f32,
    },
    /// Transmits the share 1 − alpha of the light.
    Blend,
}

/// Surface material. Light transport treats the surface as Lambertian with its base colour, metals too; pictures add
/// detail: normal maps and specular highlights of direct lights (glTF 2.0, appendix B).
#[derive(Clone, Debug, PartialEq, Encode, Decode)]
pub struct Material {
    /// Its glTF name, or empty.
    pub name: String,
    /// Linear RGB albedo and alpha, factor of the texture.
    pub base_color: [f32; 4],
    /// Index of the sRGB base-colour texture.
    pub base_color_texture: Option<u32>,
    /// Alpha mode.
    pub alpha: Alpha,
    /// True if the back reflects. Otherwise the back blocks light and reflects nothing.
    pub double_sided: bool,
    /// Emitted linear RGB radiance, factor of the texture; a [source](super::sources) of the scene.
    pub emission: [f32; 3],
    /// sRGB texture of the emission.
    pub emission_texture: Option<DetailTexture>,
    /// Metalness, 0 to 1, factor of the texture's blue.
    pub metallic: f32,
    /// Roughness, 0 to 1, factor of the texture's green.
    pub roughness: f32,
    /// Roughness and metalness.
    pub metallic_roughness_texture: Option<DetailTexture>,
    /// Specular strength of non-metal, 0 to 1; 0 for a surface that is Lambertian in pictures too.
    pub specular: f32,
    /// Normals in tangent space.
    pub normal_texture: Option<DetailTexture>,
    /// Factor of the normal texture's x and y.
    pub normal_scale: f32,
    /// Optional properties; not in section `META`.
    pub extras: Extras,
    /// How the surface shines besides; not in section `META`.
    #[cfg(feature = "radiosity")]
    pub specular_extras: SpecularExtras,
}

impl Default for Material {
    /// Black, opaque, one-sided, matt.
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: [0.0; 4],
            base_color_texture: None,
            alpha: Alpha::Opaque,
            double_sided: false,
            emission: [0.0; 3],
            emission_texture: None,
            metallic: 0.0,
            roughness: 1.0,
            metallic_roughness_texture: None,
            specular: 0.0,
            normal_texture: None,
            normal_scale: 1.0,
            extras: Extras::default(),
            #[cfg(feature = "radiosity")]
            specular_extras: SpecularExtras::default(),
        }
    }
}

impl Material {
    /// Returns true if the material transmits light independent of alpha.
    pub fn is_glass(&self) -> bool {
        let e = &self.extras;
        let is_metal = self.metallic >= 1.0 && self.metallic_roughness_texture.is_none();
        (e.transmission > 0.0 || e.scattered > 0.0) && !is_metal
    }

    /// Returns the detail textures: emission, roughness and metalness, normals, transmission.
    pub fn details(&self) -> [Option<&DetailTexture>; 4] {
        let (shine, through) = (&self.metallic_roughness_texture, &self.extras.transmission_texture);
        [&self.emission_texture, shine, &self.normal_texture, through].map(Option::as_ref)
    }
}

/// Keyframes of lights.
#[derive(Clone, Debug, Default, PartialEq, Encode, Decode)]
pub struct Animation {
    /// Its glTF name, or empty.
    pub name: String,
    /// Seconds.
    pub duration: f32,
    /// Animated properties.
    pub tracks: Vec<Track>,
}

/// Keyframes of a property of a light.
#[derive(Clone, Debug, PartialEq, Encode, Decode)]
pub struct Track {
    /// Index of the light.
    pub light: u32,
    /// Animated property.
    pub property: Property,
    /// Interpolation between keys.
    pub interpolation: Interpolation,
    /// Key times, seconds, strictly ascending; at least one key.
    pub times: Vec<f32>,
    /// [`Property::width`] numbers per key, in the units of [`Light`].
    pub values: Vec<f32>,
}

/// Animated property of a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Encode, Decode)]
pub enum Property {
    /// World space.
    Position,
    /// Direction of travel of the light, world space.
    Direction,
    /// Candela or lux.
    Intensity,
    /// Linear RGB.
    Color,
}

impl Property {
    /// Returns true if values may be negative.
    pub fn is_signed(self) -> bool {
        matches!(self, Self::Position | Self::Direction)
    }

    /// Returns the name shown in the page.
    pub fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Direction => "direction",
            Self::Intensity => "intensity",
            Self::Color => "color",
        }
    }

    /// Number of components of a value.
    pub fn width(self) -> usize {
        if self == Self::Intensity { 1 } else { 3 }
    }
}

/// Interpolation between keys.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Encode, Decode)]
pub enum Interpolation {
    /// A straight line.
    #[default]
    Linear,
    /// The previous key.
    Step,
}

impl Interpolation {
    /// Returns the name shown in the page.
    pub fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Step => "step",
        }
    }
}

/// Wrap mode of texture coordinates outside [0, 1].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Encode, Decode)]
pub enum Wrap {
    /// Tiles.
    #[default]
    Repeat,
    /// Tiles, alternately mirrored.
    MirroredRepeat,
    /// Keeps the border's colour.
    ClampToEdge,
}

/// Compressed picture in section `TEXD`.
#[derive(Clone, Debug, Default, PartialEq, Encode, Decode)]
pub struct Texture {
    /// Its glTF name, or empty.
    pub name: String,
    /// `image/png`, `image/jpeg` or `image/webp`.
    pub mime: String,
    /// Offset in section `TEXD`, bytes.
    pub offset: u64,
    /// Length, bytes.
    pub len: u64,
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// Horizontal wrap.
    pub wrap_u: Wrap,
    /// Vertical wrap.
    pub wrap_v: Wrap,
    /// False where glTF asks for nearest filtering.
    pub linear_filter: bool,
    /// True for linear data (roughness, normals), false for sRGB colours.
    pub data: bool,
}

/// A run of triangles with one material.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Encode, Decode)]
pub struct Draw {
    /// Index of the material.
    pub material: u32,
    /// First entry in section `INDX`.
    pub first_index: u32,
    /// Number of entries, a multiple of three.
    pub index_count: u32,
}

/// Settings and cost of a bake (the columns of paper, Table 1).
#[derive(Clone, Debug, Default, PartialEq, Encode, Decode)]
pub struct BakeInfo {
    /// Name of the preset.
    pub preset: String,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Link threshold ε: irradiance per unit irradiance.
    pub epsilon: f32,
    /// Number of bounces in the operator; for an unlimited operator, the number of bounces until convergence.
    pub bounces: u32,
    /// Rays cast for the operator.
    pub rays: u64,
    /// Senders times receivers.
    pub potential_links: u64,
}

/// Encodes the metadata.
///
/// # Errors
/// [`RbnError::TooLarge`] past [`MAX_BYTES`].
pub fn encode(meta: &Meta) -> Result<Vec<u8>, RbnError> {
    small::encode(meta, || {
        format!("the scene's material and texture lists need over {MAX_BYTES} bytes: merge materials")
    })
}

/// Decodes the metadata.
///
/// # Errors
/// [`RbnError::Invalid`] for malformed or left-over bytes.
pub fn decode(bytes: &[u8]) -> Result<Meta, RbnError> {
    small::decode("META", bytes)
}
