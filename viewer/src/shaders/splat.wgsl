// Each basis function is a quad around its support's projection; in each pixel its weight times its
// irradiance adds up (paper, section 4.1). Alpha adds up the weights.

struct Splat {
    // Multiplies irradiance so that it fits the target's range.
    scale: f32,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> splat: Splat;
@group(0) @binding(2) var<storage, read> points: array<Point>;
@group(0) @binding(3) var<storage, read> values: array<f32>;
@group(0) @binding(4) var depth_texture: texture_depth_2d;
@group(0) @binding(5) var surface_texture: texture_2d<u32>;
@group(0) @binding(6) var<storage, read> cuts: array<f32>;

struct Out {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) centre: vec4f,
    @location(1) @interpolate(flat) normal: vec3f,
    @location(2) @interpolate(flat) irradiance: vec3f,
    @location(3) @interpolate(flat) cuts: u32,
}

// The support is an ellipsoid with the half axes r, r in the tangent plane and r / (1 + SQUASH) along
// the normal. A plane p·x + d = 0 touches it where (p·centre + d)² = q(p, p); q is this form.
fn support(a: vec3f, b: vec3f, normal: vec3f, radius: f32) -> f32 {
    let flattening = 1.0 - 1.0 / ((1.0 + SQUASH) * (1.0 + SQUASH));
    return radius * radius * (dot(a, b) - flattening * dot(a, normal) * dot(b, normal));
}

// The interval of x / w over the ellipsoid: the k whose plane x - k w = 0 touches it.
fn interval(x: f32, w: f32, xx: f32, xw: f32, ww: f32) -> vec2f {
    let a = w * w - ww;
    let b = x * w - xw;
    let c = x * x - xx;
    let root = sqrt(max(b * b - a * c, 0.0));
    return vec2f(b - root, b + root) / a;
}

@vertex
fn vertex(@builtin(vertex_index) corner: u32, @builtin(instance_index) instance: u32) -> Out {
    var out: Out;
    let p = points[instance];
    let centre = point_position(p);
    let normal = unpack_normal(p.normal);
    out.position = vec4f(0.0, 0.0, -1.0, 1.0);
    // Rows of the projection: x, y and w as planes of local space.
    let m = transpose(frame.clip_from_local);
    let c = vec4f(centre, 1.0);
    let x = dot(m[0], c);
    let y = dot(m[1], c);
    let w = dot(m[3], c);
    let xx = support(m[0].xyz, m[0].xyz, normal, p.radius);
    let yy = support(m[1].xyz, m[1].xyz, normal, p.radius);
    let ww = support(m[3].xyz, m[3].xyz, normal, p.radius);
    let xw = support(m[0].xyz, m[3].xyz, normal, p.radius);
    let yw = support(m[1].xyz, m[3].xyz, normal, p.radius);
    let depth = sqrt(ww);
    // Outside one of the view's five planes.
    if w + depth < frame.near
        || x - w > sqrt(max(xx - 2.0 * xw + ww, 0.0)) || -x - w > sqrt(max(xx + 2.0 * xw + ww, 0.0))
        || y - w > sqrt(max(yy - 2.0 * yw + ww, 0.0)) || -y - w > sqrt(max(yy + 2.0 * yw + ww, 0.0)) {
        return out;
    }
    // Everything, where the support reaches to the eye's plane.
    var low = vec2f(-1.0);
    var high = vec2f(1.0);
    let nearest = w - depth;
    if nearest > 1e-3 * p.radius {
        let across = interval(x, w, xx, xw, ww);
        let along = interval(y, w, yy, yw, ww);
        low = max(low, vec2f(across.x, along.x));
        high = min(high, vec2f(across.y, along.y));
    }
    let at = select(low, high, vec2<bool>((corner & 1u) != 0u, (corner & 2u) != 0u));
    // In front of the whole support, so that the depth test drops what lies behind a nearer surface.
    out.position = vec4f(at, min(1.0, frame.near / max(nearest, frame.near)), 1.0);
    out.centre = vec4f(centre, p.radius);
    out.normal = normal;
    out.cuts = p.cuts;
    // Irradiance along the point's own normal: the vector was gathered over its hemisphere, and says
    // too little about others.
    out.irradiance = splat.scale * value_irradiance(instance, normal);
    return out;
}

@fragment
fn fragment(in: Out) -> @location(0) vec4f {
    let pixel = vec2u(in.position.xy);
    let depth = textureLoad(depth_texture, pixel, 0);
    // Nothing there, or (in a coarser level) covered already.
    if depth <= 0.0 || depth >= 1.0 {
        discard;
    }
    let offset = position_at(frame, in.position.xy, depth) - in.centre.xyz;
    // Most of a quad lies outside the support: no more work there.
    if squashed_distance_squared(offset, in.normal) >= in.centre.w * in.centre.w {
        discard;
    }
    for (var i = 0u; i < (in.cuts & 7u); i++) {
        let k = 3u * ((in.cuts >> 11u) + i);
        if dot(vec3f(cuts[k], cuts[k + 1u], cuts[k + 2u]), offset) > 1.0 {
            discard;
        }
    }
    let normal = unpack_normal(textureLoad(surface_texture, pixel, 0).x);
    let w = weight(offset, normal, in.normal, in.centre.w);
    if w <= 0.0 {
        discard;
    }
    return w * vec4f(in.irradiance, 1.0);
}
