//! Lamps that a mesh around them encloses, so that their light gets nowhere: a bulb with its lamp in it.

use super::light;
use super::mesh::{self, Part};
use super::source::Source;
use glam::{DMat4, DQuat, DVec3};
use rebounce_shared::light::Light;

/// Directions that are looked into, all around a point light or within a spot's cone.
const DIRECTIONS: usize = 64;
/// What encloses a lamp this near, in shares of the scene's diagonal, is its bulb or shade and no room.
const NEAR: f64 = 0.05;
/// Pairs of a lamp and a mesh that are looked at, at most.
const MOST: usize = 10_000;

/// A lamp, and the mesh around it.
pub(super) struct Enclosed {
    /// Of the file's lights.
    light: usize,
    mesh: usize,
    /// Scene units from the lamp to the farthest hit.
    farthest: f64,
}

impl Enclosed {
    /// What is said of it in a scene of this diagonal, unless it is a room.
    pub fn note(&self, source: &Source, diagonal: f64) -> Option<String> {
        (self.farthest <= NEAR * diagonal).then(|| {
            let (lamp, mesh) = (light::name(source, self.light), mesh::name(source, self.mesh));
            format!(
                "{lamp} is enclosed by {mesh}: its light gets nowhere; make the mesh transparent, or move the lamp out of it"
            )
        })
    }
}

/// The scene's lamps that have a place.
pub(super) struct Lamps {
    /// In the order of their x.
    lamps: Vec<Lamp>,
    looked_at: usize,
    pub enclosed: Vec<Enclosed>,
}

struct Lamp {
    light: usize,
    position: DVec3,
    directions: Vec<DVec3>,
}

impl Lamps {
    /// Of these lights, each with its number among the file's.
    pub fn new<'a>(lights: impl Iterator<Item = (usize, &'a Light)>) -> Self {
        let lamp = |(light, shape): (usize, &Light)| match shape {
            Light::Point { position, .. } => {
                Some(Lamp { light, position: DVec3::from(*position), directions: directions(DVec3::Z, -1.0) })
            }
            Light::Spot { position, direction, outer_cone_deg, .. } => {
                let axis = DVec3::from(*direction).try_normalize()?;
                let edge = outer_cone_deg.to_radians().cos();
                Some(Lamp { light, position: DVec3::from(*position), directions: directions(axis, edge) })
            }
            Light::Directional { .. } => None,
        };
        let mut lamps: Vec<Lamp> = lights.filter_map(lamp).collect();
        lamps.sort_by(|a, b| a.position.x.total_cmp(&b.position.x));
        Self { lamps, looked_at: 0, enclosed: Vec::new() }
    }

    /// Looks for lamps within a mesh that stands at `places`. `parts` are those that let no light through.
    pub fn look(&mut self, mesh: usize, parts: &[&Part], places: &[DMat4]) {
        if self.lamps.is_empty() {
            return;
        }
        let corners = parts
            .iter()
            .flat_map(|part| part.triangles.iter().flatten().map(|i| part.positions[*i as usize]));
        let Some(bounds) = bounds(corners) else { return };
        for world in places {
            let corner = |i: usize| DVec3::new(bounds[i & 1].x, bounds[i >> 1 & 1].y, bounds[i >> 2].z);
            let Some([low, high]) = self::bounds((0..8).map(|i| world.transform_point3(corner(i)))) else {
                continue;
            };
            let first = self.lamps.partition_point(|lamp| lamp.position.x < low.x);
            for lamp in self.lamps[first..].iter().take_while(|lamp| lamp.position.x <= high.x) {
                if lamp.position.cmpge(low).all() && lamp.position.cmple(high).all() && self.looked_at < MOST
                {
                    self.looked_at += 1;
                    let farthest = lamp.farthest(parts, world);
                    self.enclosed.extend(farthest.map(|farthest| Enclosed {
                        light: lamp.light,
                        mesh,
                        farthest,
                    }));
                }
            }
        }
    }
}

/// Least and greatest corner; `None` without points.
fn bounds(points: impl Iterator<Item = DVec3>) -> Option<[DVec3; 2]> {
    points.map(|p| [p, p]).reduce(|[low, high], [p, _]| [low.min(p), high.max(p)])
}

impl Lamp {
    /// How far away the farthest of the hits is, one in each direction; `None` where one direction is free.
    fn farthest(&self, parts: &[&Part], world: &DMat4) -> Option<f64> {
        let corners = |part: &Part, t: &[u32; 3]| {
            t.map(|i| world.transform_point3(part.positions[i as usize]) - self.position)
        };
        let triangles = parts.iter().flat_map(|part| part.triangles.iter().map(|t| corners(part, t)));
        let triangles: Vec<[DVec3; 3]> = triangles.collect();
        let mut farthest: f64 = 0.0;
        for &direction in &self.directions {
            let nearest =
                triangles.iter().filter_map(|t| distance(*t, direction)).fold(f64::INFINITY, f64::min);
            if nearest == f64::INFINITY {
                return None;
            }
            farthest = farthest.max(nearest);
        }
        Some(farthest)
    }
}

/// Directions spread evenly over the part of a sphere whose cosine with `axis` is `edge` or more.
fn directions(axis: DVec3, edge: f64) -> Vec<DVec3> {
    let turn = DQuat::from_rotation_arc(DVec3::Z, axis);
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let direction = |i: usize| {
        let z = 1.0 - (1.0 - edge) * (i as f64 + 0.5) / DIRECTIONS as f64;
        let (sin, cos) = (golden * i as f64).sin_cos();
        let r = (1.0 - z * z).max(0.0).sqrt();
        turn * DVec3::new(r * cos, r * sin, z)
    };
    (0..DIRECTIONS).map(direction).collect()
}

/// How far a ray from the origin goes to a triangle, either side of it; edges belong to both their triangles.
fn distance([a, b, c]: [DVec3; 3], direction: DVec3) -> Option<f64> {
    let (ab, ac) = (b - a, c - a);
    let p = direction.cross(ac);
    let determinant = ab.dot(p);
    let u = -a.dot(p) / determinant;
    let q = (-a).cross(ab);
    let (v, t) = (direction.dot(q) / determinant, ac.dot(q) / determinant);
    let edge = -1e-9;
    (u >= edge && v >= edge && u + v <= 1.0 - edge && t > 0.0 && t.is_finite()).then_some(t)
}
