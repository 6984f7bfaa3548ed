//! Rigs of scenes: the world above their hierarchy, other numbers for their vertices, and how far their poses reach.

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use rebounce_shared::rbn::rig::check;
use rebounce_shared::rig::pose::Pose;
use rebounce_shared::rig::skin::skinned;
use rebounce_shared::rig::{NodePose, Rig, RigAnimation, RigLayout, RigMesh, RigTarget, RigVertex};

/// Note for a rig that cannot be kept.
pub const STILL: &str = "what animations deform stands still: its numbers are not finite or far too large, or other \
     triangles have taken its place";

/// Number of a vertex that no triangle uses.
pub const UNUSED: u32 = u32::MAX;
/// The axes of local space.
const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// The node above all others: the world, local space about `origin`.
pub fn world(origin: DVec3) -> NodePose {
    let [x, y, z] = AXES;
    NodePose::Matrix([x, y, z, (-origin).to_array()])
}

/// Brings the rig of a [`WorldMesh`](super::world_mesh::WorldMesh) to a scene's local space; `places` has the number of each
/// vertex among the `count` of the scene, or [`UNUSED`]. `None` if a number is not finite, or far too large.
pub(super) fn placed(mut rig: Rig, places: &[u32], count: usize, origin: DVec3) -> Option<Rig> {
    if rig.is_empty() {
        return Some(Rig::default());
    }
    renumber(&mut rig, |vertex| Some(places[vertex as usize]).filter(|place| *place != UNUSED));
    if let Some(first) = rig.layout.nodes.first_mut() {
        first.rest = world(origin);
    }
    if !rig.is_empty() {
        rig.layout.bounds = bounds(&rig);
    }
    check(&rig, [count, 0]).is_ok().then_some(rig)
}

/// Renumbers the vertices of a rig: `now` maps an old number to none (a removed vertex), one, or several (a divided vertex). Vertices
/// of a mesh are sorted by number. Meshes without vertices are removed, and points without corners.
pub fn renumber<I: IntoIterator<Item = u32>>(rig: &mut Rig, now: impl Fn(u32) -> I) {
    let Rig { layout, vertices, deltas, points } = std::mem::take(rig);
    let RigLayout { nodes, meshes, mut animations, bounds } = layout;
    let mut first_of: Vec<Option<u32>> = vec![None; vertices.len()];
    let mut mesh_of: Vec<Option<u32>> = Vec::with_capacity(meshes.len());
    let mut kept_meshes: Vec<RigMesh> = Vec::new();
    for mesh in meshes {
        let (first, count) = (mesh.first_vertex as usize, mesh.vertex_count as usize);
        let numbers = |i: usize| now(vertices[first + i].vertex).into_iter().map(move |vertex| (vertex, i));
        let mut kept: Vec<(u32, usize)> = (0..count).flat_map(numbers).collect();
        kept.sort_unstable();
        mesh_of.push((!kept.is_empty()).then_some(kept_meshes.len() as u32));
        if kept.is_empty() {
            continue;
        }
        let (first_vertex, first_delta) = (rig.vertices.len() as u32, rig.deltas.len() as u32);
        for &(vertex, i) in &kept {
            first_of[first + i].get_or_insert(rig.vertices.len() as u32);
            rig.vertices.push(RigVertex { vertex, ..vertices[first + i] });
        }
        for target in 0..mesh.weights.len() {
            let own = &deltas[mesh.first_delta as usize + target * count..][..count];
            rig.deltas.extend(kept.iter().map(|(_, i)| own[*i]));
        }
        kept_meshes.push(RigMesh { first_vertex, first_delta, vertex_count: kept.len() as u32, ..mesh });
    }
    if kept_meshes.is_empty() {
        return;
    }
    for animation in &mut animations {
        animation.tracks.retain_mut(|track| match &mut track.target {
            RigTarget::Weights(mesh) => match mesh_of[*mesh as usize] {
                Some(now) => {
                    *mesh = now;
                    true
                }
                None => false,
            },
            _ => true,
        });
    }
    animations.retain(|animation| !animation.tracks.is_empty());
    for mut point in points {
        let corners = point.corners.map(|corner| first_of[corner as usize]);
        if let [Some(a), Some(b), Some(c)] = corners {
            point.corners = [a, b, c];
            rig.points.push(point);
        }
    }
    rig.layout = RigLayout { nodes, meshes: kept_meshes, animations, bounds };
}

