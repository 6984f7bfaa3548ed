//! Detection of lamps enclosed by an opaque mesh, such as a lamp within a modelled bulb: no light leaves the mesh.

use super::light;
use super::mesh::{self, MeshPart};
use super::source::Source;
use glam::{DMat4, DQuat, DVec3};
use rebounce_shared::elementary::Elementary;
use rebounce_shared::light::Light;

/// Number of test rays per lamp, over the sphere for a point light, within the cone for a spot light.
const DIRECTIONS: usize = 64;
/// Largest enclosure, as a share of the scene's diagonal, that counts as a bulb or shade; a larger enclosure is a room.
const NEAR: f64 = 0.05;
/// Maximum number of (lamp, mesh) pairs tested.
const MOST: usize = 10_000;

/// A lamp and the enclosing mesh.
pub(super) struct Enclosed {
    /// Index into the file's lights.
    light: usize,
    mesh: usize,
    /// Scene units from the lamp to the farthest hit.
    farthest: f64,
}

impl Enclosed {
    /// Returns a note for a scene with the given diagonal; `None` if the enclosure is a room.
    pub fn note(&self, source: &Source, diagonal: f64) -> Option<String> {
        (self.farthest <= NEAR * diagonal).then(|| {
            let (lamp, mesh) = (light::name(source, self.light), mesh::name(source, self.mesh));
            format!(
                "{lamp} is enclosed by {mesh}: its light gets nowhere; make the mesh transparent, or move the lamp out of it"
            )
        })
    }
}

/// Lights of the scene with a position, and the enclosures found.
pub(super) struct Lamps {
    /// Sorted by x.
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
    /// Collects the lights with a position; the index of a pair refers to the file's lights.
    pub fn new<'a>(lights: impl Iterator<Item = (usize, &'a Light)>) -> Self {
        let lamp = |(light, shape): (usize, &Light)| {
            let position = DVec3::from(shape.position()?);
            let axis = shape.direction().map_or(Some(DVec3::Z), |axis| DVec3::from(axis).try_normalize())?;
            let edge = f64::from(shape.source([0.0; 3]).cos_outer);
            Some(Lamp { light, position, directions: directions(axis, edge) })
        };
        let mut lamps: Vec<Lamp> = lights.filter_map(lamp).collect();
        lamps.sort_by(|a, b| a.position.x.total_cmp(&b.position.x));
        Self { lamps, looked_at: 0, enclosed: Vec::new() }
    }

    /// Tests the lamps against a mesh placed at `places`. `parts`: the opaque parts of the mesh.
    pub fn look(&mut self, mesh: usize, parts: &[&MeshPart], places: &[DMat4]) {
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

/// Minimum and maximum corner; `None` without points.
fn bounds(points: impl Iterator<Item = DVec3>) -> Option<[DVec3; 2]> {
    points.map(|p| [p, p]).reduce(|[low, high], [p, _]| [low.min(p), high.max(p)])
}

impl Lamp {
    /// Distance to the farthest of the nearest hits, one hit per direction; `None` if a direction has no hit.
    fn farthest(&self, parts: &[&MeshPart], world: &DMat4) -> Option<f64> {
        let corners = |part: &MeshPart, t: &[u32; 3]| {
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

/// Spreads `DIRECTIONS` directions evenly over the spherical cap where the cosine with `axis` is at least `edge`.
fn directions(axis: DVec3, edge: f64) -> Vec<DVec3> {
    let turn = DQuat::from_rotation_arc(DVec3::Z, axis);
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let direction = |i: usize| {
        let z = 1.0 - (1.0 - edge) * (i as f64 + 0.5) / DIRECTIONS as f64;
        let (sin, cos) = (golden * i as f64).sine_cosine();
        let r = (1.0 - z * z).max(0.0).sqrt();
        turn * DVec3::new(r * cos, r * sin, z)
    };
    (0..DIRECTIONS).map(direction).collect()
}

/// Distance along a ray from the origin to a triangle, two-sided; an edge belongs to both adjacent triangles.
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
