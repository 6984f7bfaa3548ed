//! A scene in memory. Touches no files: [`io`](crate::io) reads glTF, [`demo`](crate::demo) generates scenes.
//!
//! * [`world_mesh`] – world-space triangles, before conversion into a [`Scene`];
//! * [`texture`] – pictures and their sampling; `basis_universal` – Basis Universal pictures; `foreign` – pictures of
//!   formats outside glTF; `orientation` – picture rotations in Exif metadata;
//! * [`model`] – instanced meshes; [`brep`] – exact faces; [`assembly`] – scenes from CAD assemblies;
//! * [`rig`] – meshes that animations deform;
//! * `join` – a scene put into another; [`material_look`] – looks by name; `colours` – vertex colours; `emissive` – groups of emissive surfaces; [`groups`] – reconstruction groups;
//! * [`detail`] – the main part, with nearly all of the detail; [`outliers`] – outliers far from the rest.

pub mod assembly;
mod basis_universal;
pub mod brep;
mod colours;
pub mod detail;
mod emissive;
mod error;
mod foreign;
pub mod groups;
mod join;
pub mod material_look;
pub mod model;
pub(crate) mod needed;
mod orientation;
pub mod outliers;
pub mod rig;
pub(crate) mod steps;
pub mod texture;
mod texture_size;
pub mod world_mesh;

pub use emissive::emissive_groups;
pub use error::SceneError;
pub use model::InstancedMesh;
pub use texture::Texture;

use brep::Brep;
use glam::{Vec2, Vec3};
use rebounce_shared::camera::Camera;
use rebounce_shared::environment::Environment;
use rebounce_shared::light::Light;
use rebounce_shared::rbn::groups::Groups;
use rebounce_shared::rbn::meta::{Animation, Material};
use rebounce_shared::rig::Rig;
use std::sync::Arc;

/// Maximum number of vertices, and of triangles, of a scene. A larger scene and its bake exceed the memory of usual
/// machines, and ray traversal numbers triangles in 28 bits.
pub const MOST: usize = 1 << 28;

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
    /// Exact faces that rays meet instead of their tessellation among the triangles; `None` without CAD parts.
    pub brep: Option<Arc<Brep>>,
    /// Materials of the triangles.
    pub materials: Vec<Material>,
    /// Names of groups of shining surfaces, one per material; `None`, and beyond the list, the material is a group.
    pub light_groups: Vec<Option<String>>,
    /// Reconstruction groups, and the nodes that may move; each group's materials are its own.
    pub groups: Groups,
    /// Meshes that animations deform; the vertices above have them at rest. [`RigVertex::vertex`] is a vertex of the scene, of
    /// triangles without instances.
    ///
    /// [`RigVertex::vertex`]: rebounce_shared::rig::RigVertex::vertex
    pub rig: Rig,
    /// Textures of the materials.
    pub textures: Vec<Texture>,
    /// The scene's own lights, world space.
    pub lights: Vec<Light>,
    /// The scene's own cameras, world space; may be empty.
    pub cameras: Vec<Camera>,
    /// Picture of the environment lights; `None` for an even white.
    pub environment: Option<Arc<Environment>>,
    /// Whether surfaces with emission are shown bright, but light nothing.
    pub emission_is_shown_only: bool,
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

/// Triangles without instances, local space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh {
    /// Vertices.
    pub positions: Vec<Vec3>,
    /// Unit shading normals, one per vertex.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, one per vertex; may be empty.
    pub uvs: Vec<Vec2>,
    /// Vertex indices, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// Index of the material, one per triangle.
    pub triangle_material: Vec<u32>,
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

    /// Returns this scene with other triangles in the place of its own. They do not deform, and a note says so where the scene's
    /// do.
    pub fn with_triangles(&self, mesh: TriangleMesh) -> Self {
        let TriangleMesh { positions, normals, mut uvs, triangles, triangle_material } = mesh;
        uvs.resize(positions.len(), Vec2::ZERO);
        let mut notes = self.notes.clone();
        if !self.rig.is_empty() {
            notes.push(rig::STILL.to_owned());
        }
        Self {
            positions,
            normals,
            uvs,
            triangles,
            triangle_material,
            corner_colors: Vec::new(),
            models: Vec::new(),
            brep: None,
            rig: Rig::default(),
            notes,
            ..self.clone()
        }
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
