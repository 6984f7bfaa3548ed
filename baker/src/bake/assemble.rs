//! Assembles the file's contents.

use super::rig;
use super::stand_in::{Staged, outside};
use super::{BakeSettings, BakeSolver};
use crate::basis::Relations;
use crate::sampling::Points;
use crate::scene::rig::UNUSED;
use crate::scene::steps::{least_step, power_of_two_under, to_steps};
use crate::scene::{InstancedMesh, Scene};
use crate::transport::Operator;
use crate::transport::sources::SourceLinks;
use crate::weld::canonical_indices;
use glam::Vec3;
use rayon::prelude::*;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::basis::ParentWeights;
use rebounce_shared::environment::PackedEnvironment;
use rebounce_shared::octahedral::pack_rounded;
use rebounce_shared::rbn::LinkMatrix;
use rebounce_shared::rbn::bulk::{Copies, Instance, Vertex};
use rebounce_shared::rbn::cube_maps::CubeMaps;
use rebounce_shared::rbn::diffuse_transfer::DiffuseTransfer;
use rebounce_shared::rbn::gloss::Gloss;
use rebounce_shared::rbn::light_groups::LightGroups;
use rebounce_shared::rbn::lightmap::Lightmap;
use rebounce_shared::rbn::meta::{self, Alpha, BakeInfo, Draw, Meta};
use rebounce_shared::rbn::sources::Sources;
use std::collections::HashMap;
use std::ops::Range;

/// The contents of the .rbn file.
pub(super) fn assemble(
    scene: &Scene,
    settings: &BakeSettings,
    Staged { lights, cameras, shown }: Staged,
    points: &Points,
    (relations, operator, sources): (&Relations, &Operator, SourceLinks),
) -> BakedScene {
    let environment = match &scene.environment {
        Some(environment) if sources.sources.has_sky => PackedEnvironment::new(environment).to_bytes(),
        _ => Vec::new(),
    };
    let RenderGeometry { draws, indices, vertices, instances, copies, places } = geometry(scene);
    let (textures, texture_bytes) = pack_textures(scene);
    let (low, high) = scene.bounds();
    let senders = points.count_on(settings.operator.sender_levels);
    let (mut records, cuts, levels) = points.records();
    let mut related = relations.clone();
    related.lookup.add_materials(scene.materials.len(), |material| scene.groups.of_material(material));
    let meta = Meta {
        generator: format!("rebounce {}", env!("CARGO_PKG_VERSION")),
        scene_name: scene.name.clone(),
        origin: scene.origin,
        bounds_min: low.to_array(),
        bounds_max: high.to_array(),
        levels,
        sender_levels: settings.operator.sender_levels as u32,
        later_levels: if operator.later.is_empty() { 0 } else { settings.operator.later_levels as u32 },
        direct_levels: settings.direct_levels as u32,
        materials: scene.materials.clone(),
        textures,
        draws,
        lights,
        animations: scene.animations.clone(),
        cameras,
        bake: BakeInfo {
            preset: settings.preset.name().to_owned(),
            seed: settings.operator.seed,
            epsilon: settings.operator.epsilon * operator.reflected,
            bounces: operator.bounces,
            rays: operator.rays,
            potential_links: senders as u64 * points.points.len() as u64,
        },
        shown,
    };
    for (point, tint) in records.iter_mut().zip(&operator.tints) {
        point.tint = *tint;
    }
    BakedScene {
        parent_weights: ParentWeights::default(),
        meta,
        vertices,
        indices,
        instances,
        copies,
        texture_bytes,
        points: records,
        cuts,
        openness: points.openness.clone(),
        relations: related,
        links: LinkMatrix::from_rows(&operator.links),
        later: LinkMatrix::from_rows(&operator.later),
        source_links: match sources.links.is_empty() {
            true => LinkMatrix::default(),
            false => LinkMatrix::from_rows(&sources.links),
        },
        sources: Sources { environment, ..sources.sources },
        groups: scene.groups.clone(),
        point_groups: if scene.groups.is_empty() { Vec::new() } else { points.groups() },
        reflectance: match settings.solver {
            // Nothing moves.
            BakeSolver::Operator if scene.groups.nodes.is_empty() && scene.rig.is_empty() => Vec::new(),
            _ => operator.reflectance.clone(),
        },
        light_groups: LightGroups::default(),
        lightmap: Lightmap::default(),
        gloss: Gloss::default(),
        cube_maps: CubeMaps::default(),
        diffuse_transfer: DiffuseTransfer::default(),
        rig: rig::of_file(scene, &places, points),
    }
}

