//! A scene in memory, from glTF 2.0 or generated.
//!
//! * [`load`] – from a .gltf or .glb file, or `builtin:NAME`;
//! * [`builtin`] – the generated scenes;
//! * [`texture`] – pictures and how they are sampled; `basis` – those of Basis Universal;
//! * `colours` – colours of vertices.

mod basis;
pub mod builtin;
mod colours;
mod error;
mod gltf;
pub mod texture;

pub use error::SceneError;
pub use texture::Texture;

use glam::{DVec3, Vec2, Vec3, Vec4};
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
    /// World space = local space + origin: the centre of the world-space bounds.
    pub origin: [f64; 3],
    /// Vertices, local space.
    pub positions: Vec<Vec3>,
    /// Unit shading normals, one per vertex.
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
    /// Materials that the triangles use.
    pub materials: Vec<Material>,
    /// Textures that the materials use.
    pub textures: Vec<Texture>,
    /// The scene's own lights, world space.
    pub lights: Vec<Light>,
    /// The scene's own cameras, world space; may be empty.
    pub cameras: Vec<Camera>,
    /// How the scene's own lights move.
    pub animations: Vec<Animation>,
    /// What of the file is not taken over because it cannot be used; each names what and why.
    pub left_out: Vec<String>,
    /// Triangles without area that were left out.
    pub degenerate_triangles: usize,
}

/// Loads a scene: the path of a .gltf or .glb file, or `builtin:NAME`.
///
/// # Errors
/// [`SceneError`], which names the file and says what to do.
pub fn load(spec: &str) -> Result<Scene, SceneError> {
    match spec.strip_prefix("builtin:") {
        Some(name) => builtin::load(name),
        None => gltf::load(Path::new(spec)),
    }
}

/// Loads a scene from the bytes of a .gltf or .glb file. `name` is what errors call it, and what the scene is called;
/// files that it refers to are looked for in the working directory.
///
/// # Errors
/// [`SceneError`].
pub fn from_bytes(name: &str, bytes: &[u8]) -> Result<Scene, SceneError> {
    gltf::from_bytes(name, bytes)
}

impl Scene {
    /// Least and greatest corner, local space; both zero without vertices.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        bounds(&self.positions)
    }
}

/// Least and greatest corner; both zero without points.
pub(crate) fn bounds(positions: &[Vec3]) -> (Vec3, Vec3) {
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
}

impl WorldMesh {
    /// Whether a triangle is more than a line or a point.
    fn has_area([a, b, c]: [DVec3; 3]) -> bool {
        let (ab, ac, bc) = (b - a, c - a, c - b);
        let longest = ab.length_squared().max(ac.length_squared()).max(bc.length_squared());
        ab.cross(ac).length() > 1e-9 * longest
    }

    /// Moves the origin into the middle, where f32 is most exact, and leaves out triangles
    /// without area and vertices that no triangle uses.
    fn finish(self, scene: &mut Scene) {
        let mut used = vec![u32::MAX; self.positions.len()];
        let area = |t: &[u32; 3]| Self::has_area(t.map(|i| self.positions[i as usize]));
        let mut colors = Vec::new();
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for t in self.triangles.iter().filter(|t| area(t)) {
            for &i in t {
                low = low.min(self.positions[i as usize]);
                high = high.max(self.positions[i as usize]);
            }
        }
        let origin = if low.x <= high.x { (low + high) * 0.5 } else { DVec3::ZERO };
        scene.origin = origin.to_array();
        for (t, &material) in self.triangles.iter().zip(&self.triangle_material) {
            if !area(t) {
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
        scene.repair_normals();
        colours::apply(scene, &colors);
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
