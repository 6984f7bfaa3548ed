//! A scene in memory, from glTF 2.0 or generated.
//!
//! * [`load`] – loads a .gltf or .glb file, or `builtin:NAME`;
//! * [`builtin`] – generated scenes;
//! * [`texture`] – pictures and their sampling; `basis` – Basis Universal pictures; `foreign` – pictures of formats
//!   outside glTF; `orientation` – picture rotations in Exif metadata;
//! * [`model`] – instanced meshes;
//! * `colours` – vertex colours; `merge` – merging of equal materials; `notes` – messages about a file;
//! * `other_format` – files of other formats, with advice for conversion to glTF;
//! * [`detail`] – the main part, with nearly all of the detail; [`outliers`] – outliers far from the rest.

mod basis;
pub mod builtin;
mod colours;
pub mod detail;
mod error;
mod foreign;
mod gltf;
mod merge;
pub mod model;
pub(crate) mod needed;
mod notes;
mod orientation;
mod other_format;
pub mod outliers;
pub(crate) mod steps;
pub mod texture;
mod texture_size;

pub use error::SceneError;
pub use model::InstancedMesh;
pub use texture::Texture;

use glam::{Affine3A, DAffine3, DVec3, Vec2, Vec3, Vec4};
use model::WorldInstancedMesh;
use rebounce_shared::camera::Camera;
use rebounce_shared::light::Light;
use rebounce_shared::rbn::meta::{Animation, Material};
use std::path::Path;

/// Maximum number of vertices, and of triangles, of a scene. A larger scene and its bake exceed the memory of usual
/// machines, and ray traversal numbers triangles in 28 bits.
pub(crate) const MOST: usize = 1 << 28;

/// A scene in memory.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Name: the file's name without extension.
    pub name: String,
    /// Origin of local space: world space = local space + origin. The centre of the world-space bounds, or of the [main
    /// part](detail) if the main part is far smaller.
    pub origin: [f64; 3],
    /// Vertices, local space; vertices of [`Self::models`] come last, in model space.
    pub positions: Vec<Vec3>,
    /// Unit shading normals, one per vertex, in the same space.
    pub normals: Vec<Vec3>,
    /// Texture coordinates of the base-colour texture, its transform applied, one per vertex.
    pub uvs: Vec<Vec2>,
    /// Vertex indices, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// Index of the material, one per triangle.
    pub triangle_material: Vec<u32>,
    /// Linear RGB albedo at each triangle's corners, in place of the material's base colour and multiplied with the
    /// texture's; empty if no vertex has a colour.
    pub corner_colors: Vec<[Vec3; 3]>,
    /// Instanced meshes, in the order of the models' vertices and triangles at the end of [`Self::positions`] and
    /// [`Self::triangles`].
    pub models: Vec<InstancedMesh>,
    /// Materials of the triangles.
    pub materials: Vec<Material>,
    /// Textures of the materials.
    pub textures: Vec<Texture>,
    /// The scene's own lights, world space.
    pub lights: Vec<Light>,
    /// The scene's own cameras, world space; may be empty.
    pub cameras: Vec<Camera>,
    /// Names of the lights; may be shorter than [`Self::lights`], and names may be empty.
    pub light_names: Vec<String>,
    /// Names of the cameras, likewise.
    pub camera_names: Vec<String>,
    /// Animations of the scene's own lights.
    pub animations: Vec<Animation>,
    /// Unusable parts of the file that were left out, as sentences with name and reason.
    pub left_out: Vec<String>,
    /// Parts of the file that are read differently from the file's text or are likely mistakes, as sentences with name
    /// and reason.
    pub notes: Vec<String>,
    /// Number of degenerate triangles (without area) that were left out.
    pub degenerate_triangles: usize,
}

/// Loads a scene: the path of a .gltf or .glb file, or `builtin:NAME`.
///
/// # Errors
/// [`SceneError`], with the file's name and advice.
pub fn load(spec: &str) -> Result<Scene, SceneError> {
    load_with(spec, &LoadOptions::default())
}

/// Options for loading a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadOptions {
    /// Name or number of the glTF scene; the file's default scene when absent.
    pub scene: Option<String>,
    /// Linear RGB albedo of meshes without a material; glTF's default, 1, when absent.
    pub albedo: Option<[f32; 3]>,
}

