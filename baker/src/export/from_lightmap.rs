//! Coordinates of the texture from the file's own [lightmap](rebounce_shared::rbn::lightmap), where it has one: nothing is
//! unwrapped.

use super::meshes::ExportMesh;
use super::unwrap::{Density, UnwrappedMesh, UnwrappedVertex, UvAtlas, UvRect};
use glam::{UVec2, Vec2};
use rebounce_shared::baked::BakedScene;

/// Returns the charts of the lightmap as an atlas: as many texels as the lightmap has, or a power of two times as many along a
/// side, up to about the density. `None` without a lightmap, where a triangle that needs texels has no chart in it, and where
/// it does not fit `max_size`, or has too few texels for an exact density.
pub fn from_lightmap(
    scene: &BakedScene,
    meshes: &[ExportMesh],
    density: Density,
    max_size: u32,
    is_used: impl Fn(u32) -> bool,
) -> Option<UvAtlas> {
    let size = UVec2::from(scene.lightmap.layout.size);
    if scene.lightmap.is_empty() || size.max_element() > max_size {
        return None;
    }
    let has_charts = |mesh: &ExportMesh| {
        let mut used = mesh.triangles.iter().zip(&mesh.materials).filter(|(_, material)| is_used(**material));
        used.all(|(triangle, _)| triangle.iter().all(|v| mesh.lightmap[*v as usize].is_some()))
    };
    if !meshes.iter().all(has_charts) {
        return None;
    }
    let [texels, area] = areas(meshes);
    // The mean over the surfaces.
    let own = if area > 0.0 { (texels / area).sqrt() as f32 } else { 1.0 };
    let (Density::Exactly(wanted) | Density::AtMost(wanted)) = density;
    let mut times = 1;
    while own * (times as f32) < wanted && 2 * times * size.max_element() <= max_size {
        times *= 2;
    }
    if matches!(density, Density::Exactly(_)) && own * (times as f32) < wanted {
        return None;
    }
    let mut first_chart = 0;
    let mut parts = Vec::new();
    for mesh in meshes {
        parts.push(part(mesh, size, &mut first_chart));
    }
    let size = times * size;
    Some(UvAtlas {
        width: size.x,
        height: size.y,
        texels_per_unit: own * times as f32,
        wanted: None,
        chart_count: first_chart,
        used: (texels / scene.lightmap.area() as f64).min(1.0) as f32,
        meshes: parts,
    })
}

/// Corners of a triangle in the lightmap, texels, without the offset of the copy.
fn corners(mesh: &ExportMesh, triangle: [u32; 3]) -> Option<[Vec2; 3]> {
    let [a, b, c] = triangle.map(|v| mesh.lightmap[v as usize]);
    Some([a?, b?, c?])
}

/// Area of all triangles in the lightmap, texels, and in the scene.
fn areas(meshes: &[ExportMesh]) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for mesh in meshes {
        for copy in 0..mesh.local_from_model.len() {
            for (t, triangle) in mesh.triangles.iter().enumerate() {
                let Some([a, b, c]) = corners(mesh, *triangle) else { continue };
                sums[0] += f64::from(0.5 * (b - a).perp_dot(c - a).abs());
                sums[1] += f64::from(mesh.triangle(copy, t).area());
            }
        }
    }
    sums
}

/// A mesh with its own vertices, and the coordinates of the lightmap. Parts that hang together are charts.
fn part(mesh: &ExportMesh, size: UVec2, first_chart: &mut u32) -> UnwrappedMesh {
    let mut root: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    fn find(root: &mut [u32], mut vertex: u32) -> u32 {
        while root[vertex as usize] != vertex {
            root[vertex as usize] = root[root[vertex as usize] as usize];
            vertex = root[vertex as usize];
        }
        vertex
    }
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| find(&mut root, v));
        let least = a.min(b).min(c);
        [a, b, c].into_iter().for_each(|vertex| root[vertex as usize] = least);
    }
    let mut numbers = vec![None; root.len()];
    let mut vertices = Vec::new();
    for (source, at) in (0..).zip(&mesh.lightmap) {
        let top = find(&mut root, source) as usize;
        let chart = at.map(|_| {
            *numbers[top].get_or_insert_with(|| {
                *first_chart += 1;
                *first_chart - 1
            })
        });
        let uv = (at.unwrap_or_default() / size.as_vec2()).to_array();
        vertices.push(UnwrappedVertex { source, uv, chart });
    }
    // Coordinates without an offset are shares of the whole texture.
    let rect = |offset: &UVec2| {
        let min = offset.as_vec2() / size.as_vec2();
        UvRect { min: min.to_array(), max: (min + 1.0).to_array() }
    };
    UnwrappedMesh {
        vertices,
        triangles: mesh.triangles.clone(),
        rects: mesh.chart_offsets.iter().map(rect).collect(),
    }
}
