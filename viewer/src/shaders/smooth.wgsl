// Edges smoothed in a picture of one sample a pixel, as moving ones are (Lottes 2011, FXAA 3.11); as
// shared/src/smooth.rs.

// Contrast of brightness, as the eye counts, at which an edge is smoothed.
const CONTRAST = 0.03;
// Pixels looked at along an edge, at most, on each side.
const REACH = 8;
// How little is made of what differs from all around it: 2 in FXAA, less for moving pictures to flicker less.
const THIN = 1.75;

fn brightness(c: vec3f) -> f32 {
    return sqrt(dot(saturate(c), vec3f(0.2126, 0.7152, 0.0722)));
}

fn bilinear_at(place: vec2f) -> vec3f {
    return textureSampleLevel(picture, bilinear, place / vec2f(textureDimensions(picture)), 0.0).rgb;
}

// Brightness at a place between pixels.
fn at(place: vec2f) -> f32 {
    return brightness(bilinear_at(place));
}

// How far an edge goes on from `start` by these steps of a pixel, and by how much its brightness is off `mean` there, by
// at least `least` where it ends.
fn edge_end(start: vec2f, along: vec2f, mean: f32, least: f32) -> vec2f {
    var out = vec2f(0.0);
    while out.x < f32(REACH) && abs(out.y) < least {
        out.x += 1.0;
        out.y = at(start + out.x * along) - mean;
    }
    return out;
}

// The picture at a place in texels, centres at halves: moved across an edge by the share of the pixel that lies beyond it.
fn smoothed(place: vec2f) -> vec3f {
    let own = bilinear_at(place);
    let m = brightness(own);
    let x = vec2f(1.0, 0.0);
    let y = vec2f(0.0, 1.0);
    // Left, right, above, below; and the corners in between.
    let beside = vec4f(at(place - x), at(place + x), at(place - y), at(place + y));
    let corners = vec4f(at(place - x - y), at(place + x - y), at(place - x + y), at(place + x + y));
    let range = max(m, max(max(beside.x, beside.y), max(beside.z, beside.w)))
        - min(m, min(min(beside.x, beside.y), min(beside.z, beside.w)));
    if range < CONTRAST {
        return own;
    }
    let bend = beside.xz + beside.yw - 2.0 * m;
    let rows = 2.0 * abs(bend.y) + abs(corners.x + corners.z - 2.0 * beside.x) + abs(corners.y + corners.w - 2.0 * beside.y);
    let columns = 2.0 * abs(bend.x) + abs(corners.x + corners.y - 2.0 * beside.z) + abs(corners.z + corners.w - 2.0 * beside.w);
    let flat = rows >= columns;
    let along = select(y, x, flat);
    let pair = select(beside.xy, beside.zw, flat);
    let first = abs(pair.x - m) >= abs(pair.y - m);
    let across = (vec2f(1.0) - along) * select(1.0, -1.0, first);
    let other = select(pair.y, pair.x, first);
    let mean = 0.5 * (m + other);
    let least = 0.25 * abs(other - m);
    let back = edge_end(place + 0.5 * across, -along, mean, least);
    let on = edge_end(place + 0.5 * across, along, mean, least);
    let end = select(on, back, back.x < on.x);
    // Where the nearer end is on this pixel's side, the edge cuts another pixel.
    let edge = select(0.0, 0.5 - end.x / (back.x + on.x), (m < mean) != (end.y < 0.0));
    // What differs from all around it is thinner than a pixel.
    let around = (2.0 * dot(beside, vec4f(1.0)) + dot(corners, vec4f(1.0))) / 12.0;
    let thin = smoothstep(0.0, 1.0, abs(around - m) / range);
    return bilinear_at(place + across * max(edge, pow(thin, THIN)));
}
