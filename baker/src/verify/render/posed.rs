//! A baked file whose rig is in a pose: the twin of skin.wgsl, ride.wgsl and rest_pixel.wgsl. Surfaces and points are those of the
//! pose; a place on what deforms looks functions up where the file has it.

use crate::geometry::nearest::TriangleTree;
use glam::{DVec3, Vec3};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::octahedral::{pack_rounded, unpack_snorm16};
use rebounce_shared::rbn::bulk::Point;
use rebounce_shared::rig::pose::Pose;
use rebounce_shared::rig::skin::{put, ridden, skinned};

/// Greatest distance of a place from the triangle that it is on, as a share of the diagonal of all poses: rounding.
const ROUNDING: f64 = 1e-4;

/// A file in a pose of its rig.
#[derive(Debug)]
pub struct PosedScene {
    /// The file with its vertices in the pose. Its points are at rest.
    pub scene: BakedScene,
    pub(super) points: Vec<Point>,
    tree: TriangleTree,
    triangles: Vec<PosedTriangle>,
    most: f64,
}

/// A triangle that deforms.
#[derive(Debug)]
struct PosedTriangle {
    /// Reconstruction group.
    group: u32,
    /// Normals of the corners in the pose.
    normals: [Vec3; 3],
    /// Positions and normals of the corners where the file has them.
    rest: [[Vec3; 2]; 3],
}

impl PosedScene {
    /// Poses a file.
    pub fn new(file: &BakedScene, pose: &Pose) -> Self {
        let rig = &file.rig;
        let at = skinned(rig, pose);
        let mut scene = file.clone();
        put(rig, &at, &mut scene.vertices);
        let mut points = file.points.clone();
        for rider in &rig.points {
            let on = ridden(rider, &at);
            let point = &mut points[rider.point as usize];
            (point.position, point.normal) = (on.position.to_array(), pack_rounded(on.normal));
        }
        let numbers = rig.numbers(file.vertices.len());
        let (mut places, mut triangles) = (Vec::new(), Vec::new());
        for draw in &file.meta.draws {
            let group = file.groups.of_material(draw.material);
            let first = draw.first_index as usize;
            for corners in file.indices[first..first + draw.index_count as usize].as_chunks::<3>().0 {
                let [Some(a), Some(b), Some(c)] = corners.map(|i| numbers[i as usize]) else { continue };
                let [a, b, c] = [a, b, c].map(|number| at[number as usize]);
                places.push([a, b, c].map(|corner| corner.position.as_dvec3()));
                let rest = corners.map(|i| {
                    let vertex = &file.vertices[i as usize];
                    [Vec3::from(vertex.position), unpack_snorm16(vertex.normal)]
                });
                triangles.push(PosedTriangle { group, normals: [a, b, c].map(|corner| corner.normal), rest });
            }
        }
        let [low, high] = rig.layout.bounds.map(|corner| Vec3::from(corner).as_dvec3());
        Self {
            scene,
            points,
            tree: TriangleTree::new(places),
            triangles,
            most: ROUNDING * (high - low).length(),
        }
    }

    /// Returns a position and a normal of a group where the file has them; `None` where nothing deforms.
    pub(super) fn at_rest(&self, position: Vec3, normal: Vec3, group: u32) -> Option<(Vec3, Vec3)> {
        let at: DVec3 = position.as_dvec3();
        let is_own = |triangle: u32| self.triangles[triangle as usize].group == group;
        let found =
            self.tree.nearest(at, self.most, |triangle, distance| is_own(triangle).then_some(distance))?;
        let triangle = &self.triangles[found.triangle as usize];
        let [v, w] = found.barycentric.map(|share| share as f32);
        let mean = |[a, b, c]: [Vec3; 3]| (1.0 - v - w) * a + v * b + w * c;
        let there = mean(triangle.rest.map(|[position, _]| position));
        let facing = mean(triangle.rest.map(|[_, normal]| normal)).normalize_or(normal);
        // On the back as in the pose.
        let is_back = mean(triangle.normals).dot(normal) < 0.0;
        Some((there, if is_back { -facing } else { facing }))
    }
}