/// Loads a scene with options. `builtin:NAME` is a single scene, and all meshes of built-in scenes have materials.
///
/// # Errors
/// [`SceneError`], with the file's name and advice.
pub fn load_with(spec: &str, options: &LoadOptions) -> Result<Scene, SceneError> {
    let Some(name) = spec.strip_prefix("builtin:") else {
        return gltf::load(Path::new(spec), options);
    };
    if let Some(wanted) = options.scene.clone() {
        return Err(SceneError::NoScene {
            file: spec.to_owned(),
            wanted,
            advice: "leave --scene out, as it is one scene".to_owned(),
        });
    }
    let mut scene = builtin::load(name)?;
    scene.notes.extend(options.albedo.map(|_| UNUSED_ALBEDO.to_owned()));
    Ok(scene)
}

/// Note for an unused albedo for meshes without a material.
const UNUSED_ALBEDO: &str = "--albedo changes nothing: all meshes have materials";

/// Loads a scene from the bytes of a .gltf or .glb file. `name` is the file's name in errors and the scene's name;
/// files referred to are searched in the working directory.
///
/// # Errors
/// [`SceneError`].
pub fn from_bytes(name: &str, bytes: &[u8]) -> Result<Scene, SceneError> {
    gltf::from_bytes(name, bytes)
}

impl Scene {
    /// Returns the least and greatest corner, local space; an instance of a model contributes its box. Both zero
    /// without vertices.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let end = self.models.first().map_or(self.positions.len(), |model| model.vertices.start as usize);
        let alone = (end > 0).then(|| bounds_of(&self.positions[..end]));
        let copies = self.models.iter().flat_map(InstancedMesh::boxes);
        alone.into_iter().chain(copies).reduce(union).unwrap_or_default()
    }

    /// Returns the least and greatest corner of the [main part](detail::main_part), local space; the
    /// [bounds](Self::bounds) without a main part.
    pub fn main_part(&self) -> (Vec3, Vec3) {
        let first = self.models.first().map_or(self.triangles.len(), |model| model.triangles.start as usize);
        let corners = self.triangles[..first].iter().flatten().map(|i| self.positions[*i as usize]);
        let copies = self.models.iter().flat_map(InstancedMesh::boxes).flat_map(|(low, high)| [low, high]);
        detail::part_of(corners.chain(copies)).unwrap_or_else(|| self.bounds())
    }

    /// Number of triangles in the scene, with the triangles of every instance counted.
    pub fn triangles_placed(&self) -> u64 {
        let more = |model: &InstancedMesh| {
            model.triangles.len() as u64 * (model.local_from_model.len() as u64).saturating_sub(1)
        };
        self.triangles.len() as u64 + self.models.iter().map(more).sum::<u64>()
    }

    /// Number of the models' instances.
    pub fn instances(&self) -> usize {
        self.models.iter().map(|model| model.local_from_model.len()).sum()
    }
}

/// Union of two boxes.
pub(crate) fn union((a, b): (Vec3, Vec3), (c, d): (Vec3, Vec3)) -> (Vec3, Vec3) {
    (a.min(c), b.max(d))
}

/// Least and greatest corner of positions; both zero without positions.
pub(crate) fn bounds_of(positions: &[Vec3]) -> (Vec3, Vec3) {
    let Some(&first) = positions.first() else {
        return (Vec3::ZERO, Vec3::ZERO);
    };
    positions.iter().fold((first, first), |(low, high), &p| (low.min(p), high.max(p)))
}

/// World-space vertices and triangles, before conversion into a [`Scene`].
#[derive(Default)]
struct WorldMesh {
    positions: Vec<DVec3>,
    normals: Vec<Vec3>,
    uvs: Vec<Vec2>,
    /// Linear RGB and alpha; vertices beyond the end are white.
    colors: Vec<Vec4>,
    triangles: Vec<[u32; 3]>,
    triangle_material: Vec<u32>,
    /// Instanced meshes, in addition to [`Self::triangles`].
    models: Vec<WorldInstancedMesh>,
    /// Number of vertices and of triangles of the models.
    in_models: (usize, usize),
}

impl WorldMesh {
    /// True if the triangle is not degenerate to a line or a point.
    fn has_area([a, b, c]: [DVec3; 3]) -> bool {
        let (ab, ac, bc) = (b - a, c - a, c - b);
        let longest = ab.length_squared().max(ac.length_squared()).max(bc.length_squared());
        ab.cross(ac).length() > 1e-9 * longest
    }

    /// True if a triangle of this mesh is not degenerate.
    fn is_triangle(&self, t: &[u32; 3]) -> bool {
        Self::has_area(t.map(|i| self.positions[i as usize]))
    }

    /// Least and greatest corner of the non-degenerate triangles, without models; `None` without triangles.
    fn bounds(&self) -> Option<[DVec3; 2]> {
        self.corners().map(|p| [p, p]).reduce(|[low, high], [p, _]| [low.min(p), high.max(p)])
    }

