//! Input of the ray caster, from a loaded [`Scene`] or a baked file.

use super::glass::{Detail, Glass};
use crate::geometry::Gloss;
use crate::geometry::simplify::{TOGETHER, simplify};
use crate::scene::model::bounds_of_copy;
use crate::scene::texture::{Sampler, Texels};
use crate::scene::{InstancedMesh, Scene, SceneError, detail, needed, union};
use glam::{Affine3A, Vec2, Vec3};
use rayon::prelude::*;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::motion::Motions;
use rebounce_shared::octahedral;
use rebounce_shared::rbn::bulk::Instance;
use rebounce_shared::rbn::groups::Groups;
use rebounce_shared::rbn::lightmap::ChartOffset;
use rebounce_shared::rbn::meta::{Alpha, Material};
use std::collections::HashSet;
use std::ops::Range;
use std::sync::Arc;

/// Whether lightmaps are shown: by what can make them.
pub const WITH_LIGHTMAPS: bool = cfg!(feature = "exact-faces");

/// A triangle with the data for shading.
#[derive(Clone, Copy, Debug)]
pub struct Triangle {
    /// Corners, local space or model space.
    pub positions: [Vec3; 3],
    /// Unit shading normals at the corners.
    pub normals: [Vec3; 3],
    /// Texture coordinates at the corners.
    pub uvs: [Vec2; 3],
    /// Index of the material.
    pub material: u32,
}

/// A material, prepared for lookups.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Linear RGB factor of the albedo.
    pub color: Vec3,
    /// Factor of alpha.
    pub alpha_factor: f32,
    /// Colour and alpha texture, multiplied with the factors.
    pub texture: Option<Sampler>,
    /// Alpha mode; `Opaque` if alpha never matters.
    pub alpha: Alpha,
    /// Whether the back reflects too.
    pub double_sided: bool,
    /// Emitted linear RGB radiance, and the texture multiplied with the radiance.
    pub emission: Vec3,
    emission_texture: Option<Box<Detail>>,
    /// Whether pictures show the albedo unlit.
    pub is_unlit: bool,
    /// Factors of how it shines, and the texture of roughness (green) and metalness (blue).
    pub gloss: Gloss,
    gloss_texture: Option<Box<Detail>>,
    /// Transmission in addition to alpha.
    pub glass: Option<Box<Glass>>,
    /// [Reconstruction group](rebounce_shared::rbn::groups) of the triangles with the material.
    pub group: u32,
}

/// A model: triangles in model space, and the transforms of the copies.
#[derive(Clone, Debug)]
pub struct Placed {
    /// Range of the model's triangles.
    pub triangles: Range<usize>,
    /// Transforms of the copies: none mirrored, each invertible.
    pub local_from_model: Vec<Affine3A>,
}

/// Triangles and materials.
#[derive(Clone, Debug, Default)]
pub struct Geometry {
    /// Triangles: first in local space, then of [`Self::models`].
    pub triangles: Vec<Triangle>,
    /// Models, in the order of the triangles.
    pub models: Vec<Placed>,
    /// Linear RGB factors of the albedo at the triangles' corners, in place of the materials'; empty for none.
    pub colors: Vec<[Vec3; 3]>,
    /// Places of the corners in a [lightmap](rebounce_shared::rbn::lightmap), texels, NaN without a chart; empty without a
    /// lightmap.
    pub lightmap: Vec<[Vec2; 3]>,
    /// Of triangles without instances, then by copy of the models in their order: where their charts are in the lightmap.
    pub chart_offsets: Vec<ChartOffset>,
    /// Materials.
    pub surfaces: Vec<Surface>,
}

