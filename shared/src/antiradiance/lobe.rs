//! The local pass of metals: K with a lobe of directions (antiradiance paper, Eq. 18 and Fig. 15).
//!
//! A metal reflects by [GGX](crate::ggx). Between two bins the kernel k is its reflectance at their middles, with a lobe as wide as a bin
//! at least: α² + sin²β / 4, β a bin's half angle, is what two bins add to the spread of the half vector. With the irradiance E_i
//! that comes by each bin, radiance leaves by bin o as
//!
//! ```text
//! L_o = g_o Σ_i k(o, i) E_i,   g_o = F (S + F (1 − S)) / Σ_i k(o, i) c_i ω
//! ```
//!
//! with the reflectance F, the share S that a white surface reflects at once ([`single_scattering`]) and the mean cosine c_i
//! of a bin. In light that is the same from everywhere the sum is one, however few bins there are: what leaves is F (S + F (1 − S)),
//! and all of it where F is 1.

use super::bins::Bins;
use super::local::LocalPatch;
use super::patches::Patch;
use crate::footprint::tangents;
use crate::ggx::{alpha, reflectance, single_scattering};
use glam::{Mat3, Vec3};

/// Least cosine to the normal of a way that leaves: bins at the horizon have their middles below it.
pub const LEAST_COSINE: f32 = 0.02;

/// Glossy patches, and their gains g.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lobes {
    /// Number of each glossy patch among all.
    pub patches: Vec<u32>,
    /// g by glossy patch and bin, linear RGB; zero where no light leaves.
    pub gains: Vec<Vec3>,
}

impl Lobes {
    /// Those of the patches with a roughness.
    pub fn new(patches: &[Patch], bins: &Bins, normalisations: &[f32]) -> Self {
        let mut out = Self::default();
        out.follow(patches, bins, normalisations, 0);
        out
    }

    /// Computes the gains of the patches from number `still` on anew: they have other normals. All others keep theirs.
    pub fn follow(&mut self, patches: &[Patch], bins: &Bins, normalisations: &[f32], still: usize) {
        let kept = self.patches.partition_point(|patch| (*patch as usize) < still);
        self.patches.truncate(kept);
        self.gains.truncate(kept * bins.count());
        for number in still..patches.len() {
            let (patch, normalisation) = (&patches[number], normalisations[number]);
            let local = LocalPatch { patch, normalisation, bins };
            if let Some(kernel) = LobeKernel::new(patch, bins) {
                self.patches.push(number as u32);
                self.gains.extend((0..bins.count()).map(|leaving| kernel.gain(&local, leaving)));
            }
        }
    }

    /// Writes the radiance that leaves a glossy patch by each bin. `number` is its number among them, `arriving` the irradiance by bin.
    pub fn reflect(
        &self,
        number: usize,
        patches: &[Patch],
        bins: &Bins,
        arriving: &[Vec3],
        out: &mut [Vec3],
    ) {
        let gains = &self.gains[number * bins.count()..][..bins.count()];
        let Some(kernel) = LobeKernel::new(&patches[self.patches[number] as usize], bins) else { return };
        for (leaving, (out, gain)) in out.iter_mut().zip(gains).enumerate() {
            if *gain == Vec3::ZERO {
                *out = Vec3::ZERO;
                continue;
            }
            let lit = arriving.iter().enumerate().filter(|(_, light)| **light != Vec3::ZERO);
            *out = *gain * lit.map(|(from, light)| kernel.between(leaving, from) * *light).sum::<Vec3>();
        }
    }
}

/// α of a lobe of this roughness between bins of this sine.
pub fn widened_alpha(roughness: f32, sine: f32) -> f32 {
    let alpha = alpha(roughness);
    (alpha * alpha + 0.25 * sine * sine).sqrt()
}

/// The kernel k of a patch.
struct LobeKernel<'a> {
    alpha: f32,
    roughness: f32,
    albedo: Vec3,
    frame_from_local: Mat3,
    bins: &'a Bins,
}

impl<'a> LobeKernel<'a> {
    fn new(patch: &Patch, bins: &'a Bins) -> Option<Self> {
        let roughness = patch.roughness?;
        let (right, up) = tangents(patch.normal);
        let frame_from_local = Mat3::from_cols(right, up, patch.normal).transpose();
        let alpha = widened_alpha(roughness, bins.sine());
        Some(Self { alpha, roughness, albedo: patch.albedo, frame_from_local, bins })
    }

    /// The way of a bin that light leaves by, raised over the horizon; surface frame.
    fn to_eye(&self, leaving: usize) -> Vec3 {
        let way = self.frame_from_local * self.bins.directions[leaving];
        way.with_z(way.z.max(LEAST_COSINE)).normalize()
    }

