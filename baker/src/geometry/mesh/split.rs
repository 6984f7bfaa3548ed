//! Subdivision of large triangles near the origin of local space, where numbers are exact.
//!
//! The error of a hit's position is a fraction of the triangle's size: a millimetre on a plain of ten kilometres, too
//! much beside a house. Around the scene's detail, at the origin of local space, an edge is halved if the edge is
//! longer than the size of the detail, and longer than the distance of the edge's middle from the origin. The decision
//! depends on the edge only, so neighbours stay joined.

use super::geometry::{Geometry, Triangle, WITH_LIGHTMAPS};
use glam::{Vec2, Vec3};

/// Maximum number of halvings of an edge: from any scene down to the exactness of numbers.
const MOST: u32 = 40;

/// Subdivides triangles without instances, around a detail of this size at the origin, scene units.
pub(super) fn split(geometry: &mut Geometry, size: f32) {
    let end = geometry.models.first().map_or(geometry.triangles.len(), |model| model.triangles.start);
    let has_colors = !geometry.colors.is_empty();
    let has_lightmap = WITH_LIGHTMAPS && !geometry.lightmap.is_empty();
    let mut triangles = Vec::with_capacity(geometry.triangles.len());
    let mut colors = Vec::with_capacity(geometry.colors.len());
    let mut lightmap = Vec::with_capacity(geometry.lightmap.len());
    for (i, &triangle) in geometry.triangles[..end].iter().enumerate() {
        let color = geometry.colors.get(i).copied().unwrap_or_default();
        let texels = match has_lightmap {
            true => geometry.lightmap[i],
            false => Default::default(),
        };
        let mut left = vec![(Whole { triangle, color, texels }, 0)];
        while let Some((whole, depth)) = left.pop() {
            match longest(&whole.triangle, size).filter(|_| depth < 3 * MOST) {
                Some(edge) => left.extend(halves(&whole, edge).map(|half| (half, depth + 1))),
                None => {
                    triangles.push(whole.triangle);
                    colors.extend(has_colors.then_some(whole.color));
                    lightmap.extend(has_lightmap.then_some(whole.texels));
                }
            }
        }
    }
    let more = triangles.len() - end;
    triangles.extend(&geometry.triangles[end..]);
    colors.extend(geometry.colors.get(end..).unwrap_or_default());
    if has_lightmap {
        lightmap.extend(&geometry.lightmap[end..]);
    }
    (geometry.triangles, geometry.colors, geometry.lightmap) = (triangles, colors, lightmap);
    for model in &mut geometry.models {
        model.triangles = model.triangles.start + more..model.triangles.end + more;
    }
}

/// Returns the longest edge to be halved, as the index of the edge's first corner; `None` if every edge is short
/// enough.
fn longest(triangle: &Triangle, size: f32) -> Option<usize> {
    let p = triangle.positions;
    let edge = |i: usize| (p[(i + 1) % 3].distance(p[i]), middle(p[i], p[(i + 1) % 3]).length());
    let long = (0..3).map(|i| (i, edge(i))).filter(|(_, (length, away))| *length > size.max(*away));
    long.max_by(|a, b| a.1.0.total_cmp(&b.1.0)).map(|(i, _)| i)
}

/// Returns the middle, independent of the edge's direction.
fn middle(a: Vec3, b: Vec3) -> Vec3 {
    0.5 * (a + b)
}

/// A triangle with what else its corners have.
#[derive(Clone, Copy)]
struct Whole {
    triangle: Triangle,
    color: [Vec3; 3],
    texels: [Vec2; 3],
}

