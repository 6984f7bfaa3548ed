// By group, the rows of the matrix from where it is to where the file has it.
@group(0) @binding(9) var<uniform> rest: array<vec4f, 3072>;
// What the layers in front let through.
@group(0) @binding(10) var through_before: texture_2d<f32>;
