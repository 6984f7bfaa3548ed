//! Roots of two polynomials in two variables, in Bernstein form.

use super::bezier_patch::cut_net;
use crate::basis::bernstein;
use glam::DVec2;
use smallvec::{SmallVec, smallvec};

/// Most pieces that are looked at side by side; beyond it, the roots are no points but curves (see [`PlaneNet::roots`]).
pub const MAX_PIECES: usize = 256;

/// How far outside a piece a root may lie that counts as its own, in multiples of the domain.
const MARGIN: f64 = 1e-11;

/// Roots, on the stack up to four.
pub type PlaneRoots = SmallVec<[DVec2; 4]>;

/// A polynomial map F of the unit square into the plane, by its Bézier control points, v fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaneNet<'a> {
    /// Degrees in u and v.
    pub degrees: [usize; 2],
    /// Control points.
    pub net: &'a [DVec2],
    /// Rounding error of the control points: what is nearer to 0 may be 0.
    pub noise: f64,
    /// Where |F| is no more than this, F counts as 0; at least twice `noise`.
    pub tolerance: f64,
}

impl PlaneNet<'_> {
    /// [F, Fᵤ, Fᵥ].
    pub fn derivatives(&self, at: DVec2) -> [DVec2; 3] {
        let [values_u, slopes_u] = bernstein(self.degrees[0], at.x);
        let [values_v, slopes_v] = bernstein(self.degrees[1], at.y);
        let mut found = [DVec2::ZERO; 3];
        for (i, row) in self.net.chunks_exact(self.degrees[1] + 1).enumerate() {
            let [mut value, mut slope] = [DVec2::ZERO; 2];
            for (j, &pole) in row.iter().enumerate() {
                value += values_v[j] * pole;
                slope += slopes_v[j] * pole;
            }
            found[0] += values_u[i] * value;
            found[1] += slopes_u[i] * value;
            found[2] += values_u[i] * slope;
        }
        found
    }

    /// All roots in the closed unit square.
    ///
    /// Binary subdivision: a piece is let go only when 0 lies outside the convex hull of its control points (Nishita, Sederberg and
    /// Kakimoto 1990). Where the derivative's control points prove the piece one to one, Newton's method finds its only root
    /// (single-solution test, Hanniel and Elber 2007); where it does not, the piece is halved until all its control points are
    /// within `tolerance` of 0, and a place of it counts as a root. Roots that are joined by a line on which |F| is no more than twice
    /// the tolerance are one: double roots, and edges of the square that F takes to 0.
    ///
    /// Where the roots are a curve, more than [`MAX_PIECES`] pieces remain at some depth. Then each gives what the
    /// Gauss-Newton method finds from its middle: some points of the curve, and of roots elsewhere.
    pub fn roots(&self) -> PlaneRoots {
        let mut found = PlaneRoots::new();
        if is_apart(self.net, self.noise) {
            return found;
        }
        let length = self.net.len();
        let mut live: SmallVec<[[DVec2; 2]; 8]> = smallvec![[DVec2::ZERO, DVec2::ONE]];
        // Control points of the pieces; of the whole they are the map's own.
        let mut nets: SmallVec<[DVec2; 128]> = SmallVec::new();
        let (mut next, mut next_nets) = (SmallVec::new(), SmallVec::new());
        while !live.is_empty() {
            for (index, range) in live.iter().enumerate() {
                let net =
                    if nets.is_empty() { self.net } else { &nets[index * length..(index + 1) * length] };
                if !nets.is_empty() && is_apart(net, self.noise) {
                    continue;
                }
                if live.len() > MAX_PIECES || net.iter().all(|pole| pole.length() <= self.tolerance) {
                    if let Some(root) = self.settled(*range) {
                        self.add(root, &mut found);
                    }
                    continue;
                }
                let slopes = Slopes::of(self.degrees, net, self.noise);
                if slopes.are_one_to_one
                    && let Some(root) = self.polished(*range)
                {
                    self.add(root, &mut found);
                    continue;
                }
                let direction = slopes.steeper;
                let start = next_nets.len();
                next_nets.extend_from_slice(net);
                next_nets.extend_from_slice(net);
                let (below, above) = next_nets[start..].split_at_mut(length);
                cut_net(self.degrees, direction, 0.5, below, above);
                let middle = 0.5 * (range[0][direction] + range[1][direction]);
                let mut halves = [*range; 2];
                halves[0][1][direction] = middle;
                halves[1][0][direction] = middle;
                next.extend(halves);
            }
            std::mem::swap(&mut live, &mut next);
            std::mem::swap(&mut nets, &mut next_nets);
            next.clear();
            next_nets.clear();
        }
        found
    }

    /// The root that Newton's method finds from the middle of a piece, if it lies within it.
    fn polished(&self, range: [DVec2; 2]) -> Option<DVec2> {
        let mut at = 0.5 * (range[0] + range[1]);
        let reach = range[1] - range[0];
        for _ in 0..16 {
            let [value, by_u, by_v] = self.derivatives(at);
            let determinant = by_u.perp_dot(by_v);
            let step = DVec2::new(value.perp_dot(by_v), by_u.perp_dot(value)) / determinant;
            at -= step;
            // False for what is not a number, too.
            let is_near = at.cmpge(range[0] - reach).all() && at.cmple(range[1] + reach).all();
            if !is_near {
                return None;
            }
            if step.abs().max_element() < 1e-13 || value.length() <= 0.1 * self.noise {
                let is_within = at.cmpge(range[0] - MARGIN).all() && at.cmple(range[1] + MARGIN).all();
                return is_within.then(|| at.clamp(DVec2::ZERO, DVec2::ONE));
            }
        }
        None
    }

    /// A place in or next to a piece where F counts as 0, from its middle by the Gauss-Newton method with a little damping
    /// (Levenberg 1944), which takes singular derivatives.
    fn settled(&self, range: [DVec2; 2]) -> Option<DVec2> {
        let mut at = 0.5 * (range[0] + range[1]);
        let [low, high] = [range[0] - MARGIN, range[1] + MARGIN];
        // |F| and where.
        let mut least = (f64::INFINITY, at);
        for _ in 0..8 {
            let [value, by_u, by_v] = self.derivatives(at);
            if value.length() < least.0 {
                least = (value.length(), at);
            } else {
                break;
            }
            let [uu, uv, vv] = [by_u.length_squared(), by_u.dot(by_v), by_v.length_squared()];
            let damping = 1e-12 * (uu + vv);
            let [a, d] = [uu + damping, vv + damping];
            let pull = DVec2::new(by_u.dot(value), by_v.dot(value));
            let step = DVec2::new(d * pull.x - uv * pull.y, a * pull.y - uv * pull.x) / (a * d - uv * uv);
            if !step.is_finite() {
                break;
            }
            at = (at - step).clamp(low, high).clamp(DVec2::ZERO, DVec2::ONE);
        }
        (least.0 <= self.tolerance).then_some(least.1)
    }

    /// Adds a root unless it is one of those found.
    fn add(&self, root: DVec2, found: &mut PlaneRoots) {
        let is_old = found.iter().any(|&old| {
            [0.25, 0.5, 0.75]
                .into_iter()
                .all(|t| self.derivatives(old.lerp(root, t))[0].length() <= 2.0 * self.tolerance)
        });
        if !is_old {
            found.push(root);
        }
    }
}

