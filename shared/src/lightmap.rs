//! Light of a [lightmap](crate::rbn::lightmap) under the strengths of a picture, and bilinear filtering as GPUs have it.

use crate::baked::BakedScene;
use crate::colour::unpack_rgb9e5;
use crate::rbn::lightmap::Lightmap;
use glam::{Vec2, Vec3};

/// Irradiance of each texel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MixedLightmap {
    /// Width and height, texels; 0 without a lightmap.
    pub size: [usize; 2],
    /// Of light that bounced at least once, linear RGB, row after row.
    pub bounced: Vec<Vec3>,
    /// Straight from the sky and emissive surfaces, likewise.
    pub direct: Vec<Vec3>,
}

impl MixedLightmap {
    /// Sums the layers; `strengths` has one RGB value per group of light
    /// ([`group_strengths`](crate::light_group::group_strengths)). Linear in each strength.
    pub fn new(scene: &BakedScene, strengths: &[Vec3]) -> Self {
        let lightmap = &scene.lightmap;
        if lightmap.is_empty() {
            return Self::default();
        }
        let zeros = vec![Vec3::ZERO; lightmap.area()];
        let mut out = Self {
            size: lightmap.layout.size.map(|side| side as usize),
            bounced: zeros.clone(),
            direct: zeros,
        };
        let groups = scene.light_groups.groups.len();
        for (layer, group) in scene.light_groups.column_groups().enumerate() {
            let strength = strengths.get(group).copied().unwrap_or_default();
            let sums = if layer < groups { &mut out.bounced } else { &mut out.direct };
            if strength != Vec3::ZERO {
                add(sums, lightmap, layer, strength);
            }
        }
        out
    }

    /// Bounced light and direct light at a place, in texels: the middle of the first texel is at a half.
    pub fn at(&self, texels: Vec2) -> [Vec3; 2] {
        let (low, share) = ((texels - 0.5).floor(), (texels - 0.5).fract_gl());
        let [width, height] = self.size;
        let clamped = |at: f32, side: usize| (at.max(0.0) as usize).min(side.saturating_sub(1));
        let [x, right] = [low.x, low.x + 1.0].map(|x| clamped(x, width));
        let [y, above] = [low.y, low.y + 1.0].map(|y| clamped(y, height));
        [&self.bounced, &self.direct].map(|layer| {
            let texel = |x: usize, y: usize| layer.get(y * width + x).copied().unwrap_or_default();
            let row = |y| texel(x, y).lerp(texel(right, y), share.x);
            row(y).lerp(row(above), share.y)
        })
    }
}

fn add(sums: &mut [Vec3], lightmap: &Lightmap, layer: usize, strength: Vec3) {
    let strength = strength * lightmap.layout.scales[layer];
    for (sum, texel) in sums.iter_mut().zip(lightmap.layer(layer)) {
        *sum += strength * unpack_rgb9e5(texel.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn filtering_is_exact_on_a_plane_and_ends_at_the_border() {
        let plane = |x: f32, y: f32| Vec3::new(1.0, x, y);
        let texels: Vec<Vec3> = (0..15).map(|i| plane((i % 5) as f32 + 0.5, (i / 5) as f32 + 0.5)).collect();
        let mixed = MixedLightmap { size: [5, 3], bounced: texels, direct: vec![Vec3::ZERO; 15] };
        for at in [Vec2::new(0.5, 0.5), Vec2::new(1.25, 2.0), Vec2::new(4.5, 2.5), Vec2::new(3.1, 0.9)] {
            let [bounced, direct] = mixed.at(at);
            assert!((bounced - plane(at.x, at.y)).length() < 1e-5 && direct == Vec3::ZERO, "{at}: {bounced}");
        }
        assert_eq!(mixed.at(Vec2::new(-3.0, 99.0))[0], plane(0.5, 2.5));
        assert_eq!(MixedLightmap::default().at(Vec2::ONE), [Vec3::ZERO; 2]);
    }
}
