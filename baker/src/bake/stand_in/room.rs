//! View of a room: level, from eye height above a large floor, with open space and large parts of the room in view.

use super::{ASPECT, YFOV_DEG, spread_over_picture};
use crate::geometry::{Ray, Surfaces};
use crate::light::direct;
use crate::random::Stream;
use crate::sampling::emitter::ParticleEmitter;
use glam::Vec3;
use rayon::prelude::*;
use rebounce_shared::elementary::Elementary;
use rebounce_shared::light::LightSource;
use std::collections::HashMap;

/// Eye height, in metres; and the range of room heights interpreted as metres.
const EYES: f32 = 1.6;
const METRES: std::ops::Range<f32> = 1.9..60.0;
/// Eye height in other rooms, relative to the room height.
const UP: f32 = 0.6;
/// Maximum eye height, relative to the room height.
const HIGHEST: f32 = 0.7;
/// Number of candidate positions on floors.
const TRIES: u64 = 768;
/// Share of candidate positions at the height of a large floor; tables have fewer.
const LARGE: f32 = 0.12;
/// Number of horizontal rays around a position; number of best views to score; rays per score.
const AROUND: usize = 32;
const CLOSELY: usize = 160;
const RAYS: u32 = 240;
/// Free distance around the eye, and the distance of surfaces too near to look at, relative to the eye height.
const FREE: f32 = 0.3;
const NEAR: f32 = 0.9;

/// Eye and direction of a view of a room.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoomView {
    /// Position of the eye, local space.
    pub eye: Vec3,
    /// Horizontal unit direction.
    pub towards: Vec3,
    /// Distance from the eye to the target.
    pub far: f32,
}

/// Candidate position: a point on a floor, and the height of the ceiling.
#[derive(Clone, Copy)]
struct Stand {
    floor: Vec3,
    height: Option<f32>,
}

/// Returns the best view; `None` without a floor. With lights, lit surfaces raise the score.
pub fn view<S: Surfaces + ?Sized>(
    surfaces: &S,
    emitter: &ParticleEmitter,
    lights: &[LightSource],
) -> Option<RoomView> {
    let stands = stands(surfaces, &emitter.viewpoints);
    let mut heights: Vec<f32> = stands.iter().filter_map(|stand| stand.height).collect();
    heights.sort_by(f32::total_cmp);
    let (low, high) = surfaces.main_part();
    let usual = heights.get(heights.len() / 2).copied().unwrap_or(high.y - low.y);
    let tall = if METRES.contains(&usual) { EYES } else { UP * usual };
    let ways = |stand: &Stand| {
        // Keeps the eye below a low ceiling.
        let up = stand.height.map_or(tall, |height| tall.min(HIGHEST * height));
        let eye = stand.floor + up * Vec3::Y;
        if is_free(surfaces, eye, FREE * tall) { rough(surfaces, eye, tall) } else { Default::default() }
    };
    let mut ways: Vec<(f32, Vec3, Vec3)> = stands.par_iter().flat_map_iter(ways).collect();
    ways.sort_by(|a, b| b.0.total_cmp(&a.0));
    ways.truncate(CLOSELY);
    let scores: Vec<f32> =
        ways.par_iter().map(|(_, eye, towards)| score(surfaces, *eye, *towards, tall, lights)).collect();
    let best = (0..ways.len()).max_by(|a, b| scores[*a].total_cmp(&scores[*b]).then(b.cmp(a)))?;
    let (_, eye, towards) = ways[best];
    let far = surfaces
        .cast(&Ray::visibility(eye, towards), 0)
        .map_or(0.25 * (high - low).length(), |hit| hit.distance);
    Some(RoomView { eye, towards, far: 0.7 * far })
}

/// Returns positions on large floors, below positions visible from the viewpoints.
fn stands<S: Surfaces + ?Sized>(surfaces: &S, viewpoints: &[Vec3]) -> Vec<Stand> {
    let (low, high) = surfaces.main_part();
    let find = |i: u64| {
        let mut stream = Stream::new(0x7374_616e, i);
        let viewpoint = *viewpoints.get(i as usize % viewpoints.len().max(1))?;
        let (z, x) = (std::f32::consts::TAU * stream.unit()).sine_cosine();
        let way = Vec3::new(x, 0.5 * stream.unit() - 0.25, z).normalize();
        let free = surfaces.cast(&Ray::visibility(viewpoint, way), 0);
        let free = free.map_or(0.25 * (high - low).length(), |hit| hit.distance);
        let place = viewpoint + way * (free * stream.unit());
        let down = Ray::visibility(place, -Vec3::Y);
        let floor = surfaces.cast(&down, 0).filter(|hit| hit.faces(-Vec3::Y) && hit.normal.y > 0.8)?;
        let above = floor.offset_origin(Vec3::Y, surfaces.epsilon_at(floor.position));
        let height = surfaces.cast(&Ray::visibility(above, Vec3::Y), 0).map(|hit| hit.distance);
        Some(Stand { floor: floor.position, height })
    };
    let found: Vec<Stand> = (0..TRIES).into_par_iter().filter_map(find).collect();
    let step = 0.01 * (high - low).length();
    let alike = |stand: &Stand| {
        found.iter().filter(|other| (other.floor.y - stand.floor.y).abs() < step).count() as f32
    };
    let least = LARGE * found.len() as f32;
    found.iter().filter(|stand| alike(stand) >= least).copied().collect()
}

