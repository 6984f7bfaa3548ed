//! Winding of triangles for back-face culling of one-sided surfaces, computed on the CPU.

use super::draw_batch::DrawBatch;
use glam::Vec3;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::octahedral;
use std::borrow::Cow;

/// Returns the scene's indices, with every triangle of a one-sided run turned counterclockwise as seen from the
/// front: the side of the vertex normals, as in the bake. Triangles of most files have this winding already.
pub fn indices<'a>(scene: &'a BakedScene, runs: &[DrawBatch]) -> Cow<'a, [u32]> {
    let mut out = Cow::Borrowed(&scene.indices[..]);
    for run in runs.iter().filter(|run| run.one_sided) {
        let range = run.indices.start as usize..run.indices.end as usize;
        for (number, triangle) in scene.indices[range.clone()].as_chunks::<3>().0.iter().enumerate() {
            if goes_clockwise(scene, triangle) {
                let first = range.start + 3 * number;
                out.to_mut().swap(first + 1, first + 2);
            }
        }
    }
    out
}

fn goes_clockwise(scene: &BakedScene, triangle: &[u32; 3]) -> bool {
    let vertices = triangle.map(|i| &scene.vertices[i as usize]);
    let [a, b, c] = vertices.map(|vertex| Vec3::from(vertex.position));
    let front: Vec3 = vertices.map(|vertex| octahedral::unpack_snorm16(vertex.normal)).into_iter().sum();
    (b - a).cross(c - a).dot(front) < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use rebounce_shared::octahedral::pack_snorm16;
    use rebounce_shared::rbn::bulk::Vertex;

    #[test]
    fn triangles_of_one_sided_materials_are_turned_to_their_normals() {
        let vertex = |x: f32, y: f32, normal| Vertex {
            position: [x, y, 0.0],
            normal: pack_snorm16(normal),
            uv: [0.0; 2],
        };
        let square = |normal| [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(x, y)| vertex(x, y, normal));
        let mut scene = BakedScene { vertices: square(Vec3::Z).to_vec(), ..BakedScene::default() };
        scene.vertices.extend(square(-Vec3::Z));
        scene.indices = (0..6).chain(0..6).collect();
        let run = |indices, one_sided| DrawBatch {
            material: 0,
            indices,
            instances: 0..1,
            cut: false,
            blended: false,
            glass: false,
            one_sided,
        };
        let two_sided = indices(&scene, &[run(0..12, false)]);
        assert!(matches!(two_sided, Cow::Borrowed(_)));
        let mixed = indices(&scene, &[run(0..6, true), run(6..12, false)]);
        assert_eq!(mixed[..], [0, 1, 2, 3, 5, 4, 0, 1, 2, 3, 4, 5]);
    }
}
