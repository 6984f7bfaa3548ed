// Nearest hit of a ray: a traversal of the BVH over the placed models, and of the BVHs of the models that it meets; as
// shared/src/radiosity/traversal.rs.

// Nodes of all models' BVHs, then those of the BVH over the models from `bvh_top` on. A node has two children of two
// vectors each: least corner and first primitive or node, greatest corner and number of primitives, 0 for a node.
@group(0) @binding(1) var<storage, read> nodes: array<vec4f>;
// Three vectors a triangle: corner and group; first edge and flags; second edge and transmittance.
@group(0) @binding(2) var<storage, read> triangles: array<vec4f>;
// Eight vectors a model: rows to model space, rows to where the file has it, root of its BVH.
@group(0) @binding(3) var<storage, read> models: array<vec4f>;

const BVH_STACK = 48u;
const BVH_EDGE = 1e-5;
const BVH_NONE = 0xffffffffu;
const BVH_FAR = 3.4e38;

struct BvhHit {
    distance: f32,
    triangle: u32,
    model: u32,
}

fn hash(x: u32) -> u32 {
    let state = x * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

fn hash_unit(bits: u32) -> f32 {
    return f32(bits >> 8u) * (1.0 / 16777216.0);
}

fn bvh_reciprocal(direction: vec3f) -> vec3f {
    let sign = select(vec3f(1.0), vec3f(-1.0), direction < vec3f(0.0));
    return 1.0 / select(direction, 1e-20 * sign, abs(direction) < vec3f(1e-20));
}

// Distance at which a ray enters a child's box; BVH_FAR where it does not before `limit`.
fn bvh_entered(child: u32, origin: vec3f, inverse: vec3f, limit: f32) -> f32 {
    let a = (nodes[child].xyz - origin) * inverse;
    let b = (nodes[child + 1u].xyz - origin) * inverse;
    let low = min(a, b);
    let high = max(a, b);
    let near = max(max(low.x, low.y), max(low.z, 0.0));
    let far = min(min(high.x, high.y), min(high.z, limit));
    return select(BVH_FAR, near, near <= far * 1.0000004);
}

// Position by the rows of a matrix.
fn bvh_placed(row: u32, position: vec4f) -> vec3f {
    return vec3f(dot(models[row], position), dot(models[row + 1u], position), dot(models[row + 2u], position));
}

// Distance of a triangle along a ray (Möller and Trumbore 1997); negative without a hit.
fn bvh_distance(triangle: u32, origin: vec3f, direction: vec3f) -> f32 {
    let ab = triangles[3u * triangle + 1u].xyz;
    let ac = triangles[3u * triangle + 2u].xyz;
    let start = origin - triangles[3u * triangle].xyz;
    let p = cross(direction, ac);
    let q = cross(start, ab);
    let inverse = 1.0 / dot(ab, p);
    let u = dot(start, p) * inverse;
    let v = dot(direction, q) * inverse;
    return select(-1.0, dot(ac, q) * inverse, u >= -BVH_EDGE && v >= -BVH_EDGE && u + v <= 1.0 + BVH_EDGE);
}

// Whether a triangle stops a ray of this seed.
fn bvh_stops(triangle: u32, seed: u32) -> bool {
    let through = triangles[3u * triangle + 2u].w;
    return through <= 0.0 || hash_unit(hash(seed ^ hash(triangle))) >= through;
}

// The children of a node that a ray meets, the nearer one first: child vectors, BVH_NONE for none.
fn bvh_children(node: u32, origin: vec3f, inverse: vec3f, limit: f32) -> vec2u {
    let first = 4u * node;
    let near = vec2f(bvh_entered(first, origin, inverse, limit), bvh_entered(first + 2u, origin, inverse, limit));
    var out = select(vec2u(BVH_NONE), vec2u(first, first + 2u), near < vec2f(BVH_FAR));
    if near.y < near.x {
        out = out.yx;
    }
    return out;
}

// The nearest hit with a model before that found so far.
fn bvh_model(found: BvhHit, model: u32, origin: vec3f, direction: vec3f, seed: u32) -> BvhHit {
    let row = 8u * model;
    let local_origin = bvh_placed(row, vec4f(origin, 1.0));
    let local_direction = bvh_placed(row, vec4f(direction, 0.0));
    let inverse = bvh_reciprocal(local_direction);
    var best = found;
    var stack: array<u32, BVH_STACK>;
    var depth = 1u;
    stack[0] = bitcast<u32>(models[row + 6u].x);
    while depth > 0u {
        depth--;
        let children = bvh_children(stack[depth], local_origin, inverse, best.distance);
        // The nearer child is visited first: pushed last.
        for (var k = 2u; k > 0u; k--) {
            let child = children[k - 1u];
            if child == BVH_NONE {
                continue;
            }
            let first = bitcast<u32>(nodes[child].w);
            let count = bitcast<u32>(nodes[child + 1u].w);
            for (var triangle = first; triangle < first + count; triangle++) {
                let distance = bvh_distance(triangle, local_origin, local_direction);
                if distance > 0.0 && distance < best.distance && bvh_stops(triangle, seed) {
                    best = BvhHit(distance, triangle, model);
                }
            }
            if count == 0u && depth < BVH_STACK {
                stack[depth] = first;
                depth++;
            }
        }
    }
    return best;
}

// The nearest hit; its triangle is BVH_NONE where there is none.
fn bvh_nearest(top: u32, origin: vec3f, direction: vec3f, seed: u32) -> BvhHit {
    var best = BvhHit(BVH_FAR, BVH_NONE, 0u);
    let inverse = bvh_reciprocal(direction);
    var stack: array<u32, BVH_STACK>;
    var depth = 1u;
    stack[0] = 0u;
    while depth > 0u {
        depth--;
        let children = bvh_children(top + stack[depth], origin, inverse, best.distance);
        for (var k = 2u; k > 0u; k--) {
            let child = children[k - 1u];
            if child == BVH_NONE {
                continue;
            }
            let first = bitcast<u32>(nodes[child].w);
            let count = bitcast<u32>(nodes[child + 1u].w);
            for (var model = first; model < first + count; model++) {
                best = bvh_model(best, model, origin, direction, seed);
            }
            if count == 0u && depth < BVH_STACK {
                stack[depth] = first;
                depth++;
            }
        }
    }
    return best;
}
