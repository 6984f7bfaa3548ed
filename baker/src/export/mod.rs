//! The light of a baked scene as textures or vertex colours of a .glb file, for engines without a relighting viewer.
//!
//! * [`meshes`](mod@meshes) – the scene's triangles as meshes: static ones, models with their copies, fronts and backs apart;
//! * [`unwrap`](mod@unwrap) – coordinates of a texture in which every triangle has texels of its own;
//! * [`from_lightmap`](mod@from_lightmap) – the same from the file's own lightmap;
//! * [`rasterize`](mod@rasterize) – which triangles a texel shows;
//! * [`point`] – light at a place of a surface, as [`render`](mod@crate::verify::render) has it;
//! * [`texels`], [`dilate`] – the texels' light, and what filtering needs around it;
//! * [`vertices`] – light by vertex;
//! * [`develop`] – radiance to what a screen shows; [`materials`], [`document`], [`glb`] – the file.

pub mod develop;
pub mod dilate;
mod document;
pub mod from_lightmap;
mod glb;
mod materials;
pub mod meshes;
pub mod point;
pub mod rasterize;
pub mod texels;
pub mod unwrap;
pub mod vertices;

use crate::geometry::Surfaces;
use crate::geometry::mesh::TriangleSurfaces;
use crate::io::picture::{Only, Picture};
use crate::verify::render::Relit;
use develop::Developed;
use document::ExportDocument;
use from_lightmap::from_lightmap;
use meshes::{ExportMesh, meshes};
use point::{Lit, Shading};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::camera::Camera;
use texels::LightTexture;
use unwrap::{Density, UnwrapError, unwrap};

/// Empty texels around each chart, so that bilinear filtering finds the chart's own light there.
pub const PADDING: u32 = 2;

/// Form of the light in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Form {
    /// Base colour times light in one texture of unlit materials.
    #[default]
    Unlit,
    /// The materials as they are, and the irradiance in a picture beside, for engines' own lightmaps.
    LightmapTexture,
    /// Light by vertex, in unlit materials.
    VertexColours,
}

/// Settings of an export.
#[derive(Clone, Copy, Debug)]
pub struct ExportSettings {
    /// Form of the light.
    pub form: Form,
    /// Texels along a scene unit.
    pub density: Density,
    /// Greatest width and height of the texture, texels.
    pub max_size: u32,
    /// Whether the scene is unwrapped even if the file has a lightmap.
    pub is_unwrapped: bool,
    /// Samples of a texel or, at the least, of a triangle.
    pub samples: u32,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Components of light.
    pub only: Only,
    /// Factor of radiance before tone mapping; unused by [`Form::LightmapTexture`].
    pub exposure: f32,
}

/// A file, and a picture beside it.
#[derive(Clone, Debug)]
pub struct Export {
    /// The bytes of the .glb file.
    pub glb: Vec<u8>,
    /// Irradiance, linear RGB, of [`Form::LightmapTexture`]; the first row is at v = 0.
    pub lightmap: Option<Picture>,
    /// The texture, without light by vertex.
    pub atlas: Option<AtlasFigures>,
    /// Triangles in the file, each copy counted.
    pub triangles: u64,
}

/// Figures of a texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtlasFigures {
    /// Width and height, texels.
    pub size: [u32; 2],
    /// Texels along a scene unit.
    pub texels_per_unit: f32,
    /// Texels along a scene unit that were wanted, if they did not fit.
    pub wanted: Option<f32>,
    /// Number of charts.
    pub charts: u32,
    /// Share of the texels that show a surface, 0 to 1.
    pub used: f32,
    /// Whether the charts are those of the file's lightmap.
    pub is_own: bool,
}

/// Why a scene could not be exported.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// No coordinates for the texture.
    #[error(transparent)]
    Unwrap(#[from] UnwrapError),
    /// The file has more bytes than a .glb file can say.
    #[error("the .glb file would have {0} bytes, and 4 GiB are the most: bake fewer triangles or textures")]
    TooLarge(u64),
    /// A picture could not be encoded.
    #[error("the texture cannot be encoded: {0}; give a lower --max-size")]
    Picture(String),
}

/// Exports a baked scene under the light of `relit`, which must have been made with `surfaces` and area lights among them,
/// `with_lights`. `camera` becomes the file's camera. `done` is called after each part of the work, with the number of
/// parts, from any thread.
///
/// # Errors
/// [`ExportError`].
pub fn export(
    scene: &BakedScene,
    (surfaces, with_lights): (&TriangleSurfaces, &impl Surfaces),
    relit: &Relit,
    camera: Option<&Camera>,
    settings: &ExportSettings,
    done: impl Fn(u32) + Sync,
) -> Result<Export, ExportError> {
    let meshes = meshes(scene);
    let shading = match settings.form {
        Form::LightmapTexture => Shading::Irradiance,
        Form::Unlit => Shading::Radiance,
        Form::VertexColours => Shading::MeanRadiance,
    };
    let lit = Lit { surfaces, with_lights, relit, only: settings.only, shading };
    let mut document = ExportDocument::new(scene, settings, camera);
    let triangles = meshes.iter().map(ExportMesh::triangles_placed).sum();
    if settings.form == Form::VertexColours {
        let colours = vertices::light(&meshes, &lit, settings.samples, settings.seed, done);
        let developed = Developed { exposure: settings.exposure };
        document.add_coloured(&meshes, &colours, surfaces, developed);
        return Ok(Export { glb: document.finish()?, lightmap: None, atlas: None, triangles });
    }
    let is_used = |material: u32| !surfaces.material(material).is_unlit;
    let own = match settings.is_unwrapped {
        true => None,
        false => from_lightmap(scene, &meshes, settings.density, settings.max_size, is_used),
    };
    let is_own = own.is_some();
    let atlas = match own {
        Some(atlas) => atlas,
        None => unwrap(&meshes, settings.density, settings.max_size, is_used)?,
    };
    let coverage = rasterize::rasterize(&meshes, &atlas);
    let mut texture = LightTexture::new(&meshes, &coverage, &lit, atlas.texels_per_unit, settings, done);
    dilate::fill_charts(&mut texture);
    dilate::dilate(&mut texture, PADDING);
    dilate::fill_background(&mut texture);
    let figures = AtlasFigures {
        size: [atlas.width, atlas.height],
        texels_per_unit: atlas.texels_per_unit,
        wanted: atlas.wanted,
        charts: atlas.chart_count,
        used: atlas.used,
        is_own,
    };
    let lightmap = match settings.form {
        Form::LightmapTexture => Some(texture.picture()),
        _ => {
            let developed = Developed { exposure: settings.exposure };
            document.set_atlas(&developed.png(&texture).map_err(ExportError::Picture)?);
            None
        }
    };
    let materials = 0..scene.meta.materials.len() as u32;
    let emission: Vec<[f32; 3]> = materials.map(|m| relit.emission_strength(m).to_array()).collect();
    document.add_unwrapped(&meshes, &atlas, &emission);
    Ok(Export { glb: document.finish()?, lightmap, atlas: Some(figures), triangles })
}
