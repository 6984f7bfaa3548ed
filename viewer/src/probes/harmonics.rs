//! Spherical harmonics of probes: the first three bands of [`rebounce_shared::harmonics`], in the order of three.js'
//! `SphericalHarmonics3`.

use glam::Vec3;
use rebounce_shared::harmonics::zonal::COSINE;
use rebounce_shared::harmonics::{band, evaluate};

/// Number of coefficients.
pub const COUNT: usize = 9;

/// The basis in a direction, a unit vector.
pub fn basis(direction: Vec3) -> [f32; COUNT] {
    let all = evaluate(direction);
    std::array::from_fn(|i| all[i])
}

/// Irradiance of a surface with this unit normal under radiance of these coefficients; not negative.
pub fn irradiance(radiance: &[Vec3; COUNT], normal: Vec3) -> Vec3 {
    let basis = basis(normal);
    let terms = basis.iter().zip(radiance).enumerate();
    let sum: Vec3 = terms.map(|(i, (y, l))| *l * (*y * COSINE[band(i)])).sum();
    sum.max(Vec3::ZERO)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rebounce_shared::environment::bins;

    /// The sphere in equal parts.
    fn sphere() -> impl Iterator<Item = Vec3> {
        let places = (0..64).map(|k| glam::Vec2::new((k % 8) as f32 + 0.5, (k / 8) as f32 + 0.5) / 8.0);
        (0..bins::BINS).flat_map(move |bin| places.clone().map(move |place| bins::direction(bin, place)))
    }

    #[test]
    fn the_basis_is_orthonormal() {
        let count = sphere().count() as f32;
        for i in 0..COUNT {
            for j in 0..COUNT {
                let sum: f32 = sphere().map(|d| basis(d)[i] * basis(d)[j]).sum();
                let product = sum * 4.0 * std::f32::consts::PI / count;
                assert!((product - f32::from(u8::from(i == j))).abs() < 2e-3, "{i} {j}: {product}");
            }
        }
    }

    #[test]
    fn equal_radiance_gives_pi_and_a_cosine_gives_what_its_integral_says() {
        let count = sphere().count() as f32;
        let project = |radiance: &dyn Fn(Vec3) -> f32| {
            let mut out = [Vec3::ZERO; COUNT];
            for d in sphere() {
                for (sum, y) in out.iter_mut().zip(basis(d)) {
                    *sum += Vec3::splat(radiance(d) * y * 4.0 * std::f32::consts::PI / count);
                }
            }
            out
        };
        let even = project(&|_| 1.0);
        let up = project(&|d| 1.0 + d.y);
        for normal in [Vec3::X, Vec3::NEG_Y, Vec3::new(0.6, 0.0, 0.8)] {
            assert!((irradiance(&even, normal).x - std::f32::consts::PI).abs() < 1e-2);
            // ∫ (1 + d·y) max(0, n·d) dω = π + 2π/3 n·y.
            let wanted = std::f32::consts::PI + 2.094_395 * normal.y;
            assert!((irradiance(&up, normal).x - wanted).abs() < 1e-2);
        }
    }
}
