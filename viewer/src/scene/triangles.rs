//! The scene's triangles on the CPU, for ray casts and nearest points: walls stop the camera and dragged lights.
//!
//! Every mesh is stored once, 12 bytes a vertex and 12 a triangle; copies are transforms. Queries are in local
//! space. A query tests the bounding boxes of meshes and of chunks of consecutive triangles, then all triangles of
//! the intersected chunks. Back faces of one-sided surfaces are ignored. Glass and cut-outs count as complete
//! triangles.

use super::draw_batch::DrawBatch;
use glam::{Affine3A, Vec3, Vec3A};
use rebounce_shared::rbn::bulk::{Instance, Vertex};
use std::cell::{Cell, OnceCell, RefCell};

/// Triangles in one chunk.
const CHUNK: usize = 256;

/// A bounding box: centre and half the width along each axis.
#[derive(Clone, Copy, Debug)]
struct Aabb(Vec3A, Vec3A);

impl Aabb {
    fn around(places: impl Iterator<Item = Vec3>) -> Self {
        let start = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        let [low, high] = places.fold(start, |[low, high], p| [low.min(p), high.max(p)]);
        Self(((low + high) * 0.5).into(), ((high - low) * 0.5).into())
    }

    /// Bounding box (centre, half width) of the transformed box, widened a little for rounding errors.
    fn moved(&self, to: &Affine3A) -> [Vec3; 2] {
        let (centre, half) = (to.transform_point3a(self.0), to.matrix3.abs() * self.1);
        [centre.into(), (half * 1.0001 + centre.abs() * 1e-6).into()]
    }
}

/// Bounding boxes of a mesh and of its chunks.
struct Boxes {
    whole: Aabb,
    chunks: Vec<Aabb>,
}

/// Triangles of a scene, local space.
#[derive(Default)]
pub struct Triangles {
    positions: Vec<Vec3>,
    indices: Vec<u32>,
    instances: RefCell<Vec<Instance>>,
    runs: Vec<DrawBatch>,
    /// Created by the first query.
    boxes: OnceCell<Vec<Boxes>>,
}

/// Intersection of a ray and a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the ray, in lengths of its direction.
    pub distance: f32,
    /// Unit normal on the ray's side.
    pub normal: Vec3,
    /// Whether the surface is glass or blended.
    pub clear: bool,
}

impl Triangles {
    /// Takes the triangles of draw calls, front faces counterclockwise. `instances` begins with the identity for
    /// meshes without copies.
    pub fn new(
        vertices: &[Vertex],
        indices: Vec<u32>,
        instances: Vec<Instance>,
        runs: Vec<DrawBatch>,
    ) -> Self {
        let positions = vertices.iter().map(|vertex| vertex.position.into()).collect();
        Self { positions, indices, instances: instances.into(), runs, boxes: OnceCell::new() }
    }

    /// Replaces the instances after the identity.
    #[cfg(feature = "radiosity")]
    pub fn set_instances(&self, instances: &[Instance]) {
        self.instances.borrow_mut()[1..].copy_from_slice(instances);
    }

    /// Returns the nearest front-facing hit before `most` along a ray of unit direction.
    pub fn cast(&self, origin: Vec3, direction: Vec3, most: f32) -> Option<Hit> {
        let nearest = Cell::new(most);
        let mut met = None;
        // Avoids division by zero: a box's face may contain the origin.
        let inverse = direction.map(|x| 1.0 / if x == 0.0 { 1e-20 } else { x });
        let meets = |centre: Vec3, half: Vec3| {
            let (a, b) = ((centre - half - origin) * inverse, (centre + half - origin) * inverse);
            let (near, far) = (a.min(b).max_element(), a.max(b).min_element());
            near <= far && far >= 0.0 && near < nearest.get()
        };
        self.visit(origin, &meets, &mut |triangle, clear| {
            let distance = along(origin, direction, triangle);
            if distance > 0.0 && distance < nearest.get() {
                nearest.set(distance);
                met = Some((square(triangle), clear));
            }
        });
        let (normal, clear) = met?;
        let normal = normal.normalize();
        let normal = if normal.dot(direction) > 0.0 { -normal } else { normal };
        Some(Hit { distance: nearest.get(), normal, clear })
    }

    /// Returns the nearest place within `radius` on a front-facing surface.
    pub fn nearest(&self, to: Vec3, radius: f32) -> Option<Vec3> {
        let least = Cell::new(radius);
        let mut found = None;
        let meets = |centre: Vec3, half: Vec3| {
            let outside = ((to - centre).abs() - half).max(Vec3::ZERO);
            outside.length() < least.get()
        };
        self.visit(to, &meets, &mut |triangle, _| {
            let place = nearest_on(triangle, to);
            let distance = place.distance(to);
            if distance < least.get() {
                least.set(distance);
                found = Some(place);
            }
        });
        found
    }

