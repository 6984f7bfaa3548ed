//! Lightmap of wavelet radiosity: the unit squares of the virtual meshes, packed into a texture. Nothing is unwrapped.
//!
//! * [`charts`](mod@charts) – the face of each triangle, and its corners in the unit square;
//! * [`shelves`] – packing of rectangles;
//! * [`texels`] – the solution at the texels.

pub mod charts;
pub mod shelves;
pub mod texels;

use super::{ScenePatches, WaveletGroups};
use crate::scene::rig::renumber;
use charts::{ModelCharts, charts};
use glam::{DVec2, UVec2};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::rbn::bulk::Vertex;
use rebounce_shared::rbn::lightmap::{
    ChartOffset, Lightmap, LightmapLayout, MAX_LAYERS, MAX_SIDE, TexelCoordinates, offsets_of,
};
use std::collections::HashMap;

/// Texels around each chart with the light of its border, for bilinear filtering and for coarser copies of the texture.
pub const BORDER: u32 = 2;
/// Greatest number of texels of a chart along a side.
const MOST: u32 = 256;
/// Greatest number of texels of all layers.
const MOST_TEXELS: u64 = 1 << 26;

/// What a lightmap is made of.
#[derive(Clone, Copy)]
pub struct LightmapSource<'a> {
    /// The patches that were solved for.
    pub patches: &'a ScenePatches,
    /// A solution for each group of light.
    pub solved: &'a WaveletGroups,
    /// Offset of ray origins, scene units.
    pub epsilon: f32,
}

/// Figures of a lightmap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LightmapFigures {
    /// Width and height, texels.
    pub size: [u32; 2],
    /// Charts, those of each copy and of backs counted.
    pub charts: u32,
    /// Triangles without a chart; those of a model count once.
    pub left_out: u32,
}

/// Where the charts of a model are.
struct ModelLayout {
    model: ModelCharts,
    /// Texels of each chart along a side, without its border.
    sides: Vec<u32>,
    /// Corner of each chart with its border, in the rectangle of a copy.
    corners: Vec<UVec2>,
    /// Whether backs have rectangles of their own.
    has_backs: bool,
    /// By copy, the corners of its rectangles: front and back.
    places: Vec<[UVec2; 2]>,
}

/// Adds a lightmap to a file with light groups. Vertices on several charts are divided. Returns `None`, and leaves the file as
/// it is, where the charts do not fit a texture that browsers take.
pub fn add_lightmap(file: &mut BakedScene, source: LightmapSource<'_>) -> Option<LightmapFigures> {
    let columns = file.light_groups.columns();
    if columns == 0 || columns > MAX_LAYERS {
        return None;
    }
    let models = charts(file, source.patches, source.epsilon);
    let (layouts, size) = arrange(file, source, models);
    let texels = u64::from(size.x) * u64::from(size.y) * columns as u64;
    if size.max_element() > MAX_SIDE || size.min_element() == 0 || texels > MOST_TEXELS {
        return None;
    }
    let mut offsets = vec![ChartOffset::default(); file.instances.len() + 1];
    for layout in &layouts {
        let own = offsets_of(layout.model.copies.clone());
        for (offset, [front, back]) in offsets[own].iter_mut().zip(&layout.places) {
            *offset = ChartOffset([front.x, front.y, back.x, back.y].map(|at| at as u16));
        }
    }
    let (scales, texels) = texels::layers(file, source, &layouts, size);
    let coordinates = divide_vertices(file, &layouts);
    file.lightmap =
        Lightmap { layout: LightmapLayout { size: size.to_array(), scales }, coordinates, offsets, texels };
    let placed = |layout: &ModelLayout| {
        let sides = layout.model.charts.iter().flat_map(|chart| &chart.patches).flatten().flatten();
        sides.count() as u32
    };
    let charted: usize = layouts.iter().map(|layout| layout.model.triangles.len()).sum();
    Some(LightmapFigures {
        size: size.to_array(),
        charts: layouts.iter().map(placed).sum(),
        left_out: (file.indices.len() / 3 - charted) as u32,
    })
}