/// Least and greatest corner of the poses at rest and at all key times.
pub fn bounds(rig: &Rig) -> [[f32; 3]; 2] {
    let rest = RigAnimation::default();
    let mut moments: Vec<(&RigAnimation, f32)> = vec![(&rest, 0.0)];
    for animation in &rig.layout.animations {
        let mut times: Vec<f32> = animation.tracks.iter().flat_map(|track| track.times.clone()).collect();
        times.sort_unstable_by(f32::total_cmp);
        times.dedup();
        moments.extend(times.into_iter().map(|time| (animation, time)));
    }
    let of_moment = |(animation, time): &(&RigAnimation, f32)| {
        let vertices = skinned(rig, &Pose::of(rig, animation, *time));
        // Numbers that are not finite stay so.
        let is_finite = vertices.iter().all(|vertex| vertex.position.is_finite());
        let places = vertices.iter().map(|vertex| (vertex.position, vertex.position));
        places.reduce(super::union).filter(|_| is_finite).unwrap_or((Vec3::NAN, Vec3::NAN))
    };
    let union = |(a, b): (Vec3, Vec3), (c, d): (Vec3, Vec3)| {
        let is_finite = a.is_finite() && c.is_finite();
        if is_finite { super::union((a, b), (c, d)) } else { (Vec3::NAN, Vec3::NAN) }
    };
    let all = moments.par_iter().map(of_moment).reduce_with(union);
    let (low, high) = all.unwrap_or_default();
    [low.to_array(), high.to_array()]
}

/// Adds the rig of another scene, moved by `shift`, whose vertices have numbers from `first` on.
pub(super) fn add(own: &mut Rig, mut other: Rig, shift: DVec3, first: u32) {
    if other.is_empty() {
        return;
    }
    let (nodes, meshes) = (own.layout.nodes.len() as u32, own.layout.meshes.len() as u32);
    let (vertices, deltas) = (own.vertices.len() as u32, own.deltas.len() as u32);
    for node in &mut other.layout.nodes {
        match (&mut node.parent, &mut node.rest) {
            (Some(parent), _) => *parent += nodes,
            (None, NodePose::Matrix([.., at]) | NodePose::Parts { translation: at, .. }) => {
                *at = (DVec3::from(*at) + shift).to_array();
            }
        }
    }
    for mesh in &mut other.layout.meshes {
        mesh.node += nodes;
        mesh.joints.iter_mut().for_each(|joint| joint.node += nodes);
        mesh.first_vertex += vertices;
        mesh.first_delta += deltas;
    }
    for track in other.layout.animations.iter_mut().flat_map(|animation| &mut animation.tracks) {
        match &mut track.target {
            RigTarget::Translation(node) | RigTarget::Rotation(node) | RigTarget::Scale(node) => {
                *node += nodes
            }
            RigTarget::Weights(mesh) => *mesh += meshes,
        }
    }
    let [low, high] = other.layout.bounds.map(|corner| Vec3::from(corner) + shift.as_vec3());
    let all = match own.is_empty() {
        true => (low, high),
        false => super::union(own.layout.bounds.map(Vec3::from).into(), (low, high)),
    };
    own.layout.bounds = [all.0.to_array(), all.1.to_array()];
    own.layout.nodes.append(&mut other.layout.nodes);
    own.layout.meshes.append(&mut other.layout.meshes);
    own.layout.animations.append(&mut other.layout.animations);
    own.vertices.extend(other.vertices.iter().map(|v| RigVertex { vertex: v.vertex + first, ..*v }));
    own.deltas.append(&mut other.deltas);
}

#[cfg(test)]
mod tests;