    /// Calls `each` with every triangle that faces `from`, within boxes (centre, half width) accepted by `meets`,
    /// and with a flag for glass or blended surfaces.
    fn visit(&self, from: Vec3, meets: &dyn Fn(Vec3, Vec3) -> bool, each: &mut dyn FnMut([Vec3; 3], bool)) {
        let meets = |aabb: &Aabb, to: &Affine3A| {
            let [centre, half] = aabb.moved(to);
            meets(centre, half)
        };
        for (run, boxes) in self.runs.iter().zip(self.boxes.get_or_init(|| self.bounds())) {
            let indices = &self.indices[run.indices.start as usize..run.indices.end as usize];
            let instances = self.instances.borrow();
            for instance in &instances[run.instances.start as usize..run.instances.end as usize] {
                let to = instance.local_from_model();
                if !meets(&boxes.whole, &to) {
                    continue;
                }
                for (chunk, aabb) in indices.chunks(3 * CHUNK).zip(&boxes.chunks) {
                    if !meets(aabb, &to) {
                        continue;
                    }
                    for corners in chunk.as_chunks::<3>().0 {
                        let triangle = corners.map(|i| to.transform_point3(self.positions[i as usize]));
                        if !run.one_sided || square(triangle).dot(from - triangle[0]) > 0.0 {
                            each(triangle, run.glass || run.blended);
                        }
                    }
                }
            }
        }
    }

    /// Calls `each` with the batch, the vertices' indices and the corners of every triangle.
    #[cfg(any(feature = "guest", feature = "antiradiance"))]
    pub fn each(&self, mut each: impl FnMut(&DrawBatch, [u32; 3], [Vec3; 3])) {
        for run in &self.runs {
            let indices = &self.indices[run.indices.start as usize..run.indices.end as usize];
            let instances = self.instances.borrow();
            for instance in &instances[run.instances.start as usize..run.instances.end as usize] {
                let to = instance.local_from_model();
                for corners in indices.as_chunks::<3>().0 {
                    each(run, *corners, corners.map(|i| to.transform_point3(self.positions[i as usize])));
                }
            }
        }
    }

    fn bounds(&self) -> Vec<Boxes> {
        let of = |run: &DrawBatch| {
            let indices = &self.indices[run.indices.start as usize..run.indices.end as usize];
            let around = |part: &[u32]| Aabb::around(part.iter().map(|&i| self.positions[i as usize]));
            Boxes { whole: around(indices), chunks: indices.chunks(3 * CHUNK).map(around).collect() }
        };
        self.runs.iter().map(of).collect()
    }
}

/// Normal of a triangle with counterclockwise corners; length: twice the area.
fn square([a, b, c]: [Vec3; 3]) -> Vec3 {
    (b - a).cross(c - a)
}

/// Returns the distance of a triangle along a ray (Möller and Trumbore 1997); NaN or negative without a hit. Edges
/// have a small tolerance, so that no ray passes between neighbouring triangles.
fn along(origin: Vec3, direction: Vec3, [a, b, c]: [Vec3; 3]) -> f32 {
    let (ab, ac, from) = (b - a, c - a, origin - a);
    let (p, q) = (direction.cross(ac), from.cross(ab));
    let inverse = 1.0 / ab.dot(p);
    let (u, v) = (from.dot(p) * inverse, direction.dot(q) * inverse);
    if u >= -1e-5 && v >= -1e-5 && u + v <= 1.00001 { ac.dot(q) * inverse } else { f32::NAN }
}

