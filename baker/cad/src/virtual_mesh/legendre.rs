//! Legendre polynomials, to interpolate a function between the nodes of a Gauss–Legendre rule and to
//! integrate it.

/// Nodes of a rule, and coefficients of a series.
pub(super) const ORDER: usize = 8;

/// Nodes from −1 to 1 and weights of the Gauss–Legendre rule of eight nodes.
pub(super) const RULE: [(f64, f64); ORDER] = [
    (-0.960_289_856_497_536_3, 0.101_228_536_290_376_3),
    (-0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (-0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (-0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_3),
];

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
    for ((node, weight), value) in RULE.iter().zip(values) {
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
    let [mut low, mut high] = [-1.0, 1.0];
    let whole = 2.0 * series[0];
    if target <= 0.0 || target >= whole || whole.is_nan() {
        return if target <= 0.0 { low } else { high };
    }
    let mut x = target / series[0] - 1.0;
    for _ in 0..64 {
        let excess = integral(series, x) - target;
        if excess > 0.0 {
            high = x;
        } else {
            low = x;
        }
        let newton = x - excess / value(series, x);
        let next = if low < newton && newton < high { newton } else { 0.5 * (low + high) };
        if (next - x).abs() <= 1e-15 || high - low <= 1e-15 {
            return next;
        }
        x = next;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_of_degree_seven_are_integrated_exactly() {
        let f = |x: f64| 1.0 + x + 3.0 * x.powi(2) - x.powi(5) + 0.5 * x.powi(7) + 4.0;
        let antiderivative = |x: f64| 5.0 * x + x * x / 2.0 + x.powi(3) - x.powi(6) / 6.0 + x.powi(8) / 16.0;
        let series = series(&RULE.map(|(node, _)| f(node)));
        for i in 0..=40 {
            let x = f64::from(i) / 20.0 - 1.0;
            assert!((value(&series, x) - f(x)).abs() < 1e-13);
            let exact = antiderivative(x) - antiderivative(-1.0);
            assert!((integral(&series, x) - exact).abs() < 1e-13);
            assert!((inverse_integral(&series, exact) - x).abs() < 1e-13);
        }
    }
}
