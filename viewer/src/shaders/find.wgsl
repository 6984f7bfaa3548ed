// Finds the functions that cover the pixels: rows of indices and weights, which hold until the camera moves
// (paper, section 4.1, turned around: a pixel collects its functions).

// Off where functions are splatted (splat.wgsl): then pixels get slots only.
override ROWS = true;

@group(0) @binding(1) var<uniform> slot_layout: Slots;
@group(0) @binding(7) var<storage, read_write> rows: array<u32>;
// The slot of every pixel that has a row of its own, else 0.
@group(0) @binding(8) var<storage, read_write> slots: array<u32>;
// Rows beyond those of the blocks; functions looked at; kernels evaluated.
@group(0) @binding(9) var<storage, read_write> counts: array<atomic<u32>, 3>;

// By slot, what part of the points' light a place receives: see openness.wgsl.
@group(0) @binding(10) var<storage, read_write> open: array<f32>;
// As in gather.wgsl.
@group(0) @binding(11) var<storage, read> gains: array<f32>;

// Neighbours on one surface: their plane distance over the reach, and their normals' cosine.
const FLATNESS = 0.1;
const SAME_NORMAL = 0.99;

// Functions looked at by this workgroup, and kernels evaluated.
var<workgroup> looked_at: atomic<u32>;
var<workgroup> evaluated: atomic<u32>;

// In place of the row's smallest weight, where that is smaller.
fn replace_smallest(slot: u32, entry: u32) {
    var least = entry;
    var at = slot_layout.row_length;
    for (var k = 0u; k < slot_layout.row_length; k++) {
        let other = rows[k * slot_layout.capacity + slot];
        if (other >> 22u) < (least >> 22u) {
            least = other;
            at = k;
        }
    }
    if at < slot_layout.row_length {
        rows[at * slot_layout.capacity + slot] = entry;
    }
}

// Writes the row of a place: the functions of its group on the finest level that covers it. Whether something is near one
// of them.
fn write_row(slot: u32, place: Place, group: u32) -> bool {
    var most = 1.0;
    var count = 0u;
    var looks = 0u;
    var kernels = 0u;
    let position = at_rest(vec4f(place.position, 1.0), group);
    let normal = at_rest(vec4f(place.normal, 0.0), group);
    if place.present {
        for (var level = lookup[0]; level > 0u; level--) {
            let list = bucket(level - 1u, position, group);
            looks += list.y - list.x;
            var total = 0.0;
            count = 0u;
            for (var at = list.x; at < list.y; at++) {
                if !belongs(lookup[at], group) {
                    continue;
                }
                let j = function_of(lookup[at]);
                let w = cover(j, position, normal);
                kernels += u32(w >= 0.0);
                if w <= 0.0 {
                    continue;
                }
                total += w;
                most = max(most, gains[min(j, arrayLength(&gains) - 1u)]);
                let entry = slots_entry(j, w);
                if count < slot_layout.row_length {
                    rows[count * slot_layout.capacity + slot] = entry;
                    count++;
                } else {
                    replace_smallest(slot, entry);
                }
            }
            if total > LEAST_TOTAL {
                break;
            }
            count = 0u;
        }
    }
    if count < slot_layout.row_length {
        rows[count * slot_layout.capacity + slot] = 0u;
    }
    atomicAdd(&looked_at, looks);
    atomicAdd(&evaluated, kernels);
    return most > 1.0;
}

// Fills a slot. Where nothing is near any of the functions, nothing is near the place.
fn fill(slot: u32, pixel: vec2u, place: Place) {
    var near = true;
    if ROWS {
        near = write_row(slot, place, group_at(pixel));
    }
    open[slot] = 1.0;
    if near {
        open[slot] = received(pixel, place);
    }
}

fn add_counts(thread: u32) {
    workgroupBarrier();
    if thread == 0u {
        atomicAdd(&counts[1], atomicLoad(&looked_at));
        atomicAdd(&counts[2], atomicLoad(&evaluated));
    }
}

// The rows of the blocks: one thread each.
@compute @workgroup_size(8, 8)
fn blocks(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) thread: u32) {
    let size = slots_blocks(frame);
    if all(id.xy < size) {
        let slot = id.y * size.x + id.x;
        let place = place_at(2u * id.xy);
        fill(slot, 2u * id.xy, place);
    }
    add_counts(thread);
}

// Whether the light at `b` may be taken for that at `a`: 0 on another surface, 2 on the same, 1 where it is out of reach.
fn alike(a: Place, b: Place) -> u32 {
    let offset = b.position - a.position;
    let same = b.present && abs(dot(offset, a.normal)) < FLATNESS * slot_layout.reach && dot(a.normal, b.normal) > SAME_NORMAL;
    return select(0u, select(1u, 2u, dot(offset, offset) < slot_layout.reach * slot_layout.reach), same);
}

// The rows of pixels that cannot be interpolated: one thread a pixel.
@compute @workgroup_size(8, 8)
fn edges(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) thread: u32) {
    let size = vec2u(u32(frame.width), u32(frame.height));
    if all(id.xy < size) {
        let odd = id.xy & vec2u(1u);
        var slot = 0u;
        if any(odd != vec2u(0u)) {
            let place = place_at(id.xy);
            if place.present {
                let low = id.xy - odd;
                let high = min(id.xy + odd, 2u * (slots_blocks(frame) - 1u));
                var like = min(alike(place, place_at(low)), alike(place, place_at(high)));
                if all(odd != vec2u(0u)) {
                    like = min(like, alike(place, place_at(vec2u(low.x, high.y))));
                    like = min(like, alike(place, place_at(vec2u(high.x, low.y))));
                }
                // Where slots are short, edges come first: light would bleed across them, within a surface it is blurred
                // by a pixel.
                let blocks = slots_blocks(frame);
                let half = (slot_layout.capacity - blocks.x * blocks.y) / 2u;
                if like == 0u || (like == 1u && atomicLoad(&counts[0]) < half) {
                    slot = blocks.x * blocks.y + atomicAdd(&counts[0], 1u);
                    if slot >= slot_layout.capacity {
                        slot = 0u;
                    } else {
                        fill(slot, id.xy, place);
                    }
                }
            }
        }
        slots[id.y * size.x + id.x] = slot;
    }
    add_counts(thread);
}
