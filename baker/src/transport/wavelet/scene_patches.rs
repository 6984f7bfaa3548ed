//! Patches of a scene: its exact faces, and its triangles put together to [complex polygons](super::complex_polygons()).

use super::WaveletPatch;
use super::complex_polygons::complex_polygons;
use super::patch::{keeps_proportions, normal_from_part};
use crate::geometry::brep::BrepSurfaces;
use crate::geometry::mesh::geometry::Surface;
use crate::scene::Scene;
use crate::scene::brep::{Brep, BrepFace, BrepInstance};
use glam::{Affine3A, DAffine3, DMat3, DVec2, DVec3, Vec3};
use rayon::prelude::*;
use rebounce_cad::face::Face;
use rebounce_cad::virtual_mesh::{VirtualMesh, VirtualMeshError};
use rebounce_shared::rbn::sources::EmissiveGroup;
use std::ops::Range;
use std::sync::Arc;

/// How far from a point its patch is looked for, in multiples of the surfaces' offset of ray origins: the first that succeeds.
const REACHES: [f32; 3] = [4.0, 40.0, 400.0];

/// Patches of a scene, and which one a point lies on.
pub struct ScenePatches {
    /// Virtual meshes by face; `None` for faces that cannot be mapped.
    meshes: Vec<Option<Arc<VirtualMesh>>>,
    brep: Arc<Brep>,
    surfaces: BrepSurfaces,
    /// By patch: instance, face, and whether it is the back.
    patches: Vec<(u32, u32, bool)>,
    /// By instance, the first patch of each face: front, then back.
    firsts: Vec<Vec<Option<u32>>>,
    /// The scene's materials.
    looks: Vec<Surface>,
    /// Mean linear RGB reflectance, and emitted radiance, by material.
    materials: Vec<(Vec3, Vec3)>,
    /// Faces that cannot be mapped: they neither shoot nor receive.
    pub unmapped: usize,
}

/// Place on a patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatchCoordinates {
    /// Index of the patch.
    pub patch: usize,
    /// Coordinates in its unit square.
    pub st: DVec2,
}

impl ScenePatches {
    /// Makes the patches; `None` if there are no faces, or the crate is built without exact faces. `epsilon` is the
    /// surfaces' offset of ray origins, scene units.
    pub fn new(scene: &Scene, epsilon: f32) -> Option<Self> {
        Self::by_maps(scene, epsilon, VirtualMesh::new)
    }

    /// The same by the surfaces' natural parameters, for comparison: see [`VirtualMesh::natural`].
    pub fn natural(scene: &Scene, epsilon: f32) -> Option<Self> {
        Self::by_maps(scene, epsilon, VirtualMesh::natural)
    }

    fn by_maps(
        scene: &Scene,
        epsilon: f32,
        map: impl Fn(&Face) -> Result<VirtualMesh, VirtualMeshError> + Sync,
    ) -> Option<Self> {
        let brep = Arc::new(all_faces(scene));
        let surfaces = BrepSurfaces::new(&brep, &vec![true; scene.materials.len()], epsilon)?;
        let mesh = |face: &BrepFace| map(&face.face).ok().map(Arc::new);
        let meshes: Vec<Option<Arc<VirtualMesh>>> = brep.faces.par_iter().map(mesh).collect();
        let (mut patches, mut firsts) = (Vec::new(), Vec::new());
        for (number, instance) in (0..).zip(&brep.instances) {
            let mut of_instance = Vec::new();
            for face in instance.faces.clone() {
                let mesh = meshes[face as usize].as_ref();
                let is_mapped =
                    mesh.is_some_and(|mesh| keeps_proportions(&instance.local_from_part, mesh.is_planar()));
                of_instance.push(is_mapped.then_some(patches.len() as u32));
                if is_mapped {
                    patches.push((number, face, false));
                    if scene.materials[brep.faces[face as usize].material as usize].double_sided {
                        patches.push((number, face, true));
                    }
                }
            }
            firsts.push(of_instance);
        }
        let unmapped = firsts.iter().flatten().filter(|first| first.is_none()).count();
        let looks = looks(scene);
        let materials = mean_looks(scene, &looks);
        Some(Self { looks, meshes, brep, surfaces, patches, firsts, materials, unmapped })
    }

    /// Number of patches: a two-sided face has two.
    pub fn count(&self) -> usize {
        self.patches.len()
    }

    /// Number of faces of all instances.
    pub fn faces(&self) -> usize {
        self.firsts.iter().map(Vec::len).sum()
    }

