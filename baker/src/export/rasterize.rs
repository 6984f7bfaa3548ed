//! Which triangles a texel shows: conservatively, all that its square touches.

use super::meshes::ExportMesh;
use super::unwrap::UvAtlas;
use glam::Vec2;

/// Distance from a triangle's edge, texels, of the sample of a texel that has none.
const INSET: f32 = 0.25;

/// A triangle in the texture.
#[derive(Clone, Copy, Debug)]
pub struct TexelTriangle {
    /// Corners, texels from the texture's top left.
    pub corners: [Vec2; 3],
    /// Number of the mesh.
    pub mesh: u32,
    /// Number of the mesh's copy.
    pub copy: u32,
    /// Number of the triangle in the mesh.
    pub triangle: u32,
    /// Number of the chart: each copy of a mesh has charts of its own.
    pub chart: u64,
}

impl TexelTriangle {
    /// Returns twice the signed area.
    fn doubled_area(&self) -> f32 {
        let [a, b, c] = self.corners;
        (b - a).perp_dot(c - a)
    }

    /// Returns the barycentric weights of a place; negative ones outside.
    pub fn weights(&self, at: Vec2) -> [f32; 3] {
        let [a, b, c] = self.corners;
        let scale = 1.0 / self.doubled_area();
        let v = (at - a).perp_dot(c - a) * scale;
        let w = (b - a).perp_dot(at - a) * scale;
        [1.0 - v - w, v, w]
    }

    /// Returns whether a place is inside or on an edge.
    pub fn contains(&self, at: Vec2) -> bool {
        self.weights(at).iter().all(|weight| *weight >= 0.0)
    }

    /// Returns a place near the nearest one to a place, within the triangle by [`INSET`] as far as it goes: on an edge there
    /// may be a wall.
    pub fn nearest_inside(&self, at: Vec2) -> Vec2 {
        let nearest = self.nearest(at);
        let [a, b, c] = self.corners;
        let to_middle = (a + b + c) / 3.0 - nearest;
        nearest + to_middle.clamp_length_max(INSET)
    }

    /// Returns the place of the triangle nearest to a place.
    fn nearest(&self, at: Vec2) -> Vec2 {
        if self.contains(at) {
            return at;
        }
        let on_edge = |i: usize| {
            let (a, b) = (self.corners[i], self.corners[(i + 1) % 3]);
            let along = (at - a).dot(b - a) / (b - a).length_squared().max(f32::MIN_POSITIVE);
            a + (b - a) * along.clamp(0.0, 1.0)
        };
        let nearer = |best: Vec2, next: Vec2| {
            if next.distance_squared(at) < best.distance_squared(at) { next } else { best }
        };
        (1..3).map(on_edge).fold(on_edge(0), nearer)
    }

    /// Returns whether the triangle touches the square of a texel, by separating axes.
    fn touches(&self, x: u32, y: u32) -> bool {
        let middle = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
        let sign = self.doubled_area().signum();
        (0..3).all(|i| {
            let edge = self.corners[(i + 1) % 3] - self.corners[i];
            let reach = 0.5 * (edge.x.abs() + edge.y.abs());
            sign * edge.perp_dot(middle - self.corners[i]) >= -reach
        })
    }
}

/// The triangles of every texel.
#[derive(Clone, Debug)]
pub struct Coverage {
    /// Width of the texture, texels.
    pub width: u32,
    /// Height of the texture, texels.
    pub height: u32,
    /// All triangles with texels.
    pub triangles: Vec<TexelTriangle>,
    /// Index of each texel's first entry in `entries`, and the number of entries.
    offsets: Vec<u32>,
    /// Indices into `triangles`.
    entries: Vec<u32>,
}

impl Coverage {
    /// Returns the triangles that a texel touches, as indices into `triangles`.
    pub fn of(&self, texel: usize) -> &[u32] {
        &self.entries[self.offsets[texel] as usize..self.offsets[texel + 1] as usize]
    }

    /// Calls `visit` for each texel that a triangle touches.
    fn visit(triangle: &TexelTriangle, [width, height]: [u32; 2], mut visit: impl FnMut(usize)) {
        let corners = triangle.corners;
        let low = corners[0].min(corners[1]).min(corners[2]).max(Vec2::ZERO);
        let high = corners[0].max(corners[1]).max(corners[2]);
        let last = |high: f32, size: u32| (high.max(0.0).ceil() as u32).min(size);
        for y in low.y.floor() as u32..last(high.y, height) {
            for x in low.x.floor() as u32..last(high.x, width) {
                if triangle.touches(x, y) {
                    visit(y as usize * width as usize + x as usize);
                }
            }
        }
    }
}

/// Finds the triangles of every texel. Triangles without a chart or an area in the texture have none.
pub fn rasterize(meshes: &[ExportMesh], atlas: &UvAtlas) -> Coverage {
    let size = [atlas.width, atlas.height];
    let scale = Vec2::new(atlas.width as f32, atlas.height as f32);
    let mut triangles = Vec::new();
    for (number, (mesh, unwrapped)) in meshes.iter().zip(&atlas.meshes).enumerate() {
        for copy in 0..mesh.local_from_model.len() {
            let rect = unwrapped.rects[copy];
            for (t, vertices) in unwrapped.triangles.iter().enumerate() {
                let corners = vertices.map(|v| &unwrapped.vertices[v as usize]);
                let Some(chart) = corners[0].chart else { continue };
                if corners.iter().any(|corner| corner.chart != Some(chart)) {
                    continue;
                }
                let triangle = TexelTriangle {
                    corners: corners.map(|corner| Vec2::from(rect.place(corner.uv)) * scale),
                    mesh: number as u32,
                    copy: copy as u32,
                    triangle: t as u32,
                    chart: u64::from(chart) + copy as u64 * u64::from(atlas.chart_count),
                };
                if triangle.doubled_area().abs() > f32::MIN_POSITIVE {
                    triangles.push(triangle);
                }
            }
        }
    }
    let mut offsets = vec![0u32; size[0] as usize * size[1] as usize + 1];
    for triangle in &triangles {
        Coverage::visit(triangle, size, |texel| offsets[texel + 1] += 1);
    }
    for texel in 1..offsets.len() {
        offsets[texel] += offsets[texel - 1];
    }
    let mut next = offsets.clone();
    let mut entries = vec![0; offsets.last().copied().unwrap_or(0) as usize];
    for (i, triangle) in triangles.iter().enumerate() {
        Coverage::visit(triangle, size, |texel| {
            entries[next[texel] as usize] = i as u32;
            next[texel] += 1;
        });
    }
    Coverage { width: size[0], height: size[1], triangles, offsets, entries }
}
