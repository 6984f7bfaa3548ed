// By group, the rows of the matrix from where it is to where the file has it.
@group(0) @binding(12) var<uniform> rest: array<vec4f, 3072>;
