// The bounced irradiance of the pixels that have a row: the mean over its functions, by weight.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> slot_layout: Slots;
@group(0) @binding(2) var<storage, read> rows: array<u32>;
@group(0) @binding(3) var<storage, read> counts: array<u32, 3>;
// Irradiance along each point's normal, and its tilt.
@group(0) @binding(4) var<storage, read> display: array<vec4f>;
// By function, what its light is multiplied with; by slot, what part of that a place receives (openness.wgsl).
@group(0) @binding(6) var<storage, read> gains: array<f32>;
@group(0) @binding(7) var<storage, read> open: array<f32>;
@group(0) @binding(5) var<storage, read_write> light: array<vec4f>;

@compute @workgroup_size(64)
fn gather(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let slot = (group.y * 65535u + group.x) * 64u + thread;
    let blocks = slots_blocks(frame);
    if slot >= min(blocks.x * blocks.y + counts[0], slot_layout.capacity) {
        return;
    }
    var sum = vec3f(0.0);
    var total = 0.0;
    var tilt = vec4f(0.0);
    for (var k = 0u; k < slot_layout.row_length; k++) {
        let entry = rows[k * slot_layout.capacity + slot];
        if entry == 0u {
            break;
        }
        let w = slots_weight(entry);
        var function = display[entry & POINT_MASK];
        if frame.open_reach > 0.0 {
            function = vec4f(function.xyz * gains[entry & POINT_MASK], function.w);
        }
        sum += w * function.xyz;
        total += w;
        if slot_layout.tilts != 0u {
            tilt += vec4f(tilt_unpack(function.w), 1.0) * (w * tilt_weight(function.xyz));
        }
    }
    let part = open[slot] / max(total, 1e-30);
    light[slot] = vec4f(max(sum, vec3f(0.0)) * part, select(0.0, tilt_mean(tilt), slot_layout.tilts != 0u));
}
