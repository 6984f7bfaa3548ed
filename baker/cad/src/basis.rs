//! B-spline basis functions (Piegl and Tiller 1997, "The NURBS Book", algorithms A2.1 to A2.3).

/// Highest degree that the functions here take.
pub const MAX_DEGREE: usize = 25;

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

/// The basis functions of a span, whose poles are `span - degree` to `span`, and their derivatives by the parameter: [values,
/// derivatives]. (A2.2; the derivatives are differences of the functions a degree lower, as in A2.3.)
pub fn functions(degree: usize, knots: &[f64], span: usize, at: f64) -> [Values; 2] {
    let mut values: Values = [0.0; MAX_DEGREE + 1];
    let mut derivatives: Values = [0.0; MAX_DEGREE + 1];
    values[0] = 1.0;
    for current in 1..=degree {
        let mut carried = 0.0;
        let mut carried_slope = 0.0;
        for i in 0..current {
            let after = knots[span + i + 1];
            let before = knots[span + i + 1 - current];
            // Never 0: the two enclose the span.
            let share = values[i] / (after - before);
            values[i] = carried + (after - at) * share;
            carried = (at - before) * share;
            if current == degree {
                let slope = degree as f64 * share;
                derivatives[i] = carried_slope - slope;
                carried_slope = slope;
            }
        }
        values[current] = carried;
        if current == degree {
            derivatives[current] = carried_slope;
        }
    }
    [values, derivatives]
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
            let [values, slopes] = functions(3, &KNOTS, span, at);
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
