//! Reflection by microfacets: the GGX distribution of Trowbridge and Reitz with Smith's height-correlated masking (Walter et
//! al. 2007; Heitz 2014), sampled by visible normals, with the light that a rough surface scatters more than once given
//! back. The viewer's `gloss.wgsl` has the same formulas.
//!
//! Directions are unit vectors in the surface's frame, with the normal along z; α is the square of glTF's roughness.
//! Reflectance without Fresnel's factor, per steradian and without the cosine:
//!
//! ```text
//! f = D(h) G₂(v, l) / (4 n·v n·l),   D = α² / (π ((n·h)² (α² − 1) + 1)²),   G₂ = 1 / (1 + Λ(v) + Λ(l))
//! ```
//!
//! A sample h of the normals visible from v has l = v mirrored at h, the density G₁(v) D(h) / (4 n·v) per steradian, and so
//! the weight G₂ / G₁.

use crate::elementary::Elementary;
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, TAU};
use std::sync::OnceLock;

/// Least α, as path tracers of comparisons have it: narrower lobes are mirrors to any picture.
pub const LEAST_ALPHA: f32 = 0.01;
/// Number of samples of a lobe in [`lobe`].
pub const LOBE_SAMPLES: u32 = 16;

/// Returns α of a roughness.
#[inline]
pub fn alpha(roughness: f32) -> f32 {
    (roughness * roughness).max(LEAST_ALPHA)
}

/// Density D of the microfacets' normals, per steradian; `cosine` is n·h.
#[inline]
pub fn density(alpha: f32, cosine: f32) -> f32 {
    let a2 = alpha * alpha;
    let spread = cosine * cosine * (a2 - 1.0) + 1.0;
    a2 * FRAC_1_PI / (spread * spread)
}

/// Smith's Λ of a direction with this cosine to the normal.
#[inline]
pub fn smith_lambda(alpha: f32, cosine: f32) -> f32 {
    let c2 = cosine * cosine;
    let tan2 = (1.0 - c2).max(0.0) / c2.max(1e-12);
    0.5 * ((1.0 + alpha * alpha * tan2).sqrt() - 1.0)
}

/// Reflectance without Fresnel's factor, per steradian, without the cosine; 0 below the surface.
pub fn reflectance(alpha: f32, to_eye: Vec3, to_light: Vec3) -> f32 {
    let (nv, nl) = (to_eye.z, to_light.z);
    if nv <= 0.0 || nl <= 0.0 {
        return 0.0;
    }
    let h = (to_eye + to_light).normalize();
    density(alpha, h.z) / ((1.0 + smith_lambda(alpha, nv) + smith_lambda(alpha, nl)) * 4.0 * nv * nl)
}

/// Density of [`sample`], per steradian of the light's direction.
pub fn sample_density(alpha: f32, to_eye: Vec3, to_light: Vec3) -> f32 {
    let nv = to_eye.z.max(1e-6);
    let h = (to_eye + to_light).normalize_or_zero();
    density(alpha, h.z) / ((1.0 + smith_lambda(alpha, nv)) * 4.0 * nv)
}

/// A direction that light comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LobeSample {
    /// Surface frame.
    pub to_light: Vec3,
    /// n·l f over the density: G₂ / G₁, without Fresnel's factor. 0 below the surface.
    pub weight: f32,
    /// Density, per steradian.
    pub density: f32,
    /// Cosine of the angle between the microfacet and the eye.
    pub cosine: f32,
}

