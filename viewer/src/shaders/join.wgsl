// Adds the light straight from the sources to other light at the points, or leaves one of both out.

@group(0) @binding(1) var<storage, read> from_sources: array<vec4f>;
@group(0) @binding(2) var<storage, read_write> light: array<vec4f>;

// Bits of `step_.extra`: the other light counts; that from the sources does; both have tilts.
const OTHER = 1u;
const OWN = 2u;
const TILTS = 4u;

@compute @workgroup_size(64)
fn join(@builtin(global_invocation_id) id: vec3u) {
    let i = id.x + id.y * step_.threads;
    if i >= step_.count {
        return;
    }
    let other = light[i] * select(0.0, 1.0, (step_.extra & OTHER) != 0u);
    let own = from_sources[i] * select(0.0, 1.0, (step_.extra & OWN) != 0u);
    var tilt = 0.0;
    if (step_.extra & TILTS) != 0u {
        let flow = tilt_unpack(other.w) * tilt_weight(other.xyz) + tilt_unpack(own.w) * tilt_weight(own.xyz);
        tilt = tilt_mean(vec4f(flow, tilt_weight(other.xyz) + tilt_weight(own.xyz)));
    }
    light[i] = vec4f(other.xyz + own.xyz, tilt);
}
