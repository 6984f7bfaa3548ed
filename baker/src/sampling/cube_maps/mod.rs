//! Cube maps of the surroundings of metals (reflection probes): which surface each texel sees from places near the metals.
//! Pictures light them ([`rebounce_shared::cube_map`]).
//!
//! * here: rays through the texels;
//! * `places` – where maps are.

mod places;

use crate::geometry::{Hit, HitEmitter, Ray, Surfaces};
use glam::Vec3;
use rayon::prelude::*;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::cube_map::cube::Cube;
use rebounce_shared::rbn::cube_maps::{CubeMapLayout, CubeMaps, CubeTexel, SeenSurface};

/// Number and places of cube maps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CubeMapSettings {
    /// Maps, at most [`MAX_MAPS`](rebounce_shared::rbn::cube_maps::MAX_MAPS) in a file; 0 for none.
    pub count: usize,
    /// Texels along an edge of a face; a power of two.
    pub side: usize,
    /// Distance of maps from the metals, of the metals' size.
    pub lift: f32,
    /// A bake keeps none where more of their directions than this share see no surface: light comes to metals in the open from afar, and
    /// what hides it close by is finer than a few maps.
    pub most_open: f32,
}

impl Default for CubeMapSettings {
    fn default() -> Self {
        Self { count: 16, side: 32, lift: 0.05, most_open: 0.3 }
    }
}

/// Share of the directions of all maps that see no surface; 1 without maps.
pub fn open_share(maps: &CubeMaps) -> f32 {
    let cube = Cube { side: maps.layout.side as usize };
    let (mut open, mut all) = (0.0, 0.0);
    for (number, texel) in maps.texels.iter().enumerate() {
        let angle = cube.solid_angle(cube.direction(number % cube.texels()));
        all += angle;
        open += if *texel == CubeTexel::default() { angle } else { 0.0 };
    }
    if all > 0.0 { open / all } else { 1.0 }
}

/// Makes cube maps over the metals of a file; empty without metals that have glossy transfer.
pub fn cube_maps<S: Surfaces + ?Sized>(
    surfaces: &S,
    file: &BakedScene,
    settings: &CubeMapSettings,
) -> CubeMaps {
    let cube = Cube { side: settings.side.max(1).next_power_of_two() };
    let places = places::places(file, surfaces, settings.count, settings.lift);
    let cast = |(place, texel): (Vec3, usize)| {
        let direction = cube.direction(texel);
        let spread = cube.solid_angle(direction).sqrt();
        let ray = Ray { origin: place, direction, max_distance: f32::INFINITY, spread };
        surfaces.cast(&ray, texel as u32)
    };
    let rays: Vec<_> =
        places.iter().flat_map(|place| (0..cube.texels()).map(move |texel| (*place, texel))).collect();
    let hits: Vec<Option<Hit>> = rays.into_par_iter().map(cast).collect();
    let seen = hits.iter().flatten().map(|hit| hit.distance.max(f32::MIN_POSITIVE));
    let [near, far] = seen.fold([f32::INFINITY, 0.0], |[near, far]: [f32; 2], d| [near.min(d), far.max(d)]);
    // Without anything in sight any range will do.
    let range = if near <= far { [near, far] } else { [1.0; 2] };
    let places: Vec<[f32; 3]> = places.iter().map(|place| place.to_array()).collect();
    let layout = match places.is_empty() {
        true => return CubeMaps::default(),
        false => CubeMapLayout { side: cube.side as u32, range, places },
    };
    let group_of = file.sources.group_of_materials();
    let emitter = |hit: &Hit| {
        let Some(HitEmitter::Surface(number)) = hit.emitter else { return None };
        let material = surfaces.emitters()?.emitter(number).material;
        group_of.get(material as usize).copied().flatten()
    };
    let packed = |hit: &Option<Hit>| {
        let Some(hit) = hit else { return CubeTexel::default() };
        let surface = SeenSurface {
            distance: hit.distance,
            normal: hit.normal,
            // What is unlit reflects nothing.
            reflectance: if hit.is_unlit { Vec3::ZERO } else { hit.albedo },
            metal: hit.gloss.is_metal().then_some(hit.gloss.roughness),
            emitter: emitter(hit),
            group: hit.group,
        };
        CubeTexel::pack(&layout, &surface)
    };
    CubeMaps { texels: hits.iter().map(packed).collect(), layout }
}