/// Returns the file contents without light: geometry, materials, textures.
pub(super) fn without_light(scene: &Scene) -> BakedScene {
    let RenderGeometry { draws, indices, vertices, instances, copies, .. } = geometry(scene);
    let (textures, texture_bytes) = pack_textures(scene);
    let meta = Meta {
        materials: scene.materials.clone(),
        textures,
        draws,
        cameras: vec![outside(scene)],
        ..Meta::default()
    };
    BakedScene { meta, vertices, indices, instances, copies, texture_bytes, ..BakedScene::default() }
}

/// Concatenates the textures; equal textures are stored once.
fn pack_textures(scene: &Scene) -> (Vec<meta::Texture>, Vec<u8>) {
    let mut places: HashMap<&[u8], u64> = HashMap::new();
    let mut bytes = Vec::new();
    let textures = scene.textures.iter().map(|texture| {
        let offset = *places.entry(&texture.bytes).or_insert_with(|| {
            bytes.extend_from_slice(&texture.bytes);
            (bytes.len() - texture.bytes.len()) as u64
        });
        meta::Texture { offset, len: texture.bytes.len() as u64, ..texture.meta.clone() }
    });
    (textures.collect(), bytes)
}

/// Quantization steps of a vertex position across the scene's main part: 0.06 mm in a hall of 35 m.
const POSITION_STEPS: f32 = (1u32 << 19) as f32;
/// Quantization step of texture coordinates: an eighth of a texel of a texture 4096 wide.
const UV_STEP: f32 = 1.0 / (1u32 << 15) as f32;

/// Returns the vertices, rounded below visibility; vertices of a model are at the scale of the model's largest
/// instance.
fn vertices(scene: &Scene) -> Vec<Vertex> {
    let ((low, high), (least, greatest)) = (scene.main_part(), scene.bounds());
    let step = power_of_two_under((high - low).max_element() / POSITION_STEPS);
    let step = step.max(least_step(least, greatest));
    let corner = |(position, normal, uv): (&Vec3, &Vec3, &glam::Vec2)| Vertex {
        position: to_steps(*position, step).to_array(),
        normal: pack_rounded(*normal),
        uv: to_steps(uv.extend(0.0), UV_STEP).truncate().to_array(),
    };
    (&scene.positions, &scene.normals, &scene.uvs).into_par_iter().map(corner).collect()
}

/// Merges equal vertices in the order of first use, and updates the indices. Removes vertices without a triangle. A vertex that
/// `deforms` stays by itself: others part from it. Returns the vertices, and the number of each vertex among them, or [`UNUSED`].
fn weld(
    vertices: &[Vertex],
    deforms: impl Fn(u32) -> bool + Sync,
    indices: &mut [u32],
) -> (Vec<Vertex>, Vec<u32>) {
    let bits = |i: u32| -> [u32; 7] {
        let [a, b, c, d, e, f]: [u32; 6] = bytemuck::cast(vertices[i as usize]);
        [a, b, c, d, e, f, if deforms(i) { i + 1 } else { 0 }]
    };
    let mut places = vec![UNUSED; vertices.len()];
    let canonical_indices = canonical_indices(vertices.len(), bits);
    let mut welded = Vec::new();
    for index in indices {
        let first = canonical_indices[*index as usize] as usize;
        if places[first] == UNUSED {
            places[first] = welded.len() as u32;
            welded.push(vertices[first]);
        }
        *index = places[first];
    }
    let now = canonical_indices.iter().map(|first| places[*first as usize]).collect();
    (welded, now)
}

