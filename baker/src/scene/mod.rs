//! A scene in memory, from glTF 2.0 or generated.
//!
//! * [`load`] – from a .gltf or .glb file, or `builtin:NAME`;
//! * [`builtin`] – the generated scenes;
//! * [`texture`] – pictures and how they are sampled; `basis` – those of Basis Universal; `foreign` – those
//!   of formats that glTF does not have; `orientation` – turns that their metadata ask for;
//! * [`model`] – what stands in a scene many times;
//! * `colours` – colours of vertices; `merge` – materials that look alike; `notes` – what is said about a file;
//! * `other_format` – files that are no glTF, and how they become it;
//! * [`detail`] – the part that has the detail; [`far`] – what lies far away from the rest.

mod basis;
pub mod builtin;
mod colours;
pub mod detail;
mod error;
pub mod far;
mod foreign;
mod gltf;
mod merge;
pub mod model;
pub(crate) mod needed;
mod notes;
mod orientation;
mod other_format;
pub(crate) mod steps;
pub mod texture;
mod texture_size;

pub use error::SceneError;
pub use model::Model;
pub use texture::Texture;

use glam::{Affine3A, DAffine3, DVec3, Vec2, Vec3, Vec4};
use model::WorldModel;
use rebounce_shared::camera::Camera;
use rebounce_shared::light::Light;
use rebounce_shared::rbn::meta::{Animation, Material};
use std::path::Path;

/// Vertices, and triangles, of a scene at most: more would not fit into most machines' memory with what a bake makes of
/// them, and what rays walk through numbers triangles in 28 bits.
pub(crate) const MOST: usize = 1 << 28;

/// A scene in memory.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// What to call it: the file's name without its ending.
    pub name: String,
    /// World space = local space + origin: the centre of the world-space bounds, or of the [part](detail) that has the
    /// detail where that is far smaller.
    pub origin: [f64; 3],
    /// Vertices, local space; those of [`Self::models`] come last, in the models' spaces.
    pub positions: Vec<Vec3>,
    /// Unit shading normals, one per vertex, in the same space.
    pub normals: Vec<Vec3>,
    /// Texture coordinates of the base-colour texture, its transform applied, one per vertex.
    pub uvs: Vec<Vec2>,
    /// Vertex indices, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// Index of the material, one per triangle.
    pub triangle_material: Vec<u32>,
    /// Linear RGB albedo at each triangle's corners, in place of the material's base colour and multiplied with its
    /// texture's; empty where no vertex has a colour of its own.
    pub corner_colors: Vec<[Vec3; 3]>,
    /// What stands in the scene more than once, in the order of their vertices and triangles, which are the last ones.
    pub models: Vec<Model>,
    /// Materials that the triangles use.
    pub materials: Vec<Material>,
    /// Textures that the materials use.
    pub textures: Vec<Texture>,
    /// The scene's own lights, world space.
    pub lights: Vec<Light>,
    /// The scene's own cameras, world space; may be empty.
    pub cameras: Vec<Camera>,
    /// The lights' names; fewer, or empty ones, where they have none.
    pub light_names: Vec<String>,
    /// The cameras' names, likewise.
    pub camera_names: Vec<String>,
    /// How the scene's own lights move.
    pub animations: Vec<Animation>,
    /// What of the file is not taken over because it cannot be used; each names what and why.
    pub left_out: Vec<String>,
    /// What of the file is read otherwise than it is written, or is likely not meant; each names what and why.
    pub notes: Vec<String>,
    /// Triangles without area that were left out.
    pub degenerate_triangles: usize,
}

/// Loads a scene: the path of a .gltf or .glb file, or `builtin:NAME`.
///
/// # Errors
/// [`SceneError`], which names the file and says what to do.
pub fn load(spec: &str) -> Result<Scene, SceneError> {
    load_with(spec, &LoadOptions::default())
}

/// What of a file is loaded, and how.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadOptions {
    /// The glTF scene that is taken, by its name or number; the file's default when absent.
    pub scene: Option<String>,
    /// Linear RGB albedo of meshes without a material; glTF's default, 1, when absent.
    pub albedo: Option<[f32; 3]>,
}

/// [`load`] with options. A built-in scene is one scene, and all its meshes have materials.
///
/// # Errors
/// [`SceneError`], which names the file and says what to do.
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

/// Said where an albedo for meshes without a material is given and none is used.
const UNUSED_ALBEDO: &str = "--albedo changes nothing: all meshes have materials";

/// Loads a scene from the bytes of a .gltf or .glb file. `name` is what errors call it, and what the scene is called;
/// files that it refers to are looked for in the working directory.
///
/// # Errors
/// [`SceneError`].
pub fn from_bytes(name: &str, bytes: &[u8]) -> Result<Scene, SceneError> {
    gltf::from_bytes(name, bytes)
}

