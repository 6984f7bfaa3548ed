//! Nearest hits of rays with the triangles of a file: a BVH of obvhs.

use crate::scene::triangles::Triangles;
use glam::{Vec2, Vec3, Vec3A};
use obvhs::bvh2::Bvh2;
use obvhs::ploc::PlocBuilder;
use obvhs::ray::{Ray, RayHit};
use obvhs::triangle::Triangle;
use obvhs::{Boundable, BvhBuildParams};

/// Most triangles, copies included, of a scene that has probes.
pub const MOST_TRIANGLES: usize = 4 << 20;

/// Attributes of a triangle.
#[derive(Clone, Copy, Debug)]
struct TriangleAttributes {
    vertices: [u32; 3],
    material: u32,
    one_sided: bool,
}

/// Triangles with a BVH.
pub struct Caster {
    bvh: Bvh2,
    triangles: Vec<Triangle>,
    shades: Vec<TriangleAttributes>,
}

/// A surface that a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceHit {
    /// Distance along the ray.
    pub distance: f32,
    /// Unit normal of the triangle, on the ray's side.
    pub normal: Vec3,
    /// Index of the material.
    pub material: u32,
    /// Texture coordinates.
    pub uv: Vec2,
    /// Whether it is the back of a one-sided surface, which reflects nothing.
    pub is_back: bool,
}

impl Caster {
    /// Builds the BVH. Glass and blended surfaces are left out: rays pass. `None` past [`MOST_TRIANGLES`].
    pub fn new(from: &Triangles) -> Option<Self> {
        let (mut triangles, mut shades) = (Vec::new(), Vec::new());
        from.each(|run, vertices, corners| {
            if !run.glass && !run.blended && triangles.len() <= MOST_TRIANGLES {
                let [v0, v1, v2] = corners.map(Vec3A::from);
                triangles.push(Triangle { v0, v1, v2 });
                shades.push(TriangleAttributes {
                    vertices,
                    material: run.material,
                    one_sided: run.one_sided,
                });
            }
        });
        if triangles.len() > MOST_TRIANGLES {
            return None;
        }
        let preset = BvhBuildParams::fast_build();
        // The steps of obvhs' `build_bvh2`, which reads a clock that wasm32 lacks.
        let boxes: Vec<_> = triangles.iter().map(Boundable::aabb).collect();
        let bvh = PlocBuilder::with_capacity(boxes.len()).build(
            preset.ploc_search_distance,
            &boxes,
            (0..boxes.len() as u32).collect(),
            preset.sort_precision,
            preset.search_depth_threshold,
        );
        Some(Self { bvh, triangles, shades })
    }

    /// The nearest hit of a ray of unit direction; `uvs` has the texture coordinates of every vertex.
    pub fn cast(&self, origin: Vec3, direction: Vec3, most: f32, uvs: &[[f32; 2]]) -> Option<SurfaceHit> {
        let mut nearest = RayHit::none();
        let ray = Ray::new(origin.into(), direction.into(), 0.0, most);
        let at = |primitive: usize| self.bvh.primitive_indices[primitive] as usize;
        self.bvh
            .ray_traverse(ray, &mut nearest, |ray, primitive| self.triangles[at(primitive)].intersect(ray));
        if nearest.primitive_id == u32::MAX {
            return None;
        }
        let number = at(nearest.primitive_id as usize);
        let (Triangle { v0, v1, v2 }, shade) = (self.triangles[number], self.shades[number]);
        let front = (v1 - v0).cross(v2 - v0);
        let place = Vec3A::from(origin + direction * nearest.t);
        // Barycentric coordinates as shares of the area.
        let share = |a: Vec3A, b: Vec3A| (a - place).cross(b - place).dot(front) / front.length_squared();
        let weights = [share(v1, v2), share(v2, v0), share(v0, v1)];
        let uv = shade.vertices.iter().zip(weights).map(|(v, w)| Vec2::from(uvs[*v as usize]) * w).sum();
        let faces = front.dot(direction.into()) < 0.0;
        let normal = Vec3::from(front.normalize_or_zero()) * if faces { 1.0 } else { -1.0 };
        let is_back = shade.one_sided && !faces;
        Some(SurfaceHit { distance: nearest.t, normal, material: shade.material, uv, is_back })
    }
}
