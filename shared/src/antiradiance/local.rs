//! The local pass: K reflects what has come to a patch, J sends it on as antiradiance (antiradiance paper, Eq. 18 and 19).

use super::bins::Bins;
use super::cosines::BinCosines;
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

    /// Writes the exitant [intensity](exitant) of all bins.
    pub fn exitant(&self, radiance: Vec3, incident: &[Vec3], out: &mut [Vec3]) {
        let sine = self.bins.sine();
        let area = self.normalisation * self.patch.area();
        for ((out, light), way) in out.iter_mut().zip(incident).zip(&self.bins.directions) {
            *out = exitant(area, BinCosines::new(self.patch.normal.dot(*way), sine), radiance, *light);
        }
    }
}

/// Exitant intensity I_L − I_A of a bin: that of a radiance to the front, and of what has come from the front. `area` is the
/// patch's times its normalisation.
pub fn exitant(area: f32, cosines: BinCosines, radiance: Vec3, incident: Vec3) -> Vec3 {
    area * (cosines.front * radiance - cosines.arriving() * incident)
}
