// Openness: the cosine-weighted share of the hemisphere over a place that near surfaces leave free, from the horizons in
// the depth buffer (after Jimenez et al. 2016, ground-truth ambient occlusion). shared/src/openness/horizon.rs is its twin.

const SLICES = 3u;
const STEPS = 3u;
const NEAR_ALBEDO = 0.8;
const LEAST_OPEN = 0.3;
const HALF_PI = 1.57079633;

// Integral of the cosine in a slice, from the eye's direction to this angle.
fn openness_part(tilt: f32, angle: f32) -> f32 {
    return 0.25 * (cos(tilt) + 2.0 * angle * sin(tilt) - cos(2.0 * angle - tilt));
}

fn openness(pixel: vec2u, place: Place) -> f32 {
    let reach = frame.open_reach;
    let size = vec2f(frame.width, frame.height);
    let to_eye = normalize(frame.eye - place.position);
    let across = reach * 0.5 * frame.width / (length(frame.right) * dot(place.position - frame.eye, frame.forward));
    var sum = 0.0;
    for (var slice = 0u; slice < SLICES; slice++) {
        let angle = 2.0 * HALF_PI * f32(slice) / f32(SLICES);
        let way = vec2f(cos(angle), sin(angle));
        // Rows run down.
        let axis = normalize(cross(normalize(frame.right) * way.x - normalize(frame.up) * way.y, to_eye));
        let projected = place.normal - axis * dot(place.normal, axis);
        let tilt = atan2(dot(projected, cross(to_eye, axis)), dot(projected, to_eye));
        for (var side = -1.0; side < 2.0; side += 2.0) {
            // The horizon of the surface itself, and what lies between it and the eye.
            var highest = cos(tilt + side * HALF_PI);
            var free = openness_part(tilt, side * acos(clamp(highest, -1.0, 1.0)));
            var before = 0.0;
            sum += length(projected) * free;
            for (var k = 1u; k <= STEPS; k++) {
                let at = floor(vec2f(pixel) + 0.5 + way * (side * across * f32(k) / f32(STEPS)));
                if any(at < vec2f(0.0)) || any(at >= size) {
                    continue;
                }
                let there = seen(vec2u(at));
                if there.w <= 0.0 {
                    continue;
                }
                let offset = there.xyz - place.position;
                let distance = max(length(offset), 1e-6 * reach);
                let height = dot(offset, to_eye) / distance;
                if height > highest {
                    highest = height;
                    let left = openness_part(tilt, side * acos(min(height, 1.0)));
                    // What rises here is met between the place before and this one.
                    let open = min(0.5 * (before + distance) / reach, 1.0);
                    sum -= length(projected) * (free - left) * (1.0 - open * open);
                    free = left;
                }
                before = distance;
            }
        }
    }
    return sum / f32(SLICES);
}

// Irradiance of a place over that of an open one; 1 without detail.
fn received(pixel: vec2u, place: Place) -> f32 {
    if frame.open_reach <= 0.0 || !place.present {
        return 1.0;
    }
    let v = clamp(openness(pixel, place), LEAST_OPEN, 1.0);
    return v / (1.0 - NEAR_ALBEDO * (1.0 - v));
}
