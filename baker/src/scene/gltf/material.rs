//! Materials and their textures. Only what the triangles use is kept and decoded.

use super::picture::{check_sizes, image_index, picture, sampled};
use super::schema;
use super::source::Source;
use super::transmission::Numbers;
use crate::scene::{Scene, SceneError};
use crate::triangles::glass::textures as textures_of_light;
use glam::{DMat3, DVec3};
use rayon::prelude::*;
use rebounce_shared::rbn;
use rebounce_shared::rbn::extras::Extras;
use rebounce_shared::rbn::meta::{Alpha, DetailTexture, Material};
use std::collections::{HashMap, HashSet};

/// How a material reads its texture coordinates.
#[derive(Clone, Copy)]
pub(super) struct UvSource {
    /// Number of the TEXCOORD attribute.
    pub set: usize,
    /// From (u, v, 1) of the attribute.
    pub matrix: DMat3,
}

/// Collects the materials in the order of their first use.
pub(super) struct Materials<'a> {
    source: &'a Source,
    /// Our indices of glTF materials; `None` is glTF's default material.
    used: HashMap<Option<usize>, u32>,
    /// glTF textures in our order, and whether they hold numbers instead of colours.
    textures: Vec<(usize, bool)>,
    out: Vec<Material>,
    uv: Vec<Option<UvSource>>,
    /// What of the file is not taken over.
    left_out: Vec<String>,
}

impl<'a> Materials<'a> {
    pub fn new(source: &'a Source) -> Self {
        let (used, textures, out, uv, left_out) = Default::default();
        Self { source, used, textures, out, uv, left_out }
    }