/// Samples the normals visible from `to_eye` at a place of the unit square (Dupuy and Benyoub, *Sampling Visible GGX Normals
/// with Spherical Caps*, 2023).
#[inline]
pub fn sample(alpha: f32, to_eye: Vec3, square: Vec2) -> LobeSample {
    let nv = to_eye.z.max(1e-4);
    let stretched = Vec3::new(alpha * to_eye.x, alpha * to_eye.y, nv).normalize();
    let (sin, cos) = (TAU * square.x).sine_cosine();
    let z = (1.0 - square.y) * (1.0 + stretched.z) - stretched.z;
    let r = (1.0 - z * z).max(0.0).sqrt();
    let standard = Vec3::new(r * cos, r * sin, z) + stretched;
    let h = Vec3::new(alpha * standard.x, alpha * standard.y, standard.z.max(0.0)).normalize();
    let cosine = to_eye.dot(h);
    let to_light = 2.0 * cosine * h - to_eye;
    let masked = 1.0 + smith_lambda(alpha, nv);
    let weight = match to_light.z > 0.0 {
        true => masked / (masked + smith_lambda(alpha, to_light.z)),
        false => 0.0,
    };
    LobeSample { to_light, weight, density: density(alpha, h.z) / (masked * 4.0 * nv), cosine }
}

/// Returns sample `i` of [`LOBE_SAMPLES`] of a lobe: evenly spread over it, the same for all pictures.
#[inline]
pub fn lobe(alpha: f32, to_eye: Vec3, i: u32) -> LobeSample {
    shifted_lobe(alpha, to_eye, i, Vec2::ZERO)
}

/// As [`lobe`], with the places of the unit square shifted round (Cranley and Patterson 1976): a random shift for each lobe
/// makes the mean of many exact.
#[inline]
pub fn shifted_lobe(alpha: f32, to_eye: Vec3, i: u32, shift: Vec2) -> LobeSample {
    const GOLDEN: f32 = 0.618_034;
    let i = i as f32;
    let place = Vec2::new(i * GOLDEN, (i + 0.5) / LOBE_SAMPLES as f32);
    sample(alpha, to_eye, (place + shift).fract())
}

/// Factor that gives back what a rough surface scatters more than once, for a reflectance `head_on` at normal incidence and
/// the share `single` of all light that a white one reflects at once: 1 + F₀ (1 / E − 1) (Turquin, *Practical Multiple
/// Scattering Compensation for Microfacet Models*, 2019).
#[inline]
pub fn multiple_scattering(head_on: Vec3, single: f32) -> Vec3 {
    Vec3::ONE + head_on * (1.0 / single.max(1e-3) - 1.0)
}

/// Side of the table of [`single_scattering`].
const SIDE: usize = 32;
/// Samples of an entry, in each direction.
const ENTRY: u32 = 64;

/// Share E of all light that a white surface reflects to an eye at this cosine after one bounce: ∫ f n·l dl.
pub fn single_scattering(roughness: f32, cosine: f32) -> f32 {
    static TABLE: OnceLock<Vec<f32>> = OnceLock::new();
    let table = TABLE.get_or_init(|| {
        let entry = |i: usize| {
            let place = |i: usize| i as f32 / (SIDE - 1) as f32;
            integrated(alpha(place(i / SIDE)), place(i % SIDE))
        };
        (0..SIDE * SIDE).map(entry).collect()
    });
    let place = |x: f32| {
        let at = x.clamp(0.0, 1.0) * (SIDE - 1) as f32;
        let low = (at as usize).min(SIDE - 2);
        (low, at - low as f32)
    };
    let ((row, down), (column, right)) = (place(roughness), place(cosine));
    let line = |row: usize| {
        let at = &table[row * SIDE + column..];
        at[0] + (at[1] - at[0]) * right
    };
    line(row) + (line(row + 1) - line(row)) * down
}

