// Pull: exitant intensity of a cluster by area, of its children's; as shared/src/antiradiance/transport.rs.

fn pulled(own: u32, bin: u32) -> vec3f {
    let first = elements[own].first;
    var light = vec3f(0.0);
    for (var child = first; child < first + elements[own].children; child++) {
        light += elements[child].area * unpacked(exitant[child * pass_.bins + bin]);
    }
    return light / max(elements[own].area, 1e-30);
}
