//! Cube maps of the surroundings of metals (reflection probes), lit anew for each picture: at places near the metals, what a
//! ray through each texel hits, baked; its radiance under the lights of the picture; and a correction for the way from the
//! place of a map to the pixel that looks into it, by depth ([`march`]) or by a box ([`room`]).
//!
//! * here: the maps, and what a lobe's sample finds in them;
//! * `places` – where maps are;
//! * `cube` – texels of a cube; `levels` – blurred radiance;
//! * `march`, `room` – the two corrections.
//!
//! Radiance is without the sky: texels have coverage, and pictures read the environment itself where a texel has none.

mod cube;
mod levels;
mod march;
mod places;
mod room;

use super::cost::Cost;
use crate::geometry::{Hit, Ray, Surfaces};
use crate::random::Stream;
use cube::Cube;
use glam::{Vec3, Vec4};
use levels::Levels;
use march::{Distances, RayEnd};
use rayon::prelude::*;
use rebounce_shared::baked::BakedScene;
use room::ParallaxBox;

/// Estimates of the light of a texel: light of area lamps is sampled.
const SAMPLES: u64 = 4;
/// Maps that a sample looks into, one after the other, until one is sure.
const LOOKS: usize = 3;
/// Factor of the distance of a map that does not see the hit.
const UNSEEN: f32 = 4.0;

/// Bytes of a texel in a file: half a float of distance, two bytes of normal, three of reflectance, one of what shines there.
const TEXEL_BYTES: usize = 8;

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

/// Number and kind of cube maps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CubeMapSettings {
    /// Maps.
    pub count: usize,
    /// Texels along an edge of a face; a power of two.
    pub side: usize,
    /// How the way from map to pixel is allowed for.
    pub correction: Correction,
    /// Distance of maps from the metals, of the metals' size.
    pub lift: f32,
    /// Whether samples of which no map is sure are the glossy transfer's.
    pub with_transfer: bool,
}

impl Default for CubeMapSettings {
    fn default() -> Self {
        Self { count: 16, side: 32, correction: Correction::Depth, lift: 0.05, with_transfer: false }
    }
}

/// What the texels of a map see, as a bake has it.
struct CubeMapGeometry {
    /// Local space.
    place: Vec3,
    hits: Vec<Option<Hit>>,
}

/// A map under the lights of a picture.
struct LitCubeMap {
    place: Vec3,
    distances: Distances,
    room: ParallaxBox,
    levels: Levels,
}

/// Cube maps of a scene under the lights of a picture.
pub struct CubeMaps {
    settings: CubeMapSettings,
    maps: Vec<LitCubeMap>,
}

impl CubeMapGeometry {
    fn new(cube: Cube, place: Vec3, surfaces: &impl Surfaces) -> Self {
        let cast = |texel: usize| {
            let direction = cube.direction(texel);
            let spread = cube.solid_angle(direction).sqrt();
            let ray = Ray { origin: place, direction, max_distance: f32::INFINITY, spread };
            surfaces.cast(&ray, texel as u32)
        };
        Self { place, hits: (0..cube.len()).into_par_iter().map(cast).collect() }
    }

    /// Lights a map; `radiance` is that of a hit against a ray.
    fn lit<R>(&self, cube: Cube, radiance: &R) -> LitCubeMap
    where
        R: Fn(&Hit, Vec3, &mut Stream) -> Vec3 + Sync,
    {
        let of = |texel: usize| {
            let Some(hit) = &self.hits[texel] else { return Vec4::ZERO };
            let estimate = |sample| {
                let mut stream = Stream::new(texel as u64, sample);
                radiance(hit, cube.direction(texel), &mut stream)
            };
            ((0..SAMPLES).map(estimate).sum::<Vec3>() / SAMPLES as f32).extend(1.0)
        };
        let texels = (0..cube.len()).into_par_iter().map(of).collect();
        let distance = |hit: &Option<Hit>| hit.map_or(f32::INFINITY, |hit| hit.distance);
        let distances = Distances { cube, texels: self.hits.iter().map(distance).collect() };
        let room = ParallaxBox::fitted(&distances);
        LitCubeMap { place: self.place, distances, room, levels: Levels::new(cube, texels) }
    }
}

impl CubeMaps {
    /// Casts the rays of cube maps over the metals of a file and lights them; `radiance` is that of a hit against a ray in a
    /// direction.
    pub(super) fn new<R>(
        settings: &CubeMapSettings,
        scene: &BakedScene,
        surfaces: &impl Surfaces,
        radiance: &R,
    ) -> Self
    where
        R: Fn(&Hit, Vec3, &mut Stream) -> Vec3 + Sync,
    {
        let cube = Cube { side: settings.side.max(1).next_power_of_two() };
        let lit = |place| CubeMapGeometry::new(cube, place, surfaces).lit(cube, radiance);
        let places = places::places(scene, surfaces, settings.count, settings.lift);
        Self { settings: *settings, maps: places.into_iter().map(lit).collect() }
    }

    /// Texels that are lit anew after a change of light.
    pub fn texels(&self) -> usize {
        self.maps.iter().map(|map| map.distances.texels.len()).sum()
    }

    /// Bytes that a file would need for them, before compression.
    pub fn bytes(&self) -> usize {
        self.texels() * TEXEL_BYTES
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
            settings: &self.settings,
            maps: ranked.into_iter().map(|(_, map)| map).collect(),
            position: hit.position + hit.geometric_normal * away,
            middle: None,
        };
        if self.settings.correction == Correction::MiddleDepth {
            let mirrored = direction.reflect(hit.normal);
            around.middle = around.meet(mirrored, cost).map(|(map, met)| (map, met.along));
        }
        around
    }
}

/// The maps near a hit, best first.
pub(super) struct NearMaps<'a> {
    settings: &'a CubeMapSettings,
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
            let met = match self.settings.correction {
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
            if self.settings.with_transfer {
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
