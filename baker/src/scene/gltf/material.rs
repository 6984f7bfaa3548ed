//! Materials and base-colour textures. Only what the triangles use is kept and decoded.

use super::schema;
use super::source::Source;
use crate::scene::{SceneError, Texture};
use rayon::prelude::*;
use rebounce_shared::rbn::meta::{self, Alpha, Material, Wrap};

/// How a material reads its texture coordinates.
#[derive(Clone, Copy)]
pub(super) struct UvSource {
    /// Number of the TEXCOORD attribute.
    pub set: usize,
    /// `uv' = matrix · uv + offset`, row by row: the matrix, then the offset.
    pub matrix: [[f64; 2]; 2],
    pub offset: [f64; 2],
}

/// Collects the materials in the order of their first use.
pub(super) struct Materials<'a> {
    source: &'a Source,
    /// glTF materials in our order; `None` is glTF's default material.
    used: Vec<Option<usize>>,
    /// glTF textures in our order.
    textures: Vec<usize>,
    out: Vec<Material>,
    uv: Vec<Option<UvSource>>,
}

impl<'a> Materials<'a> {
    pub fn new(source: &'a Source) -> Self {
        Self { source, used: Vec::new(), textures: Vec::new(), out: Vec::new(), uv: Vec::new() }
    }

    /// Our index for a glTF material, and where its texture coordinates come from.
    pub fn index(&mut self, material: Option<usize>) -> Result<(u32, Option<UvSource>), SceneError> {
        if let Some(i) = self.used.iter().position(|m| *m == material) {
            return Ok((i as u32, self.uv[i]));
        }
        let source = self.source;
        let (converted, uv) = match material {
            None => (Material { base_color: [1.0; 4], ..Material::default() }, None),
            Some(i) => {
                let known = source.root.materials.get(i);
                let m = known.ok_or_else(|| source.malformed(format!("there is no material {i}")))?;
                self.convert(i, m)?
            }
        };
        self.used.push(material);
        self.out.push(converted);
        self.uv.push(uv);
        Ok((self.out.len() as u32 - 1, uv))
    }

    fn convert(
        &mut self,
        index: usize,
        m: &schema::Material,
    ) -> Result<(Material, Option<UvSource>), SceneError> {
        let pbr = &m.pbr_metallic_roughness;
        let base_color = pbr.base_color_factor.unwrap_or([1.0; 4]);
        let strength = m.extensions.emissive.as_ref().and_then(|e| e.emissive_strength).unwrap_or(1.0);
        let emission = m.emissive_factor.map(|e| e * strength);
        if !base_color.iter().chain(&emission).all(|x| x.is_finite()) {
            let problem = format!("material {index} ({:?}) has a colour that is not finite", m.name);
            return Err(self.source.malformed(problem));
        }
        let (mut base_color_texture, mut uv) = (None, None);
        if let Some(info) = &pbr.base_color_texture {
            let at = self.textures.iter().position(|&t| t == info.index).unwrap_or_else(|| {
                self.textures.push(info.index);
                self.textures.len() - 1
            });
            base_color_texture = Some(at as u32);
            uv = Some(uv_source(info));
        }
        let alpha = match m.alpha_mode.as_deref().unwrap_or("OPAQUE") {
            "MASK" => Alpha::Mask { cutoff: m.alpha_cutoff.unwrap_or(0.5) },
            "BLEND" => Alpha::Blend,
            _ => Alpha::Opaque,
        };
        let material = Material {
            name: m.name.clone(),
            // An albedo over 1 would make energy out of nothing.
            base_color: base_color.map(|c| c.clamp(0.0, 1.0)),
            base_color_texture,
            alpha,
            double_sided: m.double_sided,
            emission,
        };
        Ok((material, uv))
    }

    /// The materials, and their textures decoded; textures with one image share it.
    pub fn finish(self) -> Result<(Vec<Material>, Vec<Texture>), SceneError> {
        let source = self.source;
        let mut images: Vec<usize> = Vec::new();
        let mut of_image = Vec::new();
        for &t in &self.textures {
            let image = image_index(source, t)?;
            let at = images.iter().position(|&i| i == image).unwrap_or_else(|| {
                images.push(image);
                images.len() - 1
            });
            of_image.push(at);
        }
        let pictures: Vec<Texture> =
            images.par_iter().map(|&i| picture(source, i)).collect::<Result<_, SceneError>>()?;
        let textures =
            self.textures.iter().zip(of_image).map(|(&t, at)| sampled(source, t, &pictures[at])).collect();
        Ok((self.out, textures))
    }
}

/// The texture coordinates of KHR_texture_transform: scale, then rotate counter-clockwise as the
/// picture is seen (v points down), then offset.
fn uv_source(info: &schema::TextureInfo) -> UvSource {
    let Some(t) = &info.extensions.transform else {
        return UvSource { set: info.tex_coord, matrix: [[1.0, 0.0], [0.0, 1.0]], offset: [0.0; 2] };
    };
    let (sin, cos) = (t.rotation as f64).sin_cos();
    let [sx, sy] = t.scale.unwrap_or([1.0; 2]).map(f64::from);
    UvSource {
        set: t.tex_coord.unwrap_or(info.tex_coord),
        matrix: [[cos * sx, sin * sy], [-sin * sx, cos * sy]],
        offset: t.offset.map(f64::from),
    }
}

/// The image of a texture.
fn image_index(source: &Source, texture: usize) -> Result<usize, SceneError> {
    let known = source.root.textures.get(texture);
    let known = known.ok_or_else(|| source.malformed(format!("there is no texture {texture}")))?;
    let problem = "it has no PNG or JPEG picture (perhaps WebP or KTX only): export the scene with PNG or JPEG textures";
    known.source.ok_or_else(|| SceneError::Texture {
        file: source.file.clone(),
        texture: texture.to_string(),
        problem: problem.to_owned(),
    })
}

/// An image, decoded.
fn picture(source: &Source, index: usize) -> Result<Texture, SceneError> {
    let image = source.root.images.get(index);
    let image = image.ok_or_else(|| source.malformed(format!("there is no image {index}")))?;
    let bytes = match (&image.uri, image.buffer_view) {
        (Some(uri), _) => source.uri(uri)?,
        (None, Some(view)) => source.view(view)?.1.to_vec(),
        (None, None) => return Err(source.malformed(format!("image {index} has no data"))),
    };
    let file_name = image.uri.as_deref().filter(|uri| !uri.starts_with("data:")).unwrap_or("");
    let name = [&image.name, file_name].into_iter().find(|n| !n.is_empty());
    let name = name.map_or_else(|| index.to_string(), str::to_owned);
    Texture::new(&source.file, meta::Texture { name, ..meta::Texture::default() }, bytes)
}

/// A texture: its picture with its sampler. The index has been checked.
fn sampled(source: &Source, index: usize, picture: &Texture) -> Texture {
    let texture = &source.root.textures[index];
    let sampler = texture.sampler.and_then(|s| source.root.samplers.get(s));
    let wrap = |code: Option<u32>| match code {
        Some(33071) => Wrap::ClampToEdge,
        Some(33648) => Wrap::MirroredRepeat,
        _ => Wrap::Repeat,
    };
    let mut out = picture.clone();
    if !texture.name.is_empty() {
        out.meta.name = texture.name.clone();
    }
    out.meta.wrap_u = wrap(sampler.and_then(|s| s.wrap_s));
    out.meta.wrap_v = wrap(sampler.and_then(|s| s.wrap_t));
    out.meta.linear_filter = sampler.and_then(|s| s.mag_filter) != Some(9728);
    out
}
