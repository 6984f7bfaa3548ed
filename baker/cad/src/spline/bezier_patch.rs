//! Rational Bézier patch.

use crate::basis::bernstein;
use glam::{DVec2, DVec3, DVec4};

/// A rational Bézier patch: a piece of a surface, over a rectangle of its parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct BezierPatch {
    /// Degrees in u and v, at least 1.
    pub degrees: [usize; 2],
    /// Homogeneous control points, (w x, w y, w z, w) with w above 0, v fastest: (degree + 1) of u times (degree + 1) of v.
    pub net: Vec<DVec4>,
    /// Parameters of the surface at the corners: least and greatest.
    pub range: [DVec2; 2],
}

impl BezierPatch {
    /// The point at parameters from 0 to 1.
    pub fn point(&self, at_unit: DVec2) -> DVec3 {
        let place = self.homogeneous(at_unit);
        place.truncate() / place.w
    }

    /// The point at parameters from 0 to 1, (w x, w y, w z, w).
    pub fn homogeneous(&self, at_unit: DVec2) -> DVec4 {
        let [values_u, _] = bernstein(self.degrees[0], at_unit.x);
        let [values_v, _] = bernstein(self.degrees[1], at_unit.y);
        let rows = self.net.chunks_exact(self.degrees[1] + 1);
        let along =
            |row: &[DVec4]| row.iter().zip(values_v).map(|(&pole, value)| value * pole).sum::<DVec4>();
        rows.zip(values_u).map(|(row, value)| value * along(row)).sum()
    }

    /// A control point by its index in the net.
    pub fn pole(&self, index: usize) -> DVec3 {
        self.net[index].truncate() / self.net[index].w
    }

    /// A box about the control points, least and greatest corner: the patch lies within their convex hull.
    pub fn bounds(&self) -> [DVec3; 2] {
        (0..self.net.len()).fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[least, greatest], index| {
            [least.min(self.pole(index)), greatest.max(self.pole(index))]
        })
    }

    /// Both halves, cut across u (0) or v (1). (de Casteljau)
    pub fn halves(&self, direction: usize) -> [Self; 2] {
        self.cut(direction, 0.5)
    }

    /// The pieces below and above a parameter from 0 to 1 of u (0) or v (1). (de Casteljau)
    pub fn cut(&self, direction: usize, at_unit: f64) -> [Self; 2] {
        let [mut below, mut above] = [self.clone(), self.clone()];
        cut_net(self.degrees, direction, at_unit, &mut below.net, &mut above.net);
        let [low, high] = self.range.map(|corner| corner[direction]);
        let middle = low + at_unit * (high - low);
        below.range[1][direction] = middle;
        above.range[0][direction] = middle;
        [below, above]
    }

    /// The piece over a rectangle of the surface's parameters, as far as it lies within the patch.
    pub fn within(&self, rectangle: [DVec2; 2]) -> Self {
        let mut piece = self.clone();
        for direction in 0..2 {
            // From above, then from below: what is cut off last begins at the least parameter of the rest.
            for (side, corner) in rectangle.iter().enumerate().rev() {
                let [low, high] = piece.range.map(|corner| corner[direction]);
                let at_unit = (corner[direction] - low) / (high - low);
                if at_unit > 0.0 && at_unit < 1.0 {
                    let [below, above] = piece.cut(direction, at_unit);
                    piece = if side == 1 { below } else { above };
                }
            }
        }
        piece
    }
}

/// Points that de Casteljau's algorithm can mix.
pub(crate) trait Mix: Copy {
    /// (1 - t) of this and t of the other.
    fn mix(self, other: Self, t: f64) -> Self;
}

impl Mix for DVec2 {
    fn mix(self, other: Self, t: f64) -> Self {
        self.lerp(other, t)
    }
}

impl Mix for DVec4 {
    fn mix(self, other: Self, t: f64) -> Self {
        self.lerp(other, t)
    }
}

/// de Casteljau's algorithm on each row or column of a net. `above` holds the net, and in the end the part above the parameter;
/// `below`, of the same length, gets the part below it.
pub(crate) fn cut_net<P: Mix>(
    degrees: [usize; 2],
    direction: usize,
    at_unit: f64,
    below: &mut [P],
    above: &mut [P],
) {
    let columns = degrees[1] + 1;
    // Steps along the direction, and from one row or column to the next.
    let ([along, across], lines) =
        if direction == 0 { ([columns, 1], columns) } else { ([1, columns], degrees[0] + 1) };
    let degree = degrees[direction];
    for line in 0..lines {
        let start = line * across;
        below[start] = above[start];
        for level in 1..=degree {
            for index in 0..=degree - level {
                let here = start + index * along;
                above[here] = above[here].mix(above[here + along], at_unit);
            }
            below[start + level * along] = above[start];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix;
    use crate::spline::samples::wavy;
    use crate::spline::split::patches;

    #[test]
    fn pieces_are_the_patch() {
        let mut random = SplitMix(3);
        let patch = &patches(&wavy(6))[4];
        for direction in 0..2 {
            let at = random.between(0.1, 0.9);
            let [below, above] = patch.cut(direction, at);
            for _ in 0..200 {
                let unit = DVec2::new(random.between(0.0, 1.0), random.between(0.0, 1.0));
                let mut whole = unit;
                whole[direction] *= at;
                assert!(below.point(unit).distance(patch.point(whole)) < 1e-14);
                whole[direction] = at + (1.0 - at) * unit[direction];
                assert!(above.point(unit).distance(patch.point(whole)) < 1e-14);
            }
        }
    }

    #[test]
    fn a_patch_lies_within_its_bounds() {
        let mut random = SplitMix(4);
        for patch in patches(&wavy(6)) {
            let [least, greatest] = patch.bounds();
            for _ in 0..200 {
                let place = patch.point(DVec2::new(random.between(0.0, 1.0), random.between(0.0, 1.0)));
                assert!(place.cmpge(least).all() && place.cmple(greatest).all());
            }
        }
    }
}
