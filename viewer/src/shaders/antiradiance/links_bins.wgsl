// Light over the links of a cell; as shared/src/antiradiance/transport.rs, links by cell.

struct CellTransfer {
    sender: u32,
    factor: f32,
}

@group(0) @binding(3) var<storage, read> offsets: array<u32>;
@group(0) @binding(4) var<storage, read> transfers: array<CellTransfer>;

fn gathered(cell: u32) -> vec3f {
    var light = vec3f(0.0);
    let end = offsets[cell + 1u];
    for (var at = offsets[cell]; at < end; at++) {
        light += transfers[at].factor * unpacked(exitant[transfers[at].sender]);
    }
    return light;
}