    /// Our index for a glTF material, and where its texture coordinates come from.
    pub fn index(&mut self, material: Option<usize>) -> Result<(u32, Option<UvSource>), SceneError> {
        if let Some(&i) = self.used.get(&material) {
            return Ok((i, self.uv[i as usize]));
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
        self.used.insert(material, self.out.len() as u32);
        self.out.push(converted);
        self.uv.push(uv);
        Ok((self.out.len() as u32 - 1, uv))
    }

    fn convert(
        &mut self,
        index: usize,
        m: &schema::Material,
    ) -> Result<(Material, Option<UvSource>), SceneError> {
        let converted;
        let pbr = match &m.extensions.glossiness {
            Some(old) if m.pbr_metallic_roughness.has_no_colour() => {
                converted = old.as_metallic_roughness();
                if old.specular_glossiness_texture.is_some() {
                    let what = format!("the specular-glossiness texture of material {:?}", m.name);
                    self.left_out.push(format!("{what}: its diffuse colour and its factors are taken"));
                }
                &converted
            }
            _ => &m.pbr_metallic_roughness,
        };
        let usable = |x: &f32| x.abs() < rbn::LARGEST;
        let base_color = pbr.base_color_factor.unwrap_or([1.0; 4]);
        let strength = m.extensions.emissive.as_ref().and_then(|e| e.emissive_strength).unwrap_or(1.0);
        let emission = m.emissive_factor.map(|e| e * strength);
        if !base_color.iter().chain(&emission).all(usable) {
            let problem =
                format!("material {index} ({:?}) has a colour that is not finite, or far too large", m.name);
            return Err(self.source.malformed(problem));
        }
        let shine = [pbr.metallic_factor, pbr.roughness_factor].map(|factor| factor.unwrap_or(1.0));
        let specular = m.extensions.specular.as_ref().and_then(|s| s.specular_factor).unwrap_or(1.0);
        let normal_scale = m.normal_texture.as_ref().and_then(|t| t.scale).unwrap_or(1.0);
        let cutoff = m.alpha_cutoff.unwrap_or(0.5);
        if !shine.iter().chain([&specular, &normal_scale, &cutoff]).all(usable) {
            let problem =
                format!("material {index} ({:?}) has a factor that is not finite, or far too large", m.name);
            return Err(self.source.malformed(problem));
        }
        let base_color_texture =
            pbr.base_color_texture.as_ref().map(|info| self.texture_index(info.index, false));
        // A vertex has one pair of coordinates: the first texture's.
        let textures = [
            &pbr.base_color_texture,
            &m.normal_texture,
            &pbr.metallic_roughness_texture,
            &m.emissive_texture,
            m.extensions.transmission.as_ref().map_or(&None, |t| &t.transmission_texture),
        ];
        let uv = textures.into_iter().flatten().next().map(uv_source);
        let emission_texture = self.detail(&m.name, uv, m.emissive_texture.as_ref(), false);
        let metallic_roughness_texture =
            self.detail(&m.name, uv, pbr.metallic_roughness_texture.as_ref(), true);
        let normal_texture = self.detail(&m.name, uv, m.normal_texture.as_ref(), true);
        let alpha = match m.alpha_mode.as_deref().unwrap_or("OPAQUE") {
            "MASK" => Alpha::Mask { cutoff },
            "BLEND" => Alpha::Blend,
            _ => Alpha::Opaque,
        };
        let is_unlit = m.extensions.unlit.is_some();
        let extras = if is_unlit {
            Extras { unlit: true, ..Extras::default() }
        } else {
            self.light_through(index, m, uv)?
        };
        let material = Material {
            name: m.name.clone(),
            // An albedo over 1 would make energy out of nothing.
            base_color: base_color.map(|c| c.clamp(0.0, 1.0)),
            base_color_texture,
            alpha,
            double_sided: m.double_sided,
            emission: if is_unlit { [0.0; 3] } else { emission },
            emission_texture: emission_texture.filter(|_| !is_unlit),
            metallic: shine[0].clamp(0.0, 1.0),
            roughness: shine[1].clamp(0.0, 1.0),
            metallic_roughness_texture,
            specular: if is_unlit { 0.0 } else { specular.clamp(0.0, 1.0) },
            normal_texture,
            normal_scale,
            extras,
        };
        Ok((material, uv))
    }

    /// What a material lets through.
    fn light_through(
        &mut self,
        index: usize,
        m: &schema::Material,
        uv: Option<UvSource>,
    ) -> Result<Extras, SceneError> {
        let mut numbers = Numbers::default();
        let mut texture = None;
        let mut left_out = Vec::new();
        if let Some(t) = &m.extensions.transmission {
            numbers.transmission = t.transmission_factor;
            texture = t.transmission_texture.as_ref();
        }
        if let Some(volume) = &m.extensions.volume {
            numbers.thickness = volume.thickness_factor;
            numbers.attenuation_distance = volume.attenuation_distance.unwrap_or(f32::INFINITY);
            numbers.attenuation_color = volume.attenuation_color.unwrap_or([1.0; 3]);
            left_out.push((volume.thickness_texture.is_some(), "thickness"));
        }
        if let Some(d) = &m.extensions.diffuse_transmission {
            numbers.scattered = d.diffuse_transmission_factor;
            numbers.scattered_color = d.diffuse_transmission_color_factor.unwrap_or([1.0; 3]);
            left_out.push((d.diffuse_transmission_texture.is_some(), "diffuse transmission"));
            left_out.push((d.diffuse_transmission_color_texture.is_some(), "diffuse transmission colour"));
        }
        if !numbers.are_usable() {
            let problem = format!("material {index} ({:?}) has a transmission that is not a number", m.name);
            return Err(self.source.malformed(problem));
        }
        let extras = numbers.extras();
        if extras.transmission <= 0.0 && extras.scattered <= 0.0 {
            return Ok(Extras::default());
        }
        for (_, what) in left_out.into_iter().filter(|(is_there, _)| *is_there) {
            self.left_out.push(format!("the {what} texture of material {:?}: its factor is taken", m.name));
        }
        Ok(Extras { transmission_texture: self.detail(&m.name, uv, texture, true), ..extras })
    }

    /// Our index for a glTF texture.
    fn texture_index(&mut self, texture: usize, data: bool) -> u32 {
        let known = self.textures.iter().position(|t| *t == (texture, data));
        known.unwrap_or_else(|| {
            self.textures.push((texture, data));
            self.textures.len() - 1
        }) as u32
    }

    /// A texture besides the base colour's.
    fn detail(
        &mut self,
        material: &str,
        uv: Option<UvSource>,
        info: Option<&schema::TextureInfo>,
        data: bool,
    ) -> Option<DetailTexture> {
        let (info, uv) = (info?, uv?);
        let own = uv_source(info);
        if own.set != uv.set {
            self.left_out.push(format!(
                "texture {} of material {material:?}: its coordinates are TEXCOORD_{}, those of the material's \
                 first texture TEXCOORD_{}",
                info.index, own.set, uv.set
            ));
            return None;
        }
        let relative = own.matrix * uv.matrix.inverse();
        let largest = relative.to_cols_array().into_iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let usable =
            uv.matrix.determinant() != 0.0 && relative.is_finite() && largest < f64::from(rbn::LARGEST);
        let rows = if usable { relative } else { DMat3::IDENTITY }.transpose().as_mat3();
        let texture = self.texture_index(info.index, data);
        Some(DetailTexture { texture, uv_from_vertex: [rows.x_axis.into(), rows.y_axis.into()] })
    }

    /// The materials and their textures; textures with one image share it. Only those that light needs are decoded: the
    /// rest is for pictures, which do without what cannot be read.
    pub fn finish(mut self, scene: &mut Scene) -> Result<(), SceneError> {
        let source = self.source;
        let needed: HashSet<u32> = self.out.iter().flat_map(textures_of_light).collect();
        let mut images: Vec<(usize, bool)> = Vec::new();
        let mut of_image = Vec::new();
        for (t, &(texture, _)) in self.textures.iter().enumerate() {
            let base = needed.contains(&(t as u32));
            let image = match image_index(source, texture) {
                Ok(image) => image,
                Err(error) if base => return Err(error),
                Err(error) => {
                    self.left_out.push(error.to_string());
                    of_image.push(None);
                    continue;
                }
            };
            let at = images.iter().position(|&(i, _)| i == image).unwrap_or_else(|| {
                images.push((image, false));
                images.len() - 1
            });
            images[at].1 |= base;
            of_image.push(Some(at));
        }
        check_sizes(source, &images)?;
        let mut pictures = Vec::new();
        let read: Vec<_> = images.par_iter().map(|&(i, decoded)| picture(source, i, decoded)).collect();
        for (picture, (_, decoded)) in read.into_iter().zip(images) {
            match picture {
                Ok(picture) => pictures.push(Some(picture)),
                Err(error) if decoded => return Err(error),
                Err(error) => {
                    self.left_out.push(error.to_string());
                    pictures.push(None);
                }
            }
        }
        let mut places = Vec::new();
        for (&(texture, data), at) in self.textures.iter().zip(of_image) {
            let picture = at.and_then(|at| pictures[at].as_ref());
            places.push(picture.map(|_| scene.textures.len() as u32));
            scene.textures.extend(picture.map(|picture| sampled(source, texture, data, picture)));
        }
        for material in &mut self.out {
            let place = |t: u32| places[t as usize];
            material.base_color_texture = material.base_color_texture.and_then(place);
            let details = [
                &mut material.emission_texture,
                &mut material.metallic_roughness_texture,
                &mut material.normal_texture,
                &mut material.extras.transmission_texture,
            ];
            for detail in details {
                *detail = detail.and_then(|d| Some(DetailTexture { texture: place(d.texture)?, ..d }));
            }
        }
        scene.materials = self.out;
        scene.left_out = self.left_out;
        Ok(())
    }
}

/// The texture coordinates of KHR_texture_transform: scale, then rotate counter-clockwise as the
/// picture is seen (v points down), then offset.
fn uv_source(info: &schema::TextureInfo) -> UvSource {
    let Some(t) = &info.extensions.transform else {
        return UvSource { set: info.tex_coord, matrix: DMat3::IDENTITY };
    };
    let (sin, cos) = (t.rotation as f64).sin_cos();
    let [sx, sy] = t.scale.unwrap_or([1.0; 2]).map(f64::from);
    let [x, y] = t.offset.map(f64::from);
    UvSource {
        set: t.tex_coord.unwrap_or(info.tex_coord),
        matrix: DMat3::from_cols(
            DVec3::new(cos * sx, -sin * sx, 0.0),
            DVec3::new(sin * sy, cos * sy, 0.0),
            DVec3::new(x, y, 1.0),
        ),
    }
}