    /// The patches, whose emission is that of the groups, times the factor of each.
    pub fn with_emission(&self, groups: &[EmissiveGroup], factors: &[Vec3]) -> Vec<WaveletPatch> {
        let mut emission = vec![Vec3::ZERO; self.materials.len()];
        for (group, factor) in groups.iter().zip(factors) {
            for material in &group.materials {
                emission[*material as usize] = *factor * self.materials[*material as usize].1;
            }
        }
        let patch = |&(instance, face, is_back): &(u32, u32, bool)| {
            let material = self.brep.faces[face as usize].material as usize;
            Some(WaveletPatch {
                mesh: self.meshes[face as usize].clone()?,
                world_from_part: self.brep.instances[instance as usize].local_from_part,
                is_back,
                albedo: self.materials[material].0,
                emission: std::f32::consts::PI * emission[material],
            })
        };
        self.patches.iter().filter_map(patch).collect()
    }

    /// The patch at a point of a surface with this unit normal on its side, within reach of `epsilon` scene units.
    pub fn locate(&self, position: Vec3, normal: Vec3, epsilon: f32) -> Option<PatchCoordinates> {
        REACHES.iter().find_map(|reach| self.locate_within(position, normal, reach * epsilon))
    }

    fn locate_within(&self, position: Vec3, normal: Vec3, reach: f32) -> Option<PatchCoordinates> {
        let found = self.surfaces.locate(&self.looks, position + reach * normal, -normal, 2.0 * reach)?;
        let faces = &self.brep.instances[found.instance as usize].faces;
        let first = self.firsts[found.instance as usize][(found.face - faces.start) as usize]?;
        let has_back = self.patches.get(first as usize + 1).is_some_and(|patch| patch.2);
        let mesh = self.meshes[found.face as usize].as_ref()?;
        let patch = first as usize + usize::from(has_back && found.is_back);
        Some(PatchCoordinates { patch, st: mesh.square(found.at) })
    }
}

impl ScenePatches {
    /// The virtual mesh of a patch.
    pub fn mesh(&self, patch: usize) -> Option<&VirtualMesh> {
        let (_, face, _) = self.patches.get(patch)?;
        self.meshes[*face as usize].as_deref()
    }

    /// Area of the unit square of a patch, square scene units.
    pub fn area(&self, patch: usize) -> f64 {
        let (instance, ..) = self.patches[patch];
        let normal_from_part =
            normal_from_part(&self.brep.instances[instance as usize].local_from_part, false);
        let growth = |mesh: &VirtualMesh| (normal_from_part * mesh.normal(DVec2::splat(0.5))).length();
        self.mesh(patch).map_or(0.0, |mesh| growth(mesh) * mesh.area())
    }

    /// Position and unit normal, on its side, of a point of a patch, local space.
    pub fn point(&self, patch: usize, st: DVec2) -> [Vec3; 2] {
        let (instance, _, is_back) = self.patches[patch];
        let place = &self.brep.instances[instance as usize].local_from_part;
        let Some(mesh) = self.mesh(patch) else { return [Vec3::ZERO; 2] };
        let [position, normal] = mesh.point_and_normal(st);
        let normal = normal_from_part(place, is_back) * normal;
        [place.transform_point3(position).as_vec3(), normal.normalize_or_zero().as_vec3()]
    }

    /// The point of a patch's unit square at a position on it, local space, within `epsilon`: on a seam or at a pole, the one
    /// nearest to `st`.
    pub fn square_near(&self, patch: usize, position: Vec3, st: DVec2, epsilon: f32) -> DVec2 {
        let (instance, ..) = self.patches[patch];
        let part_from_local = self.brep.instances[instance as usize].local_from_part.inverse();
        let tolerance = f64::from(epsilon) * part_from_local.matrix3.determinant().abs().cbrt();
        let position = part_from_local.transform_point3(position.as_dvec3());
        self.mesh(patch).map_or(st, |mesh| mesh.square_near(position, st, tolerance))
    }
}

/// The exact faces of a scene, and its other triangles as planar faces.
fn all_faces(scene: &Scene) -> Brep {
    let is_exact = scene.is_exact();
    let mut all = Brep::default();
    if let Some(brep) = &scene.brep {
        all.faces.extend_from_slice(&brep.faces);
        // What shines is among the triangles, and not here.
        all.instances = split_at_others(brep, &is_exact);
    }
    let rest = scene.without_tessellation();
    let first = rest.models.first().map_or(rest.triangles.len(), |model| model.triangles.start as usize);
    add_polygons(&mut all, &rest, 0..first, &[DAffine3::IDENTITY]);
    for model in &rest.models {
        let range = model.triangles.start as usize..model.triangles.end as usize;
        let places: Vec<DAffine3> = model.local_from_model.iter().map(double).collect();
        add_polygons(&mut all, &rest, range, &places);
    }
    all
}

