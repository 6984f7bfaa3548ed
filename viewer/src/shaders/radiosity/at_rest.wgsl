// A place of a group, w 1, or a way, w 0, where the file has it.
fn at_rest(of: vec4f, group: u32) -> vec3f {
    let row = 3u * group;
    return vec3f(dot(rest[row], of), dot(rest[row + 1u], of), dot(rest[row + 2u], of));
}
