//! Materials and textures. Only those used by triangles are kept and decoded.

use super::document::Extensible;
use super::picture::{check_sizes, image_index, picture, sampled};
use super::source::Source;
use super::specular::Shine;
use super::texture_info::{TextureInfo, UvSource};
use super::transmission::{self, DiffuseTransmission, TransmissionFactors};
use crate::scene::needed;
use crate::scene::{Scene, SceneError};
use glam::DMat3;
use gltf::json::material::AlphaMode;
use gltf::json::validation::Checked;
use rayon::prelude::*;
use rebounce_shared::rbn;
use rebounce_shared::rbn::extras::Extras;
use rebounce_shared::rbn::meta::{Alpha, DetailTexture, Material};
use rebounce_shared::rbn::specular::SpecularExtras;
use std::collections::{HashMap, HashSet};

/// Surface parameters, from metallic-roughness or specular-glossiness.
struct MaterialSource {
    base_color: [f32; 4],
    base_color_texture: Option<TextureInfo>,
    metallic: f32,
    roughness: f32,
    metallic_roughness_texture: Option<TextureInfo>,
}

/// Collects the materials in the order of their first use.
pub(super) struct Materials<'a> {
    source: &'a Source<'a>,
    /// Output index by glTF material, and group of a shining one; the key `None` is glTF's default material.
    used: HashMap<(Option<usize>, Option<String>), u32>,
    /// Groups of the output materials that nodes name.
    groups: Vec<Option<String>>,
    /// glTF textures in output order, and whether the texels are data instead of colours.
    textures: Vec<(usize, bool)>,
    out: Vec<Material>,
    uv: Vec<Option<UvSource>>,
    /// Linear RGB albedo of primitives without a material.
    default: Option<[f32; 3]>,
    /// Messages about features of the file that are not imported.
    left_out: Vec<String>,
}

impl<'a> Materials<'a> {
    /// `default` is the linear RGB albedo of primitives without a material, glTF's white when absent.
    pub fn new(source: &'a Source<'a>, default: Option<[f32; 3]>) -> Self {
        let (used, groups, textures, out, uv, left_out) = Default::default();
        Self { source, used, groups, textures, out, uv, default, left_out }
    }

    /// Whether primitives without a material are white.
    pub fn has_white_default(&self) -> bool {
        self.default.is_none()
    }

    /// Whether a primitive has no material.
    pub fn has_default(&self) -> bool {
        self.used.contains_key(&(None, None))
    }

    /// Name of an output material.
    pub fn name(&self, material: u32) -> &str {
        self.out.get(material as usize).map_or("", |m| &m.name)
    }

    /// Whether an output material transmits no light.
    pub fn is_opaque(&self, material: u32) -> bool {
        self.out.get(material as usize).is_some_and(|m| m.alpha == Alpha::Opaque && !m.is_glass())
    }

    /// Returns the output index of a glTF material and the source of the texture coordinates. Converts the material on
    /// first use. A material that shines is another one in each group.
    pub fn index(
        &mut self,
        material: Option<usize>,
        group: Option<&str>,
    ) -> Result<(u32, Option<UvSource>), SceneError> {
        let source = self.source;
        let shines = |i: usize| {
            let emission = source.root.materials.get(i).map(|m| m.emissive_factor.0);
            emission.is_some_and(|emission| emission != [0.0; 3])
        };
        let group = group.filter(|_| material.is_some_and(shines)).map(str::to_owned);
        let key = (material, group.clone());
        if let Some(&i) = self.used.get(&key) {
            return Ok((i, self.uv[i as usize]));
        }
        let (converted, uv) = match material {
            None => {
                let [r, g, b] = self.default.unwrap_or([1.0; 3]);
                (Material { base_color: [r, g, b, 1.0], ..Material::default() }, None)
            }
            Some(i) => {
                let known = source.root.materials.get(i);
                let m = known.ok_or_else(|| source.malformed(format!("there is no material {i}")))?;
                self.convert(i, m)?
            }
        };
        self.used.insert(key, self.out.len() as u32);
        self.out.push(converted);
        self.groups.push(group);
        self.uv.push(uv);
        Ok((self.out.len() as u32 - 1, uv))
    }