impl Scene {
    /// Least and greatest corner, local space, of models' copies their boxes'; both zero without vertices.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let end = self.models.first().map_or(self.positions.len(), |model| model.vertices.start as usize);
        let alone = (end > 0).then(|| bounds_of(&self.positions[..end]));
        let copies = self.models.iter().flat_map(Model::boxes);
        alone.into_iter().chain(copies).reduce(union).unwrap_or_default()
    }

    /// Least and greatest corner of the [part](detail::main_part) that has the detail, local space; the
    /// [bounds](Self::bounds) where no part has.
    pub fn main_part(&self) -> (Vec3, Vec3) {
        let first = self.models.first().map_or(self.triangles.len(), |model| model.triangles.start as usize);
        let corners = self.triangles[..first].iter().flatten().map(|i| self.positions[*i as usize]);
        let copies = self.models.iter().flat_map(Model::boxes).flat_map(|(low, high)| [low, high]);
        detail::part_of(corners.chain(copies)).unwrap_or_else(|| self.bounds())
    }

    /// Number of triangles that stand in the scene, each copy of a model's counted.
    pub fn triangles_placed(&self) -> u64 {
        let more = |model: &Model| {
            model.triangles.len() as u64 * (model.local_from_model.len() as u64).saturating_sub(1)
        };
        self.triangles.len() as u64 + self.models.iter().map(more).sum::<u64>()
    }

    /// Number of the models' instances.
    pub fn instances(&self) -> usize {
        self.models.iter().map(|model| model.local_from_model.len()).sum()
    }
}

/// The least box around two.
pub(crate) fn union((a, b): (Vec3, Vec3), (c, d): (Vec3, Vec3)) -> (Vec3, Vec3) {
    (a.min(c), b.max(d))
}

/// Least and greatest corner; both zero without points.
pub(crate) fn bounds_of(positions: &[Vec3]) -> (Vec3, Vec3) {
    let Some(&first) = positions.first() else {
        return (Vec3::ZERO, Vec3::ZERO);
    };
    positions.iter().fold((first, first), |(low, high), &p| (low.min(p), high.max(p)))
}

/// Vertices in world space and triangles over them, on the way to a [`Scene`].
#[derive(Default)]
struct WorldMesh {
    positions: Vec<DVec3>,
    normals: Vec<Vec3>,
    uvs: Vec<Vec2>,
    /// Linear RGB and alpha; those beyond its end are white.
    colors: Vec<Vec4>,
    triangles: Vec<[u32; 3]>,
    triangle_material: Vec<u32>,
    /// What stands there more than once, besides.
    models: Vec<WorldModel>,
    /// Vertices and triangles of the models.
    in_models: (usize, usize),
}

impl WorldMesh {
    /// Whether a triangle is more than a line or a point.
    fn has_area([a, b, c]: [DVec3; 3]) -> bool {
        let (ab, ac, bc) = (b - a, c - a, c - b);
        let longest = ab.length_squared().max(ac.length_squared()).max(bc.length_squared());
        ab.cross(ac).length() > 1e-9 * longest
    }

    /// Whether a triangle of this mesh is one.
    fn is_triangle(&self, t: &[u32; 3]) -> bool {
        Self::has_area(t.map(|i| self.positions[i as usize]))
    }

    /// Least and greatest corner of its triangles, those of models left out; `None` without any.
    fn bounds(&self) -> Option<[DVec3; 2]> {
        self.corners().map(|p| [p, p]).reduce(|[low, high], [p, _]| [low.min(p), high.max(p)])
    }

    /// The corners of its triangles, those of models left out.
    fn corners(&self) -> impl Iterator<Item = DVec3> + '_ {
        let triangles = self.triangles.iter().filter(|t| self.is_triangle(t));
        triangles.flat_map(|t| t.map(|i| self.positions[i as usize]))
    }

    /// Moves the origin into the middle of the detail, where f32 is most exact, and leaves out triangles
    /// without area and vertices that no triangle uses.
    fn finish(mut self, scene: &mut Scene) {
        let mut models = std::mem::take(&mut self.models);
        models.retain(|model| {
            let is_seen = model.mesh.bounds().is_some();
            if !is_seen {
                scene.degenerate_triangles += model.mesh.triangles.len() * model.world_from_model.len();
            }
            is_seen
        });
        let boxes: Vec<[DVec3; 2]> = models.iter().flat_map(WorldModel::boxes).collect();
        let bounds = self.bounds().into_iter().chain(boxes.iter().copied());
        let bounds = bounds.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]);
        let main = detail::main_part(&self.corners().chain(boxes.into_iter().flatten()).collect::<Vec<_>>());
        let origin = main.or(bounds).map_or(DVec3::ZERO, |[low, high]| (low + high) * 0.5);
        scene.origin = origin.to_array();
        let mut colors = Vec::new();
        self.append(scene, origin, &mut colors);
        for WorldModel { mesh, world_from_model } in models {
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
            scene.models.push(Model {
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

    /// Adds its triangles, those of models left out, to a scene.
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
    /// Vertices without a usable normal get the area-weighted mean of their triangles' normals.
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
