// The part of the picture that each function of a level may reach: the bounding rectangle of its support's projection.
// They hold until the camera moves.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(2) var<storage, read> points: array<Point>;
// From the level's first point on: the quads of those in view, in any order. x, y: opposite corners in the picture, -1 to
// 1 in 16 bits; z: the greatest value of the depth buffer in the support, a float; w: the function.
@group(0) @binding(3) var<storage, read_write> quads: array<vec4u>;
// How the level is drawn (display/splat.rs): word SEEN counts its quads.
@group(0) @binding(4) var<storage, read_write> draws: array<atomic<u32>>;

const SEEN = 9u;

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

@compute @workgroup_size(64)
fn quads_of_level(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let i = (group.y * 65535u + group.x) * 64u + thread;
    if i >= level.count {
        return;
    }
    let function = level.first + i;
    let p = points[function];
    let found = quad(point_position(p), unpack_normal(p.normal), p.radius);
    if found.w != 0u {
        quads[level.first + atomicAdd(&draws[SEEN], 1u)] = vec4u(found.xyz, function);
    }
}
