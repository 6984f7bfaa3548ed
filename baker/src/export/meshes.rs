//! The triangles of a baked scene as meshes for export.
//!
//! The static triangles are a mesh, each model is one, with the transforms of its copies. The back of a two-sided
//! material is a mesh of its own, turned over: it has light of its own.

use glam::{Affine3A, Mat3, UVec2, Vec2, Vec3};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::octahedral;
use rebounce_shared::rbn::bulk::Instance;
use std::collections::HashMap;
use std::ops::Range;

/// A mesh, and where it stands.
#[derive(Clone, Debug, Default)]
pub struct ExportMesh {
    /// Positions of the vertices: local space, of a model model space. All triangles of a vertex have one material.
    pub positions: Vec<[f32; 3]>,
    /// Unit shading normals, on the side of the triangles' fronts where the scene has them there.
    pub normals: Vec<Vec3>,
    /// Texture coordinates of the base colour.
    pub uvs: Vec<[f32; 2]>,
    /// By vertex, the place in the file's lightmap, texels, without the offset of the copy; `None` without a chart.
    pub lightmap: Vec<Option<Vec2>>,
    /// By copy, where the charts of this side are in the lightmap, texels; zeros without a lightmap.
    pub chart_offsets: Vec<UVec2>,
    /// Vertices of each triangle, counter-clockwise from the front.
    pub triangles: Vec<[u32; 3]>,
    /// Material of each triangle; triangles of one material are consecutive.
    pub materials: Vec<u32>,
    /// Reconstruction group of each triangle.
    pub groups: Vec<u32>,
    /// Transform of each copy; one identity for the static triangles.
    pub local_from_model: Vec<Affine3A>,
    /// Whether it is a model with copies.
    pub is_model: bool,
}

/// A triangle in local space.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceTriangle {
    /// Corners.
    pub positions: [Vec3; 3],
    /// Shading normals at the corners, not normalised.
    pub normals: [Vec3; 3],
    /// Texture coordinates at the corners.
    pub uvs: [Vec2; 3],
    /// Index of the material.
    pub material: u32,
    /// Reconstruction group.
    pub group: u32,
    /// Corners in the file's lightmap, texels; `None` without a chart.
    pub lightmap: Option<[Vec2; 3]>,
}

impl SurfaceTriangle {
    /// Returns a normal vector on the front; the length is twice the area.
    pub fn front(&self) -> Vec3 {
        let [a, b, c] = self.positions;
        (b - a).cross(c - a)
    }

    /// Returns the area, square scene units.
    pub fn area(&self) -> f32 {
        0.5 * self.front().length()
    }

    /// Returns the share of the texture that a surface of this area covers.
    pub fn share(&self, area: f32) -> f32 {
        let [a, b, c] = self.uvs;
        let in_texture = 0.5 * (b - a).perp_dot(c - a).abs();
        let own = self.area();
        if own > 0.0 { in_texture * area / own } else { 0.0 }
    }
}

impl ExportMesh {
    /// Number of triangles, each copy counted.
    pub fn triangles_placed(&self) -> u64 {
        self.triangles.len() as u64 * self.local_from_model.len() as u64
    }

    /// Returns a triangle of a copy.
    pub fn triangle(&self, copy: usize, triangle: usize) -> SurfaceTriangle {
        let place = &self.local_from_model[copy];
        let vertices = self.triangles[triangle].map(|v| v as usize);
        let normal_from_model = Mat3::from(place.matrix3).inverse().transpose();
        let normal =
            |v: usize| if self.is_model { normal_from_model * self.normals[v] } else { self.normals[v] };
        SurfaceTriangle {
            positions: vertices.map(|v| place.transform_point3(self.positions[v].into())),
            normals: vertices.map(|v| normal(v).normalize_or_zero()),
            uvs: vertices.map(|v| self.uvs[v].into()),
            material: self.materials[triangle],
            group: self.groups[triangle],
            lightmap: self.lightmap_corners(vertices).map(|corners| {
                let offset = self.chart_offsets[copy].as_vec2();
                corners.map(|corner| corner + offset)
            }),
        }
    }

    /// Vertices in the file's lightmap, texels, without the offset of a copy.
    fn lightmap_corners(&self, vertices: [usize; 3]) -> Option<[Vec2; 3]> {
        let [a, b, c] = vertices.map(|v| self.lightmap[v]);
        Some([a?, b?, c?])
    }

