//! Mean transmittance of materials, for [radiosity](rebounce_shared::radiosity): its rays meet triangles without textures.

use super::blas::Blas;
use super::tlas::Instance;
use super::{Surface, TriangleSurfaces};
use glam::Vec3;

/// Samples of a material, at least.
const SAMPLES: usize = 4096;
/// Rows of samples of a triangle, at most.
const ROWS: usize = 64;

/// Centroids of the `rows`² equal parts of a triangle, barycentric.
fn centroids(rows: usize) -> impl Iterator<Item = [f32; 3]> {
    let third = 1.0 / (3 * rows) as f32;
    // Upright parts, and those between them.
    let upright = (0..rows).flat_map(move |i| (0..rows - i).map(move |j| [3 * i + 1, 3 * j + 1]));
    let between = (1..rows).flat_map(move |i| (1..=rows - i).map(move |j| [3 * i - 1, 3 * j - 1]));
    upright.chain(between).map(move |place| {
        let [v, w] = place.map(|x| x as f32 * third);
        [1.0 - v - w, v, w]
    })
}

impl TriangleSurfaces {
    /// The share of light that goes through each material: the mean over its area and the channels. Empty where all materials
    /// are opaque.
    pub fn mean_transmittance(&self) -> Vec<f32> {
        if self.surfaces.iter().all(Surface::is_opaque) {
            return Vec::new();
        }
        let mut counts = vec![0usize; self.surfaces.len()];
        let blases = || std::iter::once(&self.static_blas).chain(&self.models);
        for look in blases().flat_map(|blas| &blas.attributes) {
            counts[look.material as usize] += 1;
        }
        // Area, and the area that light goes through.
        let mut sums = vec![[0f64; 2]; self.surfaces.len()];
        let mut add = |blas: &Blas, area_of: &dyn Fn(Vec3) -> f32| {
            for (triangle, look) in blas.attributes.iter().enumerate() {
                let material = look.material as usize;
                let surface = &self.surfaces[material];
                if surface.is_opaque() {
                    continue;
                }
                let area = area_of(blas.corners[triangle].spanned());
                let rows = ((SAMPLES as f32 / counts[material] as f32).sqrt().ceil() as usize).clamp(1, ROWS);
                let through = |shares| {
                    surface
                        .through(blas.color(&self.surfaces, triangle, shares), look.uv(shares))
                        .element_sum()
                };
                let mean = centroids(rows).map(through).sum::<f32>() / (3 * rows * rows) as f32;
                sums[material][0] += f64::from(area);
                sums[material][1] += f64::from(area * mean);
            }
        };
        add(&self.static_blas, &|spanned| spanned.length());
        let mut copies: Vec<Vec<&Instance>> = vec![Vec::new(); self.models.len()];
        self.instances.all.iter().for_each(|instance| copies[instance.model as usize].push(instance));
        for (model, copies) in self.models.iter().zip(&copies) {
            add(model, &|spanned| copies.iter().map(|copy| copy.across(spanned).length()).sum());
        }
        sums.iter()
            .map(|[area, passed]| if *area > 0.0 { (passed / area).clamp(0.0, 1.0) as f32 } else { 0.0 })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_samples_of_a_triangle_are_in_it_and_have_its_middle() {
        for rows in [1, 2, 7, ROWS] {
            let all: Vec<Vec3> = centroids(rows).map(Vec3::from).collect();
            assert_eq!(all.len(), rows * rows);
            assert!(all.iter().all(|shares| shares.min_element() > 0.0));
            let mean = all.iter().sum::<Vec3>() / all.len() as f32;
            assert!((mean - Vec3::splat(1.0 / 3.0)).abs().max_element() < 1e-4, "{rows}: {mean}");
        }
    }
}