/// Returns the two halves of a triangle with the edge from corner `i` halved.
fn halves(whole: &Whole, i: usize) -> [Whole; 2] {
    let j = (i + 1) % 3;
    let Whole { triangle: Triangle { positions: p, normals: n, uvs, .. }, color, texels } = whole;
    let position = middle(p[i], p[j]);
    // Not normalised, so that the halves have the normals of the original triangle.
    let (normal, uv, tone) = (middle(n[i], n[j]), 0.5 * (uvs[i] + uvs[j]), middle(color[i], color[j]));
    let texel = 0.5 * (texels[i] + texels[j]);
    [i, j].map(|corner| {
        let mut half = *whole;
        let Triangle { positions, normals, uvs, .. } = &mut half.triangle;
        (positions[corner], normals[corner], uvs[corner]) = (position, normal, uv);
        (half.color[corner], half.texels[corner]) = (tone, texel);
        half
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::mesh::geometry::Placed;
    use glam::{Affine3A, Vec2, vec3};
    use std::collections::HashMap;

    fn triangle(positions: [Vec3; 3]) -> Triangle {
        Triangle {
            positions,
            normals: [Vec3::Y; 3],
            uvs: positions.map(|p| Vec2::new(p.x, p.z)),
            material: 0,
        }
    }

    fn area(t: &Triangle) -> f64 {
        let [a, b, c] = t.positions.map(|p| p.as_dvec3());
        0.5 * (b - a).cross(c - a).length()
    }

    #[test]
    fn a_plain_is_cut_up_near_the_middle_and_stays_joined() {
        let corner = |x: f32, z: f32| vec3(8000.0 * x + 3.0, -1.5, 5000.0 * z - 1.0);
        let (a, b, c, d) = (corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0));
        let model = triangle([a, b, c]);
        let mut geometry = Geometry {
            triangles: vec![triangle([a, c, b]), triangle([a, d, c]), model],
            models: vec![Placed { triangles: 2..3, local_from_model: vec![Affine3A::IDENTITY] }],
            ..Geometry::default()
        };
        let whole: f64 = geometry.triangles[..2].iter().map(area).sum();
        split(&mut geometry, 10.0);
        let end = geometry.models[0].triangles.start;
        assert!((100..2000).contains(&end) && geometry.triangles.len() == end + 1, "{end}");
        assert_eq!(geometry.triangles[end].positions, model.positions);
        let cut = &geometry.triangles[..end];
        assert!((cut.iter().map(area).sum::<f64>() / whole - 1.0).abs() < 1e-6);
        // Each edge has one triangle on each side, or is of the border.
        let mut edges: HashMap<[[u32; 3]; 2], i32> = HashMap::new();
        let mut border = 0.0;
        for t in cut {
            for i in 0..3 {
                let bits = |p: Vec3| p.to_array().map(f32::to_bits);
                let [p, q] = [t.positions[i], t.positions[(i + 1) % 3]];
                *edges.entry([bits(p), bits(q)]).or_default() += 1;
                *edges.entry([bits(q), bits(p)]).or_default() -= 1;
                // Edges near the origin are short.
                let nearest = p.length().min(q.length()).min((0.5 * (p + q)).length());
                assert!(p.distance(q) <= 10.0f32.max(2.0 * nearest), "{p} {q}");
                assert_eq!(t.uvs[i], Vec2::new(p.x, p.z));
            }
        }
        for ([p, q], count) in edges {
            if count > 0 {
                let [p, q] = [p, q].map(|bits| Vec3::from(bits.map(f32::from_bits)));
                border += p.distance(q) as f64;
            }
        }
        assert!((border - 52_000.0).abs() < 1.0, "{border}");
    }

    #[test]
    fn what_is_no_larger_than_the_detail_stays() {
        let small = triangle([Vec3::ZERO, Vec3::X, Vec3::Z]);
        let far = triangle([vec3(500.0, 0.0, 0.0), vec3(510.0, 0.0, 0.0), vec3(500.0, 0.0, 30.0)]);
        let mut geometry = Geometry { triangles: vec![small, far], ..Geometry::default() };
        split(&mut geometry, 2.0);
        assert_eq!(geometry.triangles.len(), 2);
    }
}
