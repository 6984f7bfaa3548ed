//! Lamp for a scene without lights: placed within the picture, beside the surface in view, which the lamp lights.

use super::{ASPECT, spread_over_picture};
use crate::geometry::{Hit, Ray, Surfaces};
use crate::light::direct;
use glam::Vec3;
use rayon::prelude::*;
use rebounce_shared::camera::CameraFrame;
use rebounce_shared::elementary::Elementary;
use rebounce_shared::light::{Light, LightSource};
use std::f32::consts::PI;

/// Candidate positions in the picture, measured from the centre, relative to half the width and half the height: in the
/// left or right third, with the lamp's handle well within the picture.
const ACROSS: [f32; 5] = [0.38, 0.46, 0.55, 0.65, 0.75];
const UP: [f32; 8] = [0.72, 0.62, 0.52, 0.42, 0.32, 0.22, 0.12, 0.05];
/// Candidate distances from the eye, relative to the distance of the surface behind.
const AWAY: [f32; 7] = [0.85, 0.75, 0.65, 0.55, 0.45, 0.35, 0.25];
/// Best distance of a lamp below the ceiling, relative to the eye's height above the floor: a nearer lamp burns out the
/// ceiling. In high rooms, the best height is midway between eye and ceiling; in low rooms, the best height is `LEAST`
/// times the eye's height or more.
const BELOW: f32 = 0.75;
const LEAST: f32 = 1.05;
/// Widest spot (outer cone angle), degrees: a wider spot needs six shadow maps.
const WIDEST: f32 = 60.0;
/// Cone angle of a spot, relative to the angle of the object's bounding sphere: the light on the ground fades out.
const CONE: f32 = 1.9;
/// Preferred minimum distance of a spot from the centre of an object, relative to the scene's diagonal, so that the
/// spot lights the object completely.
const BACK: f32 = 0.7;
/// Number of best-rated positions to rate by illumination, and rays per picture.
const CLOSELY: usize = 96;
const RAYS: u32 = 160;
/// Irradiance of burnt-out points, relative to the mean; and the share of burnt-out points considered small.
const BURNT: f32 = 5.0;
const FEW_BURNT: f32 = 0.03;
/// Free distance around a lamp: in a room, relative to the local room height; in the open, relative to the scene's
/// diagonal.
const FREE: f32 = 0.12;
const FREE_IN_OPEN: f32 = 0.05;
/// Best height of a lamp under open sky, and the upper bound of the room height, relative to the eye's height.
const SKY: [f32; 2] = [2.5, 3.0];
/// Free horizontal distance of a well-placed lamp in a room, relative to the local room height: walls are then evenly
/// lit.
const ASIDE: f32 = 0.5;

/// Surfaces in a picture.
struct PictureView<'a, S: Surfaces + ?Sized> {
    surfaces: &'a S,
    frame: &'a CameraFrame,
    is_open: bool,
    /// Minimum and maximum corner of the detailed part of the scene, local space.
    part: (Vec3, Vec3),
    /// Height of the eye above the surface below.
    tall: f32,
    /// Hit at the centre of the picture, or nearest to the centre.
    target: Option<Hit>,
    /// Hits in the picture.
    seen: Vec<Hit>,
}

/// Distances of the surfaces around a position: minimum over all directions, minimum over horizontal directions, up,
/// down.
struct Room {
    around: f32,
    aside: f32,
    above: Option<f32>,
    below: Option<f32>,
}

/// Returns a lamp for the picture, world space: a point light in a room, a spot in the open.
pub fn lamp<S: Surfaces + ?Sized>(
    surfaces: &S,
    frame: &CameraFrame,
    is_open: bool,
    origin: [f64; 3],
) -> Light {
    let sight = PictureView::new(surfaces, frame, is_open);
    let place = sight.place();
    let position = std::array::from_fn(|i| origin[i] + f64::from(place[i]));
    let color = [1.0; 3];
    let gain = sight.gain(place);
    let intensity = two_digits(f64::from(if is_open { PI } else { 0.5 * PI } / gain));
    if !is_open {
        return Light::Point { position, intensity, color, radius: 0.0 };
    }
    let (low, high) = sight.part;
    let (to, radius) = (0.5 * (low + high) - place, 0.5 * (high - low).length());
    let around = (radius / to.length().max(1e-6 * radius)).min(1.0).arc_sine().to_degrees();
    let outer = f64::from((CONE * around).clamp(25.0, WIDEST).round());
    Light::Spot {
        position,
        direction: to.as_dvec3().to_array(),
        outer_cone_deg: outer,
        inner_cone_deg: Some((outer / f64::from(CONE)).round()),
        intensity,
        color,
        radius: 0.0,
    }
}

