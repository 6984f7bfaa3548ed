//! Multiwavelets' smoothing functions: tensor products of Legendre polynomials on a cell, and their two-scale
//! relation.

use glam::{DVec2, DVec3};

/// Most functions of a cell.
pub(super) const MOST: usize = 9;

/// Order of the multiwavelet basis (Gortler et al. 1993): how many Legendre polynomials along each side of a
/// cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Order {
    /// Constant: Haar.
    M1,
    /// Linear.
    #[default]
    M2,
    /// Quadratic.
    M3,
}

impl Order {
    /// Functions along a side.
    pub fn side(self) -> usize {
        match self {
            Self::M1 => 1,
            Self::M2 => 2,
            Self::M3 => 3,
        }
    }

    /// Functions of a cell.
    pub fn functions(self) -> usize {
        self.side() * self.side()
    }
}

/// Coefficients of a cell, linear RGB: function i + n j is φᵢ(x) φⱼ(y); those beyond n² are 0. The first is
/// the mean.
pub(super) type Coefficients = [DVec3; MOST];

/// Values at the n × n Gauss points of a cell, x fastest.
pub(super) type Samples = [DVec3; MOST];

/// The basis on a cell, with x and y from 0 to 1 in it: φₖ(x) = √(2k + 1) Pₖ(2x − 1), orthonormal under the
/// mean over the cell.
///
/// So coefficients of one function are the same on cells of any size, and so are the two-scale coefficients:
/// on a surface, because its virtual mesh keeps areas (Alonso et al. 2001, 5.2).
#[derive(Clone, Debug)]
pub(super) struct Basis {
    order: Order,
    /// φₐ((x + half) / 2) = Σ `two_scale[half][a][b]` φᵦ(x).
    two_scale: [[[f64; 3]; 3]; 2],
    /// The functions at the Gauss points.
    at_points: [[f64; MOST]; MOST],
}

impl Basis {
    pub(super) fn new(order: Order) -> Self {
        let mut two_scale = [[[0.0; 3]; 3]; 2];
        for (half, coefficients) in two_scale.iter_mut().enumerate() {
            for (x, weight) in gauss(Order::M3) {
                let [parent, child] = [0.5 * (x + half as f64), x].map(legendre);
                for a in 0..3 {
                    for b in 0..3 {
                        coefficients[a][b] += weight * parent[a] * child[b];
                    }
                }
            }
        }
        let mut it = Self { order, two_scale, at_points: [[0.0; MOST]; MOST] };
        for index in 0..order.functions() {
            it.at_points[index] = it.values(it.point(index).0);
        }
        it
    }

    pub(super) fn order(&self) -> Order {
        self.order
    }

    /// Values of the functions at a point of the cell.
    pub(super) fn values(&self, at: DVec2) -> [f64; MOST] {
        let side = self.order.side();
        let [x, y] = [legendre(at.x), legendre(at.y)];
        let mut values = [0.0; MOST];
        for j in 0..side {
            for i in 0..side {
                values[i + side * j] = x[i] * y[j];
            }
        }
        values
    }

    /// The function with these coefficients at a point of the cell.
    pub(super) fn evaluate(&self, coefficients: &Coefficients, at: DVec2) -> DVec3 {
        let values = self.values(at);
        coefficients.iter().zip(values).map(|(c, value)| value * *c).sum()
    }

    /// Gauss points of a cell and their weights, whose sum is 1: below [`Order::functions`].
    pub(super) fn point(&self, index: usize) -> (DVec2, f64) {
        let side = self.order.side();
        let rule = gauss(self.order);
        let [(x, of_x), (y, of_y)] = [index % side, index / side].map(|i| rule[i]);
        (DVec2::new(x, y), of_x * of_y)
    }

    /// Coefficients of the function with these values at the Gauss points.
    pub(super) fn project(&self, samples: &Samples) -> Coefficients {
        let mut coefficients = [DVec3::ZERO; MOST];
        for (index, sample) in samples.iter().enumerate().take(self.order.functions()) {
            let weighted = self.point(index).1 * *sample;
            for (coefficient, value) in coefficients.iter_mut().zip(self.at_points[index]) {
                *coefficient += value * weighted;
            }
        }
        coefficients
    }

    /// The same function on a quarter of the cell: g of Equation 4. Quadrant 1 is that of greater x, 2 that
    /// of greater y.
    pub(super) fn push(&self, coefficients: &Coefficients, quadrant: usize) -> Coefficients {
        let side = self.order.side();
        let [of_x, of_y] = [quadrant % 2, quadrant / 2].map(|half| &self.two_scale[half]);
        let mut child = [DVec3::ZERO; MOST];
        for j in 0..side {
            for i in 0..side {
                let coefficient = coefficients[i + side * j];
                for l in 0..=j {
                    for k in 0..=i {
                        child[k + side * l] += of_x[i][k] * of_y[j][l] * coefficient;
                    }
                }
            }
        }
        child
    }

