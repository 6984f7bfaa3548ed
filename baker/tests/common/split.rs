//! Subdivision of a scene's triangles.

use rebounce::scene::Scene;

/// Splits every triangle into n x n similar triangles. Neighbours keep their common edges.
pub fn split(scene: &mut Scene, n: u32) {
    let (mut positions, mut normals, mut uvs) = (Vec::new(), Vec::new(), Vec::new());
    let (mut triangles, mut materials, mut colors) = (Vec::new(), Vec::new(), Vec::new());
    for (t, corners) in scene.triangles.iter().enumerate() {
        let first = positions.len() as u32;
        let corners = corners.map(|c| c as usize);
        let shares = |i: u32, j: u32| [(n - i - j) as f32, i as f32, j as f32].map(|share| share / n as f32);
        // Row i has n - i + 1 vertices.
        let at = |i: u32, j: u32| first + i * (n + 1) - i * i.saturating_sub(1) / 2 + j;
        for i in 0..=n {
            for j in 0..=n - i {
                let s = shares(i, j);
                let mix = |list: &[glam::Vec3]| (0..3).map(|c| list[corners[c]] * s[c]).sum::<glam::Vec3>();
                positions.push(mix(&scene.positions));
                normals.push(mix(&scene.normals).normalize_or(scene.normals[corners[0]]));
                uvs.push((0..3).map(|c| scene.uvs[corners[c]] * s[c]).sum::<glam::Vec2>());
            }
        }
        for i in 0..n {
            for j in 0..n - i {
                triangles.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
                if i + j + 1 < n {
                    triangles.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
        materials.resize(triangles.len(), scene.triangle_material[t]);
        if let Some(color) = scene.corner_colors.get(t) {
            colors.resize(triangles.len(), *color);
        }
    }
    (scene.positions, scene.normals, scene.uvs) = (positions, normals, uvs);
    (scene.triangles, scene.triangle_material, scene.corner_colors) = (triangles, materials, colors);
}
