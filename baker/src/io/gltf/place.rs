//! A mesh's parts to world-space triangles.

use super::mesh::MeshPart;
use super::rest::normals_along;
use super::source::Source;
use crate::scene::model::{self, Copies};
use crate::scene::world_mesh::{WorldInstancedMesh, WorldMesh};
use crate::scene::{MOST, SceneError};
use glam::{DMat3, DMat4, DVec3, Vec3, Vec4};

/// Scene units from the origin beyond which products of lengths leave the range of 32-bit numbers.
const FAR: f64 = 1e12;

/// Statistics of the triangles of a placed mesh.
#[derive(Clone, Copy, Default)]
pub(super) struct PlacementNotes {
    /// Triangles without area.
    pub degenerate: usize,
    /// Longest side of a triangle, scene units.
    pub longest: f64,
}

/// Makes models of a mesh's parts, of a group of nodes, for the placements where instancing pays. Returns for each placement
/// whether a model covers the placement.
pub(super) fn models(
    source: &Source,
    (parts, group): (&[MeshPart], u32),
    places: &[DMat4],
    out: &mut WorldMesh,
    seen: &mut PlacementNotes,
) -> Result<Vec<bool>, SceneError> {
    let mut taken = vec![false; places.len()];
    let triangles = parts.iter().map(|part| part.triangles.len()).sum();
    // Unused vertices may be anywhere, so the bounds skip unused vertices.
    let used = |part: &MeshPart| {
        part.triangles.iter().flatten().map(|i| part.positions[*i as usize]).collect::<Vec<_>>()
    };
    let corners = parts.iter().flat_map(used);
    let bounds = corners.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[a, b], p| [a.min(p), b.max(p)]);
    for Copies { model_from_mesh, placed } in model::divide(places, triangles, bounds) {
        let mut model = WorldInstancedMesh { group, ..WorldInstancedMesh::default() };
        let mut once = PlacementNotes::default();
        for part in parts {
            append(source, part, &model_from_mesh, &mut model.mesh, &mut once)?;
        }
        seen.degenerate += once.degenerate * placed.len();
        seen.longest = seen.longest.max(once.longest);
        for (place, world_from_model) in placed {
            taken[place] = true;
            model.world_from_model.push(world_from_model);
        }
        if !model.boxes().flatten().all(|p| p.abs().max_element() <= FAR) {
            return Err(out_of_range(source, &parts[0]));
        }
        out.in_models.0 += model.mesh.positions.len();
        out.in_models.1 += model.mesh.triangles.len();
        out.models.push(model);
        check_counts(source, out, 0, 0)?;
    }
    Ok(taken)
}

/// Checks the vertex and triangle counts, including the given additions, against `MOST`.
fn check_counts(
    source: &Source,
    out: &WorldMesh,
    vertices: usize,
    triangles: usize,
) -> Result<(), SceneError> {
    let vertices = vertices.saturating_add(out.positions.len() + out.in_models.0);
    let triangles = triangles.saturating_add(out.triangles.len() + out.in_models.1);
    for (what, count) in [("vertices", vertices), ("triangles", triangles)] {
        if count > MOST {
            return Err(SceneError::TooLarge { file: source.file.clone(), what, count, limit: MOST });
        }
    }
    Ok(())
}

fn out_of_range(source: &Source, part: &MeshPart) -> SceneError {
    let problem = "is placed beyond the range of numbers, 10^12 units from the origin";
    source.malformed(format!("{} {problem}", part.what))
}

/// The part's vertex of each vertex that [`append`] adds.
pub(super) fn origins(part: &MeshPart, matrix: &DMat4) -> Vec<u32> {
    let mirrored = DMat3::from_mat4(*matrix).determinant() < 0.0;
    match part.normals {
        Some(_) => (0..part.positions.len() as u32).collect(),
        None => part.triangles.iter().flat_map(|t| turned(t, mirrored)).collect(),
    }
}

/// Corners of a triangle, counter-clockwise once it is placed.
fn turned(&[a, b, c]: &[u32; 3], mirrored: bool) -> [u32; 3] {
    if mirrored { [a, c, b] } else { [a, b, c] }
}

/// Appends a part, placed by `matrix`.
pub(super) fn append(
    source: &Source,
    part: &MeshPart,
    matrix: &DMat4,
    out: &mut WorldMesh,
    seen: &mut PlacementNotes,
) -> Result<(), SceneError> {
    let flat = part.normals.is_none();
    let added = if flat { part.triangles.len().saturating_mul(3) } else { part.positions.len() };
    check_counts(source, out, added, part.triangles.len())?;
    let linear = DMat3::from_mat4(*matrix);
    let mirrored = linear.determinant() < 0.0;
    let world: Vec<DVec3> = part.positions.iter().map(|&p| matrix.transform_point3(p)).collect();
    if !world.iter().all(|p| p.abs().max_element() <= FAR) {
        return Err(out_of_range(source, part));
    }
    let turned = |corners: &[u32; 3]| turned(corners, mirrored);
    for t in &part.triangles {
        let corners = t.map(|i| world[i as usize]);
        let [a, b, c] = corners;
        seen.longest = seen.longest.max(a.distance(b)).max(b.distance(c)).max(c.distance(a));
        seen.degenerate += !WorldMesh::has_area(corners) as usize;
    }
    let first = out.positions.len();
    if let Some(colors) = &part.colors {
        out.colors.resize(first, Vec4::ONE);
        if flat {
            out.colors.extend(part.triangles.iter().flat_map(|t| turned(t).map(|i| colors[i as usize])));
        } else {
            out.colors.extend(colors);
        }
    }
    match &part.normals {
        Some(normals) => {
            let turn = normals_along(linear);
            let unit = |&n: &DVec3| (turn * n).try_normalize().unwrap_or(DVec3::ZERO).as_vec3();
            out.normals.extend(normals.iter().map(unit));
            out.positions.extend(world);
            out.uvs.extend(&part.uvs);
            out.triangles.extend(part.triangles.iter().map(|t| turned(t).map(|i| i + first as u32)));
        }
        None => {
            // glTF: without normals, triangles are flat-shaded; vertices are not shared.
            for t in part.triangles.iter().map(turned) {
                let [a, b, c] = t.map(|i| world[i as usize]);
                let normal = (b - a).cross(c - a).try_normalize().map_or(Vec3::ZERO, |n| n.as_vec3());
                let at = out.positions.len() as u32;
                out.triangles.push([at, at + 1, at + 2]);
                for i in t {
                    out.positions.push(world[i as usize]);
                    out.normals.push(normal);
                    out.uvs.push(part.uvs[i as usize]);
                }
            }
        }
    }
    out.triangle_material.resize(out.triangles.len(), part.material);
    Ok(())
}
