// A coarser level of cube maps: means of four texels by their solid angles; as shared/src/cube_map/levels.rs.

@group(0) @binding(0) var finer: texture_2d_array<f32>;
@group(0) @binding(1) var coarser: texture_storage_2d_array<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn cube_mips(@builtin(global_invocation_id) id: vec3u) {
    let side = textureDimensions(coarser).x;
    if any(id.xy >= vec2u(side)) {
        return;
    }
    var sum = vec4f(0.0);
    var whole = 0.0;
    for (var k = 0u; k < 4u; k++) {
        let texel = 2u * id.xy + vec2u(k & 1u, k >> 1u);
        let at = cube_place(texel, 2u * side);
        let far = 1.0 + dot(at, at);
        let solid_angle = 1.0 / (far * sqrt(far));
        sum += solid_angle * textureLoad(finer, texel, id.z, 0);
        whole += solid_angle;
    }
    textureStore(coarser, id.xy, id.z, sum / whole);
}