fn is_free<S: Surfaces + ?Sized>(surfaces: &S, eye: Vec3, least: f32) -> bool {
    let around = (0..8).map(|i| {
        let (z, x) = (std::f32::consts::TAU * i as f32 / 8.0).sine_cosine();
        Vec3::new(x, 0.0, z)
    });
    around.chain([Vec3::Y, -Vec3::Y]).all(|way| {
        let ray = Ray { max_distance: least, ..Ray::visibility(eye, way) };
        surfaces.cast(&ray, 0).is_none()
    })
}

/// Returns the three most open level views from a position: openness, eye, direction.
fn rough<S: Surfaces + ?Sized>(surfaces: &S, eye: Vec3, tall: f32) -> Vec<(f32, Vec3, Vec3)> {
    let way = |i: usize| {
        let (z, x) = (std::f32::consts::TAU * i as f32 / AROUND as f32).sine_cosine();
        Vec3::new(x, 0.0, z)
    };
    let open: Vec<f32> = (0..AROUND)
        .map(|i| match surfaces.cast(&Ray::visibility(eye, way(i)), 0) {
            Some(hit) if hit.faces(way(i)) => (hit.distance / tall).logarithm1p(),
            // Back sides, and the sky.
            Some(_) => -1.0,
            None => 0.5,
        })
        .collect();
    // An eighth of a turn to each side.
    let side = AROUND / 8;
    let mut ways: Vec<(f32, Vec3, Vec3)> = (0..AROUND)
        .map(|i| {
            let seen = (0..=2 * side).map(|k| open[(i + k + AROUND - side) % AROUND]);
            (seen.sum(), eye, way(i))
        })
        .collect();
    ways.sort_by(|a, b| b.0.total_cmp(&a.0));
    ways.truncate(3);
    ways
}

/// Returns the score of a level view: distant and varied surfaces, floor in view, and, with lights, lit surfaces raise
/// the score; near surfaces, back sides and sky lower the score.
fn score<S: Surfaces + ?Sized>(
    surfaces: &S,
    eye: Vec3,
    towards: Vec3,
    tall: f32,
    lights: &[LightSource],
) -> f32 {
    let right = towards.cross(Vec3::Y);
    let half = (0.5 * YFOV_DEG as f32).to_radians().tangent();
    let (mut open, mut seen, mut near, mut floor, mut lit) = (0.0, 0.0f32, 0.0, 0.0, 0.0);
    let mut kinds: HashMap<u32, u32> = HashMap::new();
    for [x, y] in spread_over_picture(RAYS) {
        let way = (towards + half * (ASPECT * x * right + y * Vec3::Y)).normalize();
        let ray = Ray::visibility(eye, way);
        let Some(hit) = surfaces.see(&ray, 0).filter(|hit| hit.faces(way)) else { continue };
        seen += 1.0;
        open += (hit.distance / tall).logarithm1p();
        near += (hit.distance < NEAR * tall) as u32 as f32;
        floor += (hit.normal.y > 0.8 && hit.position.y < eye.y - 0.7 * tall) as u32 as f32;
        if !lights.is_empty() && direct::at_hit(surfaces, lights, &hit) != Vec3::ZERO {
            lit += 1.0;
        }
        if let Some(primitives) = surfaces.primitives()
            && let Some((place, _)) = primitives.find_seen(&ray, 0)
        {
            *kinds.entry(primitives.primitive(place.primitive).kind).or_default() += 1;
        }
    }
    let rays = RAYS as f32;
    // Effective number of materials: the number of equal shares with the same entropy.
    let part = |count: &u32| *count as f32 / seen.max(1.0);
    let kinds = kinds.values().map(|count| -part(count) * part(count).logarithm()).sum::<f32>().exponential();
    let share = |part: f32| part / rays;
    let in_light = if lights.is_empty() { 1.0 } else { 0.3 + 0.7 * (share(lit) / 0.2).min(1.0) };
    share(open)
        * share(seen).powi(2)
        * (1.0 - 3.0 * share(near)).max(0.0)
        * (0.25 + 0.75 * (share(floor) / 0.12).min(1.0))
        * kinds.sqrt()
        * in_light
}
