//! Antiderivatives of area elements that depend on one parameter: closed forms and their inverses, or a
//! table.

use super::cumulative::Cumulative;
use super::root::root;
use rebounce_shared::elementary::Elementary;
use std::f64::consts::FRAC_PI_2;

/// G with G′ = g, a density that is not negative within the limits. Beyond them the parameter is clamped.
#[derive(Clone, Debug)]
pub(super) struct Antiderivative {
    form: Form,
    /// The parameters between which g is not negative; may be infinite.
    limits: [f64; 2],
}

/// Formula of g.
#[derive(Clone, Debug)]
pub(super) enum Form {
    /// g = density.
    Constant {
        /// Above 0.
        density: f64,
    },
    /// g = side (constant + slope t), as of a cone.
    Linear {
        /// At t = 0.
        constant: f64,
        /// Not 0.
        slope: f64,
        /// 1, or −1 where the line is below 0.
        side: f64,
    },
    /// g = mean + amplitude cos(t + phase), as of a torus. G = mean t + amplitude sin(t + phase) is inverted
    /// as Kepler's equation.
    Kepler {
        /// Not negative, but for the inner part of an apple.
        mean: f64,
        /// Of the cosine.
        amplitude: f64,
        /// Radians.
        phase: f64,
    },
    /// g = scale √(constant + square w²) dw/dt, as of a conic turned about its axis; see [`Substitution`].
    Conic {
        /// w.
        substitution: Substitution,
        /// Radius across the axis.
        scale: f64,
        /// Below 0 of hyperboloids of two sheets.
        constant: f64,
        /// Of any sign; above 0 if `constant` is below.
        square: f64,
    },
    /// g = scale |t| √(1 + t²), as of a paraboloid, on the side of this sign.
    Parabola {
        /// 4 F².
        scale: f64,
        /// 1 or −1.
        side: f64,
    },
    /// Any other.
    Table(Cumulative),
}

/// What w is.
#[derive(Clone, Copy, Debug)]
pub(super) enum Substitution {
    /// sin(t − base), within a quarter turn of the base: ellipses.
    Sine {
        /// The parameter farthest from the axis, radians.
        base: f64,
    },
    /// sinh t: hyperboloids of one sheet.
    HyperbolicSine,
    /// side · cosh t where t has the sign of `side`: hyperboloids of two sheets.
    HyperbolicCosine {
        /// 1 or −1.
        side: f64,
    },
}

impl Antiderivative {
    /// Of a formula that holds between limits.
    pub(super) fn new(form: Form, limits: [f64; 2]) -> Self {
        Self { form, limits }
    }

    /// Of a constant density, everywhere.
    pub(super) fn constant(density: f64) -> Self {
        Self::new(Form::Constant { density }, [f64::NEG_INFINITY, f64::INFINITY])
    }

    /// Whether its density is constant.
    pub(super) fn is_linear(&self) -> bool {
        matches!(self.form, Form::Constant { .. })
    }

    /// Whether a range of parameters lies within the limits, but for rounding.
    pub(super) fn holds(&self, [low, high]: [f64; 2]) -> bool {
        let margin = 1e-9 * (high - low);
        self.limits[0] <= low + margin && high - margin <= self.limits[1]
    }

    /// G(t).
    pub(super) fn value(&self, t: f64) -> f64 {
        let t = t.clamp(self.limits[0], self.limits[1]);
        match &self.form {
            Form::Constant { density } => density * t,
            Form::Linear { constant, slope, side } => side * t * (constant + 0.5 * slope * t),
            Form::Kepler { mean, amplitude, phase } => mean * t + amplitude * (t + phase).sine(),
            Form::Conic { substitution, scale, constant, square } => {
                scale * root_integral(*constant, *square, substitution.forward(t))
            }
            Form::Parabola { scale, side } => side * scale / 3.0 * (1.0 + t * t).power(1.5),
            Form::Table(table) => table.value(t),
        }
    }