/// Geometry sections of the file, for drawing.
struct RenderGeometry {
    draws: Vec<Draw>,
    indices: Vec<u32>,
    vertices: Vec<Vertex>,
    instances: Vec<Instance>,
    copies: Vec<Copies>,
    /// Number of each vertex of the scene, or [`UNUSED`].
    places: Vec<u32>,
}

/// Returns the geometry: first the triangles outside of models, then the models; within either, triangles are grouped
/// by material.
fn geometry(scene: &Scene) -> RenderGeometry {
    let mut indices = vec![0; 3 * scene.triangles.len()];
    let first =
        |model: Option<&InstancedMesh>| model.map_or(scene.triangles.len(), |m| m.triangles.start as usize);
    let mut draws = draws(scene, 0..first(scene.models.first()), &mut indices);
    let (mut instances, mut copies) = (Vec::new(), Vec::new());
    if !scene.models.is_empty() {
        copies.resize(draws.len(), Copies::default());
    }
    for model in &scene.models {
        let stands = Copies { first: instances.len() as u32, count: model.local_from_model.len() as u32 };
        instances.extend(model.local_from_model.iter().map(Instance::from));
        let range = model.triangles.start as usize..model.triangles.end as usize;
        draws.extend(self::draws(scene, range, &mut indices));
        copies.resize(draws.len(), stands);
    }
    let mut deforms = vec![false; if scene.rig.is_empty() { 0 } else { scene.positions.len() }];
    scene.rig.vertices.iter().for_each(|vertex| deforms[vertex.vertex as usize] = true);
    let deforms = |i: u32| deforms.get(i as usize) == Some(&true);
    let (vertices, places) = weld(&vertices(scene), deforms, &mut indices);
    RenderGeometry { draws, indices, vertices, instances, copies, places }
}

/// Groups a range of triangles by material into the same range of `indices`: opaque materials first, then masked, then
/// blended.
fn draws(scene: &Scene, triangles: Range<usize>, indices: &mut [u32]) -> Vec<Draw> {
    let mut counts = vec![0u32; scene.materials.len()];
    let materials = &scene.triangle_material[triangles.clone()];
    materials.iter().for_each(|material| counts[*material as usize] += 3);
    let mut order: Vec<usize> = (0..counts.len()).filter(|m| counts[*m] > 0).collect();
    order.sort_by_key(|m| match scene.materials[*m].alpha {
        Alpha::Opaque => 0,
        Alpha::Mask { .. } => 1,
        Alpha::Blend => 2,
    });
    let mut first_index = 3 * triangles.start as u32;
    let mut draws = Vec::new();
    // Position of each material's next triangle in `indices`.
    let mut next = vec![0usize; counts.len()];
    for material in order {
        draws.push(Draw { material: material as u32, first_index, index_count: counts[material] });
        next[material] = first_index as usize;
        first_index += counts[material];
    }
    for (corners, material) in scene.triangles[triangles].iter().zip(materials) {
        let place = &mut next[*material as usize];
        indices[*place..*place + 3].copy_from_slice(corners);
        *place += 3;
    }
    draws
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_vertices_become_one_and_triangles_stay() {
        let vertex = |x: f32, normal: u32| Vertex { position: [x, 0.0, 0.0], normal, uv: [0.0; 2] };
        let vertices = [vertex(9.0, 0), vertex(0.0, 1), vertex(1.0, 1), vertex(0.0, 1), vertex(0.0, 2)];
        let mut indices = [1, 2, 4, 3, 2, 4];
        let (welded, places) = weld(&vertices, |_| false, &mut indices);
        assert_eq!(indices, [0, 1, 2, 0, 1, 2]);
        assert_eq!(welded, [vertices[1], vertices[2], vertices[4]]);
        assert_eq!(places, [UNUSED, 0, 1, 0, 2]);
    }

    #[test]
    fn vertices_that_deform_stay_by_themselves() {
        let vertices = [Vertex::default(); 4];
        let mut indices = [0, 1, 2, 0, 1, 3];
        let (welded, places) = weld(&vertices, |i| i == 1 || i == 2, &mut indices);
        assert_eq!((welded.len(), indices), (3, [0, 1, 2, 0, 1, 0]));
        assert_eq!(places, [0, 1, 2, 0]);
    }
}
