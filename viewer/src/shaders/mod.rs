//! The WGSL modules, each put together from its parts when it is used; build.rs takes out the comments.

/// A module's parts, in order.
pub type Source = &'static [&'static str];

macro_rules! modules {
    ($($(#[$doc:meta])* $name:ident: $($part:literal)+;)+) => {
        $($(#[$doc])* pub const $name: Source =
            &[$(include_str!(concat!(env!("OUT_DIR"), "/", $part, ".wgsl"))),+];)+

        /// All modules with their names.
        pub const ALL: &[(&str, Source)] = &[$((stringify!($name), $name)),+];
    };
}

modules! {
    /// Direct irradiance at points.
    DIRECT: "octahedral" "point" "lights" "lights_second" "visibility" "footprint" "step" "direct";
    /// Pull.
    PULL: "link" "step" "pull";
    /// What the senders send.
    SEND: "colour" "point" "step" "send";
    /// Links times what is sent.
    TRANSPORT: "octahedral" "link" "point" "tilt" "step" "lanes" "transport";
    /// Later bounces between coarse points.
    BOUNCE: "colour" "step" "lanes" "bounce";
    /// Later bounces to finer senders.
    LIFT: "link" "step" "lift";
    /// How much light there is.
    LEVEL: "step" "level";
    /// Shadow maps.
    SHADOW: "material" "model" "shadow";
    /// G-buffer.
    GBUFFER: "octahedral" "frame" "material" "detail" "model" "mesh" "gbuffer";
    /// Blended surfaces, layer by layer.
    BLENDED: "octahedral" "frame" "material" "detail" "model" "mesh" "point" "kernel" "cover" "lookup" "lights" "lights_third"
        "visibility" "tilt" "surface" "brdf" "reflect" "blended";
    /// The functions that cover each pixel.
    FIND: "octahedral" "point" "kernel" "cover" "lookup" "frame" "slots" "find";
    /// From functions to pixels.
    GATHER: "frame" "slots" "tilt" "gather";
    /// The tone-mapped picture.
    COMPOSITE: "octahedral" "frame" "lights" "lights_second" "visibility" "slots" "tilt" "surface" "brdf" "reflect" "shade" "fullscreen" "composite";
    /// Luminance of some pixels.
    LOOK: "octahedral" "frame" "lights" "lights_second" "visibility" "slots" "tilt" "surface" "brdf" "reflect" "shade" "look";
    /// Automatic exposure.
    KEY: "key";
    /// Bounced light alone.
    INDIRECT: "octahedral" "frame" "lights" "lights_second" "visibility" "slots" "tilt" "surface" "brdf" "reflect" "shade" "fullscreen" "indirect";
    /// Encoding for the screen.
    PRESENT: "fullscreen" "present";
    /// Mip levels.
    MIPS: "fullscreen" "mips";
    /// Dots over the picture.
    OVERLAY: "point" "frame" "overlay";
    /// The lights' handles.
    GIZMO: "gizmo";
}

#[cfg(test)]
mod tests {
    #[test]
    fn every_module_validates() {
        for (name, parts) in super::ALL {
            let source = &parts.concat();
            let module = naga::front::wgsl::parse_str(source)
                .unwrap_or_else(|e| panic!("{name}: {}", e.emit_to_string(source)));
            naga::valid::Validator::new(
                naga::valid::ValidationFlags::all(),
                naga::valid::Capabilities::empty(),
            )
            .validate(&module)
            .unwrap_or_else(|e| panic!("{name}: {}", e.emit_to_string(source)));
        }
    }
}
