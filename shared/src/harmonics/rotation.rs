//! Rotation of coefficients: Ivanic and Ruedenberg, *Rotation Matrices for Real Spherical Harmonics. Direct Determination
//! by Recursion*, J. Phys. Chem. 100, 1996, with the corrections of 1998.
//!
//! Each band turns by itself. The matrix of band 1 is the rotation with the axes in the order y, z, x; that of band l
//! follows from those of bands 1 and l − 1.

use super::{BANDS, COUNT, Coefficients};
use glam::{Mat3, Vec3};

/// Entries of the matrices of all bands: 1 + 9 + 25 + 49 + 81.
const ENTRIES: usize = 165;

/// Rotation of coefficients: a square matrix a band.
#[derive(Clone, Debug, PartialEq)]
pub struct Rotation([f32; ENTRIES]);

/// First entry of a band's matrix.
const fn first(band: usize) -> usize {
    [0, 1, 10, 35, 84][band]
}

impl Rotation {
    /// The rotation that takes a function f to the function f(R⁻¹ ω). `rotation` is R, orthonormal with determinant 1.
    pub fn new(rotation: Mat3) -> Self {
        let mut out = Self([0.0; ENTRIES]);
        out.0[0] = 1.0;
        // Axes in the order of the functions of band 1.
        let axis = |i: usize| [1, 2, 0][i];
        for row in 0..3 {
            for column in 0..3 {
                out.0[first(1) + 3 * row + column] = rotation.col(axis(column))[axis(row)];
            }
        }
        for l in 2..BANDS as i32 {
            for m in -l..=l {
                for n in -l..=l {
                    let entry = out.recursion(l, m, n);
                    let side = 2 * l + 1;
                    out.0[first(l as usize) + ((m + l) * side + n + l) as usize] = entry;
                }
            }
        }
        out
    }

    /// Entry of a band, by orders.
    fn at(&self, l: i32, m: i32, n: i32) -> f32 {
        self.0[first(l as usize) + ((m + l) * (2 * l + 1) + n + l) as usize]
    }

    /// Sum P of the paper's table 2, for the band l: i is −1, 0 or 1.
    fn p(&self, i: i32, l: i32, m: i32, n: i32) -> f32 {
        let before = l - 1;
        if n == -l {
            self.at(1, i, 1) * self.at(before, m, 1 - l) + self.at(1, i, -1) * self.at(before, m, l - 1)
        } else if n == l {
            self.at(1, i, 1) * self.at(before, m, l - 1) - self.at(1, i, -1) * self.at(before, m, 1 - l)
        } else {
            self.at(1, i, 0) * self.at(before, m, n)
        }
    }

    /// Entry (m, n) of band l: u U + v V + w W (table 1 and 2).
    fn recursion(&self, l: i32, m: i32, n: i32) -> f32 {
        let is_zero = f32::from(u8::from(m == 0));
        let below = if n.abs() == l { (2 * l * (2 * l - 1)) as f32 } else { ((l + n) * (l - n)) as f32 };
        let size = m.abs();
        let u = (((l + m) * (l - m)) as f32 / below).sqrt();
        let v = 0.5
            * ((1.0 + is_zero) * ((l + size - 1) * (l + size)) as f32 / below).sqrt()
            * (1.0 - 2.0 * is_zero);
        let w = -0.5 * (((l - size - 1) * (l - size)) as f32 / below).max(0.0).sqrt() * (1.0 - is_zero);
        let mut sum = 0.0;
        if u != 0.0 {
            sum += u * self.p(0, l, m, n);
        }
        if v != 0.0 {
            sum += v * self.v(l, m, n);
        }
        if w != 0.0 {
            sum += w * self.w(l, m, n);
        }
        sum
    }

    fn v(&self, l: i32, m: i32, n: i32) -> f32 {
        let root = std::f32::consts::SQRT_2;
        match m {
            0 => self.p(1, l, 1, n) + self.p(-1, l, -1, n),
            1 => root * self.p(1, l, 0, n),
            -1 => root * self.p(-1, l, 0, n),
            2.. => self.p(1, l, m - 1, n) - self.p(-1, l, 1 - m, n),
            _ => self.p(1, l, m + 1, n) + self.p(-1, l, -m - 1, n),
        }
    }

    fn w(&self, l: i32, m: i32, n: i32) -> f32 {
        if m > 0 {
            self.p(1, l, m + 1, n) + self.p(-1, l, -m - 1, n)
        } else {
            self.p(1, l, m - 1, n) - self.p(-1, l, 1 - m, n)
        }
    }

    /// Returns the coefficients of the turned function.
    pub fn apply(&self, coefficients: &Coefficients) -> Coefficients {
        let mut out = [Vec3::ZERO; COUNT];
        for l in 0..BANDS {
            let side = 2 * l + 1;
            let (start, matrix) = (l * l, &self.0[first(l)..]);
            for row in 0..side {
                let entries = matrix[row * side..][..side].iter().zip(&coefficients[start..]);
                out[start + row] = entries.map(|(entry, c)| *c * *entry).sum();
            }
        }
        out
    }
}
