// Bounced light of files without a lightmap.

fn shown_bounced(pixel: vec2u, tilts: bool) -> mat2x3f {
    return bounced_irradiance(pixel, tilts);
}