/// Returns the place of a triangle nearest to `to`.
fn nearest_on(triangle: [Vec3; 3], to: Vec3) -> Vec3 {
    let normal = square(triangle);
    let [a, b, c] = triangle;
    let edges = [(a, b), (b, c), (c, a)];
    if normal != Vec3::ZERO && edges.iter().all(|&(v, w)| (w - v).cross(to - v).dot(normal) >= 0.0) {
        return to - normal * ((to - a).dot(normal) / normal.length_squared());
    }
    let on = |(v, w): (Vec3, Vec3)| {
        let edge = w - v;
        v + edge * ((to - v).dot(edge) / edge.length_squared().max(1e-30)).clamp(0.0, 1.0)
    };
    let [x, y, z] = edges.map(on);
    let nearer = |p: Vec3, q: Vec3| if p.distance_squared(to) < q.distance_squared(to) { p } else { q };
    nearer(x, nearer(y, z))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Two-sided triangles without copies.
    pub fn two_sided(triangles: &[[Vec3; 3]]) -> Triangles {
        of(triangles, vec![Instance::IDENTITY], false)
    }

    fn of(triangles: &[[Vec3; 3]], instances: Vec<Instance>, one_sided: bool) -> Triangles {
        let vertex = |position: &Vec3| Vertex { position: position.to_array(), ..Vertex::default() };
        let vertices: Vec<_> = triangles.iter().flatten().map(vertex).collect();
        let count = vertices.len() as u32;
        let run = DrawBatch {
            material: 0,
            indices: 0..count,
            instances: 0..instances.len() as u32,
            cut: false,
            blended: false,
            glass: false,
            one_sided,
        };
        Triangles::new(&vertices, (0..count).collect(), instances, vec![run])
    }

    /// Numbers from -1 to 1.
    fn numbers() -> impl FnMut() -> f32 {
        let mut state = 1u32;
        move || {
            state = state.wrapping_mul(1664525).wrapping_add(1013904223);
            (state >> 8) as f32 / (1 << 23) as f32 - 1.0
        }
    }

    fn scattered() -> Vec<[Vec3; 3]> {
        let mut next = numbers();
        let mut place = |size: f32| Vec3::new(next(), next(), next()) * size;
        (0..1500)
            .map(|_| {
                let at = place(5.0);
                [at, at + place(0.4), at + place(0.4)]
            })
            .collect()
    }

    /// Scale by two, a quarter turn around y, and a translation.
    fn elsewhere() -> Instance {
        Instance { rows: [[0.0, 0.0, 2.0, 11.0], [0.0, 2.0, 0.0, 1.0], [-2.0, 0.0, 0.0, 0.5]] }
    }

    #[test]
    fn casts_and_nearest_places_are_those_of_trying_every_triangle() {
        for one_sided in [false, true] {
            let instances = vec![Instance::IDENTITY, elsewhere()];
            let triangles = of(&scattered(), instances.clone(), one_sided);
            let all: Vec<[Vec3; 3]> = instances
                .iter()
                .flat_map(|i| {
                    scattered().into_iter().map(|t| t.map(|p| i.local_from_model().transform_point3(p)))
                })
                .collect();
            let mut next = numbers();
            let mut hits = 0;
            for i in 0..800 {
                let origin = Vec3::new(next() * 12.0, next() * 8.0, next() * 8.0);
                let direction =
                    if i % 8 == 0 { -Vec3::X } else { Vec3::new(next(), next(), next()).normalize() };
                let seen = |t: &&[Vec3; 3]| !one_sided || square(**t).dot(origin - t[0]) > 0.0;
                let first = all.iter().filter(seen).map(|t| along(origin, direction, *t));
                let first = first.filter(|t| *t > 0.0 && *t < 30.0).min_by(f32::total_cmp);
                let hit = triangles.cast(origin, direction, 30.0);
                assert_eq!(hit.map(|hit| hit.distance), first);
                assert!(hit.is_none_or(|hit| hit.normal.dot(direction) <= 0.0));
                hits += hit.is_some() as u32;
                let distances = all.iter().filter(seen).map(|t| nearest_on(*t, origin).distance(origin));
                let least = distances.min_by(f32::total_cmp).filter(|d| *d < 2.0);
                assert_eq!(triangles.nearest(origin, 2.0).map(|p| p.distance(origin)), least);
            }
            assert!((50..800).contains(&hits), "{hits}");
        }
    }

    #[test]
    fn the_nearest_place_of_a_triangle_is_nearer_than_all_others() {
        let mut next = numbers();
        let mut place = || Vec3::new(next(), next(), next());
        for _ in 0..200 {
            let [a, b, c, to] = [place(), place(), place(), place()];
            let found = nearest_on([a, b, c], to).distance(to);
            for i in 0..=20 {
                for j in 0..=20 - i {
                    let (u, v) = (i as f32 / 20.0, j as f32 / 20.0);
                    assert!(found <= (a + u * (b - a) + v * (c - a)).distance(to) + 1e-5);
                }
            }
        }
    }

    #[test]
    fn no_ray_goes_between_neighbours_nor_meets_what_has_no_area() {
        let [a, b, c, d] =
            [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(x, y)| Vec3::new(x, y, 0.0));
        let square = two_sided(&[[a, b, c], [b, d, c], [a, a, b], [a, a, a]]);
        for i in 1..100 {
            let x = i as f32 / 100.0;
            let hit = square.cast(Vec3::new(x, 1.0 - x, 3.0), Vec3::NEG_Z, 10.0).unwrap();
            assert!((hit.distance - 3.0).abs() < 1e-5 && hit.normal == Vec3::Z, "{hit:?}");
        }
        assert_eq!(two_sided(&[]).cast(a, Vec3::X, 1.0), None);
    }
}
