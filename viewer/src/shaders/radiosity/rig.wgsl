// Vertices of meshes that deform. As shared/src/rig/mod.rs.

struct RigPass {
    // Vertices of the mesh, or points that ride on all meshes.
    first: u32,
    count: u32,
    // Morph targets: the first record, their number, the first weight.
    first_delta: u32,
    targets: u32,
    first_weight: u32,
    first_matrix: u32,
}

@group(0) @binding(0) var<uniform> rig: RigPass;
// RigVertex: vertex, position, normal, joints, weights.
@group(0) @binding(1) var<storage, read> binds: array<u32>;

const BIND_WORDS = 9u;
// Section VERT: position, normal, texture coordinates.
const VERTEX_WORDS = 6u;
