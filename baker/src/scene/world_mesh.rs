//! World-space triangles of a file or a generator, and their conversion into a scene's local space.

use super::model::bounds_of_placed;
use super::rig::UNUSED;
use super::{InstancedMesh, Scene, bounds_of, colours, detail, rig};
use glam::{Affine3A, DAffine3, DVec3, Vec2, Vec3, Vec4};
use rebounce_shared::rig::Rig;

/// World-space vertices and triangles, before conversion into a [`Scene`].
#[derive(Default)]
pub struct WorldMesh {
    /// Vertices, world space.
    pub positions: Vec<DVec3>,
    /// Unit shading normals, one per vertex; an unusable normal is replaced by the mean of its triangles'.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, one per vertex.
    pub uvs: Vec<Vec2>,
    /// Linear RGB and alpha; vertices beyond the end are white.
    pub colors: Vec<Vec4>,
    /// Vertex indices, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// Index of the material, one per triangle.
    pub triangle_material: Vec<u32>,
    /// [Group of nodes](super::groups::NodeGroups) of each triangle; those beyond the end have none.
    pub triangle_group: Vec<u32>,
    /// Meshes that animations deform, among the vertices above. The first of its nodes is the world; it has no bounds yet.
    pub rig: Rig,
    /// Instanced meshes, in addition to [`Self::triangles`].
    pub models: Vec<WorldInstancedMesh>,
    /// Number of vertices and of triangles of the models.
    pub in_models: (usize, usize),
}

impl WorldMesh {
    /// True if the triangle is not degenerate to a line or a point.
    pub fn has_area([a, b, c]: [DVec3; 3]) -> bool {
        let (ab, ac, bc) = (b - a, c - a, c - b);
        let longest = ab.length_squared().max(ac.length_squared()).max(bc.length_squared());
        ab.cross(ac).length() > 1e-9 * longest
    }

    /// True if a triangle of this mesh is not degenerate.
    pub fn is_triangle(&self, t: &[u32; 3]) -> bool {
        Self::has_area(t.map(|i| self.positions[i as usize]))
    }

    /// Least and greatest corner of the non-degenerate triangles, without models; `None` without triangles.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        self.corners().map(|p| [p, p]).reduce(|[low, high], [p, _]| [low.min(p), high.max(p)])
    }

    /// Corners of the non-degenerate triangles, without models.
    pub fn corners(&self) -> impl Iterator<Item = DVec3> + '_ {
        let triangles = self.triangles.iter().filter(|t| self.is_triangle(t));
        triangles.flat_map(|t| t.map(|i| self.positions[i as usize]))
    }

    /// Moves the origin to the centre of the main part, where f32 is most precise, and drops degenerate triangles and
    /// unused vertices.
    pub fn finish(mut self, scene: &mut Scene) {
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
        let rig = std::mem::take(&mut self.rig);
        let places = self.append(scene, origin, &mut colors);
        scene.rig = rig::placed(rig, &places, scene.positions.len(), origin).unwrap_or_else(|| {
            scene.notes.push(rig::STILL.to_owned());
            Rig::default()
        });
        for WorldInstancedMesh { mesh, world_from_model, group: _ } in models {
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

    /// Appends the non-degenerate triangles, without models, to a scene. Returns the number of each vertex in the scene, or
    /// [`UNUSED`].
    pub fn append(self, scene: &mut Scene, origin: DVec3, colors: &mut Vec<Vec4>) -> Vec<u32> {
        let mut used = vec![UNUSED; self.positions.len()];
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
                if *slot == UNUSED {
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
        used
    }
}

/// A model before conversion into a [`Scene`].
#[derive(Default)]
pub struct WorldInstancedMesh {
    /// Mesh in model space.
    pub mesh: WorldMesh,
    /// Transforms of the instances.
    pub world_from_model: Vec<DAffine3>,
    /// [Group of nodes](super::groups::NodeGroups); 0 for none.
    pub group: u32,
}

impl WorldInstancedMesh {
    /// Least and greatest corner of each instance's box, world space.
    pub fn boxes(&self) -> impl Iterator<Item = [DVec3; 2]> + '_ {
        let bounds = self.mesh.bounds().unwrap_or_default();
        self.world_from_model.iter().map(move |place| bounds_of_placed(place, bounds))
    }
}