    /// Corners of the non-degenerate triangles, without models.
    fn corners(&self) -> impl Iterator<Item = DVec3> + '_ {
        let triangles = self.triangles.iter().filter(|t| self.is_triangle(t));
        triangles.flat_map(|t| t.map(|i| self.positions[i as usize]))
    }

    /// Moves the origin to the centre of the main part, where f32 is most precise, and drops degenerate triangles and
    /// unused vertices.
    fn finish(mut self, scene: &mut Scene) {
        let mut models = std::mem::take(&mut self.models);
        models.retain(|model| {
            let is_seen = model.mesh.bounds().is_some();
            if !is_seen {
                scene.degenerate_triangles += model.mesh.triangles.len() * model.world_from_model.len();
            }
            is_seen
        });
        let boxes: Vec<[DVec3; 2]> = models.iter().flat_map(WorldInstancedMesh::boxes).collect();
        let bounds = self.bounds().into_iter().chain(boxes.iter().copied());
        let bounds = bounds.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]);
        let main = detail::main_part(&self.corners().chain(boxes.into_iter().flatten()).collect::<Vec<_>>());
        let origin = main.or(bounds).map_or(DVec3::ZERO, |[low, high]| (low + high) * 0.5);
        scene.origin = origin.to_array();
        let mut colors = Vec::new();
        self.append(scene, origin, &mut colors);
        for WorldInstancedMesh { mesh, world_from_model } in models {
            let copies = world_from_model.len().saturating_sub(1);
            let (first_triangle, first_vertex) = (scene.triangles.len() as u32, scene.positions.len());
            let degenerate = scene.degenerate_triangles;
            mesh.append(scene, DVec3::ZERO, &mut colors);
            scene.degenerate_triangles += copies * (scene.degenerate_triangles - degenerate);
            let (low, high) = bounds_of(&scene.positions[first_vertex..]);
            let local = |place: &DAffine3| -> Affine3A {
                let place = DAffine3 { translation: place.translation - origin, ..*place };
                let [x, y, z, at] = place.to_cols_array_2d().map(|column| column.map(|x| x as f32));
                Affine3A::from_cols_array_2d(&[x, y, z, at])
            };
            scene.models.push(InstancedMesh {
                triangles: first_triangle..scene.triangles.len() as u32,
                vertices: first_vertex as u32..scene.positions.len() as u32,
                local_from_model: world_from_model.iter().map(local).collect(),
                bounds: [low, high],
            });
        }
        scene.repair_normals();
        if !colors.is_empty() {
            colors.resize(scene.positions.len(), Vec4::ONE);
        }
        colours::apply(scene, &colors);
    }

    /// Appends the non-degenerate triangles, without models, to a scene.
    fn append(self, scene: &mut Scene, origin: DVec3, colors: &mut Vec<Vec4>) {
        let mut used = vec![u32::MAX; self.positions.len()];
        if !self.colors.is_empty() {
            colors.resize(scene.positions.len(), Vec4::ONE);
        }
        for (t, &material) in self.triangles.iter().zip(&self.triangle_material) {
            if !self.is_triangle(t) {
                scene.degenerate_triangles += 1;
                continue;
            }
            let local = t.map(|i| {
                let slot = &mut used[i as usize];
                if *slot == u32::MAX {
                    *slot = scene.positions.len() as u32;
                    scene.positions.push((self.positions[i as usize] - origin).as_vec3());
                    scene.normals.push(self.normals[i as usize]);
                    scene.uvs.push(self.uvs[i as usize]);
                    if !self.colors.is_empty() {
                        colors.push(self.colors.get(i as usize).copied().unwrap_or(Vec4::ONE));
                    }
                }
                *slot
            });
            scene.triangles.push(local);
            scene.triangle_material.push(material);
        }
    }
}

impl Scene {
    /// Replaces every unusable vertex normal by the area-weighted mean of the adjacent triangles' normals.
    fn repair_normals(&mut self) {
        let usable = |n: &Vec3| n.is_finite() && n.length_squared() > 0.5;
        if self.normals.iter().all(usable) {
            return;
        }
        let mut sums = vec![Vec3::ZERO; self.positions.len()];
        for t in &self.triangles {
            let [a, b, c] = t.map(|i| self.positions[i as usize]);
            for &i in t {
                sums[i as usize] += (b - a).cross(c - a);
            }
        }
        for (normal, sum) in self.normals.iter_mut().zip(sums) {
            if !usable(normal) {
                *normal = (sum * (1.0 / sum.abs().max_element().max(f32::MIN_POSITIVE)))
                    .try_normalize()
                    .unwrap_or(Vec3::Y);
            }
        }
    }
}
