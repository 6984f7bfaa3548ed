//! Legendre polynomials, to interpolate a function between the nodes of a Gauss–Legendre rule and to
//! integrate it.

use super::root::root;
use crate::quadrature::GAUSS_8;

/// Nodes of a rule, and coefficients of a series.
pub(super) const ORDER: usize = GAUSS_8.len();

/// Coefficients by degree of a sum of Legendre polynomials on −1 to 1.
pub(super) type Series = [f64; ORDER];

/// P₀ to P₈, by Bonnet's recursion.
pub(super) fn polynomials(x: f64) -> [f64; ORDER + 1] {
    let mut values = [1.0; ORDER + 1];
    values[1] = x;
    for k in 1..ORDER {
        let degree = k as f64;
        values[k + 1] = ((2.0 * degree + 1.0) * x * values[k] - degree * values[k - 1]) / (degree + 1.0);
    }
    values
}

/// The series through values at the nodes of the rule.
pub(super) fn series(values: &[f64; ORDER]) -> Series {
    let mut series = [0.0; ORDER];
    for ((node, weight), value) in GAUSS_8.iter().zip(values) {
        let at_node = polynomials(*node);
        for (k, coefficient) in series.iter_mut().enumerate() {
            *coefficient += (k as f64 + 0.5) * weight * value * at_node[k];
        }
    }
    series
}

/// A series at x.
pub(super) fn value(series: &Series, x: f64) -> f64 {
    polynomials(x).iter().zip(series).map(|(p, c)| p * c).sum()
}

/// Its integral from −1 to x: (2k + 1) ∫ Pₖ = Pₖ₊₁ − Pₖ₋₁.
pub(super) fn integral(series: &Series, x: f64) -> f64 {
    let p = polynomials(x);
    let first = series[0] * (x + 1.0);
    (1..ORDER).fold(first, |sum, k| sum + series[k] * (p[k + 1] - p[k - 1]) / (2 * k + 1) as f64)
}

/// The x from −1 to 1 at which the integral of a series that is not negative is `target`: Newton's iteration,
/// bisection where that leaves the bracket.
pub(super) fn inverse_integral(series: &Series, target: f64) -> f64 {
    let whole = 2.0 * series[0];
    if target <= 0.0 || target >= whole || whole.is_nan() {
        return if target <= 0.0 { -1.0 } else { 1.0 };
    }
    let start = target / series[0] - 1.0;
    root([-1.0, 1.0], start, |x| (integral(series, x) - target, value(series, x)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_of_degree_seven_are_integrated_exactly() {
        let f = |x: f64| 1.0 + x + 3.0 * x.powi(2) - x.powi(5) + 0.5 * x.powi(7) + 4.0;
        let antiderivative = |x: f64| 5.0 * x + x * x / 2.0 + x.powi(3) - x.powi(6) / 6.0 + x.powi(8) / 16.0;
        let series = series(&GAUSS_8.map(|(node, _)| f(node)));
        for i in 0..=40 {
            let x = f64::from(i) / 20.0 - 1.0;
            assert!((value(&series, x) - f(x)).abs() < 1e-13);
            let exact = antiderivative(x) - antiderivative(-1.0);
            assert!((integral(&series, x) - exact).abs() < 1e-13);
            assert!((inverse_integral(&series, exact) - x).abs() < 1e-13);
        }
    }
}
