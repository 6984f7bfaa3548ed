//! Puts the file's contents together.

use super::BakeSettings;
use crate::basis::Relations;
use crate::operator::Operator;
use crate::points::Points;
use crate::scene::Scene;
use glam::{DVec3, Vec3};
use rebounce_shared::camera::Camera;
use rebounce_shared::octahedral::pack_snorm16;
use rebounce_shared::rbn::bulk::{Point, Vertex};
use rebounce_shared::rbn::meta::{self, Alpha, BakeInfo, Draw, Level, Meta};
use rebounce_shared::rbn::{self, LinkMatrix};
use std::collections::HashMap;

/// The contents of the .rbn file.
pub(super) fn assemble(
    scene: &Scene,
    settings: &BakeSettings,
    viewpoint: Vec3,
    points: &Points,
    relations: &Relations,
    operator: &Operator,
) -> rbn::Scene {
    let (draws, mut indices) = draws(scene);
    let vertices = weld(&vertices(scene), &mut indices);
    let (textures, texture_bytes) = pack_textures(scene);
    let (low, high) = scene.bounds();
    let senders = points.count_on(settings.operator.sender_levels);
    let mut cameras = scene.cameras.clone();
    if cameras.is_empty() {
        cameras.push(camera_at(scene.origin, viewpoint, low, high));
    }
    let meta = Meta {
        generator: format!("rebounce {}", env!("CARGO_PKG_VERSION")),
        scene_name: scene.name.clone(),
        origin: scene.origin,
        bounds_min: low.to_array(),
        bounds_max: high.to_array(),
        levels: points
            .levels
            .iter()
            .map(|level| Level {
                first: level.first as u32,
                count: level.count as u32,
                disk_radius: level.disk_radius,
                support_radius: level.support_radius,
            })
            .collect(),
        sender_levels: settings.operator.sender_levels as u32,
        later_levels: if operator.later.is_empty() { 0 } else { settings.operator.later_levels as u32 },
        direct_levels: settings.direct_levels as u32,
        materials: scene.materials.clone(),
        textures,
        draws,
        lights: scene.lights.clone(),
        animations: scene.animations.clone(),
        cameras,
        bake: BakeInfo {
            preset: settings.preset.name().to_owned(),
            seed: settings.operator.seed,
            epsilon: settings.operator.epsilon * settings.operator.reflected,
            bounces: operator.bounces,
            rays: operator.rays,
            potential_links: senders as u64 * points.points.len() as u64,
        },
    };
    let mut packed = Vec::with_capacity(points.points.len());
    let mut cuts = Vec::new();
    for level in &points.levels {
        for i in level.range() {
            let (p, own) = (&points.points[i], points.cuts_of(i));
            packed.push(Point {
                position: p.position.to_array(),
                radius: level.support_radius,
                normal: pack_snorm16(p.normal),
                cuts: Point::pack_cuts(cuts.len(), own.len(), points.samples_of(i)),
                tint: operator.tints[i],
            });
            cuts.extend_from_slice(own);
        }
    }
    rbn::Scene {
        meta,
        vertices,
        indices,
        texture_bytes,
        points: packed,
        cuts,
        push_offsets: relations.push_offsets.clone(),
        push_entries: relations.push_entries.clone(),
        pull_offsets: relations.pull_offsets.clone(),
        pull_entries: relations.pull_entries.clone(),
        links: LinkMatrix::from_rows(&operator.links),
        later: LinkMatrix::from_rows(&operator.later),
    }
}

/// Textures one after another; equal pictures are written once.
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

fn vertices(scene: &Scene) -> Vec<Vertex> {
    let corner = |((position, normal), uv): ((&Vec3, &Vec3), &glam::Vec2)| Vertex {
        position: position.to_array(),
        normal: pack_snorm16(*normal),
        uv: uv.to_array(),
    };
    scene.positions.iter().zip(&scene.normals).zip(&scene.uvs).map(corner).collect()
}

/// Equal vertices become one, in the order of their first use; the indices follow. Vertices of no triangle go.
fn weld(vertices: &[Vertex], indices: &mut [u32]) -> Vec<Vertex> {
    let mut places: HashMap<[u32; 6], u32> = HashMap::new();
    let mut welded = Vec::new();
    for index in indices {
        let vertex = &vertices[*index as usize];
        *index = *places.entry(bytemuck::cast(*vertex)).or_insert_with(|| {
            welded.push(*vertex);
            welded.len() as u32 - 1
        });
    }
    welded
}

/// Triangles grouped by material: opaque ones first, then masked, then blended.
fn draws(scene: &Scene) -> (Vec<Draw>, Vec<u32>) {
    let mut by_material: Vec<Vec<u32>> = vec![Vec::new(); scene.materials.len()];
    for (corners, material) in scene.triangles.iter().zip(&scene.triangle_material) {
        by_material[*material as usize].extend_from_slice(corners);
    }
    let mut order: Vec<usize> = (0..by_material.len()).filter(|m| !by_material[*m].is_empty()).collect();
    order.sort_by_key(|m| match scene.materials[*m].alpha {
        Alpha::Opaque => 0,
        Alpha::Mask { .. } => 1,
        Alpha::Blend => 2,
    });
    let mut draws = Vec::new();
    let mut indices = Vec::with_capacity(3 * scene.triangles.len());
    for material in order {
        let corners = &by_material[material];
        draws.push(Draw {
            material: material as u32,
            first_index: indices.len() as u32,
            index_count: corners.len() as u32,
        });
        indices.extend_from_slice(corners);
    }
    (draws, indices)
}

/// A camera at the viewpoint, looking level towards the far side of the scene.
fn camera_at(origin: [f64; 3], viewpoint: Vec3, low: Vec3, high: Vec3) -> Camera {
    let mut towards = 0.5 * (low + high) - viewpoint;
    towards.y = 0.0;
    if towards.length() < 0.05 * (high - low).length() {
        towards = if high.x - low.x > high.z - low.z { Vec3::X } else { Vec3::Z };
    }
    let position = DVec3::from(origin) + viewpoint.as_dvec3();
    let target = position + towards.normalize().as_dvec3() * 0.25 * (high - low).length() as f64;
    Camera { position: position.to_array(), target: target.to_array(), up: [0.0, 1.0, 0.0], yfov_deg: 60.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_vertices_become_one_and_triangles_stay() {
        let vertex = |x: f32, normal: u32| Vertex { position: [x, 0.0, 0.0], normal, uv: [0.0; 2] };
        let vertices = [vertex(9.0, 0), vertex(0.0, 1), vertex(1.0, 1), vertex(0.0, 1), vertex(0.0, 2)];
        let mut indices = [1, 2, 4, 3, 2, 4];
        let welded = weld(&vertices, &mut indices);
        assert_eq!(indices, [0, 1, 2, 0, 1, 2]);
        assert_eq!(welded, [vertices[1], vertices[2], vertices[4]]);
    }
}
