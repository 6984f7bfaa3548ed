// Real spherical harmonics of five bands; as shared/src/harmonics/mod.rs.

const HARMONICS = 25u;

// Factors of the bands for a lobe whose directions have a mean vector of this length; as shared/src/harmonics/zonal.rs.
fn harmonics_lobe(r: f32) -> array<f32, 5> {
    let cube = r * r * r;
    return array<f32, 5>(1.0, r, cube, cube * cube, cube * cube * cube * r);
}

fn harmonics(d: vec3f) -> array<f32, HARMONICS> {
    let s = d * d;
    return array<f32, HARMONICS>(
        0.2820948,
        0.4886025 * d.y,
        0.4886025 * d.z,
        0.4886025 * d.x,
        1.0925484 * d.x * d.y,
        1.0925484 * d.y * d.z,
        0.31539157 * (3.0 * s.z - 1.0),
        1.0925484 * d.x * d.z,
        0.5462742 * (s.x - s.y),
        0.5900436 * d.y * (3.0 * s.x - s.y),
        2.8906114 * d.x * d.y * d.z,
        0.4570458 * d.y * (5.0 * s.z - 1.0),
        0.37317634 * d.z * (5.0 * s.z - 3.0),
        0.4570458 * d.x * (5.0 * s.z - 1.0),
        1.4453057 * d.z * (s.x - s.y),
        0.5900436 * d.x * (s.x - 3.0 * s.y),
        2.503343 * d.x * d.y * (s.x - s.y),
        1.7701308 * d.y * d.z * (3.0 * s.x - s.y),
        0.9461747 * d.x * d.y * (7.0 * s.z - 1.0),
        0.6690465 * d.y * d.z * (7.0 * s.z - 3.0),
        0.10578555 * (35.0 * s.z * s.z - 30.0 * s.z + 3.0),
        0.6690465 * d.x * d.z * (7.0 * s.z - 3.0),
        0.47308735 * (s.x - s.y) * (7.0 * s.z - 1.0),
        1.7701308 * d.x * d.z * (s.x - 3.0 * s.y),
        0.6258357 * (s.x * (s.x - 3.0 * s.y) - s.y * (3.0 * s.x - s.y)),
    );
}