    fn between(&self, leaving: usize, from: usize) -> f32 {
        let to_light = -(self.frame_from_local * self.bins.directions[from]);
        let to_light = to_light.with_z(to_light.z.max(LEAST_COSINE)).normalize();
        reflectance(self.alpha, self.to_eye(leaving), to_light)
    }

    fn gain(&self, local: &LocalPatch<'_>, leaving: usize) -> Vec3 {
        if local.cosines(leaving).front <= 0.0 {
            return Vec3::ZERO;
        }
        let from = (0..self.bins.count()).filter(|from| local.cosines(*from).back > 0.0);
        let white: f32 = from.map(|from| self.between(leaving, from) * local.irradiance_of(from)).sum();
        let single = single_scattering(self.roughness, self.to_eye(leaving).z);
        self.albedo * (single + self.albedo * (1.0 - single)) / white.max(f32::MIN_POSITIVE)
    }
}

#[cfg(test)]
mod tests {
    use super::super::cosines::normalisation;
    use super::*;

    const ROUGHNESSES: [f32; 4] = [0.1, 0.3, 0.6, 1.0];

    fn metal(normal: Vec3, albedo: f32, roughness: f32) -> Patch {
        Patch {
            roughness: Some(roughness),
            ..Patch::around(Vec3::ZERO, normal.normalize(), 1.0, Vec3::splat(albedo))
        }
    }

    /// What leaves a patch by each bin, with the light by each bin that `arriving` gives.
    fn leaving(patch: &Patch, bins: &Bins, arriving: impl Fn(&LocalPatch<'_>, usize) -> f32) -> Vec<f32> {
        let normalisation = normalisation(bins, patch.normal);
        let patches = [*patch];
        let lobes = Lobes::new(&patches, bins, &[normalisation]);
        let local = LocalPatch { patch, normalisation, bins };
        let arriving: Vec<Vec3> = (0..bins.count()).map(|bin| Vec3::splat(arriving(&local, bin))).collect();
        let mut out = vec![Vec3::ZERO; bins.count()];
        lobes.reflect(0, &patches, bins, &arriving, &mut out);
        out.into_iter().map(|light| light.x).collect()
    }

    #[test]
    fn a_white_metal_is_invisible_in_even_light() {
        for count in [64, 128, 512] {
            let bins = Bins::new(count);
            for (roughness, normal) in ROUGHNESSES.into_iter().zip([Vec3::Y, Vec3::X, Vec3::ONE, Vec3::NEG_Z])
            {
                let patch = metal(normal, 1.0, roughness);
                let found = leaving(&patch, &bins, |local, bin| local.irradiance_of(bin));
                for (way, light) in bins.directions.iter().zip(found) {
                    let is_front = way.dot(patch.normal) > bins.sine();
                    assert!(!is_front || (light - 1.0).abs() < 1e-4, "{light} at {roughness}");
                }
            }
        }
    }

    #[test]
    fn a_beam_leaves_around_its_mirror_image_with_its_energy() {
        let bins = Bins::new(256);
        for (roughness, normal) in [(0.1, Vec3::Y), (0.4, Vec3::new(0.3, 1.0, -0.2)), (0.8, Vec3::Z)] {
            let patch = metal(normal, 1.0, roughness);
            let beams = (0..bins.count()).filter(|bin| bins.directions[*bin].dot(patch.normal) < -0.5);
            for beam in beams.step_by(7) {
                let found = leaving(&patch, &bins, |_, bin| if bin == beam { 1.0 } else { 0.0 });
                let local = LocalPatch { patch: &patch, normalisation: 1.0, bins: &bins };
                let flux =
                    |(bin, light): (usize, &f32)| local.cosines(bin).front * bins.solid_angle() * light;
                let all: f32 = found.iter().enumerate().map(flux).sum();
                assert!((all - 1.0).abs() < 0.2, "{all} at {roughness}");
                let way = bins.directions[beam];
                let mirrored = way - 2.0 * way.dot(patch.normal) * patch.normal;
                let middle: Vec3 = found.iter().zip(&bins.directions).map(|(light, way)| *light * *way).sum();
                assert!(middle.normalize().dot(mirrored) > 0.8, "{middle} at {roughness}");
            }
        }
    }

    #[test]
    fn reflectance_is_a_factor() {
        let bins = Bins::new(128);
        let of =
            |albedo: f32| leaving(&metal(Vec3::Y, albedo, 0.1), &bins, |local, bin| local.irradiance_of(bin));
        for (half, whole) in of(0.5).into_iter().zip(of(1.0)) {
            assert!((half - 0.5 * whole).abs() < 0.02, "{half} {whole}");
        }
    }
}
