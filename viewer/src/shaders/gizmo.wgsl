// The lights' handles: discs, rings and lines, in canvas pixels.

struct View {
    size: vec2f,
    pad: vec2f,
}

@group(0) @binding(0) var<uniform> view: View;

struct Out {
    @builtin(position) position: vec4f,
    @location(0) color: vec4f,
    // Place within the shape, pixels from its centre.
    @location(1) at: vec2f,
    // Outer and inner radius; a line has a length instead of the inner radius, negative.
    @location(2) shape: vec2f,
}

@vertex
fn vertex(
    @location(0) position: vec2f,
    @location(1) at: vec2f,
    @location(2) shape: vec2f,
    @location(3) color: vec4f,
) -> Out {
    let clip = vec2f(2.0, -2.0) * position / view.size + vec2f(-1.0, 1.0);
    return Out(vec4f(clip, 0.0, 1.0), color, at, shape);
}

@fragment
fn fragment(in: Out) -> @location(0) vec4f {
    var d = length(in.at);
    if in.shape.y < 0.0 {
        d = length(vec2f(max(abs(in.at.x) + in.shape.y, 0.0), in.at.y));
    }
    var share = saturate(in.shape.x - d + 0.5);
    if in.shape.y > 0.0 {
        share *= saturate(d - in.shape.y + 0.5);
    }
    return vec4f(in.color.rgb, in.color.a * share);
}
