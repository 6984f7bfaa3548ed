// Radiance that leaves a patch by a bin, and in w the normalisation of its cosines; as Leaving in
// shared/src/antiradiance/leaving.rs. `radiance` has the matt radiance of all patches, then that of glossy ones by bin.

fn leaves(own: u32, bin: u32) -> vec4f {
    let light = radiance[elements[own].first];
    if elements[own].glossy == NONE {
        return light;
    }
    let lobe = radiance[pass_.patches + elements[own].glossy * pass_.bins + bin];
    return vec4f(light.xyz + lobe.xyz, light.w);
}
