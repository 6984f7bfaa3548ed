//! The small metadata of a .rbn file: section `META`, bincode 2 standard configuration.
//!
//! bincode is used here and in [`extras`](super::extras) alone, and never for more than [`MAX_BYTES`].

use super::RbnError;
use super::extras::Extras;
pub use super::limits::MAX_BYTES;
use super::shown::Shown;
pub use super::texture::DetailTexture;
use crate::{camera::Camera, light::Light};
use bincode::{Decode, Encode};

/// What a file holds besides the bulk sections.
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
    /// Levels of points, coarsest first; level `l` ends where level `l + 1` begins.
    pub levels: Vec<Level>,
    /// Senders are the points of this many levels, the coarsest ones.
    pub sender_levels: u32,
    /// Light that bounces again is gathered by the points of this many levels, at most `sender_levels`.
    pub later_levels: u32,
    /// Direct light is sampled at the points of this many levels, at least `sender_levels`.
    pub direct_levels: u32,
    /// Materials, by index.
    pub materials: Vec<Material>,
    /// Textures, by index.
    pub textures: Vec<Texture>,
    /// Draw calls, opaque ones first.
    pub draws: Vec<Draw>,
    /// The scene's own lights, world space.
    pub lights: Vec<Light>,
    /// The scene's own cameras, world space; the first is the one to start with. Never empty.
    pub cameras: Vec<Camera>,
    /// How the scene's own lights move.
    pub animations: Vec<Animation>,
    /// How the bake was made and what it cost.
    pub bake: BakeInfo,
    /// Names of lights and cameras, and the ground; not in section `META`.
    pub shown: Shown,
}

impl Meta {
    /// Whether any material bends normals.
    pub fn is_bumpy(&self) -> bool {
        self.materials.iter().any(|m| m.normal_texture.is_some())
    }
}

/// One level of points.
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
    /// Cut where alpha is under the cutoff.
    Mask {
        /// 0 to 1.
        cutoff: f32,
    },
    /// Lets the share 1 − alpha of the light through.
    Blend,
}

/// A surface. Light transport takes it as Lambertian in its base colour, metals too; pictures add detail: normal
/// maps and the direct lights' highlights (glTF 2.0, appendix B).
#[derive(Clone, Debug, PartialEq, Encode, Decode)]
pub struct Material {
    /// Its glTF name, or empty.
    pub name: String,
    /// Linear RGB albedo and alpha, multiplied with the texture's.
    pub base_color: [f32; 4],
    /// Index of the sRGB base-colour texture.
    pub base_color_texture: Option<u32>,
    /// How alpha is meant.
    pub alpha: Alpha,
    /// Whether the back reflects too. If not, the back blocks light and reflects nothing.
    pub double_sided: bool,
    /// Linear RGB radiance that the surface sends out by itself, multiplied with the texture's; shown, not part of
    /// the transport.
    pub emission: [f32; 3],
    /// sRGB texture of the emission.
    pub emission_texture: Option<DetailTexture>,
    /// 0 to 1, multiplied with the texture's blue.
    pub metallic: f32,
    /// 0 to 1, multiplied with the texture's green.
    pub roughness: f32,
    /// Roughness and metalness.
    pub metallic_roughness_texture: Option<DetailTexture>,
    /// Strength of the highlights of what is not metal, 0 to 1; 0 for a surface that is Lambertian in pictures too.
    pub specular: f32,
    /// Normals in tangent space.
    pub normal_texture: Option<DetailTexture>,
    /// What the normal texture's x and y are multiplied with.
    pub normal_scale: f32,
    /// What few materials have; not in section `META`.
    pub extras: Extras,
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
        }
    }
}

impl Material {
    /// Whether any light goes through because of what the material is, not of alpha.
    pub fn is_glass(&self) -> bool {
        let e = &self.extras;
        let is_metal = self.metallic >= 1.0 && self.metallic_roughness_texture.is_none();
        (e.transmission > 0.0 || e.scattered > 0.0) && !is_metal
    }

    /// Textures of detail that it has: emission, roughness and metalness, normals, transmission.
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
    /// What changes.
    pub tracks: Vec<Track>,
}

/// One property of one light over time.
#[derive(Clone, Debug, PartialEq, Encode, Decode)]
pub struct Track {
    /// Index of the light.
    pub light: u32,
    /// What of it changes.
    pub property: Property,
    /// What is between two keys.
    pub interpolation: Interpolation,
    /// Seconds, each greater than the one before; at least one.
    pub times: Vec<f32>,
    /// [`Property::width`] numbers a time, in the units of [`Light`].
    pub values: Vec<f32>,
}

/// What of a light may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Encode, Decode)]
pub enum Property {
    /// World space.
    Position,
    /// The way the light travels, world space.
    Direction,
    /// Candela or lux.
    Intensity,
    /// Linear RGB.
    Color,
}

impl Property {
    /// Whether its numbers may be negative.
    pub fn is_signed(self) -> bool {
        matches!(self, Self::Position | Self::Direction)
    }

    /// Its name in the page.
    pub fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Direction => "direction",
            Self::Intensity => "intensity",
            Self::Color => "color",
        }
    }

    /// Numbers of one value.
    pub fn width(self) -> usize {
        if self == Self::Intensity { 1 } else { 3 }
    }
}

/// What is between two keys.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Encode, Decode)]
pub enum Interpolation {
    /// A straight line.
    #[default]
    Linear,
    /// The key before.
    Step,
}

impl Interpolation {
    /// Its name in the page.
    pub fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Step => "step",
        }
    }
}

/// How a texture coordinate outside [0, 1] is meant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Encode, Decode)]
pub enum Wrap {
    /// Tiles.
    #[default]
    Repeat,
    /// Tiles, every other one mirrored.
    MirroredRepeat,
    /// Keeps the border's colour.
    ClampToEdge,
}

/// A compressed picture in section `TEXD`.
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
    /// True for numbers (roughness, normals), false for sRGB colours.
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

/// How a bake was made and what it cost (the columns of paper, Table 1).
#[derive(Clone, Debug, Default, PartialEq, Encode, Decode)]
pub struct BakeInfo {
    /// Name of the preset.
    pub preset: String,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Link threshold ε: irradiance per unit irradiance.
    pub epsilon: f32,
    /// Bounces of light that the operator holds; where it holds all, those that were followed until the light settled.
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
    let too_large = || {
        RbnError::TooLarge(format!(
            "the scene's material and texture lists need over {MAX_BYTES} bytes: merge materials"
        ))
    };
    let bytes = bincode::encode_to_vec(meta, bincode::config::standard()).map_err(|_| too_large())?;
    if bytes.len() > MAX_BYTES { Err(too_large()) } else { Ok(bytes) }
}

/// Decodes the metadata; all bytes must be used.
///
/// # Errors
/// [`RbnError::Invalid`].
pub fn decode(bytes: &[u8]) -> Result<Meta, RbnError> {
    let config = bincode::config::standard().with_limit::<MAX_BYTES>();
    match bincode::decode_from_slice::<Meta, _>(bytes, config) {
        Ok((meta, used)) if used == bytes.len() => Ok(meta),
        Ok((_, used)) => {
            Err(RbnError::invalid("META", format!("{} bytes are left over", bytes.len() - used)))
        }
        Err(error) => Err(RbnError::invalid("META", error.to_string())),
    }
}
