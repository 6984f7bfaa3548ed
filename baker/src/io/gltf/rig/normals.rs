//! Normals of meshes before they are deformed, and what morph targets add to them.

use super::super::bind::Bind;
use super::super::mesh::MeshPart;
use glam::{DVec3, Vec3};

/// Unit normals of the vertices that come from `origins`, and by morph target what is added to them. Without normals in the file
/// each triangle has its own three vertices and is flat; a normal of the file that is not finite, or zero, is the mean of the
/// triangles around it.
pub(super) fn bind_normals(part: &MeshPart, bind: &Bind, origins: &[u32]) -> (Vec<Vec3>, Vec<Vec<DVec3>>) {
    let unit = |normal: DVec3| normal.try_normalize().unwrap_or(DVec3::Y);
    let Some(normals) = &bind.normals else {
        let flat = |of: &dyn Fn(u32) -> DVec3| -> Vec<DVec3> {
            let faces = part.triangles.iter().map(|triangle| unit(across(triangle, bind, of)));
            faces.flat_map(|normal| [normal; 3]).collect()
        };
        let own = flat(&|i| bind.positions[i as usize]);
        let of_target = |moves: &Vec<[DVec3; 2]>| {
            let moved = flat(&|i| bind.positions[i as usize] + moves[i as usize][0]);
            moved.iter().zip(&own).map(|(moved, own)| *moved - *own).collect()
        };
        let of_targets = bind.targets.iter().map(of_target).collect();
        return (own.iter().map(|normal| normal.as_vec3()).collect(), of_targets);
    };
    let usable = |normal: &DVec3| normal.is_finite() && normal.length_squared() > 1e-12;
    let mut means = Vec::new();
    if !normals.iter().all(usable) {
        means = vec![DVec3::ZERO; normals.len()];
        for triangle in &part.triangles {
            let normal = across(triangle, bind, &|i| bind.positions[i as usize]);
            triangle.iter().for_each(|i| means[*i as usize] += normal);
        }
    }
    let of = |i: &u32| {
        let own = &normals[*i as usize];
        unit(if usable(own) { *own } else { means[*i as usize] }).as_vec3()
    };
    let of_targets = bind.targets.iter().map(|moves| origins.iter().map(|i| moves[*i as usize][1]).collect());
    (origins.iter().map(of).collect(), of_targets.collect())
}

/// Normal of a triangle in mesh space, twice its area long.
fn across(&[a, b, c]: &[u32; 3], bind: &Bind, of: &dyn Fn(u32) -> DVec3) -> DVec3 {
    let [a, b, c] = [a, b, c].map(of);
    let normal = (b - a).cross(c - a);
    if bind.is_mirrored { -normal } else { normal }
}
