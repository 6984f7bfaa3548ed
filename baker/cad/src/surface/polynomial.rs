//! Real roots of quadratics and cubics, and a root between two places.

use std::ops::Deref;

/// At most four numbers, ascending. A slice, by [`Deref`].
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Roots {
    roots: [f64; 4],
    count: usize,
}

impl Roots {
    /// Adds one that is finite; beyond four, none.
    pub fn push(&mut self, root: f64) {
        if root.is_finite()
            && let Some(place) = self.roots.get_mut(self.count)
        {
            *place = root;
            self.count += 1;
        }
    }
}

impl Deref for Roots {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        &self.roots[..self.count]
    }
}

/// Where the search for a root begins at an end of the interval at least, in multiples of it.
const FARTHEST_START: f64 = 0.1;

/// Roots of a s² + 2 b s + c. The caller computes the discriminant b² − a c, which it knows how to do without cancellation. Nor do
/// the roots cancel: the greater one in magnitude is q / a, the other c / q (Press et al., "Numerical Recipes", section 5.6). A
/// root that a vanishing a sends to infinity is left out; a double root comes twice.
pub(crate) fn quadratic(a: f64, b: f64, c: f64, discriminant: f64) -> Roots {
    let mut roots = Roots::default();
    if discriminant >= 0.0 {
        let q = -(b + discriminant.sqrt().copysign(b));
        // Where q is 0, so are b and the discriminant, and a double root is 0.
        let [one, other] = if q == 0.0 { [0.0 / a; 2] } else { [q / a, c / q] };
        roots.push(one.min(other));
        roots.push(one.max(other));
    }
    roots
}

/// Roots of s³ + p s + q within [low, high], each to `tolerance`: between the places where the slope is 0 there is at most one
/// each (Yuksel, "High-performance polynomial root finding for graphics", 2022). A double root may be left out.
pub(crate) fn depressed_cubic(p: f64, q: f64, [low, high]: [f64; 2], tolerance: f64) -> Roots {
    let polynomial = |s: f64| ((s * s + p) * s + q, 3.0 * s * s + p);
    let turn = (-p / 3.0).max(0.0).sqrt();
    let mut roots = Roots::default();
    let mut from = low;
    for to in [-turn, turn, high] {
        let to = to.clamp(from, high);
        if let Some(root) = root_between(polynomial, [from, to], tolerance) {
            roots.push(root);
        }
        from = to;
    }
    roots
}

/// The root of a function in an interval where it changes sign once, by Newton's method kept within the interval by bisection
/// (Press et al., "Numerical Recipes", section 9.4). `None` if the ends have the same sign, 0 counted as positive. `function`
/// gives value and slope; `tolerance` is of both values and places.
pub(crate) fn root_between(
    function: impl Fn(f64) -> (f64, f64),
    [mut low, mut high]: [f64; 2],
    tolerance: f64,
) -> Option<f64> {
    let ends = [function(low).0, function(high).0];
    let is_low_negative = ends[0] < 0.0;
    if is_low_negative == (ends[1] < 0.0) {
        return None;
    }
    // Where the chord is 0, but not near an end: there the function may be flat.
    let chord = ends[0] / (ends[0] - ends[1]);
    let share = if chord.is_nan() { 0.5 } else { chord.clamp(FARTHEST_START, 1.0 - FARTHEST_START) };
    let mut s = low + share * (high - low);
    let mut step = high - low;
    // Every second step at least halves, or the interval does: 1e-16 of it is reached.
    for _ in 0..120 {
        let (value, slope) = function(s);
        if value.abs() <= tolerance {
            break;
        }
        if (value < 0.0) == is_low_negative {
            low = s
        } else {
            high = s
        }
        let newton = s - value / slope;
        let next = if newton > low && newton < high && (newton - s).abs() < 0.5 * step {
            newton
        } else {
            0.5 * (low + high)
        };
        step = (next - s).abs();
        s = next;
        if step <= tolerance {
            break;
        }
    }
    Some(s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rebounce_shared::elementary::Elementary;

    #[test]
    fn quadratic_keeps_the_small_root() {
        // (s − 1e9) (s − 1e-9): the school formula loses the second.
        let [b, c] = [-0.5 * (1e9 + 1e-9), 1.0];
        let roots = quadratic(1.0, b, c, b * b - c);
        assert!((roots[0] - 1e-9).abs() < 1e-24 && (roots[1] - 1e9).abs() < 1e-6);
        // Linear, double, none.
        assert_eq!(&*quadratic(0.0, 1.0, -4.0, 1.0), &[2.0]);
        assert_eq!(&*quadratic(2.0, 0.0, 0.0, 0.0), &[0.0, 0.0]);
        assert!(quadratic(1.0, 0.0, 1.0, -1.0).is_empty());
        assert!(quadratic(0.0, 0.0, 1.0, 0.0).is_empty());
    }

    #[test]
    fn cubic_has_the_roots_it_is_made_of() {
        for a in [-0.9, -0.3, 0.0, 0.1, 0.4] {
            for b in [-0.7, -0.2, 0.3, 0.55] {
                let mut made = [a, b, -a - b];
                made.sort_by(f64::total_cmp);
                if made[1] - made[0] < 1e-9 || made[2] - made[1] < 1e-9 {
                    continue;
                }
                let (p, q) = (a * b - (a + b) * (a + b), a * b * (a + b));
                let roots = depressed_cubic(p, q, [-2.0, 2.0], 1e-15);
                assert_eq!(roots.len(), 3, "{made:?} {roots:?}");
                for (root, made) in roots.iter().zip(made) {
                    assert!((root - made).abs() < 1e-13, "{root} {made}");
                }
                assert_eq!(depressed_cubic(p, q, [made[0] + 1e-3, 2.0], 1e-15).len(), 2);
            }
        }
        assert_eq!(depressed_cubic(1.0, -2.0, [-3.0, 3.0], 1e-15).len(), 1);
    }

    #[test]
    fn root_between_survives_flat_functions() {
        // Newton alone flies off from the flanks of an arctangent, and creeps to a root of order 9.
        let arctangent = |s: f64| ((s - 0.3).arc_tangent(), 1.0 / (1.0 + (s - 0.3).powi(2)));
        let root = root_between(arctangent, [-1e3, 1e4], 1e-15).unwrap();
        assert!((root - 0.3).abs() < 1e-13);
        let flat = |s: f64| ((s - 0.3).powi(9), 9.0 * (s - 0.3).powi(8));
        let root = root_between(flat, [-1.0, 1.0], 0.0).unwrap();
        assert!((root - 0.3).abs() < 1e-12);
        assert!(root_between(|_| (f64::NAN, f64::NAN), [0.0, 1.0], 1e-15).is_none());
    }
}