    /// Returns the scale of each copy: the cube root of how much it grows a volume.
    pub fn scales(&self) -> Vec<f32> {
        self.local_from_model.iter().map(|place| place.matrix3.determinant().abs().cbrt()).collect()
    }

    /// Returns the runs of triangles of one material: the material and the range.
    pub fn runs(&self) -> Vec<(u32, Range<usize>)> {
        let mut out: Vec<(u32, Range<usize>)> = Vec::new();
        for (i, material) in self.materials.iter().enumerate() {
            match out.last_mut() {
                Some((last, range)) if last == material => range.end = i + 1,
                _ => out.push((*material, i..i + 1)),
            }
        }
        out
    }
}

/// A mesh that grows, with the vertices taken so far.
#[derive(Default)]
struct Growing {
    mesh: ExportMesh,
    /// By vertex of the scene and material: a vertex has one material.
    taken: HashMap<(u32, u32), u32>,
    is_back: bool,
}

impl Growing {
    fn new(local_from_model: Vec<Affine3A>, is_model: bool, is_back: bool) -> Self {
        let mesh = ExportMesh { local_from_model, is_model, ..ExportMesh::default() };
        Self { mesh, taken: HashMap::new(), is_back }
    }

    fn vertex(&mut self, scene: &BakedScene, index: u32, material: u32) -> u32 {
        let Self { mesh, taken, is_back } = self;
        *taken.entry((index, material)).or_insert_with(|| {
            let vertex = &scene.vertices[index as usize];
            let normal = octahedral::unpack_snorm16(vertex.normal);
            mesh.positions.push(vertex.position);
            mesh.normals.push(if *is_back { -normal } else { normal });
            mesh.uvs.push(vertex.uv);
            let texels = scene.lightmap.coordinates.get(index as usize);
            mesh.lightmap.push(texels.and_then(|at| at.texels()));
            mesh.positions.len() as u32 - 1
        })
    }

    fn add(&mut self, scene: &BakedScene, triangle: [u32; 3], material: u32) {
        let [a, b, c] = triangle.map(|index| self.vertex(scene, index, material));
        self.mesh.triangles.push(if self.is_back { [a, c, b] } else { [a, b, c] });
        self.mesh.materials.push(material);
        self.mesh.groups.push(scene.groups.of_material(material));
    }
}

/// Returns the meshes of a scene: static triangles first, then the models, each front before back. A mesh without
/// triangles is left out.
pub fn meshes(scene: &BakedScene) -> Vec<ExportMesh> {
    let mut out: Vec<ExportMesh> = Vec::new();
    let draws = || scene.meta.draws.iter().enumerate();
    let mut copies = Vec::from([Range { start: 0, end: 0 }]);
    for range in draws().map(|(i, _)| scene.copies_of(i)).filter(|range| !range.is_empty()) {
        if !copies.contains(&range) {
            copies.push(range);
        }
    }
    for range in copies {
        let places: Vec<Affine3A> = match range.is_empty() {
            true => vec![Affine3A::IDENTITY],
            false => scene.instances[range.clone()].iter().map(Instance::local_from_model).collect(),
        };
        let mut sides = [false, true].map(|back| {
            let mut side = Growing::new(places.clone(), !range.is_empty(), back);
            let offsets = scene.lightmap.offsets_of(range.clone());
            let offset = |copy: usize| offsets.get(copy).map(|one| one.of_side(back));
            side.mesh.chart_offsets =
                (0..places.len()).map(|copy| offset(copy).unwrap_or_default()).collect();
            side
        });
        let is_of_these = |i: usize| {
            let own = scene.copies_of(i);
            own == range || own.is_empty() && range.is_empty()
        };
        let mut own: Vec<_> = draws().filter(|(i, _)| is_of_these(*i)).map(|(_, draw)| draw).collect();
        own.sort_by_key(|draw| draw.material);
        for draw in own {
            let is_two_sided = scene.meta.materials[draw.material as usize].double_sided;
            let indices = draw.first_index as usize..(draw.first_index + draw.index_count) as usize;
            for triangle in scene.indices[indices].as_chunks::<3>().0 {
                sides[0].add(scene, *triangle, draw.material);
                if is_two_sided {
                    sides[1].add(scene, *triangle, draw.material);
                }
            }
        }
        let sides = sides.into_iter().map(|side| side.mesh);
        out.extend(sides.filter(|mesh| !mesh.triangles.is_empty()));
    }
    out
}
