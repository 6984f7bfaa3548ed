// Encodes sRGB and dithers to 8 bits. A picture that is not yet averaged has its edges smoothed; a sketch is enlarged.

struct Shading {
    lights: vec4f,
    // Share of the picture in the average so far.
    blend: f32,
    scale: u32,
    flags: u32,
    // Pixels of the screen across one of the picture.
    enlarge: u32,
}

@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var bilinear: sampler;
@group(0) @binding(2) var<uniform> shading: Shading;

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

// The mean along an edge through the pixel, or the pixel (Lottes, FXAA, in its shortest form).
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

fn encode(c: vec3f) -> vec3f {
    return select(1.055 * pow(c, vec3f(1.0 / 2.4)) - 0.055, 12.92 * c, c <= vec3f(0.0031308));
}

// Evenly spread noise in [0, 1) (Jimenez, interleaved gradient noise).
fn noise(pixel: vec2f) -> f32 {
    return fract(52.9829189 * fract(dot(pixel, vec2f(0.06711056, 0.00583715))));
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    var color: vec3f;
    if shading.blend > 0.4 {
        color = saturate(smoothed(position.xy / f32(shading.enlarge)));
    } else {
        color = saturate(textureLoad(picture, vec2u(position.xy), 0).rgb);
    }
    return vec4f(encode(color) + (noise(position.xy) - 0.5) / 255.0, 1.0);
}
