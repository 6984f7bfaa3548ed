// Points of the basis as dots, coloured by level.

struct Dots {
    color: vec4f,
    // Half a dot's width, pixels.
    size: f32,
    pad0: f32,
    pad1: f32,
    pad2: f32,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> points: array<Point>;
@group(0) @binding(2) var<uniform> dots: Dots;

struct Out {
    @builtin(position) position: vec4f,
    @location(0) corner: vec2f,
}

@vertex
fn vertex(@builtin(vertex_index) corner: u32, @builtin(instance_index) instance: u32) -> Out {
    let p = points[instance];
    var clip = frame.clip_from_local * vec4f(point_position(p), 1.0);
    let at = vec2f(f32(corner & 1u), f32(corner >> 1u)) * 2.0 - 1.0;
    clip += vec4f(at * dots.size * 2.0 / vec2f(frame.width, frame.height) * clip.w, 0.0, 0.0);
    // A little towards the viewer, so that the surface that the point lies on does not hide it.
    clip.z *= 1.02;
    return Out(clip, at);
}

@fragment
fn fragment(in: Out) -> @location(0) vec4f {
    let edge = saturate((1.0 - length(in.corner)) * dots.size);
    return vec4f(dots.color.rgb, dots.color.a * edge);
}
