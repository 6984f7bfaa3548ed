//! Distance of a point from a triangle, in f64.

use glam::DVec3;

/// A triangle's area.
pub fn area([a, b, c]: [DVec3; 3]) -> f64 {
    0.5 * (b - a).cross(c - a).length()
}

/// Distance from a point to a triangle, and the barycentric coordinates of the nearest place.
pub fn nearest([a, b, c]: [DVec3; 3], p: DVec3) -> (f64, [f64; 3]) {
    let corners = [a, b, c];
    let normal = (b - a).cross(c - a);
    let shares = [(b, c), (c, a), (a, b)].map(|(from, to)| {
        (to - from).cross(p - from).dot(normal) / normal.length_squared().max(f64::MIN_POSITIVE)
    });
    if normal.length_squared() > 0.0 && shares.iter().all(|share| *share >= 0.0) {
        return ((p - a).dot(normal).abs() / normal.length(), shares);
    }
    let on_edge = |i: usize| {
        let j = (i + 1) % 3;
        let along = corners[j] - corners[i];
        let share =
            ((p - corners[i]).dot(along) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        let mut shares = [0.0; 3];
        (shares[i], shares[j]) = (1.0 - share, share);
        (p.distance(corners[i] + share * along), shares)
    };
    let edges = [on_edge(0), on_edge(1), on_edge(2)];
    edges.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::INFINITY, [0.0; 3]))
}
