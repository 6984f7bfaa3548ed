//! The solution at the texels of the charts.

use super::{BORDER, LightmapSource, ModelLayout};
use crate::basis::Leveled;
use glam::{DVec2, UVec2, Vec3};
use rayon::prelude::*;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::colour::pack_rgb9e5;
use rebounce_shared::rbn::lightmap::Texel;

/// A chart of one copy and side.
struct PlacedChart {
    patch: usize,
    /// Reconstruction group of its surface.
    group: u32,
    /// Corner with the border, texels of the lightmap.
    corner: UVec2,
    /// Texels along a side, without the border.
    side: u32,
}

/// Light of the layers at a texel: that of the wavelets, and that of the points for direct light.
struct LayerLight<'a> {
    source: LightmapSource<'a>,
    basis: Leveled,
    /// By column of direct light, the points' irradiance.
    direct: Vec<Vec<Vec3>>,
}

impl<'a> LayerLight<'a> {
    fn new(file: &BakedScene, source: LightmapSource<'a>) -> Self {
        let all = &file.light_groups;
        let bounced = all.groups.len();
        let direct = all.column_groups().enumerate().skip(bounced);
        Self {
            source,
            basis: Leveled::of_baked(file),
            direct: direct.map(|(column, group)| all.irradiance(group, column, file.push())).collect(),
        }
    }

    /// Irradiance by column at a point of a patch.
    fn at(&self, patch: usize, group: u32, st: DVec2) -> Vec<Vec3> {
        let LightmapSource { patches, solved, .. } = self.source;
        let mut out: Vec<Vec3> =
            solved.solutions.iter().map(|one| one.irradiance(patch, st).max(Vec3::ZERO)).collect();
        if !self.direct.is_empty() {
            let [position, normal] = patches.point(patch, st);
            let mut weights = Vec::new();
            self.basis.interpolate(position, normal, group, &mut weights);
            let column =
                |values: &Vec<Vec3>| -> Vec3 { weights.iter().map(|(i, w)| values[*i as usize] * *w).sum() };
            out.extend(self.direct.iter().map(column));
        }
        out
    }
}

/// Evaluates the layers; returns their scales and texels.
pub(super) fn layers(
    file: &BakedScene,
    source: LightmapSource<'_>,
    layouts: &[ModelLayout],
    size: UVec2,
) -> (Vec<f32>, Vec<Texel>) {
    let (columns, area) = (LayerLight::new(file, source), size.x as usize * size.y as usize);
    let placed: Vec<PlacedChart> = layouts.iter().flat_map(|layout| of_model(file, layout)).collect();
    let light: Vec<Vec<Vec<Vec3>>> = placed.par_iter().map(|chart| of_chart(&columns, chart)).collect();
    let count = file.light_groups.columns();
    let (mut scales, mut texels) = (Vec::new(), Vec::with_capacity(area * count));
    for column in 0..count {
        let values = || light.iter().flatten().map(|values| values[column]);
        // The greatest value is 1: nine bits tell apart what is 2^-25 of it.
        let greatest = values().map(Vec3::max_element).fold(0.0, f32::max);
        let scale = if greatest.is_normal() { greatest } else { 1.0 };
        let mut layer = vec![Texel::default(); area];
        for (chart, values) in placed.iter().zip(&light) {
            let whole = chart.side + 2 * BORDER;
            for (i, value) in (0..).zip(values) {
                let at = chart.corner + UVec2::new(i % whole, i / whole);
                layer[(at.y * size.x + at.x) as usize] = Texel(pack_rgb9e5(value[column] / scale));
            }
        }
        scales.push(scale);
        texels.extend(layer);
    }
    (scales, texels)
}

fn of_model(file: &BakedScene, layout: &ModelLayout) -> Vec<PlacedChart> {
    let mut out = Vec::new();
    for (number, chart) in layout.model.charts.iter().enumerate() {
        for (patches, places) in chart.patches.iter().zip(&layout.places) {
            for (patch, place) in patches.iter().zip(places) {
                out.extend(patch.map(|patch| PlacedChart {
                    patch,
                    group: file.groups.of_material(chart.material),
                    corner: place + layout.corners[number],
                    side: layout.sides[number],
                }));
            }
        }
    }
    out
}

/// Light by column of each texel with the border, row after row. Virtual points have the light of the nearest real ones.
fn of_chart(columns: &LayerLight<'_>, chart: &PlacedChart) -> Vec<Vec<Vec3>> {
    let whole = chart.side + 2 * BORDER;
    let mesh = columns.source.patches.mesh(chart.patch);
    let texel = |i: u32| {
        let at = DVec2::new(f64::from(i % whole), f64::from(i / whole));
        let st = (at + 0.5 - f64::from(BORDER)) / f64::from(chart.side);
        let st = st.clamp(DVec2::ZERO, DVec2::ONE);
        columns.at(chart.patch, chart.group, mesh.map_or(st, |mesh| mesh.nearest_real(st)))
    };
    (0..whole * whole).into_par_iter().map(texel).collect()
}
