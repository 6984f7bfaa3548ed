//! Newton's iteration in a bracket.

/// The x in a bracket where a function that does not descend is 0: Newton's iteration, with a bisection where
/// it leaves the bracket, until x settles to 1e-15 of its size. `function` returns value and slope.
pub(super) fn root([mut low, mut high]: [f64; 2], start: f64, function: impl Fn(f64) -> (f64, f64)) -> f64 {
    let mut x = start;
    for _ in 0..200 {
        let (value, slope) = function(x);
        if value == 0.0 {
            return x;
        }
        if value > 0.0 {
            high = x;
        } else {
            low = x;
        }
        let newton = x - value / slope;
        let next = if low <= newton && newton <= high { newton } else { 0.5 * (low + high) };
        let settled = 1e-15 * x.abs().max(1.0);
        if (next - x).abs() <= settled || high - low <= settled {
            return next;
        }
        x = next;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::root;
    use rebounce_shared::elementary::Elementary;

    #[test]
    fn roots_of_kepler_and_cubic() {
        for i in 0..=100 {
            let mean = -3.0 + 0.06 * f64::from(i);
            let at = root([mean - 1.0, mean + 1.0], mean, |t| (t - t.sine() - mean, 1.0 - t.cosine()));
            assert!((at - at.sine() - mean).abs() < 1e-14);
        }
        assert!(root([-1.0, 2.0], 2.0, |t| (t * t * t, 3.0 * t * t)).abs() < 1e-10);
    }
}