impl Surface {
    /// Prepares a material of group 0. `texture` returns textures by number.
    pub fn new(material: &Material, texture: impl Fn(u32) -> Option<Sampler>) -> Self {
        let [r, g, b, a] = material.base_color;
        let glass = Glass::new(material, &texture);
        let emission_texture = Detail::new(&material.emission_texture, &texture).map(Box::new);
        let gloss_texture = Detail::new(&material.metallic_roughness_texture, &texture).map(Box::new);
        let Material { metallic, roughness, specular, .. } = *material;
        let texture = material.base_color_texture.and_then(texture);
        // Many exporters mark opaque surfaces as BLEND or MASK: search for a texel that is not opaque.
        let least = |s: &Sampler| s.texels.rgba.iter().map(|t| t[3]).min().unwrap_or(255) as f32 / 255.0;
        let alpha = match material.alpha {
            Alpha::Opaque => Alpha::Opaque,
            alpha => {
                let least = a * texture.as_ref().map_or(1.0, least);
                let opaque = match alpha {
                    Alpha::Mask { cutoff } => least >= cutoff,
                    _ => least >= 1.0,
                };
                if opaque { Alpha::Opaque } else { alpha }
            }
        };
        Self {
            color: Vec3::new(r, g, b),
            alpha_factor: a,
            texture,
            alpha,
            double_sided: material.double_sided,
            emission: Vec3::from(material.emission),
            emission_texture,
            is_unlit: material.extras.unlit,
            gloss: Gloss { metallic, roughness, specular },
            gloss_texture,
            glass,
            group: 0,
        }
    }

    /// Returns whether the surface stops light completely at every position.
    pub fn is_opaque(&self) -> bool {
        self.alpha == Alpha::Opaque && self.glass.is_none()
    }

    /// Returns the base colour around a texture coordinate, averaged over about the fraction `share` of the texture.
    #[inline]
    fn base(&self, color: Vec3, uv: Vec2, share: f32) -> Vec3 {
        match &self.texture {
            Some(texture) => color * texture.color(uv, share, self.alpha != Alpha::Opaque),
            None => color,
        }
    }

    /// Returns the linear RGB reflectance around a texture coordinate, for stopped rays, averaged over about the
    /// fraction `share` of the texture. `color` is the factor: [`Self::color`] or the vertices' colour.
    #[inline]
    pub fn albedo(&self, color: Vec3, uv: Vec2, share: f32) -> Vec3 {
        let base = self.base(color, uv, share);
        match &self.glass {
            None => base,
            // Reflected light comes from stopped rays.
            Some(glass) => {
                let passage = glass.passage(self.base(color, uv, 0.0), self.cover(uv), uv);
                (base * (passage.reflected / stopped(passage.through).max(1e-6))).min(Vec3::ONE)
            }
        }
    }

    /// Returns the emitted linear RGB radiance around a texture coordinate, averaged over about the fraction `share`
    /// of the texture.
    pub fn shine(&self, uv: Vec2, share: f32) -> Vec3 {
        self.emission * self.emission_texture.as_ref().map_or(Vec3::ONE, |texture| texture.color(uv, share))
    }

    /// Returns how the surface shines at a texture coordinate.
    #[inline]
    pub fn gloss(&self, uv: Vec2) -> Gloss {
        let Some(texture) = &self.gloss_texture else { return self.gloss };
        Gloss {
            metallic: self.gloss.metallic * texture.channel(uv, 2),
            roughness: self.gloss.roughness * texture.channel(uv, 1),
            ..self.gloss
        }
    }

    /// Returns alpha; 1 for an opaque surface.
    #[inline]
    fn cover(&self, uv: Vec2) -> f32 {
        let alpha = || self.alpha_factor * self.texture.as_ref().map_or(1.0, |t| t.alpha(uv));
        match self.alpha {
            Alpha::Opaque => 1.0,
            Alpha::Mask { cutoff } => (alpha() >= cutoff) as u32 as f32,
            Alpha::Blend => alpha(),
        }
    }

    /// Returns the transmittance at a texture coordinate, linear RGB.
    #[inline]
    pub fn through(&self, color: Vec3, uv: Vec2) -> Vec3 {
        match &self.glass {
            None => Vec3::splat(1.0 - self.cover(uv)),
            Some(glass) => glass.passage(self.base(color, uv, 0.0), self.cover(uv), uv).through,
        }
    }

    /// Returns the fraction of light stopped at a texture coordinate, as the mean over the channels: 1 if opaque.
    #[inline]
    pub fn opacity(&self, color: Vec3, uv: Vec2) -> f32 {
        match &self.glass {
            None => self.cover(uv),
            Some(_) => stopped(self.through(color, uv)),
        }
    }
}

/// Returns the stopped fraction for a transmittance.
#[inline]
fn stopped(through: Vec3) -> f32 {
    1.0 - through.element_sum() / 3.0
}

/// Returns the minimum and maximum corner of triangles; zero without triangles.
pub(super) fn bounds(triangles: &[Triangle]) -> (Vec3, Vec3) {
    triangles.par_iter().map(Triangle::bounds).reduce_with(union).unwrap_or_default()
}

