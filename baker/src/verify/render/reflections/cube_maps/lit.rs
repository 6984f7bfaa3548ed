//! Light of the texels of cube maps: each texel's surface under the lights of a picture. The viewer's cube_light.wgsl has the
//! same formulas.

use super::{CubeMapLookup, CubeMaps, ParallaxBox};
use crate::geometry::Surfaces;
use crate::light::direct;
use crate::random::Stream;
use crate::verify::render::Relit;
use crate::verify::render::reflections::{Reflections, skies};
use glam::{Vec3, Vec4};
use rayon::prelude::*;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::cube_map::levels::Levels;
use rebounce_shared::cube_map::march::Distances;
use rebounce_shared::cube_map::metal_in_map;
use rebounce_shared::environment::reflection::of_skies;
use rebounce_shared::rbn::cube_maps::CubeMaps as CubeMapsOfFile;
use std::f32::consts::FRAC_1_PI;

/// A map under the lights of a picture.
pub(super) struct LitCubeMap {
    pub place: Vec3,
    pub distances: Distances,
    pub room: ParallaxBox,
    pub levels: Levels,
}

impl LitCubeMap {
    /// From the radiance and coverage of every texel.
    pub fn new(maps: &CubeMapsOfFile, map: usize, texels: Vec<Vec4>) -> Self {
        let distances = maps.distances(map);
        let room = ParallaxBox::fitted(&distances);
        Self { place: maps.place(map), distances, room, levels: Levels::new(maps.cube(), texels) }
    }
}

impl CubeMaps {
    /// Lights maps for a picture.
    pub(in super::super) fn new(
        maps: &CubeMapsOfFile,
        lookup: CubeMapLookup,
        reflections: &Reflections,
        relit: &Relit,
        scene: &BakedScene,
        surfaces: &impl Surfaces,
    ) -> Self {
        let emission = scene.gloss.layout.emission.iter().zip(&relit.lighting.emission);
        let emission: Vec<Vec3> = emission.map(|(mean, factor)| Vec3::from(*mean) * *factor).collect();
        let (cube, skies) = (maps.cube(), skies(&relit.lighting));
        let radiance = |i: usize| {
            let Some(point) = maps.point(i) else { return Vec4::ZERO };
            let (texel, stream) = (maps.texels[i], &mut Stream::new(i as u64, 0));
            let (position, normal) = (point.position(), texel.normal());
            // The sums over lamps and functions are the viewer's.
            let lamps = direct::at_footprint(surfaces, &relit.lighting.lamps, &point);
            let light = relit.light_with_detail(surfaces, position, [normal; 2], texel.group(), stream);
            let around = texel.metal().and_then(|roughness| {
                let arriving = reflections.arriving(&relit.basis, position, normal, texel.group())?;
                let way = cube.direction(i % cube.texels());
                Some(metal_in_map(&arriving, way, normal, roughness, |direction, solid_angle| {
                    of_skies(&skies, direction, solid_angle)
                }))
            });
            let around = around.unwrap_or((light.bounced + light.from_sources) * FRAC_1_PI);
            let shining =
                texel.emitter().and_then(|group| emission.get(group)).copied().unwrap_or(Vec3::ZERO);
            (texel.reflectance() * (around + lamps * FRAC_1_PI) + shining).extend(1.0)
        };
        let lit = |map: usize| {
            let texels = map * cube.texels()..(map + 1) * cube.texels();
            LitCubeMap::new(maps, map, texels.into_par_iter().map(radiance).collect())
        };
        Self { lookup, maps: (0..maps.layout.places.len()).map(lit).collect() }
    }
}
