//! The local pass: K reflects what has come to a patch, J sends it on as antiradiance (antiradiance paper, Eq. 18 and 19).

use super::bins::Bins;
use super::cosines::BinCosines;
use super::hierarchy::Element;
use super::leaving::Leaving;
use super::patches::Patch;
use glam::Vec3;

/// A patch, for the local pass.
#[derive(Clone, Copy, Debug)]
pub struct LocalPatch<'a> {
    /// The patch.
    pub patch: &'a Patch,
    /// See [`normalisation`](super::cosines::normalisation).
    pub normalisation: f32,
    /// The bins.
    pub bins: &'a Bins,
}

impl LocalPatch<'_> {
    /// Irradiance from the incident radiance by bin: the shading integral, without the BRDF of a matt surface.
    pub fn irradiance(&self, incident: impl Iterator<Item = Vec3>) -> Vec3 {
        let sine = self.bins.sine();
        let mut sum = Vec3::ZERO;
        for (light, way) in incident.zip(&self.bins.directions) {
            let cosine = self.patch.normal.dot(*way);
            if cosine < sine {
                sum += BinCosines::new(cosine, sine).arriving() * light;
            }
        }
        self.normalisation * self.bins.solid_angle() * sum
    }

    /// Cosines of a bin to the normal.
    pub fn cosines(&self, bin: usize) -> BinCosines {
        BinCosines::new(self.patch.normal.dot(self.bins.directions[bin]), self.bins.sine())
    }

    /// Irradiance of a radiance of 1 that comes by a bin.
    pub fn irradiance_of(&self, bin: usize) -> f32 {
        self.normalisation * self.bins.solid_angle() * self.cosines(bin).back
    }

    /// Writes the irradiance by bin: the terms of [`Self::irradiance`].
    pub fn irradiance_by_bin(&self, incident: impl Iterator<Item = Vec3>, out: &mut [Vec3]) {
        let factor = self.normalisation * self.bins.solid_angle();
        for (bin, (out, light)) in out.iter_mut().zip(incident).enumerate() {
            *out = factor * self.cosines(bin).arriving() * light;
        }
    }

    /// Writes the exitant [intensity](exitant) of all bins; `element` is the patch's.
    pub fn exitant(&self, element: &Element, leaving: &Leaving<'_>, incident: &[Vec3], out: &mut [Vec3]) {
        let area = self.normalisation * self.patch.area();
        for (bin, (out, light)) in out.iter_mut().zip(incident).enumerate() {
            *out = exitant(area, self.cosines(bin), leaving.by(element, bin), *light);
        }
    }
}

/// Exitant intensity I_L − I_A of a bin: that of a radiance to the front, and of what has come from the front. `area` is the
/// patch's times its normalisation.
pub fn exitant(area: f32, cosines: BinCosines, radiance: Vec3, incident: Vec3) -> Vec3 {
    area * (cosines.front * radiance - cosines.arriving() * incident)
}
