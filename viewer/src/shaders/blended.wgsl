// Blended surfaces, from front to back, one layer at a time: first how far away the nearest surface behind the layer
// before is in every pixel, then what it sends to the eye, put under what is in front of it. Group 1 holds the material.

// By material.
@group(0) @binding(2) var<storage, read> looks: array<MaterialRecord>;
// Irradiance along each point's normal, and its tilt.
@group(0) @binding(3) var<storage, read> display: array<vec4f>;
@group(0) @binding(7) var opaque_depth: texture_depth_2d;
// For `next` that of the layer before, for `fragment` that of the layer itself.
@group(0) @binding(8) var layer_depth: texture_depth_2d;

// Half a step of 8 bits: what covers less is no layer.
const LEAST_ALPHA = 0.002;
// The most that a 16-bit float is given.
const BRIGHTEST = 60000.0;

fn layer_at(in: Out) -> f32 {
    return textureLoad(layer_depth, vec2u(in.position.xy), 0);
}

// The depth of a surface in front of what is opaque and behind `before`. It is written as it is compared, so that no
// rounding in the depth test makes a surface come twice.
fn peeled(in: Out, before: f32) -> f32 {
    let alpha = cover_of(mesh_color(in.uv).a);
    let depth = in.position.z;
    if alpha < LEAST_ALPHA || depth >= before || depth <= textureLoad(opaque_depth, vec2u(in.position.xy), 0) {
        discard;
    }
    return depth;
}

@fragment
fn first(in: Out) -> @builtin(frag_depth) f32 {
    // Nothing is nearer than 1.
    return peeled(in, 2.0);
}

@fragment
fn next(in: Out) -> @builtin(frag_depth) f32 {
    return peeled(in, layer_at(in));
}

// The bounced light at a place, as find.wgsl and gather.wgsl have it for the pixels of the G-buffer.
fn bounced_at(place: vec3f, facing: vec3f) -> mat2x3f {
    let group = group_of(material.index);
    let position = at_rest(vec4f(place, 1.0), group);
    let normal = at_rest(vec4f(facing, 0.0), group);
    for (var level = lookup[0]; level > 0u; level--) {
        let list = bucket(level - 1u, position, group);
        var sum = vec3f(0.0);
        var total = 0.0;
        var tilt = vec4f(0.0);
        for (var at = list.x; at < list.y; at++) {
            let j = function_of(lookup[at]);
            let w = cover(j, position, normal);
            if w > 0.0 && belongs(lookup[at], group) {
                let function = display[j];
                sum += w * function.xyz;
                total += w;
                tilt += vec4f(tilt_unpack(function.w), 1.0) * (w * tilt_weight(function.xyz));
            }
        }
        if total > LEAST_TOTAL {
            return mat2x3f(max(sum, vec3f(0.0)) / total, tilt.xyz / max(tilt.w, 1e-20));
        }
    }
    return mat2x3f();
}

struct Layer {
    // Radiance that it adds to what is seen through it, times `shading.unit`.
    light: vec3f,
    alpha: f32,
    // RGB share of the light behind it that is seen.
    through: vec3f,
    // What it shows whatever the light.
    shine: vec3f,
}

// Called for all pixels alike: derivatives are taken.
fn layer(in: Out) -> Layer {
    // Derivatives and filtered samples first.
    let color = mesh_color(in.uv);
    let facing = mesh_facing(in);
    var surface = Surface(facing.normal, facing.normal, facing.facet, looks[min(material.index, arrayLength(&looks) - 1u)]);
    if (shading.flags & DETAILED) != 0u {
        let seen = detail(facing.normal, in.local, in.uv);
        surface.bent = seen.normal;
        surface.look.metallic = seen.metallic;
        surface.look.roughness = seen.roughness;
        surface.look.emission *= seen.emission;
    }
    let nothing = Layer(vec3f(0.0), 0.0, vec3f(1.0), vec3f(0.0));
    // No discard, after which some implementations go on with all that follows.
    if in.position.z != layer_at(in) {
        return nothing;
    }
    let alpha = cover_of(color.a);
    var albedo = color.rgb;
    var out = nothing;
    out.alpha = alpha;
    out.through = vec3f(1.0 - alpha);
    if material.glass != 0u {
        let passed = passage(albedo, in.uv);
        out.through += alpha * passed.through;
        out.alpha = 1.0 - dot(out.through, vec3f(1.0 / 3.0));
        albedo *= passed.reflected;
    }
    if surface.look.unlit > 0.0 {
        if (shading.flags & UNLIT) != 0u {
            out.shine = alpha * albedo;
        }
        return out;
    }
    var bounced = mat2x3f();
    if shading.indirect > 0.0 {
        bounced = bounced_at(in.local, facing.normal);
    }
    let light = reflected(surface, albedo, in.local, bounced, false);
    out.light = alpha * min(light * shading.unit, vec3f(BRIGHTEST));
    return out;
}

@fragment
fn fragment(in: Out) -> @location(0) vec4f {
    let seen = layer(in);
    return vec4f(seen.light, seen.alpha);
}

// The same where layers have colours: the first and last add up, what goes through is multiplied.
struct Tinted {
    @location(0) veil: vec4f,
    @location(1) through: vec4f,
    @location(2) shine: vec4f,
}

@fragment
fn tinted_layer(in: Out) -> Tinted {
    let seen = layer(in);
    let before = textureLoad(through_before, vec2u(in.position.xy), 0).rgb;
    return Tinted(vec4f(before * seen.light, seen.alpha), vec4f(seen.through, 1.0), vec4f(before * seen.shine, 1.0));
}
