// Bounced irradiance of the pixels of another renderer's picture, RGB, and its tilt, packed (tilt.wgsl); 0 where there are
// no normal maps.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> slot_layout: Slots;
@group(0) @binding(2) var<storage, read> light: array<vec4f>;
@group(0) @binding(3) var<storage, read> slots: array<u32>;

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let tilts = slot_layout.tilts != 0u;
    let bounced = bounced_irradiance(vec2u(position.xy), tilts);
    return vec4f(bounced[0], select(0.0, tilt_pack(bounced[1]), tilts));
}
