// Light of a point without a patch: the mean of its parents', by their weights. `handed_down` has that of coarser points.

const NONE = 0xffffffffu;
// No tilt, as tilt.wgsl packs it: where the light comes from is not known.
const EVEN = 8421504.0;

fn of_parents(i: u32) -> vec4f {
    var sum = vec4f(0.0);
    var total = 0.0;
    for (var at = push_offsets[i]; at < push_offsets[i + 1u]; at++) {
        let entry = push_entries[at];
        sum += handed_down[entry_point(entry)] * entry_weight(entry);
        total += entry_weight(entry);
    }
    return select(vec4f(0.0), sum / total, total > 0.0);
}