/// Whether a line through 0 leaves all points on one side, further from it than `noise`: 0 is not in their convex hull.
fn is_apart(points: &[DVec2], noise: f64) -> bool {
    let Some(&first) = points.first() else { return true };
    // The angle that the points take up, counterclockwise from `right` to `left`, while it is less than half a turn.
    let [mut right, mut left] = [first, first];
    for &point in points {
        let [after, before] = [right.perp_dot(point), point.perp_dot(left)];
        if after >= 0.0 && before >= 0.0 {
            if point.dot(right) <= 0.0 && point.dot(left) <= 0.0 {
                return false;
            }
        } else if after > 0.0 {
            left = point;
        } else if before > 0.0 {
            right = point;
        } else {
            return false;
        }
    }
    let normal = right.normalize_or_zero() + left.normalize_or_zero();
    let normal = normal.normalize_or_zero();
    points.iter().all(|point| point.dot(normal) > noise)
}

/// What the derivatives of a piece tell.
struct Slopes {
    /// Whether F is one to one on the piece.
    are_one_to_one: bool,
    /// The direction in which F changes more: u (0) or v (1).
    steeper: usize,
}

impl Slopes {
    fn of(degrees: [usize; 2], net: &[DVec2], noise: f64) -> Self {
        let [p, q] = degrees;
        let columns = q + 1;
        // Mean derivatives; the sums along the rows telescope.
        let mean_u = (0..columns).map(|j| net[p * columns + j] - net[j]).sum::<DVec2>() / columns as f64;
        let mean_v = net.chunks_exact(columns).map(|row| row[q] - row[0]).sum::<DVec2>() / (p + 1) as f64;
        let determinant = mean_u.perp_dot(mean_v);
        // Derivatives multiplied by the inverse of their mean: the least of the diagonal, the greatest off it.
        let scale = 1.0 / determinant;
        let inverse = |slope: DVec2| DVec2::new(slope.perp_dot(mean_v), mean_u.perp_dot(slope)) * scale;
        let [mut least, mut greatest, mut change] = [DVec2::INFINITY, DVec2::ZERO, DVec2::ZERO];
        for i in 0..=p {
            for j in 0..=q {
                let pole = net[i * columns + j];
                if i < p {
                    let slope = p as f64 * (net[(i + 1) * columns + j] - pole);
                    let turned = inverse(slope);
                    least.x = least.x.min(turned.x);
                    greatest.x = greatest.x.max(turned.y.abs());
                    change.x = change.x.max(slope.length_squared());
                }
                if j < q {
                    let slope = q as f64 * (net[i * columns + j + 1] - pole);
                    let turned = inverse(slope);
                    least.y = least.y.min(turned.y);
                    greatest.y = greatest.y.max(turned.x.abs());
                    change.y = change.y.max(slope.length_squared());
                }
            }
        }
        // Then x · J x > 0 for any mean J of derivatives and any x, so that no two points of the (convex) piece have one image.
        let off = greatest.x + greatest.y;
        // Rounding errors of derivatives, after the inverse, must be small against 1.
        let error = 2.0 * p.max(q) as f64 * noise * mean_u.length().max(mean_v.length());
        let is_certain = determinant.abs() > 100.0 * error;
        let are_one_to_one = is_certain && least.min_element() > 0.05 && 3.0 * least.x * least.y > off * off;
        Self { are_one_to_one, steeper: usize::from(change.y > change.x) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix;

    /// The net whose map is this one, of degree 2 in each direction and 3 in v alone at most: by interpolation.
    fn conic(f: impl Fn(DVec2) -> DVec2) -> PlaneNet<'static> {
        let mut net = vec![DVec2::ZERO; 9];
        // Quadratic Bézier control points of a function are f(0), 2 f(1/2) - (f(0) + f(1)) / 2 and f(1).
        let line = |g: &dyn Fn(f64) -> DVec2| [g(0.0), 2.0 * g(0.5) - 0.5 * (g(0.0) + g(1.0)), g(1.0)];
        for j in 0..3 {
            for (i, pole) in line(&|u| line(&|v| f(DVec2::new(u, v)))[j]).into_iter().enumerate() {
                net[i * 3 + j] = pole;
            }
        }
        PlaneNet { degrees: [2, 2], net: net.leak(), noise: 1e-15, tolerance: 1e-12 }
    }

    #[test]
    fn a_hull_is_apart_from_zero_where_a_line_parts_them() {
        let mut random = SplitMix(8);
        for _ in 0..20_000 {
            let points: Vec<_> =
                (0..5).map(|_| DVec2::new(random.between(-1.0, 0.2), random.between(-1.0, 1.0))).collect();
            let expected = (0..3600).any(|step| {
                let normal = DVec2::from_angle(f64::from(step) * std::f64::consts::TAU / 3600.0);
                points.iter().all(|point| point.dot(normal) > 0.0)
            });
            // The directions tried are a thousandth apart, and miss what a narrower gap would let through.
            let narrow = (0..3600).any(|step| {
                let normal = DVec2::from_angle(f64::from(step) * std::f64::consts::TAU / 3600.0);
                points.iter().all(|point| point.dot(normal) > -2e-3)
            });
            let found = is_apart(&points, 0.0);
            assert!(found || !expected);
            assert!(!found || narrow);
        }
    }

    #[test]
    fn roots_of_a_circle_and_a_line() {
        // x² + y² = r² about the middle, and y = 0.2 + 0.1 x.
        let mut random = SplitMix(9);
        for _ in 0..2000 {
            let [radius, slope, offset] =
                [random.between(0.1, 0.6), random.between(-1.0, 1.0), random.between(-0.5, 0.5)];
            let net = conic(|at| {
                let at = at - 0.5;
                DVec2::new(at.length_squared() - radius * radius, at.y - offset - slope * at.x)
            });
            let [a, b, c] = [1.0 + slope * slope, slope * offset, offset * offset - radius * radius];
            let under = b * b - a * c;
            let mut expected = Vec::new();
            if under > 0.0 {
                for sign in [-1.0, 1.0] {
                    let x = (-b + sign * under.sqrt()) / a;
                    expected.push(DVec2::new(x, offset + slope * x) + 0.5);
                }
            }
            expected.retain(|at| at.cmpge(DVec2::ZERO).all() && at.cmple(DVec2::ONE).all());
            let found = net.roots();
            assert_eq!(found.len(), expected.len());
            for root in expected {
                assert!(found.iter().any(|at| at.distance(root) < 1e-12 / under));
            }
        }
    }

    #[test]
    fn roots_at_borders_double_roots_and_collapsed_edges() {
        let corner = conic(|at| at);
        assert_eq!(corner.roots()[..], [DVec2::ZERO]);
        let middle = DVec2::new(0.3, 0.6);
        let double = conic(|at| DVec2::new(at.x - 0.3, (at.y - 0.6).powi(2))).roots();
        assert_eq!(double.len(), 1);
        assert!(double[0].distance(middle) < 2e-6);
        // The edge v = 1 is one point.
        let pole = conic(|at| (1.0 - at.y) * DVec2::new(1.0 + at.x, 1.0 - at.x)).roots();
        assert_eq!(pole.len(), 1);
        assert!((pole[0].y - 1.0).abs() < 1e-12);
    }

    #[test]
    fn curves_of_roots_end() {
        let skew = conic(|at| DVec2::new(at.x + 0.7 * at.y - 0.8, 0.0)).roots();
        assert!(!skew.is_empty() && skew.len() < 4);
        assert_eq!(conic(|_| DVec2::ZERO).roots().len(), 1);
    }
}