/// E of one entry, by an even grid of samples.
fn integrated(alpha: f32, cosine: f32) -> f32 {
    let cosine = cosine.max(0.004);
    let to_eye = Vec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
    let cells = (0..ENTRY * ENTRY).map(|k| Vec2::new((k % ENTRY) as f32, (k / ENTRY) as f32));
    let weights = cells.map(|cell| sample(alpha, to_eye, (cell + 0.5) / ENTRY as f32).weight);
    weights.sum::<f32>() / (ENTRY * ENTRY) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    const ROUGHNESSES: [f32; 5] = [0.15, 0.3, 0.5, 0.75, 1.0];

    fn eye(cosine: f32) -> Vec3 {
        Vec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine)
    }

    #[test]
    fn projected_areas_of_microfacets_add_up_to_the_surface() {
        for roughness in ROUGHNESSES {
            let alpha = alpha(roughness);
            // ∫ D n·h dh = 1, over cells of n·h.
            let n = 400_000;
            let sum: f64 = (0..n)
                .map(|i| {
                    let c = (f64::from(i) + 0.5) / f64::from(n);
                    f64::from(density(alpha, c as f32)) * c
                })
                .sum();
            assert!((sum * std::f64::consts::TAU / f64::from(n) - 1.0).abs() < 2e-3, "{roughness}: {sum}");
        }
    }

    #[test]
    fn samples_have_the_density_and_the_weight_that_the_formulas_say() {
        let mut stream = Stream::new(6, 1);
        for roughness in ROUGHNESSES {
            for cosine in [0.1, 0.5, 0.95] {
                let (alpha, eye) = (alpha(roughness), eye(cosine));
                for _ in 0..200 {
                    let s = sample(alpha, eye, stream.square());
                    let density = sample_density(alpha, eye, s.to_light);
                    assert!((s.density / density - 1.0).abs() < 2e-2, "{} {density}", s.density);
                    if s.to_light.z > 0.01 {
                        let weight = reflectance(alpha, eye, s.to_light) * s.to_light.z / density;
                        assert!((s.weight - weight).abs() < 2e-2, "{} {weight}", s.weight);
                    }
                }
            }
        }
    }

    #[test]
    fn samples_and_uniform_directions_find_the_same_albedo() {
        let mut stream = Stream::new(2, 9);
        for roughness in [0.4, 0.7, 1.0] {
            for cosine in [0.2, 0.7] {
                let (alpha, eye) = (alpha(roughness), eye(cosine));
                let n = 400_000;
                let mut sum = 0.0f64;
                for _ in 0..n {
                    let mut l = stream.sphere();
                    l.z = l.z.abs();
                    sum += f64::from(reflectance(alpha, eye, l) * l.z);
                }
                let uniform = sum * std::f64::consts::TAU / f64::from(n);
                let table = f64::from(single_scattering(roughness, cosine));
                assert!((uniform - table).abs() < 0.01, "{roughness} {cosine}: {uniform} {table}");
            }
        }
    }

    #[test]
    fn reflectance_is_reciprocal() {
        let mut stream = Stream::new(1, 1);
        for _ in 0..200 {
            let [mut a, mut b] = [stream.sphere(), stream.sphere()];
            (a.z, b.z) = (a.z.abs(), b.z.abs());
            let (there, back) = (reflectance(0.3, a, b), reflectance(0.3, b, a));
            assert!((there - back).abs() <= 1e-4 * (there + back));
        }
    }

    #[test]
    fn a_white_surface_gives_back_all_light_at_every_roughness() {
        for step in 0..=20 {
            let roughness = step as f32 / 20.0;
            for cosine in [0.05, 0.2, 0.5, 0.9, 1.0] {
                // The samples of a picture, with their own share in place of the table's.
                let all = (0..LOBE_SAMPLES).map(|i| lobe(alpha(roughness), eye(cosine), i).weight);
                let single = all.sum::<f32>() / LOBE_SAMPLES as f32;
                let white = single * multiple_scattering(Vec3::ONE, single).x;
                assert!((white - 1.0).abs() < 1e-4, "{roughness} {cosine}: {white}");
                // Few samples see about what many do.
                let table = single_scattering(roughness, cosine);
                assert!((single - table).abs() < 0.12, "{roughness} {cosine}: {single} {table}");
            }
        }
    }
}