impl Triangle {
    /// Returns the minimum and maximum corner.
    pub(super) fn bounds(&self) -> (Vec3, Vec3) {
        let [a, b, c] = self.positions;
        (a.min(b).min(c), a.max(b).max(c))
    }
}

impl Placed {
    /// Returns the local-space boxes of the copies of a model with these bounds.
    pub(super) fn boxes(&self, (low, high): (Vec3, Vec3)) -> impl Iterator<Item = (Vec3, Vec3)> {
        self.local_from_model.iter().map(move |place| bounds_of_copy(place, [low, high]))
    }
}

impl Geometry {
    /// Returns the minimum and maximum corner of the models, model space.
    pub(super) fn model_bounds(&self) -> Vec<(Vec3, Vec3)> {
        self.models.iter().map(|model| bounds(&self.triangles[model.triangles.clone()])).collect()
    }

    /// Returns the minimum and maximum corner of the [part](detail::main_part) with the detail, local space; `None`
    /// for the complete scene.
    pub(super) fn main_part(&self) -> Option<(Vec3, Vec3)> {
        let end = self.models.first().map_or(self.triangles.len(), |model| model.triangles.start);
        let corners = self.triangles[..end].iter().flat_map(|triangle| triangle.positions);
        let bounds = self.model_bounds();
        let boxes = self.models.iter().zip(&bounds).flat_map(|(model, bounds)| model.boxes(*bounds));
        detail::part_of(corners.chain(boxes.flat_map(|(low, high)| [low, high])))
    }

    /// Returns a scene's geometry after simplification: [`simplify`].
    pub fn simplified(scene: &Scene) -> Self {
        let surfaces = surfaces(scene);
        let corners = simplify(scene, |i| surfaces[i].is_opaque(), TOGETHER);
        // A model's triangles stay consecutive.
        let first = |t: u32| corners.partition_point(|corners| corners[0] / 3 < t);
        Self::of(scene, surfaces, corners.par_iter().copied(), first)
    }

    /// Builds geometry from triangles between corners of a scene. A corner is 3 × triangle number + corner index.
    /// `first` returns the index of the first triangle from a scene triangle's number on.
    fn of(
        scene: &Scene,
        surfaces: Vec<Surface>,
        corners: impl IndexedParallelIterator<Item = [u32; 3]> + Clone,
        first: impl Fn(u32) -> usize,
    ) -> Self {
        let vertex = |corner: u32| scene.triangles[corner as usize / 3][corner as usize % 3] as usize;
        let triangle = |corners: [u32; 3]| Triangle {
            positions: corners.map(|c| scene.positions[vertex(c)]),
            normals: corners.map(|c| scene.normals[vertex(c)]),
            uvs: corners.map(|c| scene.uvs[vertex(c)]),
            material: scene.triangle_material[corners[0] as usize / 3],
        };
        let placed = |m: &InstancedMesh| Placed {
            triangles: first(m.triangles.start)..first(m.triangles.end),
            local_from_model: m.local_from_model.clone(),
        };
        let color = |c: u32| scene.corner_colors[c as usize / 3][c as usize % 3];
        Self {
            triangles: corners.clone().map(triangle).collect(),
            colors: match scene.corner_colors[..] {
                [] => Vec::new(),
                _ => corners.map(|corners| corners.map(color)).collect(),
            },
            models: scene.models.iter().map(placed).collect(),
            lightmap: Vec::new(),
            chart_offsets: Vec::new(),
            surfaces,
        }
    }
}

/// Prepares the materials of a scene.
fn surfaces(scene: &Scene) -> Vec<Surface> {
    let texture = |t: u32| scene.textures[t as usize].sampler();
    of_groups(&scene.groups, scene.materials.iter().map(|m| Surface::new(m, texture)))
}

/// Gives prepared materials their reconstruction groups.
fn of_groups(groups: &Groups, surfaces: impl Iterator<Item = Surface>) -> Vec<Surface> {
    (0..).zip(surfaces).map(|(i, surface)| Surface { group: groups.of_material(i), ..surface }).collect()
}

impl From<&Scene> for Geometry {
    fn from(scene: &Scene) -> Self {
        let all = (0..scene.triangles.len() as u32).into_par_iter();
        Self::of(scene, surfaces(scene), all.map(|t| [3 * t, 3 * t + 1, 3 * t + 2]), |t| t as usize)
    }
}

