//! Cube maps of the surroundings of metals (reflection probes), lit anew for each picture: at places near the metals, what a
//! ray through each texel hits, [baked](rebounce_shared::rbn::cube_maps); its radiance under the lights of the picture; and a
//! correction for the way from the place of a map to the pixel that looks into it, by depth
//! ([`march`](rebounce_shared::cube_map::march)) or by a box ([`room`]).
//!
//! * here: what a lobe's sample finds in the maps;
//! * `lit` – light of the texels;
//! * `room` – correction by a box.
//!
//! Radiance is without the sky: texels have coverage, and pictures read the environment itself where a texel has none.

mod lit;
mod room;

use super::cost::Cost;
use crate::geometry::Hit;
use glam::Vec3;
use lit::LitCubeMap;
use rebounce_shared::cube_map::least_roughness;
use rebounce_shared::cube_map::march::RayEnd;
use rebounce_shared::rbn::cube_maps::CubeTexel;
use room::ParallaxBox;

/// Maps that a sample looks into, one after the other, until one is sure.
const LOOKS: usize = 3;
/// Factor of the distance of a map that does not see the hit.
const UNSEEN: f32 = 4.0;

/// How the way from map to pixel is allowed for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Correction {
    /// By following the ray through the distances of a map.
    #[default]
    Depth,
    /// By following the ray in the middle of a lobe: all of the lobe is taken to be as far away.
    MiddleDepth,
    /// By a box around a map.
    Box,
    /// Not at all: all is far away.
    None,
}

/// How pictures look into cube maps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CubeMapLookup {
    /// How the way from map to pixel is allowed for.
    pub correction: Correction,
    /// Whether samples of which no map is sure are the glossy transfer's.
    pub with_transfer: bool,
    /// Whether metals of less than the [least roughness](least_roughness) reflect by the transfer.
    pub only_rough: bool,
}

impl CubeMapLookup {
    /// As pages do.
    pub const PAGE: Self =
        Self { correction: Correction::MiddleDepth, with_transfer: false, only_rough: true };
}

/// Cube maps of a scene under the lights of a picture.
pub struct CubeMaps {
    lookup: CubeMapLookup,
    maps: Vec<LitCubeMap>,
}

impl CubeMaps {
    /// Whether a metal of this roughness reflects the maps.
    pub(super) fn reflects(&self, roughness: f32) -> bool {
        let cube = self.maps.first().map(|map| map.distances.cube);
        !self.lookup.only_rough || cube.is_some_and(|cube| roughness >= least_roughness(cube))
    }

    /// Whether some samples are the transfer's.
    pub(super) fn needs_transfer(&self) -> bool {
        self.lookup.with_transfer || self.maps.is_empty()
    }

    /// Texels that are lit anew after a change of light.
    pub fn texels(&self) -> usize {
        self.maps.iter().map(|map| map.distances.texels.len()).sum()
    }

    /// Bytes that a file would need for them, before compression.
    pub fn bytes(&self) -> usize {
        self.texels() * size_of::<CubeTexel>()
    }

    /// Orders the maps for a hit.
    pub(super) fn around<'a>(&'a self, hit: &Hit, direction: Vec3, cost: &mut Cost) -> NearMaps<'a> {
        let rank = |map: &'a LitCubeMap| {
            let from = hit.position - map.place;
            let is_unseen = !map.distances.sees(from) || from.dot(hit.geometric_normal) > 0.0;
            (from.length() * if is_unseen { UNSEEN } else { 1.0 }, map)
        };
        let mut ranked: Vec<(f32, &LitCubeMap)> = self.maps.iter().map(rank).collect();
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        ranked.truncate(LOOKS);
        let angle = ranked.first().map_or(0.0, |(_, map)| map.distances.cube.angle());
        // Off the surface by a texel, so that rays do not end where they begin.
        let away = ranked.first().map_or(0.0, |(_, map)| map.place.distance(hit.position) * angle);
        let mut around = NearMaps {
            lookup: self.lookup,
            maps: ranked.into_iter().map(|(_, map)| map).collect(),
            position: hit.position + hit.geometric_normal * away,
            middle: None,
        };
        if self.lookup.correction == Correction::MiddleDepth {
            let mirrored = direction.reflect(hit.normal);
            around.middle = around.meet(mirrored, cost).map(|(map, met)| (map, met.along));
        }
        around
    }
}

/// The maps near a hit, best first.
pub(super) struct NearMaps<'a> {
    lookup: CubeMapLookup,
    maps: Vec<&'a LitCubeMap>,
    position: Vec3,
    /// Map of the ray in the middle of the lobe, and how far that ray goes: all of the lobe is taken to be as far.
    middle: Option<(&'a LitCubeMap, f32)>,
}

impl<'a> NearMaps<'a> {
    /// Where a ray of unit direction ends, by the best map.
    fn meet(&self, direction: Vec3, cost: &mut Cost) -> Option<(&'a LitCubeMap, RayEnd)> {
        if let Some((map, along)) = self.middle {
            let place = self.position - map.place + along * direction;
            let is_far = !along.is_finite();
            let seen_from_map = if is_far { direction } else { place };
            let from_map = if is_far { f32::INFINITY } else { place.length() };
            return Some((map, RayEnd { seen_from_map, along, from_map, is_sure: true }));
        }
        let mut best = None;
        for map in &self.maps {
            let from = self.position - map.place;
            let met = match self.lookup.correction {
                Correction::Depth | Correction::MiddleDepth => {
                    map.distances.follow(from, direction, &mut cost.steps)
                }
                Correction::Box => map.room.meet(from, direction),
                Correction::None => {
                    ParallaxBox { low: Vec3::NEG_INFINITY, high: Vec3::INFINITY }.meet(from, direction)
                }
            };
            if met.is_sure {
                return Some((*map, met));
            }
            best = best.or(Some((*map, met)));
        }
        best
    }

    /// Radiance from a unit direction over about this solid angle; `sky` is the environment's. `None` where the transfer has
    /// to answer.
    pub fn radiance(
        &self,
        direction: Vec3,
        solid_angle: f32,
        sky: impl FnOnce() -> Vec3,
        cost: &mut Cost,
    ) -> Option<Vec3> {
        let (map, met) = self.meet(direction, cost)?;
        if !met.is_sure {
            cost.fallbacks += 1;
            if self.lookup.with_transfer {
                return None;
            }
        }
        cost.steps += 1;
        // The footprint on what is met, as the map sees it.
        let wider = match met.from_map.is_finite() {
            true => (met.along / met.from_map.max(1e-6)).powi(2),
            false => 1.0,
        };
        let seen = met.seen_from_map.try_normalize().unwrap_or(direction);
        let texel = map.levels.at(seen, solid_angle * wider);
        Some(texel.truncate() + sky() * (1.0 - texel.w))
    }
}

#[cfg(test)]
mod tests;
