//! The WGSL modules, concatenated from their parts on use; build.rs minifies the parts (minify.rs).

/// Parts of a module, in order.
pub type Source = &'static [&'static str];

macro_rules! modules {
    ($($(#[doc = $doc:literal])+ $(#[cfg($when:meta)])? $name:ident: $($part:literal)+;)+) => {
        $($(#[doc = $doc])+ $(#[cfg($when)])? pub const $name: Source =
            &[$(include_str!(concat!(env!("OUT_DIR"), "/", $part, ".wgsl"))),+];)+

        /// All modules with their names.
        pub const ALL: &[(&str, Source)] = &[$($(#[cfg($when)])? (stringify!($name), $name)),+];
    };
}

modules! {
    /// Direct irradiance at points.
    DIRECT: "octahedral" "point" "lights" "lights_second" "area" "visibility" "penumbra" "footprint" "step" "direct";
    /// Pull.
    PULL: "link" "step" "pull";
    /// Radiance sent by the senders.
    SEND: "colour" "point" "step" "send";
    /// Matrix product of links and the senders' light.
    TRANSPORT: "octahedral" "link" "point" "tilt" "across" "step" "lanes" "push" "transport";
    /// Matrix product of links and the strengths of sources.
    SOURCES: "octahedral" "link" "point" "tilt" "across" "step" "lanes" "push" "sources";
    /// Sum of light at points.
    JOIN: "tilt" "step" "join";
    /// Later bounces between coarse points.
    BOUNCE: "colour" "step" "lanes" "bounce";
    /// Later bounces to finer senders.
    LIFT: "link" "step" "lift";
    /// Light level.
    LEVEL: "step" "light_level";
    /// Shadow maps.
    SHADOW: "material" "model" "shadow";
    /// Colours of the lights behind glass.
    TINT: "octahedral" "material" "detail" "passage" "model" "tint";
    /// G-buffer.
    GBUFFER: "octahedral" "frame" "material" "detail" "model" "mesh" "gbuffer";
    /// Blended surfaces, layer by layer.
    #[cfg(feature = "radiosity")]
    BLENDED: "octahedral" "frame" "material" "detail" "passage" "model" "mesh" "point" "kernel" "cuts" "cover" "lookup" "groups" "rest_blended" "at_rest" "lights" "lights_third"
        "area" "visibility" "penumbra" "tilt" "surface" "lobe" "brdf_coated" "reflect" "blended";
    /// The functions that cover each pixel.
    #[cfg(feature = "radiosity")]
    FIND: "octahedral" "point" "kernel" "cuts" "cover" "lookup" "groups" "rest_find" "rest_pixel" "frame" "place" "slots" "openness" "find";
    /// Blended surfaces, layer by layer.
    #[cfg(not(feature = "radiosity"))]
    BLENDED: "octahedral" "frame" "material" "detail" "passage" "model" "mesh" "point" "kernel" "cuts" "cover" "lookup" "one_group" "through" "lights" "lights_third"
        "area" "visibility" "penumbra" "tilt" "surface" "lobe" "brdf" "reflect" "blended";
    /// The functions that cover each pixel.
    #[cfg(not(feature = "radiosity"))]
    FIND: "octahedral" "point" "kernel" "cuts" "cover" "lookup" "one_group" "frame" "place" "slots" "openness" "find";
    /// As [`FIND`], for places that another renderer draws.
    FIND_GIVEN: "octahedral" "point" "kernel" "cuts" "cover" "lookup" "any_group" "frame" "place_given" "slots" "openness" "find";
    /// Bounced irradiance of another renderer's pixels.
    IRRADIANCE: "frame" "slots" "tilt" "bounced" "fullscreen" "irradiance";
    /// Surfaces at the hits of probes' rays.
    HIT_SURFACE: "material" "octahedral" "detail" "hit_surface";
    /// Radiance at probes.
    PROBES: "colour" "point" "probes";
    /// Light of the slots, from functions to pixels.
    GATHER: "frame" "slots" "tilt" "gather";
    /// Bounding quads of functions.
    QUADS: "octahedral" "point" "kernel" "frame" "level" "quads";
    /// Brightness of the splats.
    BRIGHTEST: "brightest";
    /// From functions to sums in pixels.
    SPLAT: "octahedral" "point" "kernel" "cuts" "frame" "place" "slots" "tilt" "level" "atlas" "fullscreen" "splat";
    /// From sums to pixels.
    RESOLVE: "octahedral" "kernel" "frame" "place" "slots" "tilt" "level" "atlas" "resolve";
    /// The tone-mapped picture.
    #[cfg(feature = "radiosity")]
    COMPOSITE: "octahedral" "frame" "lights" "lights_second" "area" "visibility" "penumbra" "slots" "tilt" "surface" "lobe" "brdf_coated" "reflect" "sky" "bounced" "charted" "glossy" "shade" "backdrop" "fullscreen" "composite";
    /// The tone-mapped picture.
    #[cfg(not(feature = "radiosity"))]
    COMPOSITE: "octahedral" "frame" "lights" "lights_second" "area" "visibility" "penumbra" "slots" "tilt" "surface" "lobe" "brdf" "reflect" "sky" "bounced" "uncharted" "matt" "shade" "backdrop" "fullscreen" "composite";
    /// Luminance of some pixels.
    #[cfg(feature = "radiosity")]
    LOOK: "octahedral" "frame" "lights" "lights_second" "area" "visibility" "penumbra" "slots" "tilt" "surface" "lobe" "brdf_coated" "reflect" "sky" "bounced" "charted" "glossy" "shade" "look";
    /// Luminance of some pixels.
    #[cfg(not(feature = "radiosity"))]
    LOOK: "octahedral" "frame" "lights" "lights_second" "area" "visibility" "penumbra" "slots" "tilt" "surface" "lobe" "brdf" "reflect" "sky" "bounced" "uncharted" "matt" "shade" "look";
    /// Automatic exposure.
    KEY: "key";
    /// Bounced light alone.
    #[cfg(feature = "radiosity")]
    INDIRECT: "octahedral" "frame" "lights" "lights_second" "area" "visibility" "penumbra" "slots" "tilt" "surface" "lobe" "brdf_coated" "reflect" "sky" "bounced" "charted" "glossy" "shade" "fullscreen" "indirect";
    /// Bounced light alone.
    #[cfg(not(feature = "radiosity"))]
    INDIRECT: "octahedral" "frame" "lights" "lights_second" "area" "visibility" "penumbra" "slots" "tilt" "surface" "lobe" "brdf" "reflect" "sky" "bounced" "uncharted" "matt" "shade" "fullscreen" "indirect";
    /// Encoding for the screen.
    PRESENT: "fullscreen" "smooth" "present";
    /// Mip levels.
    MIPS: "fullscreen" "mips";
    /// Light of a lightmap on the visible surfaces.
    #[cfg(feature = "radiosity")]
    LIGHTMAP: "octahedral" "frame" "model" "lightmap";
    /// Vertices of meshes that deform.
    #[cfg(feature = "radiosity")]
    SKIN: "octahedral" "rig" "skin";
    /// Points on meshes that deform.
    #[cfg(feature = "radiosity")]
    RIDE: "octahedral" "rig" "ride";
    /// Where the file has the visible surfaces of meshes that deform.
    #[cfg(feature = "radiosity")]
    REST_PLACES: "octahedral" "frame" "model" "rest_places";
    /// Glossy transfer: vectors of clusters under distant light.
    #[cfg(feature = "radiosity")]
    LIGHT_VECTORS: "harmonics" "gloss_pass" "light_vectors";
    /// Glossy transfer: light that arrives at points.
    #[cfg(feature = "radiosity")]
    ARRIVE: "link" "harmonics" "gloss_pass" "arrive";
    /// Glossy links.
    #[cfg(feature = "radiosity")]
    GLOSS_LINKS: "octahedral" "point" "harmonics" "gloss_pass" "gloss_links";
    /// Glossy transfer: reflections of the visible surfaces.
    #[cfg(feature = "radiosity")]
    REFLECTIONS: "octahedral" "frame" "slots" "lobe" "brdf_coated" "surface" "harmonics" "smith" "ggx" "fullscreen" "reflected_sky" "cube_march" "reflections";
    /// Cube maps: light of the texels.
    #[cfg(feature = "radiosity")]
    CUBE_LIGHT: "octahedral" "point" "frame" "slots" "harmonics" "smith" "ggx" "reflected_sky" "cube" "cube_light";
    /// Cube maps: coarser levels.
    #[cfg(feature = "radiosity")]
    CUBE_MIPS: "cube" "cube_mips";
    /// Radiosity: irradiance of receivers by rays.
    #[cfg(feature = "radiosity")]
    GATHER_LIGHT: "octahedral" "point" "kernel" "cuts" "lookup" "groups" "radiosity_pass" "bvh" "hemisphere" "reconstruct" "gather_light";
    /// Radiosity: light of coarse levels on finer ones.
    #[cfg(feature = "radiosity")]
    PULL_DOWN: "link" "radiosity_pass" "pull_down";
    /// Radiosity: mean of a bounce.
    #[cfg(feature = "radiosity")]
    BOUNCE_MEAN: "radiosity_pass" "bounce_mean";
    /// Radiosity: light of a solution for display.
    #[cfg(feature = "radiosity")]
    SHOW_LIGHT: "radiosity_pass" "show_light";
    /// Radiosity: light that points send.
    #[cfg(feature = "radiosity")]
    SEND_LIGHT: "colour" "radiosity_pass" "send_light";
    /// Antiradiance: global pass and push.
    #[cfg(feature = "antiradiance")]
    GATHER_BINS: "antiradiance_pass" "links_bins" "gather_bins";
    /// Antiradiance: a wave of the ordered iteration.
    #[cfg(feature = "antiradiance")]
    SWEEP_BINS: "antiradiance_pass" "leaves_bin" "links_bins" "pull_bins" "sweep_bins";
    /// Antiradiance: irradiance of patches.
    #[cfg(feature = "antiradiance")]
    MEASURE_BINS: "antiradiance_pass" "measure_bins";
    /// Antiradiance: light that patches reflect.
    #[cfg(feature = "antiradiance")]
    REFLECT_PATCHES: "antiradiance_pass" "reflect_patches";
    /// Antiradiance: light that leaves elements, less what went through them.
    #[cfg(feature = "antiradiance")]
    LEAVE_BINS: "antiradiance_pass" "leaves_bin" "pull_bins" "leave_bins";
    /// Antiradiance: irradiance of metals by bin.
    #[cfg(feature = "antiradiance")]
    ARRIVE_LOBES: "antiradiance_pass" "lobe_bins" "arrive_lobes";
    /// Antiradiance: change of the bounced light of points beside an operator.
    #[cfg(feature = "antiradiance")]
    CHANGE_PATCHES: "link" "patch_points" "of_parents" "change_patches";
    /// Antiradiance: K of metals.
    #[cfg(feature = "antiradiance")]
    REFLECT_LOBES: "antiradiance_pass" "lobe_bins" "smith" "reflect_lobes";
    /// Antiradiance: direct light of metals by bin.
    #[cfg(feature = "antiradiance")]
    DIRECT_LOBES: "octahedral" "point" "lights" "lights_second" "area" "visibility" "penumbra" "footprint" "patch_points" "direct_lobes";
    /// Antiradiance: direct light of patches from that of points.
    #[cfg(feature = "antiradiance")]
    LIGHT_PATCHES: "patch_points" "light_patches";
    /// Antiradiance: light of points from that of patches.
    #[cfg(feature = "antiradiance")]
    SHOW_PATCHES: "link" "patch_points" "of_parents" "show_patches";
    /// Dots over the picture.
    OVERLAY: "point" "frame" "overlay";
    /// The lights' handles.
    GIZMO: "gizmo";
}

#[cfg(test)]
#[path = "../../minify.rs"]
mod minify;

#[cfg(test)]
mod tests {
    use super::minify::minified;

    #[test]
    fn shortened_shaders_keep_what_others_call_and_what_the_language_has() {
        let source = "
            override LANES = 1u; // Threads.
            struct Place { position: vec3f, xy: f32, distance: f32 }
            @group(0) @binding(0) var<storage, read> places: array<Place, 3>;
            @vertex
            fn main(@builtin(position) position: vec4f) -> @location(0) @interpolate(flat) f32 {
                let a = places[LANES].distance - -1.5e-3;
                var sum: array<f32, 2> = array<f32, 2>(a, .5);
                return distance(position.xyz, places[0x1eu].position) + sum[0] * helper(position.xy);
            }";
        let other = "fn helper(position: vec2f) -> f32 { return position.x; }";
        let short = minified(&[source.to_owned(), other.to_owned()], 2);
        let [source, other] = [&short[0], &short[1]];
        for kept in [
            "override LANES=1u",
            "fn main(@builtin(position)a:vec4f)",
            "@interpolate(flat)",
            "distance(",
            ".xyz",
            "- -1.5e-3",
            "> =array",
            "0x1eu",
            ".5)",
        ] {
            assert!(source.contains(kept), "{kept}: {source}");
        }
        for gone in ["helper", "places", "Place", "Threads", "sum"] {
            assert!(!source.contains(gone) && !other.contains(gone), "{gone}: {source}{other}");
        }
        let name = other.strip_prefix("fn ").unwrap().split('(').next().unwrap();
        assert!(source.contains(&format!("*{name}(")), "one name in all: {source}{other}");
    }

    #[test]
    fn every_module_validates() {
        for (name, parts) in super::ALL {
            let source = &parts.concat();
            let module = naga::front::wgsl::parse_str(source)
                .unwrap_or_else(|e| panic!("{name}: {}", e.emit_to_string(source)));
            naga::valid::Validator::new(
                naga::valid::ValidationFlags::all(),
                // What WebGPU has without any feature: cube arrays, and packing of half floats, are naga's capabilities for
                // OpenGL's sake.
                naga::valid::Capabilities::CUBE_ARRAY_TEXTURES
                    | naga::valid::Capabilities::SHADER_FLOAT16_IN_FLOAT32,
            )
            .validate(&module)
            .unwrap_or_else(|e| panic!("{name}: {}", e.emit_to_string(source)));
        }
    }
}
