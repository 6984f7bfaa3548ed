// Vector irradiance at points: nine floats of `values`, channel after channel.

fn value(point: u32, channel: u32) -> vec3f {
    let at = point * 9u + channel * 3u;
    return vec3f(values[at], values[at + 1u], values[at + 2u]);
}

// Irradiance, RGB, along a unit normal.
fn value_irradiance(point: u32, normal: vec3f) -> vec3f {
    return vec3f(dot(value(point, 0u), normal), dot(value(point, 1u), normal), dot(value(point, 2u), normal));
}
