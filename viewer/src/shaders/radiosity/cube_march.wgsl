// Rays through the distances of cube maps: correction of parallax by depth; as shared/src/cube_map/march.rs and cube_maps/mod.rs
// of the baker.

// Places of the maps, local space.
@group(0) @binding(13) var<storage, read> map_places: array<vec4f>;
// Distances, scene units; FAR and more for the sky.
@group(0) @binding(14) var map_distances: texture_cube_array<f32>;
@group(0) @binding(15) var nearest_sampler: sampler;
// Radiance by `map_unit`, times coverage; and coverage.
@group(0) @binding(16) var map_radiance: texture_cube_array<f32>;
@group(0) @binding(17) var map_sampler: sampler;

const FAR = 1e30;
// Most steps of a ray, and halvings of the step in which it passes behind a surface.
const MOST_STEPS = 64.0;
const HALVINGS = 4u;
// Least distance behind a surface that counts as behind, texels.
const BIAS = 1.0;
// Share of its distance, and texels, that a surface is taken to be thick.
const THICK = vec2f(0.03, 3.0);
// Least sine of the angle at which a ray is seen from the side.
const RADIAL = 1e-3;
// Maps that a ray looks into, one after the other, until one is sure.
const LOOKS = 3u;
// Factor of the distance of a map that does not see the place.
const UNSEEN = 4.0;

// Where a ray ends: how far from its origin, and whether the map saw all of the way.
struct RayEnd {
    along: f32,
    sure: bool,
}

fn map_distance(map: u32, way: vec3f) -> f32 {
    return textureSampleLevel(map_distances, nearest_sampler, way, map, 0.0).r;
}

fn map_sees(map: u32, place: vec3f, angle: f32) -> bool {
    return length(place) <= map_distance(map, place) * (1.0 + THICK.x + THICK.y * angle);
}

// Along the ray to what a map has in this direction.
fn map_along(map: u32, origin: vec3f, way: vec3f, toward: vec3f) -> f32 {
    let far = map_distance(map, toward);
    return select(max(dot(far * toward - origin, way), 0.0), FAR, far >= FAR);
}

// Follows a ray of unit direction from a place, which is from that of the map; `angle` is that of a texel.
fn map_follow(map: u32, origin: vec3f, way: vec3f, angle: f32) -> RayEnd {
    let start = length(origin);
    let first = select(way, origin / max(start, 1e-20), start > 1e-20);
    let cosine = clamp(dot(first, way), -1.0, 1.0);
    let across = way - cosine * first;
    let sine = length(across);
    if sine < RADIAL {
        return RayEnd(map_along(map, origin, way, way), true);
    }
    let second = across / sine;
    let whole = acos(cosine);
    let count = clamp(ceil(whole / angle), 1.0, MOST_STEPS);
    let step = whole / count;
    var was_behind = start > map_distance(map, first) * (1.0 + BIAS * angle);
    var sure = map_sees(map, origin, angle);
    for (var i = 1.0; i <= count; i += 1.0) {
        let phi = step * i;
        let behind = map_behind(map, vec2f(phi, whole), start * sine, first, second, angle);
        if behind && !was_behind {
            var low = phi - step;
            var high = phi;
            for (var k = 0u; k < HALVINGS; k++) {
                let middle = 0.5 * (low + high);
                if map_behind(map, vec2f(middle, whole), start * sine, first, second, angle) {
                    high = middle;
                } else {
                    low = middle;
                }
            }
            let toward = cos(high) * first + sin(high) * second;
            let far = map_distance(map, toward);
            if ray_distance(vec2f(low, whole), start * sine) < far * (1.0 + THICK.x + THICK.y * angle) {
                return RayEnd(map_along(map, origin, way, toward), sure);
            }
            sure = false;
        }
        was_behind = behind;
    }
    return RayEnd(map_along(map, origin, way, way), sure && !was_behind);
}

// Distance of the ray from the map where it is seen at angle phi.x, of phi.y in all.
fn ray_distance(phi: vec2f, across: f32) -> f32 {
    let rest = sin(phi.y - phi.x);
    return select(2.0 * FAR, across / max(rest, 1e-5), rest > 1e-5);
}

fn map_behind(map: u32, phi: vec2f, across: f32, first: vec3f, second: vec3f, angle: f32) -> bool {
    let surface = map_distance(map, cos(phi.x) * first + sin(phi.x) * second);
    return ray_distance(phi, across) > surface * (1.0 + BIAS * angle);
}

// The map of a lobe, the place from that of the map, and how far the ray in the middle goes: all of the lobe is taken to be
// as far.
struct MapLobe {
    map: u32,
    place: vec3f,
    along: f32,
}

fn map_lobe(position: vec3f, facet: vec3f, mirrored: vec3f) -> MapLobe {
    let angle = 0.5 * PI / reflecting.map_side;
    // The nearest maps, nearest first.
    var maps: array<u32, LOOKS>;
    var ranks = array<f32, LOOKS>(3.0 * FAR, 3.0 * FAR, 3.0 * FAR);
    for (var map = 0u; map < reflecting.maps; map++) {
        let from = position - map_places[map].xyz;
        let unseen = dot(from, facet) > 0.0 || !map_sees(map, from, angle);
        var rank = length(from) * select(1.0, UNSEEN, unseen);
        var number = map;
        for (var k = 0u; k < LOOKS; k++) {
            if rank < ranks[k] {
                let farther_rank = ranks[k];
                let farther = maps[k];
                ranks[k] = rank;
                maps[k] = number;
                rank = farther_rank;
                number = farther;
            }
        }
    }
    // Off the surface by a texel, so that rays do not end where they begin.
    let away = position + facet * (distance(map_places[maps[0]].xyz, position) * angle);
    let looks = min(LOOKS, reflecting.maps);
    var first = MapLobe(maps[0], vec3f(0.0), 0.0);
    for (var k = 0u; k < looks; k++) {
        let place = away - map_places[maps[k]].xyz;
        let end = map_follow(maps[k], place, mirrored, angle);
        let found = MapLobe(maps[k], place, end.along);
        if end.sure {
            return found;
        }
        if k == 0u {
            first = found;
        }
    }
    return first;
}

// Radiance from a direction over about this solid angle; `sky` is that of the environment.
fn map_light(lobe: MapLobe, way: vec3f, solid_angle: f32, sky: vec3f) -> vec3f {
    let far = lobe.along >= FAR;
    let seen = select(lobe.place + lobe.along * way, way, far);
    // The footprint on what is met, as the map sees it, against a texel there.
    let wider = select(lobe.along / max(length(seen), 1e-6), 1.0, far);
    let size = abs(seen);
    let tilt = max(size.x, max(size.y, size.z)) / max(length(seen), 1e-20);
    let own = 4.0 / (reflecting.map_side * reflecting.map_side) * tilt * tilt * tilt;
    let level = max(0.5 * log2(solid_angle * wider * wider / own), 0.0);
    let texel = textureSampleLevel(map_radiance, map_sampler, seen, lobe.map, level);
    return texel.rgb / reflecting.map_unit + sky * (1.0 - texel.a);
}
