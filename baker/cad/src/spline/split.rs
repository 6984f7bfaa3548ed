//! Bézier pieces of a NURBS surface.

use super::bezier_patch::{BezierPatch, Mix};
use crate::basis::MAX_DEGREE;
use crate::surface::NurbsSurface;
use glam::{DVec2, DVec4};

/// The surface as Bézier patches, one for each pair of knot spans that are not empty, v fastest. Each is what knots inserted up to
/// full multiplicity leave there; their control points are found as values of the polar form (Ramshaw 1989, "Blossoms are polar
/// forms").
pub fn patches(surface: &NurbsSurface) -> Vec<BezierPatch> {
    let [spans_u, spans_v] = [0, 1].map(|direction| spans(surface, direction));
    let mut found = Vec::with_capacity(spans_u.len() * spans_v.len());
    for &u in &spans_u {
        for &v in &spans_v {
            found.push(patch(surface, [u, v]));
        }
    }
    found
}

/// Knot spans of a direction that are not empty.
pub(crate) fn spans(surface: &NurbsSurface, direction: usize) -> Vec<usize> {
    let knots = &surface.knots[direction];
    (surface.degrees[direction]..surface.counts[direction]).filter(|&i| knots[i] < knots[i + 1]).collect()
}

/// The piece over a pair of knot spans, which must not be empty.
pub(crate) fn patch(surface: &NurbsSurface, spans: [usize; 2]) -> BezierPatch {
    let [p, q] = surface.degrees;
    let mut net = Vec::with_capacity((p + 1) * (q + 1));
    for i in 0..=p {
        for j in 0..=q {
            net.push(surface.homogeneous(spans[0] - p + i, spans[1] - q + j));
        }
    }
    let mut line = [DVec4::ZERO; MAX_DEGREE + 1];
    for row in net.chunks_exact_mut(q + 1) {
        line[..=q].copy_from_slice(row);
        row.copy_from_slice(&bezier(q, &surface.knots[1], spans[1], &line)[..=q]);
    }
    for column in 0..=q {
        for i in 0..=p {
            line[i] = net[i * (q + 1) + column];
        }
        let poles = bezier(p, &surface.knots[0], spans[0], &line);
        for i in 0..=p {
            net[i * (q + 1) + column] = poles[i];
        }
    }
    let corner =
        |side: usize| DVec2::new(surface.knots[0][spans[0] + side], surface.knots[1][spans[1] + side]);
    BezierPatch { degrees: [p, q], net, range: [corner(0), corner(1)] }
}

/// The Bézier points of a span of a B-spline: point j is the polar form of the span at its lower end, degree - j times, and its
/// upper end, j times.
fn bezier<P: Mix>(
    degree: usize,
    knots: &[f64],
    span: usize,
    poles: &[P; MAX_DEGREE + 1],
) -> [P; MAX_DEGREE + 1] {
    let [low, high] = [knots[span], knots[span + 1]];
    let mut found = *poles;
    for (j, point) in found.iter_mut().enumerate().take(degree + 1) {
        let mut line = *poles;
        for level in 1..=degree {
            let at = if level <= j { high } else { low };
            for i in (level..=degree).rev() {
                let before = knots[span - degree + i];
                let after = knots[span + 1 + i - level];
                line[i] = line[i - 1].mix(line[i], (at - before) / (after - before));
            }
        }
        *point = line[degree];
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix;
    use crate::spline::samples::{sphere, torus, wavy};

    #[test]
    fn patches_are_the_surface() {
        let mut random = SplitMix(5);
        // One whose knots do not repeat at the ends.
        let loose = NurbsSurface {
            knots: [(0..10).map(f64::from).collect(), (0..10).map(|i| f64::from(i * i)).collect()],
            ..wavy(6)
        };
        for (surface, count) in [(sphere(2.0), 8), (torus(3.0, 1.0), 16), (wavy(7), 16), (loose, 9)] {
            let patches = patches(&surface);
            assert_eq!(patches.len(), count);
            for patch in patches {
                for _ in 0..50 {
                    let unit = DVec2::new(random.between(0.0, 1.0), random.between(0.0, 1.0));
                    let at = patch.range[0] + unit * (patch.range[1] - patch.range[0]);
                    assert!(patch.point(unit).distance(surface.derivatives(at)[0]) < 1e-13);
                }
            }
        }
    }
}
