// The part of the picture that each function of a level may reach: the bounding rectangle of its support's projection.
// They hold until the camera moves.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(2) var<storage, read> points: array<Point>;
// Quads of the functions that may reach pixels with slots of their own, from the level's first point on, and of those that
// may reach blocks, as much further on as there are points; in any order. x, y: opposite corners in the picture, -1 to 1
// in 16 bits; z: the greatest value of the depth buffer in the support, a float; w: the function.
@group(0) @binding(3) var<storage, read_write> quads: array<vec4u>;
// How the level is drawn (display/splat.rs): words PIXELS and BLOCKS count the vertices of the two lists, SEEN the
// functions in one of them or in both.
@group(0) @binding(4) var<storage, read_write> draws: array<atomic<u32>>;
@group(0) @binding(5) var depth_texture: texture_depth_2d;
// The slot of every pixel that has one of its own, else 0.
@group(0) @binding(6) var<storage, read> slots: array<u32>;

const PIXELS = 12u;
const BLOCKS = 16u;
const SEEN = 23u;

// Quads of no more pixels than these are drawn only where one of them is seen and wanted.
const MOST_PIXELS = 16u;

// cos and sin of 30 degrees: pixels face the eye, and functions reach normals up to 60 degrees from theirs, so what faces
// away by more than 150 degrees reaches no pixel.
const AWAY = vec2f(0.8660254, 0.5);

// A linear form's gradient in the space in which the support, an ellipsoid, is the unit ball: over the support the form
// differs from its value in the middle by the gradient's length at most.
fn gradient(form: vec3f, normal: vec3f, radius: f32) -> vec3f {
    return radius * (form - SQUASH / (1.0 + SQUASH) * dot(form, normal) * normal);
}

// Least and greatest x / w over the support, x and w being linear forms, w positive all over it: where the support
// touches the plane x = w · (middle + d) it holds (w.w² - |w'|²) d² + 2 (x' · w') d - |x'|² = 0 with the gradients x', w'.
fn extent(x: vec4f, w: vec4f, centre: vec4f, normal: vec3f, radius: f32) -> vec2f {
    let w_centre = dot(w, centre);
    let middle = dot(x, centre) / w_centre;
    let gradient_w = gradient(w.xyz, normal, radius);
    let gradient_x = gradient(x.xyz - middle * w.xyz, normal, radius);
    let a = w_centre * w_centre - dot(gradient_w, gradient_w);
    let b = dot(gradient_x, gradient_w);
    let root = sqrt(b * b + a * dot(gradient_x, gradient_x));
    return middle + vec2f(-b - root, -b + root) / a;
}

// The quad of a function; w is 1 where it is in view, else 0.
fn quad(centre: vec3f, normal: vec3f, radius: f32) -> vec4u {
    let rows = transpose(frame.clip_from_local);
    let place = vec4f(centre, 1.0);
    // On the wrong side of an edge of the picture, a plane through the eye.
    for (var edge = 0u; edge < 4u; edge++) {
        let plane = rows[3] + select(-1.0, 1.0, edge < 2u) * rows[edge & 1u];
        if dot(plane, place) + length(gradient(plane.xyz, normal, radius)) <= 0.0 {
            return vec4u(0u);
        }
    }
    let ahead = dot(rows[3], place);
    let reach = length(gradient(rows[3].xyz, normal, radius));
    let to_eye = frame.eye - centre;
    let distance = length(to_eye);
    // Seen from anywhere in the support.
    let sine = radius / distance;
    let faces_away = sine < 0.5
        && dot(normal, to_eye) < -distance * (dot(AWAY, vec2f(sqrt(1.0 - sine * sine), sine)) + 0.01);
    if ahead + reach <= frame.near || faces_away {
        return vec4u(0u);
    }
    let front = ahead - reach;
    var low = vec2f(-1.0);
    var high = vec2f(1.0);
    // A support around the eye may be anywhere in the picture.
    if front > 0.01 * reach {
        let x = extent(rows[0], rows[3], place, normal, radius);
        let y = extent(rows[1], rows[3], place, normal, radius);
        // For what rounding takes away.
        let more = 1e-3 * (vec2f(x.y, y.y) - vec2f(x.x, y.x)) + 1e-5;
        low = max(low, vec2f(x.x, y.x) - more);
        high = min(high, vec2f(x.y, y.y) + more);
    }
    let depth = select(1.0, min(1.0, 1.001 * frame.near / front), front > frame.near);
    let corners = vec4f(floor(low * 32767.0), ceil(high * 32767.0)) / 32767.0;
    return vec4u(pack2x16snorm(corners.xy), pack2x16snorm(corners.zw), bitcast<u32>(depth), 1u);
}

// Whether a quad reaches pixels with slots of their own, and blocks.
fn reaches(found: vec4u) -> vec2<bool> {
    let size = vec2f(frame.width, frame.height);
    let low = unpack2x16snorm(found.x);
    let high = unpack2x16snorm(found.y);
    // From the first pixel whose middle it holds to before this one.
    let first = vec2u(ceil((vec2f(low.x, -high.y) * 0.5 + 0.5) * size - 0.5));
    let end = vec2u(clamp(floor((vec2f(high.x, -low.y) * 0.5 + 0.5) * size + 0.5), vec2f(0.0), size));
    if any(first >= end) {
        return vec2<bool>(false);
    }
    if (end.x - first.x) * (end.y - first.y) > MOST_PIXELS {
        return vec2<bool>(true);
    }
    var found_pixels = false;
    var found_blocks = false;
    for (var y = first.y; y < end.y; y++) {
        for (var x = first.x; x < end.x; x++) {
            let depth = textureLoad(depth_texture, vec2u(x, y), 0);
            if depth > 0.0 && depth < bitcast<f32>(found.z) {
                found_pixels |= slots[y * u32(frame.width) + x] != 0u;
                found_blocks |= ((x | y) & 1u) == 0u;
            }
        }
    }
    return vec2<bool>(found_pixels, found_blocks);
}

@compute @workgroup_size(64)
fn quads_of_level(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let i = (group.y * 65535u + group.x) * 64u + thread;
    if i >= level.count {
        return;
    }
    let function = level.first + i;
    let p = points[function];
    let found = quad(point_position(p), unpack_normal(p.normal), p.radius);
    if found.w == 0u {
        return;
    }
    let reached = reaches(found);
    let entry = vec4u(found.xyz, function);
    if reached.x {
        quads[level.first + atomicAdd(&draws[PIXELS], 6u) / 6u] = entry;
    }
    if reached.y {
        quads[arrayLength(&quads) / 2u + level.first + atomicAdd(&draws[BLOCKS], 6u) / 6u] = entry;
    }
    if any(reached) {
        atomicAdd(&draws[SEEN], 1u);
    }
}
