// Light of a point without a patch: the mean of its parents', by their weights. `handed_down` has that of coarser points.

const NONE = 0xffffffffu;

fn of_parents(i: u32) -> vec3f {
    var sum = vec3f(0.0);
    var total = 0.0;
    for (var at = push_offsets[i]; at < push_offsets[i + 1u]; at++) {
        let entry = push_entries[at];
        sum += handed_down[entry_point(entry)].xyz * entry_weight(entry);
        total += entry_weight(entry);
    }
    return select(vec3f(0.0), sum / total, total > 0.0);
}