    /// The t within the limits with G(t) = `value`; to rounding, but for 1e-8 where g is 0.
    pub(super) fn inverse(&self, value: f64) -> f64 {
        let [low, high] = self.limits;
        let t = match &self.form {
            Form::Constant { density } => value / density,
            Form::Linear { constant, slope, side } => {
                let value = side * value;
                let here = side * (constant * constant + 2.0 * slope * value).max(0.0).sqrt();
                // Of the quadratic's two formulas the one without cancellation.
                if constant * side > 0.0 {
                    2.0 * value / (constant + here)
                } else {
                    (here - constant) / slope
                }
            }
            Form::Kepler { mean, amplitude, phase } => {
                let reach = (amplitude / mean).abs();
                let middle = value / mean;
                let bracket = [low.max(middle - reach), high.min(middle + reach)];
                let bracket = if mean.abs() > 1e-12 * amplitude.abs() { bracket } else { [low, high] };
                let start = 0.5 * (bracket[0] + bracket[1]);
                root(bracket, start, |t| {
                    let excess = mean * t + amplitude * (t + phase).sine() - value;
                    (excess, mean + amplitude * (t + phase).cosine())
                })
            }
            Form::Conic { substitution, scale, constant, square } => {
                let target = value / scale;
                let mut bracket = [low, high].map(|t| substitution.forward(t));
                for (end, outward) in bracket.iter_mut().zip([-1.0, 1.0]) {
                    if end.is_infinite() {
                        *end = outward;
                        while outward * (root_integral(*constant, *square, *end) - target) < 0.0 {
                            *end *= 2.0;
                        }
                    }
                }
                let start = 0.5 * (bracket[0] + bracket[1]);
                substitution.backward(root(bracket, start, |w| {
                    let slope = (constant + square * w * w).max(0.0).sqrt();
                    (root_integral(*constant, *square, w) - target, slope)
                }))
            }
            Form::Parabola { scale, side } => {
                side * ((3.0 * side * value / scale).max(1.0).power(2.0 / 3.0) - 1.0).max(0.0).sqrt()
            }
            Form::Table(table) => table.inverse(value),
        };
        t.clamp(low, high)
    }
}

impl Substitution {
    fn forward(self, t: f64) -> f64 {
        match self {
            Self::Sine { base } => (t - base).clamp(-FRAC_PI_2, FRAC_PI_2).sine(),
            Self::HyperbolicSine => t.hyperbolic_sine(),
            Self::HyperbolicCosine { side } => side * t.hyperbolic_cosine(),
        }
    }

    fn backward(self, w: f64) -> f64 {
        match self {
            Self::Sine { base } => base + w.clamp(-1.0, 1.0).arc_sine(),
            Self::HyperbolicSine => w.area_hyperbolic_sine(),
            Self::HyperbolicCosine { side } => side * (side * w).max(1.0).area_hyperbolic_cosine(),
        }
    }
}

