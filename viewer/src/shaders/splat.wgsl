// Splatting (paper, section 4.1): each function's weight and weighted irradiance are added up in the pixels that it
// covers. Level by level, the finest first; the coarser ones only where no finer one covers a place.
//
// The depth buffer holds what a texel of the atlas shows where it is still open, and 1 elsewhere. A quad is as near as
// the nearest place of its function's support, so the depth test drops what is hidden or not wanted.

@group(0) @binding(4) var<storage, read> points: array<Point>;
@group(0) @binding(8) var<storage, read> light: array<vec4f>;
@group(0) @binding(9) var<storage, read> quads: array<vec4u>;
// Irradiance along each point's normal, and its tilt.
@group(0) @binding(10) var<storage, read> display: array<vec4f>;

// As in gather.wgsl.
@group(0) @binding(11) var<storage, read> gains: array<f32>;

// Tilts are summed in so much of the light, which is larger.
const TILT_SHARE = 0.015625;

@fragment
fn mask(@builtin(position) position: vec4f) -> @builtin(frag_depth) f32 {
    let texel = vec2u(position.xy);
    let slot = atlas_slot(texel);
    if slot == NO_SLOT || (level.finest == 0u && light[slot].w != OPEN) {
        return 1.0;
    }
    let depth = textureLoad(depth_texture, atlas_pixel(texel), 0);
    return select(depth, 1.0, depth <= 0.0);
}

struct Splat {
    @builtin(position) position: vec4f,
    // Position and radius.
    @location(0) @interpolate(flat) place: vec4f,
    @location(1) @interpolate(flat) normal: vec3f,
    @location(2) @interpolate(flat) cuts: u32,
    // Irradiance times the scale, and tilt.
    @location(3) @interpolate(flat) value: vec4f,
}

// Two triangles a quad; instances of a quad each cost some adapters a draw call each.
@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Splat {
    let quad = quads[level.first + index / 6u];
    // Corners 0, 1, 2 and 2, 1, 3, two bits each.
    let corner = (0xda4u >> (index % 6u * 2u)) & 3u;
    let at = select(unpack2x16snorm(quad.x), unpack2x16snorm(quad.y), vec2<bool>((corner & 1u) != 0u, corner > 1u));
    let p = points[quad.w];
    let value = display[quad.w];
    var gain = splat_scale();
    if frame.open_reach > 0.0 {
        gain *= gains[quad.w];
    }
    return Splat(
        vec4f(at, bitcast<f32>(quad.z), 1.0),
        vec4f(point_position(p), p.radius),
        unpack_normal(p.normal),
        p.cuts,
        vec4f(value.xyz * gain, value.w),
    );
}

struct Sums {
    // Weighted irradiance, and weights.
    @location(0) light: vec4f,
    // Weighted tilts, and their weights: as in gather.wgsl.
    @location(1) tilt: vec4f,
}

@fragment
fn fragment(in: Splat) -> Sums {
    let place = place_at(atlas_pixel(vec2u(in.position.xy)));
    let offset = place.position - in.place.xyz;
    let w = weight(offset, place.normal, in.normal, in.place.w);
    if w <= 0.0 || is_cut(offset, in.cuts) {
        discard;
    }
    var tilt = vec4f(0.0);
    if level.tilts != 0u {
        tilt = vec4f(tilt_unpack(in.value.w), 1.0) * (w * TILT_SHARE * tilt_weight(in.value.xyz));
    }
    return Sums(w * vec4f(in.value.xyz, PARTS), tilt);
}
