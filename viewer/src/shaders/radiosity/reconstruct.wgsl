// Unshot light at a hit, from the points of the sender level; as shared/src/radiosity/reconstruction.rs.

// Points where their groups are.
@group(0) @binding(4) var<storage, read> points: array<Point>;
// The light that each point sends: albedo times unshot irradiance.
@group(0) @binding(7) var<storage, read> sent: array<vec4f>;

// A place of a surface: where it is, its unit normal, its group, and the row of `models` that leads to where the file has it.
struct Sender {
    position: vec3f,
    normal: vec3f,
    group: u32,
    rest: u32,
}

// The light of the point of a level with the nearest centre, among those that may cover the place, whose normals agree, and
// whose supports no clip plane ends before it; w is 0 where there is none.
fn nearest_light(list: vec2u, place: Sender) -> vec4f {
    var best = BVH_FAR;
    var found = 0u;
    for (var at = list.x; at < list.y; at++) {
        let j = function_of(lookup[at]);
        let offset = place.position - point_position(points[j]);
        let distance = dot(offset, offset);
        if distance < min(best, points[j].radius * points[j].radius) && belongs(lookup[at], place.group)
            && dot(unpack_normal(points[j].normal), place.normal) > LEAST_COSINE
            && !is_cut(bvh_placed(place.rest, vec4f(offset, 0.0)), points[j].cuts) {
            best = distance;
            found = j;
        }
    }
    return vec4f(sent[found].xyz, select(0.0, 1.0, best < BVH_FAR));
}

// The mean over the functions of a level that cover the place; w is 0 where none does.
fn mean_light(list: vec2u, place: Sender) -> vec4f {
    var sum = vec3f(0.0);
    var total = 0.0;
    for (var at = list.x; at < list.y; at++) {
        let j = function_of(lookup[at]);
        let offset = place.position - point_position(points[j]);
        let w = weight(offset, place.normal, unpack_normal(points[j].normal), points[j].radius);
        if w > 0.0 && belongs(lookup[at], place.group) && !is_cut(bvh_placed(place.rest, vec4f(offset, 0.0)), points[j].cuts) {
            sum += w * sent[j].xyz;
            total += w;
        }
    }
    return vec4f(sum / max(total, 1e-30), select(0.0, 1.0, total > LEAST_TOTAL));
}

// The light that a place sends. Where no point of the sender level has a part in it, those of finer levels count, then those
// of coarser ones.
fn sent_light(place: Sender, sender_level: u32, levels: u32, exact: bool) -> vec3f {
    let rest = bvh_placed(place.rest, vec4f(place.position, 1.0));
    for (var k = 0u; k < levels; k++) {
        let level = select(levels - 1u - k, sender_level + k, sender_level + k < levels);
        let list = bucket(level, rest, place.group);
        var light = vec4f(0.0);
        if exact {
            light = mean_light(list, place);
        } else {
            light = nearest_light(list, place);
        }
        if light.w > 0.0 {
            return light.xyz;
        }
    }
    return vec3f(0.0);
}