/// An antiderivative of √(a + b w²), odd in w.
fn root_integral(a: f64, b: f64, w: f64) -> f64 {
    let root = (a + b * w * w).max(0.0).sqrt();
    // ∫ dw / √(a + b w²).
    let rest = if a < 0.0 {
        let beyond = (b.sqrt() * w.abs() + root) / (-a).sqrt();
        beyond.logarithm().copysign(w) / b.sqrt()
    } else if b == 0.0 {
        w / a.sqrt()
    } else if b > 0.0 {
        (w * (b / a).sqrt()).area_hyperbolic_sine() / b.sqrt()
    } else {
        (w * (-b / a).sqrt()).clamp(-1.0, 1.0).arc_sine() / (-b).sqrt()
    };
    0.5 * (w * root + a * rest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// g, by the formulas of the forms.
    fn density(form: &Form, t: f64) -> f64 {
        match *form {
            Form::Constant { density } => density,
            Form::Linear { constant, slope, side } => side * (constant + slope * t),
            Form::Kepler { mean, amplitude, phase } => mean + amplitude * (t + phase).cosine(),
            Form::Conic { substitution, scale, constant, square } => {
                let [w, speed] = match substitution {
                    Substitution::Sine { base } => [(t - base).sine(), (t - base).cosine()],
                    Substitution::HyperbolicSine => [t.hyperbolic_sine(), t.hyperbolic_cosine()],
                    Substitution::HyperbolicCosine { side } => {
                        [t.hyperbolic_cosine(), side * t.hyperbolic_sine()]
                    }
                };
                scale * (constant + square * w * w).sqrt() * speed
            }
            Form::Parabola { scale, side } => scale * side * t * (1.0 + t * t).sqrt(),
            Form::Table(_) => f64::NAN,
        }
    }

    #[test]
    fn slopes_are_the_densities_and_values_come_back() {
        let conic =
            |substitution, constant, square| Form::Conic { substitution, scale: 1.3, constant, square };
        let sine = Substitution::Sine { base: 2.0 };
        let [low, high] = [2.0 - FRAC_PI_2, 2.0 + FRAC_PI_2];
        let one_side = Substitution::HyperbolicCosine { side: 1.0 };
        let other_side = Substitution::HyperbolicCosine { side: -1.0 };
        let everywhere = [f64::NEG_INFINITY, f64::INFINITY];
        let pole = (-0.5_f64).arc_cosine();
        let forms = [
            (Form::Constant { density: 2.5 }, everywhere, [-3.0, 3.0]),
            (Form::Linear { constant: 1.0, slope: 0.4, side: 1.0 }, [-2.5, f64::INFINITY], [-2.5, 3.0]),
            (Form::Linear { constant: 1.0, slope: 0.4, side: -1.0 }, [f64::NEG_INFINITY, -2.5], [-7.0, -2.5]),
            (Form::Linear { constant: -1.0, slope: 1e-9, side: -1.0 }, everywhere, [-3.0, 3.0]),
            (Form::Kepler { mean: 2.0, amplitude: 1.5, phase: 0.3 }, everywhere, [-TAU, 3.0 * TAU]),
            (Form::Kepler { mean: 0.5, amplitude: 1.0, phase: 0.0 }, [-pole, pole], [-pole, pole]),
            (Form::Kepler { mean: 0.0, amplitude: 1.0, phase: 0.0 }, [-1.5, 1.5], [-1.5, 1.5]),
            (conic(sine, 4.0, 0.0), [low, high], [low, high]),
            (conic(sine, 4.0, 2.0), [low, high], [low, high]),
            (conic(sine, 4.0, -3.5), [low, high], [low, high]),
            (conic(Substitution::HyperbolicSine, 1.0, 3.0), everywhere, [-3.0, 3.0]),
            (conic(one_side, -1.0, 3.0), [0.0, f64::INFINITY], [0.0, 3.0]),
            (conic(other_side, -1.0, 3.0), [f64::NEG_INFINITY, 0.0], [-3.0, 0.0]),
            (Form::Parabola { scale: 0.7, side: 1.0 }, [0.0, f64::INFINITY], [0.0, 3.0]),
            (Form::Parabola { scale: 0.7, side: -1.0 }, [f64::NEG_INFINITY, 0.0], [-3.0, 0.0]),
        ];
        for (form, limits, [low, high]) in forms {
            let it = Antiderivative::new(form.clone(), limits);
            assert!(it.holds([low, high]));
            for i in 0..=200 {
                let t = low + (high - low) * f64::from(i) / 200.0;
                let h = 1e-5 * (high - low);
                if low + h < t && t < high - h {
                    let slope = (it.value(t + h) - it.value(t - h)) / (2.0 * h);
                    let expected = density(&form, t);
                    assert!((slope - expected).abs() < 1e-7 * (1.0 + expected), "{form:?} at {t}: {slope}");
                    assert!(expected >= 0.0);
                }
                let back = it.inverse(it.value(t));
                let tolerance = if density(&form, t) < 0.1 { 1e-7 } else { 1e-12 };
                assert!((back - t).abs() < tolerance, "{form:?} at {t}: {back}");
                assert!((it.value(back) - it.value(t)).abs() < 1e-12 * (1.0 + it.value(t).abs()));
            }
        }
    }
}