/// Rounds to two significant digits.
fn two_digits(x: f64) -> f64 {
    format!("{x:.1e}").parse().unwrap_or(x)
}

impl<'a, S: Surfaces + ?Sized> PictureView<'a, S> {
    fn new(surfaces: &'a S, frame: &'a CameraFrame, is_open: bool) -> Self {
        let part = surfaces.main_part();
        let down = surfaces.cast(&Ray::visibility(frame.eye, -Vec3::Y), 0);
        let tall = down.map_or(0.1 * (part.1 - part.0).length(), |hit| hit.distance);
        let mut sight = Self { surfaces, frame, is_open, part, tall, target: None, seen: Vec::new() };
        let places: Vec<[f32; 2]> = spread_over_picture(RAYS).collect();
        let hits: Vec<(f32, Hit)> =
            places.par_iter().filter_map(|at| Some((at[0].hypotenuse(at[1]), sight.hit(*at)?))).collect();
        let nearest = hits.iter().min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, hit)| *hit);
        sight.target = sight.hit([0.0; 2]).or(nearest);
        sight.seen = hits.into_iter().map(|(_, hit)| hit).collect();
        sight
    }

    /// Returns the unit direction through a position in the picture, -1 to 1, right and up.
    fn way(&self, [x, y]: [f32; 2]) -> Vec3 {
        let t = self.frame.tan_half_yfov;
        (self.frame.forward + t * (ASPECT * x * self.frame.right + y * self.frame.up)).normalize()
    }

    fn hit(&self, at: [f32; 2]) -> Option<Hit> {
        let way = self.way(at);
        self.surfaces.see(&Ray::visibility(self.frame.eye, way), 0).filter(|hit| hit.faces(way))
    }

    fn diagonal(&self) -> f32 {
        (self.part.1 - self.part.0).length()
    }

    /// Returns the distances of the surfaces around a position.
    fn room(&self, place: Vec3) -> Room {
        let free = |way: Vec3| self.surfaces.cast(&Ray::visibility(place, way), 0).map(|hit| hit.distance);
        let signs = [-1.0, 0.0, 1.0];
        let ways = signs.into_iter().flat_map(|x| signs.into_iter().map(move |z| (x, z)));
        let ways = ways.flat_map(|(x, z)| signs.into_iter().map(move |y| Vec3::new(x, y, z)));
        let ways: Vec<(Vec3, f32)> = ways
            .filter(|way| *way != Vec3::ZERO)
            .map(|way| (way, free(way.normalize()).unwrap_or(f32::INFINITY)))
            .collect();
        let least = |ways: &mut dyn Iterator<Item = &(Vec3, f32)>| {
            ways.map(|(_, free)| *free).fold(f32::INFINITY, f32::min)
        };
        Room {
            around: least(&mut ways.iter()),
            aside: least(&mut ways.iter().filter(|(way, _)| way.y == 0.0)),
            above: free(Vec3::Y),
            below: free(-Vec3::Y),
        }
    }

    /// Returns the irradiance of the target from 1 cd at `place`; 0 if occluded.
    fn reaches(&self, place: Vec3) -> f32 {
        self.target.as_ref().map_or(0.0, |hit| self.irradiance(place, hit))
    }

    fn irradiance(&self, place: Vec3, hit: &Hit) -> f32 {
        let position = place.as_dvec3().to_array();
        let light = Light::Point { position, intensity: 1.0, color: [1.0; 3], radius: 0.0 };
        let lights: [LightSource; 1] = [light.source([0.0; 3])];
        direct::at_hit(self.surfaces, &lights, hit).element_sum() / 3.0
    }

    /// Returns the irradiance of the lit points in the picture, from 1 cd at `place`.
    fn lit(&self, place: Vec3) -> Vec<f32> {
        self.seen.iter().map(|hit| self.irradiance(place, hit)).filter(|light| *light > 0.0).collect()
    }

    /// Returns the geometric mean of the irradiance of lit points in the picture, from 1 cd at `place`.
    fn gain(&self, place: Vec3) -> f32 {
        let mean = geometric_mean(&self.lit(place));
        let distance = 0.5 * self.diagonal();
        mean.max(1e-3 / (distance * distance).max(f32::MIN_POSITIVE))
    }

    /// Returns the position of the lamp, local space.
    fn place(&self) -> Vec3 {
        let eye = self.frame.eye;
        let looked = self.target.as_ref().map_or(0.5 * self.diagonal(), |hit| hit.distance);
        let tries: Vec<([f32; 2], f32)> = [-1.0, 1.0]
            .into_iter()
            .flat_map(|side| ACROSS.into_iter().map(move |x| side * x))
            .flat_map(|x| UP.into_iter().map(move |y| [x, y]))
            .flat_map(|at| AWAY.into_iter().map(move |away| (at, away)))
            .collect();
        let rated = |(at, away): &([f32; 2], f32)| {
            let behind = self.hit(*at).map_or(f32::INFINITY, |hit| hit.distance);
            let place = eye + self.way(*at) * (away * behind.min(1.5 * looked));
            (self.rate(place, *at, looked), place)
        };
        let mut rated: Vec<(f32, Vec3)> = tries.par_iter().map(rated).collect();
        rated.sort_by(|a, b| b.0.total_cmp(&a.0));
        rated.truncate(CLOSELY);
        let closely = |(rate, place): &(f32, Vec3)| {
            let lit: Vec<f32> = self.lit(*place);
            let usual = BURNT * geometric_mean(&lit);
            let share = |count: usize| count as f32 / self.seen.len().max(1) as f32;
            let burnt = share(lit.iter().filter(|light| **light > usual).count()) / FEW_BURNT;
            rate * (0.1 + share(lit.len()).powi(3)) / (1.0 + burnt * burnt)
        };
        let closely: Vec<f32> = rated.par_iter().map(closely).collect();
        let best = (0..rated.len()).max_by(|a, b| closely[*a].total_cmp(&closely[*b]).then(b.cmp(a)));
        best.map_or(eye, |best| rated[best].1)
    }

    /// Returns the score of a position without the illumination of the picture, over 0: free space, height below the
    /// ceiling, light on the target from the side, distance from the eye.
    fn rate(&self, place: Vec3, [x, _]: [f32; 2], looked: f32) -> f32 {
        let diagonal = self.diagonal();
        let room = self.room(place);
        let (low, high) = self.part;
        let below = room.below.unwrap_or(0.2 * diagonal);
        let tall = room.above.map_or(f32::INFINITY, |above| above + below).min(SKY[1] * self.tall);
        let wanted = if self.is_open { FREE_IN_OPEN * diagonal } else { FREE * tall };
        let free = (room.around / wanted).min(1.0);
        let (up, aside) = if self.is_open {
            let away = place.distance(0.5 * (low + high)) / (BACK * diagonal);
            let up = (place.y - low.y) / (high.y - low.y).max(1e-6);
            (0.75 + 0.25 * up.clamp(-1.0, 1.2), away.min(1.0).powi(2))
        } else {
            let up = match room.above {
                Some(above) => {
                    let high = above + below;
                    let wanted =
                        (high - BELOW * self.tall).min(0.5 * (self.tall + high)).max(LEAST * self.tall);
                    bell((below - wanted) / high, 0.15)
                }
                None => bell(below / self.tall - SKY[0], 1.5),
            };
            (up, (room.aside / (ASIDE * tall)).min(1.0))
        };
        let at_target = self.reaches(place);
        let reached = match &self.target {
            Some(hit) if at_target > 0.0 => {
                let cosine = at_target * place.distance_squared(hit.position);
                0.3 + 0.7 * cosine.min(0.7)
            }
            _ => 0.01,
        };
        let nearer = place.distance(self.frame.eye) / looked.max(1e-6 * diagonal);
        let depth = bell(nearer - 0.55, 0.45).max(0.05);
        let third = bell(x.abs() - 0.5, 0.4);
        // A position without free space is only a last resort.
        let free = if free < 1.0 { 0.001 * free } else { 1.0 };
        free * (0.02 + up.max(0.0)) * (0.2 + 0.8 * aside) * reached * depth * third + f32::MIN_POSITIVE
    }
}

/// Returns the geometric mean; 0 for an empty slice.
fn geometric_mean(light: &[f32]) -> f32 {
    let logs: f32 = light.iter().map(|light| light.logarithm()).sum();
    if light.is_empty() { 0.0 } else { (logs / light.len() as f32).exponential() }
}

fn bell(x: f32, width: f32) -> f32 {
    (-(x / width).powi(2)).exponential()
}
