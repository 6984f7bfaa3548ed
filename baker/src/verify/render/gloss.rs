//! Reflections of metals: the light that arrives at the points from each direction, under the lobe of each hit.

use crate::basis::Leveled;
use crate::geometry::Hit;
use glam::Vec3;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::gloss::{Fresnel, GlossyField};
use rebounce_shared::lighting::Lighting;

/// Light that arrives at points of glossy surfaces.
pub(super) struct Reflections {
    field: GlossyField,
}

impl Reflections {
    /// Applies the glossy transfer of a file to what its senders send; `None` if it has none.
    pub fn new(scene: &BakedScene, lighting: &Lighting, sent: &[Vec3]) -> Option<Self> {
        let field = GlossyField::new(scene, lighting, sent);
        (!field.is_empty()).then_some(Self { field })
    }

    /// Radiance that a metal sends along a ray, without the light of lamps: a GGX conductor whose reflectance is the albedo at
    /// every angle. `None` where the transfer does not reach.
    pub fn of_metal(&self, lighting: &Lighting, basis: &Leveled, hit: &Hit, direction: Vec3) -> Option<Vec3> {
        let mut weights = Vec::with_capacity(64);
        basis.interpolate(hit.position, hit.normal, hit.group, &mut weights);
        let arriving = self.field.mean(&weights)?;
        let skies: Vec<_> = lighting.background.iter().map(|background| background.reflected()).collect();
        let lobe = self.field.reflected(&arriving, &skies, hit.gloss.roughness, hit.normal, -direction);
        Some(lobe.reflected(&Fresnel { head_on: hit.albedo, grazing: hit.albedo }))
    }
}
