// Where the file has what a pixel shows, in place of group.wgsl and at_rest.wgsl: surfaces that deform by their pixels, others
// by the motion of their group.

// rest_places.wgsl; zero where nothing deforms.
@group(0) @binding(13) var rest_texture: texture_2d<u32>;

// Of the pixel whose group was asked for last.
var<private> resting: vec4u;

fn group_at(pixel: vec2u) -> u32 {
    // A single texel where nothing of the scene deforms.
    resting = textureLoad(rest_texture, min(pixel, textureDimensions(rest_texture) - 1u), 0);
    return group_of(textureLoad(surface_texture, pixel, 0).y >> 16u);
}

// A place of a group, w 1, or a way, w 0, where the file has it.
fn at_rest(of: vec4f, group: u32) -> vec3f {
    if resting.w != 0u {
        if of.w == 1.0 {
            return bitcast<vec3f>(resting.xyz);
        }
        return unpack_normal(resting.w);
    }
    let row = 3u * group;
    return vec3f(dot(rest[row], of), dot(rest[row + 1u], of), dot(rest[row + 2u], of));
}
