// Light over the links of a cell; as shared/src/antiradiance/transport.rs, links by cell.

struct CellTransfer {
    sender: u32,
    factor: f32,
}

@group(0) @binding(3) var<storage, read> offsets: array<u32>;
@group(0) @binding(4) var<storage, read> transfers: array<CellTransfer>;

fn over_links(row: u32) -> vec3f {
    var light = vec3f(0.0);
    let end = offsets[row + 1u];
    for (var at = offsets[row]; at < end; at++) {
        light += transfers[at].factor * unpacked(exitant[transfers[at].sender]);
    }
    return light;
}

fn gathered(cell: u32) -> vec3f {
    var light = over_links(cell);
    if pass_.moving > 0u {
        light += over_links(pass_.moving + cell);
    }
    return light;
}