    fn convert(
        &mut self,
        index: usize,
        m: &gltf::json::Material,
    ) -> Result<(Material, Option<UvSource>), SceneError> {
        let source = self.source;
        let name = m.name.clone().unwrap_or_default();
        let extensions = m.extensions.as_ref();
        let pbr = self.surface(m, &name);
        let usable = |x: &f32| x.abs() < rbn::LARGEST;
        let base_color = pbr.base_color;
        let strength = extensions.and_then(|e| e.emissive_strength.as_ref());
        let strength = strength.map_or(1.0, |e| e.emissive_strength.0);
        let emission = m.emissive_factor.0.map(|e| e * strength);
        if !base_color.iter().chain(&emission).all(usable) {
            let problem = "has a colour that is not finite, or far too large";
            return Err(source.malformed(format!("material {index} ({name:?}) {problem}")));
        }
        let shine = [pbr.metallic, pbr.roughness];
        let normal_scale = m.normal_texture.as_ref().map_or(1.0, |t| t.scale);
        let cutoff = m.alpha_cutoff.unwrap_or_default().0;
        if !shine.iter().chain([&normal_scale, &cutoff]).all(usable) {
            let problem = "has a factor that is not finite, or far too large";
            return Err(source.malformed(format!("material {index} ({name:?}) {problem}")));
        }
        let read = |problem: String| source.malformed(format!("material {index} ({name:?}) {problem}"));
        let Shine { specular, extras: specular_extras, left_out } = Shine::new(m).map_err(read)?;
        let normal = m.normal_texture.as_ref().map(TextureInfo::of_normals).transpose().map_err(read)?;
        let emissive = m.emissive_texture.as_ref().map(TextureInfo::new);
        let [base, shiny] = [pbr.base_color_texture, pbr.metallic_roughness_texture];
        let base_color_texture = base.as_ref().map(|info| self.texture_index(info.index, false));
        // A vertex has a single pair of coordinates: that of the first texture.
        let shone_through = extensions.and_then(|e| e.transmission.as_ref());
        let shone_through = shone_through.and_then(|t| t.transmission_texture.as_ref()).map(TextureInfo::new);
        let uv = [&base, &normal, &shiny, &emissive, &shone_through].into_iter().flatten().next();
        let uv = uv.map(TextureInfo::uv_source);
        let emission_texture = self.detail(&name, uv, emissive.as_ref(), false);
        let metallic_roughness_texture = self.detail(&name, uv, shiny.as_ref(), true);
        let normal_texture = self.detail(&name, uv, normal.as_ref(), true);
        let alpha = match m.alpha_mode {
            Checked::Valid(AlphaMode::Mask) => Alpha::Mask { cutoff },
            Checked::Valid(AlphaMode::Blend) => Alpha::Blend,
            Checked::Valid(AlphaMode::Opaque) | Checked::Invalid => Alpha::Opaque,
        };
        let is_unlit = extensions.is_some_and(|e| e.unlit.is_some());
        for what in left_out.into_iter().filter(|_| !is_unlit) {
            self.left_out.push(format!("the {what} texture of material {name:?}: its factor is taken"));
        }
        let extras = if is_unlit {
            Extras { unlit: true, ..Extras::default() }
        } else {
            let extras = self.light_through(index, m, &name)?;
            let lets_through = extras.transmission > 0.0 || extras.scattered > 0.0;
            let texture = shone_through.as_ref().filter(|_| lets_through);
            Extras { transmission_texture: self.detail(&name, uv, texture, true), ..extras }
        };
        let material = Material {
            name,
            // An albedo over 1 would create energy.
            base_color: base_color.map(|c| c.clamp(0.0, 1.0)),
            base_color_texture,
            alpha,
            double_sided: m.double_sided,
            emission: if is_unlit { [0.0; 3] } else { emission },
            emission_texture: emission_texture.filter(|_| !is_unlit),
            metallic: shine[0].clamp(0.0, 1.0),
            roughness: shine[1].clamp(0.0, 1.0),
            metallic_roughness_texture,
            specular: if is_unlit { 0.0 } else { specular },
            normal_texture,
            normal_scale,
            extras,
            specular_extras: if is_unlit { SpecularExtras::default() } else { specular_extras },
        };
        Ok((material, uv))
    }

    /// Returns base colour and metallic-roughness. KHR_materials_pbrSpecularGlossiness applies if
    /// `pbrMetallicRoughness` has no base colour.
    fn surface(&mut self, m: &gltf::json::Material, name: &str) -> MaterialSource {
        let pbr = &m.pbr_metallic_roughness;
        let older = m.extensions.as_ref().and_then(|e| e.pbr_specular_glossiness.as_ref());
        let has_colour = pbr.base_color_factor.0 != [1.0; 4] || pbr.base_color_texture.is_some();
        match older.filter(|_| !has_colour) {
            Some(older) => {
                if older.specular_glossiness_texture.is_some() {
                    let what = format!("the specular-glossiness texture of material {name:?}");
                    self.left_out.push(format!("{what}: its diffuse colour and its factors are taken"));
                }
                // The diffuse colour is that of a dielectric.
                MaterialSource {
                    base_color: older.diffuse_factor.0,
                    base_color_texture: older.diffuse_texture.as_ref().map(TextureInfo::new),
                    metallic: 0.0,
                    roughness: 1.0 - older.glossiness_factor.0,
                    metallic_roughness_texture: None,
                }
            }
            None => MaterialSource {
                base_color: pbr.base_color_factor.0,
                base_color_texture: pbr.base_color_texture.as_ref().map(TextureInfo::new),
                metallic: pbr.metallic_factor.0,
                roughness: pbr.roughness_factor.0,
                metallic_roughness_texture: pbr.metallic_roughness_texture.as_ref().map(TextureInfo::new),
            },
        }
    }

