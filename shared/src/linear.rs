//! Weights that reproduce linear functions.
use glam::{Vec2, Vec3};

/// Tilts weights.
pub fn make_linear(normal: Vec3, row: &mut [(u32, f32)], offset: impl Fn(u32) -> Vec3) {
    let mu: f32 = std::env::var("MLS_MU").ok().and_then(|x| x.parse().ok()).unwrap_or(0.01);
    if row.len() < 2 {
        return;
    }
    let (t, b) = normal.any_orthonormal_pair();
    let flat = |j: u32| {
        let o = offset(j);
        Vec2::new(o.dot(t), o.dot(b))
    };
    let total: f32 = row.iter().map(|e| e.1).sum();
    let mean: Vec2 = row.iter().map(|e| flat(e.0) * e.1).sum::<Vec2>() / total;
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for e in row.iter() {
        let d = flat(e.0) - mean;
        xx += e.1 * d.x * d.x;
        xy += e.1 * d.x * d.y;
        yy += e.1 * d.y * d.y;
    }
    let trace = xx + yy;
    xx += mu * trace;
    yy += mu * trace;
    let det = xx * yy - xy * xy;
    if det <= 1e-6 * trace * trace {
        return;
    }
    // C^-1 m
    let tilt = Vec2::new(yy * mean.x - xy * mean.y, xx * mean.y - xy * mean.x) * (total / det);
    let most = row.iter().map(|e| (flat(e.0) - mean).dot(tilt)).fold(0.0f32, f32::max);
    let limit = if most > 0.95 { 0.95 / most } else { 1.0 };
    for e in row.iter_mut() {
        let d = flat(e.0) - mean;
        e.1 *= 1.0 - limit * d.dot(tilt);
    }
}
