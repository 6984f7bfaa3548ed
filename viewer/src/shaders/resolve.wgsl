// From what a level's splats sum up to the light of the slots that it covers; those that it does not are left open for the
// next coarser one.

// As `Sums` of splat.wgsl.
@group(0) @binding(4) var light_sums: texture_2d<f32>;
@group(0) @binding(5) var tilt_sums: texture_2d<f32>;
@group(0) @binding(8) var<storage, read_write> light: array<vec4f>;
@group(0) @binding(10) var<storage, read> open: array<f32>;
// How the next coarser level is drawn (display/splat.rs).
@group(0) @binding(9) var<storage, read_write> draws: array<atomic<u32>>;

// Words of `draws`: vertices of the quads to draw, and so many further on of all that are in view; of the mask; workgroups
// of this shader in x.
const PIXELS = 0u;
const BLOCKS = 4u;
const ALL = 12u;
const MASK = 8u;
const GROUPS = 20u;

@compute @workgroup_size(8, 8)
fn resolve(@builtin(global_invocation_id) id: vec3u) {
    let slot = atlas_slot(id.xy);
    if slot == NO_SLOT || (level.finest == 0u && light[slot].w != OPEN) {
        return;
    }
    let sums = textureLoad(light_sums, id.xy, 0);
    if sums.w > LEAST_TOTAL * PARTS {
        var tilt = 0.0;
        if level.tilts != 0u {
            tilt = tilt_mean(textureLoad(tilt_sums, id.xy, 0));
        }
        light[slot] = vec4f(max(sums.rgb, vec3f(0.0)) * (open[slot] * PARTS / (sums.w * splat_scale())), tilt);
        return;
    }
    let is_open = level.index > 0u && textureLoad(depth_texture, atlas_pixel(id.xy), 0) > 0.0;
    light[slot] = vec4f(0.0, 0.0, 0.0, select(0.0, OPEN, is_open));
    if is_open {
        atomicStore(&draws[PIXELS], atomicLoad(&draws[PIXELS + ALL]));
        atomicStore(&draws[BLOCKS], atomicLoad(&draws[BLOCKS + ALL]));
        atomicStore(&draws[MASK], 3u);
        atomicStore(&draws[GROUPS], (u32(frame.width) + 7u) / 8u);
    }
}
