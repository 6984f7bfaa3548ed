//! The light of every texel: the mean over samples in the texel's square that are on a surface and not hidden.

use super::ExportSettings;
use super::meshes::ExportMesh;
use super::point::{Lit, SurfaceElement};
use super::rasterize::{Coverage, TexelTriangle};
use crate::geometry::Surfaces;
use crate::io::picture::Picture;
use crate::random::Stream;
use glam::{Vec2, Vec4, Vec4Swizzles};
use rayon::prelude::*;

/// Number of no chart.
pub const NO_CHART: u64 = u64::MAX;
/// Share of the samples of a texel that has no sample on a surface, and only touches one.
const TOUCHED: u32 = 4;

/// A texture of light.
#[derive(Clone, Debug, PartialEq)]
pub struct LightTexture {
    /// Width, texels.
    pub width: u32,
    /// Height, texels.
    pub height: u32,
    /// Linear RGB light and opacity, row after row; row 0 is at v = 0.
    pub values: Vec<Vec4>,
    /// The chart of each texel, or [`NO_CHART`].
    pub charts: Vec<u64>,
    /// Whether a texel has light.
    pub is_lit: Vec<bool>,
}

/// A texel's square, and its samples.
struct TexelSamples<'a, S> {
    meshes: &'a [ExportMesh],
    coverage: &'a Coverage,
    lit: &'a Lit<'a, S>,
    /// Area of a sample, square scene units.
    area: f32,
    samples: u32,
    seed: u64,
}

impl LightTexture {
    /// Evaluates the light of all texels. `done` is called after each row, with the number of rows, from any thread.
    pub fn new<S: Surfaces>(
        meshes: &[ExportMesh],
        coverage: &Coverage,
        lit: &Lit<S>,
        texels_per_unit: f32,
        settings: &ExportSettings,
        done: impl Fn(u32) + Sync,
    ) -> Self {
        let samples = settings.samples.max(1);
        let area = 1.0 / (texels_per_unit * texels_per_unit * samples as f32);
        let of = TexelSamples { meshes, coverage, lit, area, samples, seed: settings.seed };
        let (width, height) = (coverage.width, coverage.height);
        let count = width as usize * height as usize;
        let chart = |texel: usize| {
            let first = coverage.of(texel).first();
            first.map_or(NO_CHART, |first| coverage.triangles[*first as usize].chart)
        };
        let mut values = vec![Vec4::ZERO; count];
        let mut is_lit = vec![false; count];
        let columns = width.max(1) as usize;
        let rows = values.par_chunks_mut(columns).zip(is_lit.par_chunks_mut(columns)).enumerate();
        rows.for_each(|(y, (values, is_lit))| {
            for (x, (value, is_lit)) in values.iter_mut().zip(is_lit).enumerate() {
                if let Some(mean) = of.mean(x, y) {
                    (*value, *is_lit) = (mean, true);
                }
            }
            done(height);
        });
        Self { width, height, values, charts: (0..count).map(chart).collect(), is_lit }
    }

    /// Returns the light as a picture.
    pub fn picture(&self) -> Picture {
        let pixels = self.values.iter().map(|value| value.xyz()).collect();
        Picture { width: self.width, height: self.height, pixels }
    }
}

impl<S: Surfaces> TexelSamples<'_, S> {
    /// Returns the mean over the samples of a texel; `None` without one.
    fn mean(&self, x: usize, y: usize) -> Option<Vec4> {
        let texel = y * self.coverage.width as usize + x;
        let touched = self.coverage.of(texel);
        if touched.is_empty() {
            return None;
        }
        let low = Vec2::new(x as f32, y as f32);
        let side = self.samples.isqrt();
        let (mut sum, mut count, mut met) = (Vec4::ZERO, 0u32, false);
        let first = texel as u64 * u64::from(self.samples);
        for s in 0..self.samples {
            let mut stream = Stream::new(self.seed, first + u64::from(s));
            let mut jitter = stream.square();
            if s < side * side {
                jitter = (Vec2::new((s % side) as f32, (s / side) as f32) + jitter) / side as f32;
            }
            let at = low + jitter;
            let found = touched.iter().map(|t| &self.coverage.triangles[*t as usize]);
            let Some(triangle) = found.into_iter().find(|triangle| triangle.contains(at)) else { continue };
            met = true;
            if let Some(value) = self.value(triangle, at, &mut stream) {
                sum += value;
                count += 1;
            }
        }
        if !met {
            let middle = low + 0.5;
            let places = touched.iter().map(|t| &self.coverage.triangles[*t as usize]);
            let places = places.map(|triangle| (triangle, triangle.nearest_inside(middle)));
            let (triangle, at) = places
                .min_by(|a, b| a.1.distance_squared(middle).total_cmp(&b.1.distance_squared(middle)))?;
            for s in 0..self.samples.div_ceil(TOUCHED) {
                let mut stream = Stream::new(self.seed, first + u64::from(s));
                if let Some(value) = self.value(triangle, at, &mut stream) {
                    sum += value;
                    count += 1;
                }
            }
        }
        (count > 0).then(|| sum / count as f32)
    }

    /// Returns the light at a place of a triangle, in texels.
    fn value(&self, triangle: &TexelTriangle, at: Vec2, stream: &mut Stream) -> Option<Vec4> {
        let mesh = &self.meshes[triangle.mesh as usize];
        let surface = mesh.triangle(triangle.copy as usize, triangle.triangle as usize);
        let weights = triangle.weights(at).map(|weight| weight.clamp(0.0, 1.0));
        let sum: f32 = weights.iter().sum();
        let point = SurfaceElement::new(&surface, weights.map(|weight| weight / sum), self.area)?;
        self.lit.at(&point, stream)
    }
}