    /// Transmission of a material, without the transmission texture.
    fn light_through(
        &mut self,
        index: usize,
        m: &gltf::json::Material,
        name: &str,
    ) -> Result<Extras, SceneError> {
        let extensions = m.extensions.as_ref();
        let mut numbers = TransmissionFactors::default();
        let mut left_out = Vec::new();
        if let Some(t) = extensions.and_then(|e| e.transmission.as_ref()) {
            numbers.transmission = t.transmission_factor.0;
        }
        if let Some(volume) = extensions.and_then(|e| e.volume.as_ref()) {
            numbers.thickness = volume.thickness_factor.0;
            numbers.attenuation_distance = volume.attenuation_distance.0;
            numbers.attenuation_color = volume.attenuation_color.0;
            left_out.push((volume.thickness_texture.is_some(), "thickness"));
        }
        let bad = |problem: String| self.source.malformed(format!("material {index} ({name:?}) {problem}"));
        let diffuse = m.extension::<DiffuseTransmission>(transmission::DIFFUSE).map_err(bad)?;
        if let Some(diffuse) = diffuse {
            numbers.scattered = diffuse.diffuse_transmission_factor;
            numbers.scattered_color = diffuse.diffuse_transmission_color_factor;
            left_out.push((diffuse.diffuse_transmission_texture.is_some(), "diffuse transmission"));
            left_out
                .push((diffuse.diffuse_transmission_color_texture.is_some(), "diffuse transmission colour"));
        }
        if !numbers.are_usable() {
            return Err(bad("has a transmission that is not a number".into()));
        }
        let extras = numbers.extras();
        if extras.transmission <= 0.0 && extras.scattered <= 0.0 {
            return Ok(Extras::default());
        }
        for (_, what) in left_out.into_iter().filter(|(is_there, _)| *is_there) {
            self.left_out.push(format!("the {what} texture of material {name:?}: its factor is taken"));
        }
        Ok(extras)
    }

    /// Returns the output index of a glTF texture.
    fn texture_index(&mut self, texture: usize, data: bool) -> u32 {
        let known = self.textures.iter().position(|t| *t == (texture, data));
        known.unwrap_or_else(|| {
            self.textures.push((texture, data));
            self.textures.len() - 1
        }) as u32
    }

    /// Converts a reference to a texture, except base colour.
    fn detail(
        &mut self,
        material: &str,
        uv: Option<UvSource>,
        info: Option<&TextureInfo>,
        data: bool,
    ) -> Option<DetailTexture> {
        let (info, uv) = (info?, uv?);
        let own = info.uv_source();
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

    /// Adds the materials and textures to the scene; textures with a common image share the image. Decodes the images
    /// that light transport needs, and those of emission. Only transport images are required: an unreadable image that
    /// serves rendered pictures alone is left out.
    pub fn finish(mut self, scene: &mut Scene) -> Result<(), SceneError> {
        let source = self.source;
        let needed: HashSet<u32> = self.out.iter().flat_map(needed::of_light).collect();
        let of_pictures = |m| needed::of_emission(m).into_iter().chain(needed::of_gloss(m));
        let shining: HashSet<u32> = self.out.iter().flat_map(of_pictures).collect();
        // Image index, whether decoded, whether needed by light transport.
        let mut images: Vec<(usize, bool, bool)> = Vec::new();
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
            let at = images.iter().position(|&(i, ..)| i == image).unwrap_or_else(|| {
                images.push((image, false, false));
                images.len() - 1
            });
            images[at].1 |= base || shining.contains(&(t as u32));
            images[at].2 |= base;
            of_image.push(Some(at));
        }
        check_sizes(source, &images)?;
        let mut pictures = Vec::new();
        // An image for rendered pictures alone may have a format that only browsers decode.
        let read = |&(i, decoded, needed): &(usize, bool, bool)| match picture(source, i, decoded) {
            Err(_) if decoded && !needed => picture(source, i, false),
            read => read,
        };
        let read: Vec<_> = images.par_iter().map(read).collect();
        for (picture, (.., needed)) in read.into_iter().zip(images) {
            match picture {
                Ok(picture) => pictures.push(Some(picture)),
                Err(error) if needed => return Err(error),
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
        (scene.materials, scene.light_groups) = (self.out, self.groups);
        scene.left_out = self.left_out;
        Ok(())
    }
}