/// Texels of a chart along a side: as many as the deepest cells of its patches tell apart. Direct light of the sky and of
/// emissive surfaces is as fine as the points.
fn side_of(file: &BakedScene, source: LightmapSource<'_>, chart: &charts::Chart) -> u32 {
    let patches = || chart.patches.iter().flatten().flatten();
    let of_wavelets = source.solved.solutions.iter().flat_map(|solution| {
        patches().map(|patch| (solution.order().side() as u32) << solution.depth(*patch))
    });
    let mut side = of_wavelets.max().unwrap_or(1);
    if file.light_groups.columns() > file.light_groups.groups.len() {
        let finest = file.meta.levels.last().map_or(0.0, |level| f64::from(level.support_radius));
        let widest = patches().map(|patch| source.patches.area(*patch).sqrt()).fold(0.0, f64::max);
        side = side.max((widest / finest.max(f64::MIN_POSITIVE)).min(f64::from(MOST)) as u32);
    }
    side.clamp(2, MOST)
}

/// Packs the charts of each model, then the copies.
fn arrange(
    file: &BakedScene,
    source: LightmapSource<'_>,
    models: Vec<ModelCharts>,
) -> (Vec<ModelLayout>, UVec2) {
    let mut layouts = Vec::new();
    let mut rectangles = Vec::new();
    for model in models {
        let sides: Vec<u32> = model.charts.iter().map(|chart| side_of(file, source, chart)).collect();
        let sizes: Vec<UVec2> = sides.iter().map(|side| UVec2::splat(side + 2 * BORDER)).collect();
        let packed = shelves::pack(&sizes);
        let has_backs = model.charts.iter().flat_map(|chart| &chart.patches).any(|sides| sides[1].is_some());
        let copies = model.copies.len().max(1);
        rectangles.extend(vec![packed.size; copies * if has_backs { 2 } else { 1 }]);
        layouts.push(ModelLayout { model, sides, corners: packed.corners, has_backs, places: Vec::new() });
    }
    let all = shelves::pack(&rectangles);
    let mut next = all.corners.into_iter();
    for layout in &mut layouts {
        for _ in 0..layout.model.copies.len().max(1) {
            let front = next.next().unwrap_or_default();
            let back = if layout.has_backs { next.next().unwrap_or_default() } else { front };
            layout.places.push([front, back]);
        }
    }
    (layouts, all.size)
}

impl ModelLayout {
    /// Coordinates of a point of a chart's unit square in the rectangle of a copy, texels.
    fn texels(&self, chart: usize, st: DVec2) -> DVec2 {
        self.corners[chart].as_dvec2() + f64::from(BORDER) + f64::from(self.sides[chart]) * st
    }
}

/// Gives each vertex coordinates; one that lies on several charts, or at a seam, becomes several.
fn divide_vertices(file: &mut BakedScene, layouts: &[ModelLayout]) -> Vec<TexelCoordinates> {
    // By index, its chart and coordinates.
    let mut of_corner = vec![None; file.indices.len()];
    let mut first_chart = 0;
    for layout in layouts {
        for triangle in &layout.model.triangles {
            for (k, st) in triangle.corners.iter().enumerate() {
                let st = st.clamp(DVec2::ZERO, DVec2::ONE);
                let texels = layout.texels(triangle.chart as usize, st).as_vec2();
                let corner = (first_chart + triangle.chart, TexelCoordinates::nearest(texels));
                of_corner[triangle.first_index as usize + k] = Some(corner);
            }
        }
        first_chart += layout.model.charts.len() as u32;
    }
    let mut known: HashMap<(u32, Option<u32>), Vec<u32>> = HashMap::new();
    let (mut vertices, mut coordinates): (Vec<Vertex>, Vec<TexelCoordinates>) = Default::default();
    // By vertex, what becomes of it.
    let mut now: Vec<Vec<u32>> = vec![Vec::new(); if file.rig.is_empty() { 0 } else { file.vertices.len() }];
    for (index, corner) in file.indices.iter_mut().zip(of_corner) {
        let (chart, at) = match corner {
            Some((chart, at)) => (Some(chart), at),
            None => (None, TexelCoordinates::NONE),
        };
        let same = known.entry((*index, chart)).or_default();
        // Rounding may take triangles that meet there to neighbouring steps.
        let is_here = |v: &&u32| {
            let own = coordinates[**v as usize].0;
            own.iter().zip(at.0).all(|(a, b)| a.abs_diff(b) <= 1)
        };
        if let Some(v) = same.iter().find(is_here) {
            *index = *v;
            continue;
        }
        vertices.push(file.vertices[*index as usize]);
        coordinates.push(at);
        if let Some(now) = now.get_mut(*index as usize) {
            now.push(vertices.len() as u32 - 1);
        }
        *index = vertices.len() as u32 - 1;
        same.push(*index);
    }
    file.vertices = vertices;
    if !file.rig.is_empty() {
        renumber(&mut file.rig, |vertex| now[vertex as usize].iter().copied());
    }
    coordinates
}
