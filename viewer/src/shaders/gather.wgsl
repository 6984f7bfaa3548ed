// The bounced irradiance of the pixels that have a row: the mean over its functions, by weight.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> slot_layout: Slots;
@group(0) @binding(2) var<storage, read> rows: array<u32>;
@group(0) @binding(3) var<storage, read> counts: array<u32, 3>;
// Irradiance along each point's normal.
@group(0) @binding(4) var<storage, read> display: array<vec4f>;
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
    for (var k = 0u; k < slot_layout.row_length; k++) {
        let entry = rows[k * slot_layout.capacity + slot];
        if entry == 0u {
            break;
        }
        let w = slots_weight(entry);
        sum += w * display[entry & POINT_MASK].xyz;
        total += w;
    }
    light[slot] = vec4f(max(sum, vec3f(0.0)) / max(total, 1e-30), 1.0);
}
