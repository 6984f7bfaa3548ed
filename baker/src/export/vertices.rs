//! Light by vertex: the mean around a vertex, weighted by the share that interpolation gives the vertex there.

use super::meshes::ExportMesh;
use super::point::{Lit, SurfaceElement};
use crate::geometry::Surfaces;
use crate::random::Stream;
use glam::{DVec4, Vec4};
use rayon::prelude::*;

/// Samples on a square scene unit, where those of a triangle are fewer.
const SAMPLES_PER_AREA: f32 = 64.0;
/// Most samples of a triangle, as a multiple of the least.
const MOST: u32 = 64;
/// Steps of the sequence R2 (Roberts 2018): evenly spread places.
const R2: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_3];

/// Light at the vertices of a copy, linear RGB and opacity.
pub type VertexLight = Vec<Vec4>;

/// Returns the light at the vertices of each copy of each mesh. `samples` are the least of a triangle. `done` is called
/// after each copy, with the number of copies.
pub fn light<S: Surfaces>(
    meshes: &[ExportMesh],
    lit: &Lit<S>,
    samples: u32,
    seed: u64,
    done: impl Fn(u32) + Sync,
) -> Vec<Vec<VertexLight>> {
    let total = meshes.iter().map(|mesh| mesh.local_from_model.len() as u32).sum();
    let mut first = 0u64;
    let mut out = Vec::new();
    for mesh in meshes {
        let mut copies = Vec::new();
        for copy in 0..mesh.local_from_model.len() {
            copies.push(of_copy(mesh, copy, lit, samples.max(1), (seed, first)));
            first += mesh.triangles.len() as u64;
            done(total);
        }
        out.push(copies);
    }
    out
}

/// Sums of a triangle's samples for its corners: light times weight, and weight.
type CornerSums = [(DVec4, f64); 3];

fn of_copy<S: Surfaces>(
    mesh: &ExportMesh,
    copy: usize,
    lit: &Lit<S>,
    samples: u32,
    (seed, first): (u64, u64),
) -> VertexLight {
    let corners: Vec<CornerSums> = (0..mesh.triangles.len())
        .into_par_iter()
        .map(|t| of_triangle(mesh, copy, t, lit, samples, Stream::new(seed, first + t as u64)))
        .collect();
    let mut sums = vec![(DVec4::ZERO, 0.0); mesh.positions.len()];
    // In the order of the triangles.
    for (vertices, corners) in mesh.triangles.iter().zip(&corners) {
        for (vertex, (light, weight)) in vertices.iter().zip(corners) {
            let sum: &mut (DVec4, f64) = &mut sums[*vertex as usize];
            *sum = (sum.0 + *light, sum.1 + weight);
        }
    }
    let mean =
        |(light, weight): (DVec4, f64)| if weight > 0.0 { (light / weight).as_vec4() } else { Vec4::W };
    sums.into_iter().map(mean).collect()
}

fn of_triangle<S: Surfaces>(
    mesh: &ExportMesh,
    copy: usize,
    triangle: usize,
    lit: &Lit<S>,
    samples: u32,
    mut stream: Stream,
) -> CornerSums {
    let mut sums = [(DVec4::ZERO, 0.0); 3];
    let surface = mesh.triangle(copy, triangle);
    if lit.surfaces.material(surface.material).is_unlit {
        return sums;
    }
    let area = surface.area();
    let count = ((area * SAMPLES_PER_AREA) as u32).clamp(samples, samples.saturating_mul(MOST));
    let shift = stream.square().as_dvec2();
    for i in 0..count {
        let at = [shift.x + R2[0] * f64::from(i), shift.y + R2[1] * f64::from(i)].map(|x| x.fract() as f32);
        let (v, w) = if at[0] + at[1] > 1.0 { (1.0 - at[0], 1.0 - at[1]) } else { (at[0], at[1]) };
        let weights = [1.0 - v - w, v, w];
        let point = SurfaceElement::new(&surface, weights, area / count as f32);
        let Some(value) = point.and_then(|point| lit.at(&point, &mut stream)) else { continue };
        for (sum, weight) in sums.iter_mut().zip(weights) {
            let weight = f64::from(weight) * f64::from(area) / f64::from(count);
            *sum = (sum.0 + weight * value.as_dvec4(), sum.1 + weight);
        }
    }
    sums
}