    /// The best approximation, in the mean square, of a function on the four quarters: h of Equation 4.
    pub(super) fn pull(&self, children: &[Coefficients; 4]) -> Coefficients {
        let side = self.order.side();
        let mut parent = [DVec3::ZERO; MOST];
        for (quadrant, child) in children.iter().enumerate() {
            let [of_x, of_y] = [quadrant % 2, quadrant / 2].map(|half| &self.two_scale[half]);
            for j in 0..side {
                for i in 0..side {
                    for l in 0..=j {
                        for k in 0..=i {
                            parent[i + side * j] += 0.25 * of_x[i][k] * of_y[j][l] * child[k + side * l];
                        }
                    }
                }
            }
        }
        parent
    }
}

/// φ₀, φ₁, φ₂.
fn legendre(x: f64) -> [f64; 3] {
    let t = 2.0 * x - 1.0;
    [1.0, 3_f64.sqrt() * t, 5_f64.sqrt() * (1.5 * t * t - 0.5)]
}

/// Nodes from 0 to 1 and weights of the Gauss–Legendre rule with as many nodes as functions along a side; the
/// rest is 0.
fn gauss(order: Order) -> [(f64, f64); 3] {
    match order {
        Order::M1 => [(0.5, 1.0), (0.0, 0.0), (0.0, 0.0)],
        Order::M2 => {
            let offset = 0.5 / 3_f64.sqrt();
            [(0.5 - offset, 0.5), (0.5 + offset, 0.5), (0.0, 0.0)]
        }
        Order::M3 => {
            let offset = 0.5 * 0.6_f64.sqrt();
            [(0.5 - offset, 5.0 / 18.0), (0.5, 4.0 / 9.0), (0.5 + offset, 5.0 / 18.0)]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ORDERS: [Order; 3] = [Order::M1, Order::M2, Order::M3];

    fn quarter(quadrant: usize, at: DVec2) -> DVec2 {
        0.5 * (at + DVec2::new((quadrant % 2) as f64, (quadrant / 2) as f64))
    }

    #[test]
    fn functions_are_orthonormal() {
        let basis = Basis::new(Order::M3);
        for a in 0..9 {
            for b in 0..9 {
                let product = |i: usize| basis.point(i).1 * basis.at_points[i][a] * basis.at_points[i][b];
                let sum: f64 = (0..9).map(product).sum();
                assert!((sum - f64::from(u8::from(a == b))).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn polynomials_of_the_order_are_exact_on_all_levels() {
        for order in ORDERS {
            let basis = Basis::new(order);
            let degree = order.side() as i32 - 1;
            let f = |at: DVec2| {
                let [x, y] = [(1.0 + at.x).powi(degree), (2.0 - 3.0 * at.y).powi(degree)];
                DVec3::new(x * y, x, 1.0 - y)
            };
            let mut samples = [DVec3::ZERO; MOST];
            for (index, sample) in samples.iter_mut().enumerate().take(order.functions()) {
                *sample = f(basis.point(index).0);
            }
            let whole = basis.project(&samples);
            let quarters = [0, 1, 2, 3].map(|quadrant| basis.push(&whole, quadrant));
            for i in 0..25 {
                let at = DVec2::new(f64::from(i % 5), f64::from(i / 5)) / 4.0;
                assert!(basis.evaluate(&whole, at).distance(f(at)) < 1e-12);
                for (quadrant, coefficients) in quarters.iter().enumerate() {
                    let there = quarter(quadrant, at);
                    assert!(basis.evaluate(coefficients, at).distance(f(there)) < 1e-12);
                }
            }
            let back = basis.pull(&quarters);
            assert!(back.iter().zip(whole).all(|(a, b)| a.distance(b) < 1e-12), "{order:?}");
        }
    }

    #[test]
    fn pull_is_the_adjoint_of_push_and_keeps_the_mean() {
        for order in ORDERS {
            let basis = Basis::new(order);
            let unit = |k: usize| {
                let mut it = [DVec3::ZERO; MOST];
                it[k] = DVec3::ONE;
                it
            };
            for quadrant in 0..4 {
                for a in 0..order.functions() {
                    let pushed = basis.push(&unit(a), quadrant);
                    for (b, &expected) in pushed.iter().enumerate().take(order.functions()) {
                        let mut children = [[DVec3::ZERO; MOST]; 4];
                        children[quadrant] = unit(b);
                        assert!((4.0 * basis.pull(&children)[a]).distance(expected) < 1e-14);
                    }
                }
            }
        }
    }
}
