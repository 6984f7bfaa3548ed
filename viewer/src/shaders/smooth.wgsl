// Edges smoothed in a picture of one sample a pixel, as moving ones are (Lottes 2009, FXAA, in its shortest form); as
// shared/src/smooth.rs.

// Contrast of brightness, as the eye counts, at which an edge is smoothed.
const CONTRAST = 0.06;
// Pixels averaged along an edge, at most, on each side.
const REACH = 6.0;

fn brightness(c: vec3f) -> f32 {
    return sqrt(dot(saturate(c), vec3f(0.2126, 0.7152, 0.0722)));
}

fn at(pixel: vec2i, dx: i32, dy: i32) -> f32 {
    let last = vec2i(textureDimensions(picture)) - 1;
    return brightness(textureLoad(picture, clamp(pixel + vec2i(dx, dy), vec2i(0), last), 0).rgb);
}

fn bilinear_at(place: vec2f) -> vec3f {
    return textureSampleLevel(picture, bilinear, place / vec2f(textureDimensions(picture)), 0.0).rgb;
}

// The mean along an edge through the pixel, or the pixel; `place` in texels, centres at halves.
fn smoothed(place: vec2f) -> vec3f {
    let pixel = vec2i(place);
    let own = bilinear_at(place);
    let middle = brightness(own);
    let corners = vec4f(at(pixel, -1, -1), at(pixel, 1, -1), at(pixel, -1, 1), at(pixel, 1, 1));
    let low = min(middle, min(min(corners.x, corners.y), min(corners.z, corners.w)));
    let high = max(middle, max(max(corners.x, corners.y), max(corners.z, corners.w)));
    if high - low < CONTRAST {
        return own;
    }
    var along = vec2f(corners.z + corners.w - corners.x - corners.y, corners.x + corners.z - corners.y - corners.w);
    let least = min(abs(along.x), abs(along.y)) + 0.03 * dot(corners, vec4f(1.0)) + 0.01;
    along = clamp(along / least, vec2f(-REACH), vec2f(REACH));
    let near = 0.5 * (bilinear_at(place - along / 6.0) + bilinear_at(place + along / 6.0));
    let far = 0.5 * near + 0.25 * (bilinear_at(place - 0.5 * along) + bilinear_at(place + 0.5 * along));
    let reached = brightness(far);
    return select(far, near, reached < low || reached > high);
}
