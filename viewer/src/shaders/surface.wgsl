// What the G-buffer says about a pixel's surface.

struct Surface {
    // Shading normal, that of the normal map, and that of the triangle.
    normal: vec3f,
    bent: vec3f,
    facet: vec3f,
    look: MaterialRecord,
}

// `detailed`: whether the G-buffer holds what textures say; else materials have one look all over.
fn surface_unpack(texel: vec4u, material: MaterialRecord, detailed: bool) -> Surface {
    let normal = unpack_normal(texel.x);
    let flat_normal = octahedral_decode(unpack4x8snorm(texel.y & 0xffffu).xy);
    var out = Surface(normal, normal, flat_normal, material);
    if detailed {
        out.bent = unpack_normal(texel.z);
        out.look.metallic = f32(texel.w & 255u) / 255.0;
        out.look.roughness = f32((texel.w >> 8u) & 255u) / 255.0;
        let glow = vec3f(vec3u((texel.w >> 16u) & 31u, (texel.w >> 21u) & 63u, texel.w >> 27u)) / vec3f(31.0, 63.0, 31.0);
        out.look.emission *= glow * glow;
    }
    return out;
}