impl Geometry {
    /// Geometry of a baked file whose groups are where `motions` have them. Decodes the textures for light transport and for
    /// emission.
    ///
    /// # Errors
    /// [`SceneError::Texture`] if a picture for light transport cannot be decoded.
    pub fn of_baked(scene: &BakedScene, motions: &Motions) -> Result<Self, SceneError> {
        let instances = scene.moved_instances(motions);
        let materials = &scene.meta.materials;
        let needed: HashSet<u32> = materials.iter().flat_map(needed::of_light).collect();
        let of_gloss = |m| needed::of_gloss(m).filter(|_| !scene.gloss.is_empty());
        let of_pictures = |m| needed::of_emission(m).into_iter().chain(of_gloss(m));
        let used: HashSet<u32> = materials.iter().flat_map(of_pictures).collect();
        let textures: Result<Vec<Option<Sampler>>, SceneError> = (0..scene.meta.textures.len())
            .into_par_iter()
            .map(|i| {
                let is_needed = needed.contains(&(i as u32));
                if !is_needed && !used.contains(&(i as u32)) {
                    return Ok(None);
                }
                let meta = &scene.meta.textures[i];
                let texels = match Texels::decode(scene.texture(i)) {
                    Ok(texels) => texels,
                    Err(problem) if is_needed => {
                        return Err(SceneError::Texture {
                            file: scene.meta.scene_name.clone(),
                            texture: meta.name.clone(),
                            problem,
                        });
                    }
                    // Pictures do without a texture of emission or gloss.
                    Err(_) => return Ok(None),
                };
                Ok(Some(Sampler {
                    texels: Arc::new(texels),
                    wrap_u: meta.wrap_u,
                    wrap_v: meta.wrap_v,
                    linear_filter: meta.linear_filter,
                }))
            })
            .collect();
        let textures = textures?;
        let texture = |t: u32| textures[t as usize].clone();
        let (mut triangles, mut models): (Vec<Triangle>, Vec<Placed>) = Default::default();
        let mut lightmap: Vec<[Vec2; 3]> = Vec::new();
        let mut chart_offsets = scene.lightmap.offsets_of(0..0).to_vec();
        // Triangles without instances first, then models: a model is a run of draw calls with equal copies.
        let stands = |draw: usize| scene.copies_of(draw);
        let draws = || scene.meta.draws.iter().enumerate();
        let alone = draws().filter(|(draw, _)| stands(*draw).is_empty());
        let copied = draws().filter(|(draw, _)| !stands(*draw).is_empty());
        let mut last = 0..0;
        for (number, draw) in alone.chain(copied) {
            let (first, copies) = (triangles.len(), stands(number));
            if !copies.is_empty() && copies != last {
                let local_from_model = instances[copies.clone()].iter().map(Instance::local_from_model);
                models.push(Placed { triangles: first..first, local_from_model: local_from_model.collect() });
                chart_offsets.extend(scene.lightmap.offsets_of(copies.clone()));
                last = copies;
            }
            let range = draw.first_index as usize..(draw.first_index + draw.index_count) as usize;
            triangles.extend(scene.indices[range].as_chunks::<3>().0.iter().map(|t| {
                let vertices = t.map(|i| scene.vertices[i as usize]);
                Triangle {
                    positions: vertices.map(|v| Vec3::from(v.position)),
                    normals: vertices.map(|v| octahedral::unpack_snorm16(v.normal)),
                    uvs: vertices.map(|v| Vec2::from(v.uv)),
                    material: draw.material,
                }
            }));
            if WITH_LIGHTMAPS && !scene.lightmap.is_empty() {
                let range = draw.first_index as usize..(draw.first_index + draw.index_count) as usize;
                let place = |i: u32| scene.lightmap.coordinates[i as usize].texels().unwrap_or(Vec2::NAN);
                lightmap.extend(scene.indices[range].as_chunks::<3>().0.iter().map(|t| t.map(place)));
            }
            if let Some(model) = models.last_mut() {
                model.triangles.end = triangles.len();
            }
        }
        Ok(Self {
            triangles,
            models,
            colors: Vec::new(),
            lightmap,
            chart_offsets,
            surfaces: of_groups(&scene.groups, materials.iter().map(|m| Surface::new(m, texture))),
        })
    }
}
