//! B-spline basis functions (Piegl and Tiller 1997, "The NURBS Book", algorithms A2.1 to A2.3).

/// Highest degree that the functions here take.
pub const MAX_DEGREE: usize = 25;

/// Most control points of a curve or a surface.
pub const MAX_POLES: usize = 1_000_000;

/// A value for each of the functions that may differ from 0 at a parameter: the first `degree + 1` count.
pub type Values = [f64; MAX_DEGREE + 1];

/// The knot span of a parameter: the i with `knots[i]` ≤ t < `knots[i + 1]`, within the domain. Beyond the domain and at its end, the
/// span nearest to it. `degree` is at most [`MAX_DEGREE`], and there are at least 2 (`degree` + 1) knots. (A2.1)
pub fn span(degree: usize, knots: &[f64], at: f64) -> usize {
    let count = knots.len().saturating_sub(degree + 1);
    let inner = knots.get(degree + 1..count).unwrap_or(&[]);
    let mut span = degree + inner.partition_point(|&knot| knot <= at);
    while span > degree && knots[span] >= knots[span + 1] {
        span -= 1;
    }
    span
}

/// The basis functions of a span, whose poles are `span - degree` to `span`, and their first and second derivatives by the
/// parameter. (A2.2, and equation 2.7.)
pub fn functions(degree: usize, knots: &[f64], span: usize, at: f64) -> [Values; 3] {
    let mut lower = [[0.0; MAX_DEGREE + 1]; 2];
    let mut basis = [0.0; MAX_DEGREE + 1];
    basis[0] = 1.0;
    for q in 1..=degree {
        // Those of one and of two degrees less.
        if q == degree {
            lower[1] = basis;
        } else if q + 1 == degree {
            lower[0] = basis;
        }
        let mut saved = 0.0;
        for r in 0..q {
            let [left, right] = [at - knots[span + 1 + r - q], knots[span + 1 + r] - at];
            let quotient = basis[r] / (left + right);
            basis[r] = saved + right * quotient;
            saved = left * quotient;
        }
        basis[q] = saved;
    }
    let first = differentiate(degree, knots, span, &lower[1]);
    let second = if degree < 2 {
        [0.0; MAX_DEGREE + 1]
    } else {
        differentiate(degree, knots, span, &differentiate(degree - 1, knots, span, &lower[0]))
    };
    [basis, first, second]
}

/// Derivatives of the functions of this degree from those of one degree less (equation 2.7).
fn differentiate(degree: usize, knots: &[f64], span: usize, lower: &Values) -> Values {
    let mut result = [0.0; MAX_DEGREE + 1];
    for r in 0..degree {
        let step = degree as f64 * lower[r] / (knots[span + 1 + r] - knots[span + 1 + r - degree]);
        result[r] -= step;
        result[r + 1] += step;
    }
    result
}

/// Bernstein polynomials of a degree, at most [`MAX_DEGREE`]: [values, derivatives].
pub fn bernstein(degree: usize, at: f64) -> [Values; 2] {
    let [mut values, mut slopes]: [Values; 2] = [[0.0; MAX_DEGREE + 1]; 2];
    values[0] = 1.0;
    for current in 1..=degree {
        if current == degree {
            slopes[0] = -(degree as f64) * values[0];
            for i in 1..=degree {
                slopes[i] = degree as f64 * (values[i - 1] - values[i]);
            }
        }
        for i in (1..=current).rev() {
            values[i] = at * values[i - 1] + (1.0 - at) * values[i];
        }
        values[0] *= 1.0 - at;
    }
    [values, slopes]
}

#[cfg(test)]
mod tests {
    use super::*;

    const KNOTS: [f64; 11] = [0.0, 0.0, 0.0, 0.0, 0.3, 0.7, 0.7, 2.0, 2.0, 2.0, 2.0];

    #[test]
    fn spans_enclose_their_parameters() {
        for (at, expected) in
            [(-1.0, 3), (0.0, 3), (0.29, 3), (0.3, 4), (0.7, 6), (1.9, 6), (2.0, 6), (3.0, 6), (f64::NAN, 3)]
        {
            assert_eq!(span(3, &KNOTS, at), expected, "{at}");
        }
    }

    #[test]
    fn functions_sum_to_one_and_reproduce_the_parameter() {
        for step in 0..=200 {
            let at = step as f64 / 100.0;
            let span = span(3, &KNOTS, at);
            let [values, slopes, _] = functions(3, &KNOTS, span, at);
            assert!((values[..4].iter().sum::<f64>() - 1.0).abs() < 1e-14);
            assert!(slopes[..4].iter().sum::<f64>().abs() < 1e-13);
            // Poles at the means of the knots (Greville) make the spline the identity.
            let [mut place, mut speed] = [0.0, 0.0];
            for i in 0..4 {
                let mean = KNOTS[span - 3 + i + 1..span - 3 + i + 4].iter().sum::<f64>() / 3.0;
                place += values[i] * mean;
                speed += slopes[i] * mean;
            }
            assert!((place - at).abs() < 1e-14 && (speed - 1.0).abs() < 1e-13);
        }
    }
}