/// Instances without the faces that are not exact: a range for each run of exact ones.
fn split_at_others(brep: &Brep, is_exact: &[bool]) -> Vec<BrepInstance> {
    let mut out = Vec::new();
    for instance in &brep.instances {
        let mut begin = instance.faces.start;
        for face in instance.faces.clone() {
            if !is_exact[brep.faces[face as usize].material as usize] {
                if begin < face {
                    out.push(BrepInstance { faces: begin..face, ..instance.clone() });
                }
                begin = face + 1;
            }
        }
        if begin < instance.faces.end {
            out.push(BrepInstance { faces: begin..instance.faces.end, ..instance.clone() });
        }
    }
    out
}

fn double(place: &Affine3A) -> DAffine3 {
    let [x, y, z, at] = place.to_cols_array_2d().map(|column| DVec3::from(column.map(f64::from)));
    DAffine3 { matrix3: DMat3::from_cols(x, y, z), translation: at }
}

/// Adds the planar faces of some triangles at these places.
fn add_polygons(all: &mut Brep, scene: &Scene, range: Range<usize>, places: &[DAffine3]) {
    let positions: Vec<DVec3> = scene.positions.iter().map(|p| p.as_dvec3()).collect();
    let facing = |t: usize| facing_front(scene, t);
    let triangles: Vec<[u32; 3]> = range.clone().map(facing).collect();
    let faces = complex_polygons(&positions, &triangles, &scene.triangle_material[range]);
    let begin = all.faces.len() as u32;
    let prepared =
        faces.into_par_iter().filter_map(|(face, material): (Face, u32)| BrepFace::new(face, material).ok());
    all.faces.extend(prepared.collect::<Vec<_>>());
    let faces = begin..all.faces.len() as u32;
    if !faces.is_empty() {
        all.instances.extend(
            places.iter().map(|place| BrepInstance { faces: faces.clone(), local_from_part: *place }),
        );
    }
}

/// Corners of a triangle, counter-clockwise seen from the side of its shading normals.
fn facing_front(scene: &Scene, triangle: usize) -> [u32; 3] {
    let [i, j, k] = scene.triangles[triangle];
    let [a, b, c] = [i, j, k].map(|i| scene.positions[i as usize]);
    let normal: Vec3 = [i, j, k].map(|i| scene.normals[i as usize]).iter().sum();
    if (b - a).cross(c - a).dot(normal) < 0.0 { [i, k, j] } else { [i, j, k] }
}

/// The materials of a scene.
fn looks(scene: &Scene) -> Vec<Surface> {
    let texture = |t: u32| scene.textures[t as usize].sampler();
    scene.materials.iter().map(|m| Surface::new(m, texture)).collect()
}

/// Mean reflectance and emission of each material over its triangles, textures and vertex colours included.
fn mean_looks(scene: &Scene, surfaces: &[Surface]) -> Vec<(Vec3, Vec3)> {
    let mut sums = vec![(0.0f32, Vec3::ZERO, Vec3::ZERO); surfaces.len()];
    for (t, (corners, material)) in scene.triangles.iter().zip(&scene.triangle_material).enumerate() {
        let surface = &surfaces[*material as usize];
        let [a, b, c] = corners.map(|i| scene.positions[i as usize]);
        let [p, q, r] = corners.map(|i| scene.uvs[i as usize]);
        let area = (b - a).cross(c - a).length();
        let share = 0.5 * (q - p).perp_dot(r - p).abs();
        let uv = (p + q + r) / 3.0;
        let color =
            scene.corner_colors.get(t).map_or(surface.color, |colors| colors.iter().sum::<Vec3>() / 3.0);
        let sum = &mut sums[*material as usize];
        sum.0 += area;
        sum.1 += area * surface.albedo(color, uv, share);
        sum.2 += area * surface.shine(uv, share);
    }
    let mean = |(area, albedo, emission): (f32, Vec3, Vec3)| {
        let factor = if area > 0.0 { area.recip() } else { 0.0 };
        ((factor * albedo).clamp(Vec3::ZERO, Vec3::ONE), factor * emission)
    };
    sums.into_iter().map(mean).collect()
}
