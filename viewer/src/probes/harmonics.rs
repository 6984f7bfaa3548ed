//! Real spherical harmonics to the second band, in the order of three.js' `SphericalHarmonics3`: 1, y, z, x, xy, yz,
//! 3z² − 1, xz, x² − y².

use glam::Vec3;

/// Number of coefficients.
pub const COUNT: usize = 9;

/// Factor of each band that turns radiance into irradiance (Ramamoorthi and Hanrahan 2001, *An Efficient Representation
/// for Irradiance Environment Maps*, Eq. 8): π, 2π/3, π/4.
pub const COSINE: [f32; 3] = [std::f32::consts::PI, 2.094_395_2, std::f32::consts::FRAC_PI_4];

/// The basis in a direction, a unit vector.
pub fn basis(d: Vec3) -> [f32; COUNT] {
    [
        0.282_094_8,
        0.488_602_5 * d.y,
        0.488_602_5 * d.z,
        0.488_602_5 * d.x,
        1.092_548_4 * d.x * d.y,
        1.092_548_4 * d.y * d.z,
        0.315_391_57 * (3.0 * d.z * d.z - 1.0),
        1.092_548_4 * d.x * d.z,
        0.546_274_2 * (d.x * d.x - d.y * d.y),
    ]
}

/// Irradiance of a surface with this unit normal under radiance of these coefficients; not negative.
pub fn irradiance(radiance: &[Vec3; COUNT], normal: Vec3) -> Vec3 {
    let band = |i: usize| COSINE[usize::from(i > 0) + usize::from(i > 3)];
    let sum: Vec3 =
        basis(normal).iter().zip(radiance).enumerate().map(|(i, (y, l))| *l * (*y * band(i))).sum();
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
