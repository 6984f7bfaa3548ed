//! Triangles that stand for curved surfaces in a picture.

use super::Surfaces;
use crate::scene::TriangleMesh;

/// Surfaces that can be drawn. Rays see the surfaces themselves; a rasterizer draws the triangles.
pub trait Tessellate: Surfaces {
    /// Returns triangles with vertices on the surfaces, at most about `tolerance` scene units away from the surfaces.
    fn tessellate(&self, tolerance: f32) -> TriangleMesh;
}
