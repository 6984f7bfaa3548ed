// What the layers in front let through.
@group(0) @binding(9) var through_before: texture_2d<f32>;
