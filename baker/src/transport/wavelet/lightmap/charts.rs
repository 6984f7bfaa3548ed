//! Charts: which face the triangles of a file lie on, and where their corners are in its unit square.

use super::super::scene_patches::ScenePatches;
use glam::{Affine3A, DVec2, Mat3, Vec3};
use rayon::prelude::*;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::octahedral;
use rebounce_shared::rbn::bulk::Instance;
use std::collections::HashMap;
use std::ops::Range;

/// Places in a triangle at which its face is looked for, barycentric weights: the first that succeeds.
const PLACES: [[f32; 3]; 4] = [[1.0 / 3.0; 3], [0.8, 0.1, 0.1], [0.1, 0.8, 0.1], [0.1, 0.1, 0.8]];

/// The unit square of a face, shared by all copies of a model.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Material of its triangles.
    pub material: u32,
    /// By copy, the patches of front and back; no back of one-sided faces.
    pub patches: Vec<[Option<usize>; 2]>,
}

/// The charts of triangles with the same copies.
#[derive(Clone, Debug)]
pub struct ModelCharts {
    /// Range of instances; empty for triangles without copies.
    pub copies: Range<usize>,
    /// Charts.
    pub charts: Vec<Chart>,
    /// By triangle with a chart: the place of its first index, its chart, and the corners in the unit square.
    pub triangles: Vec<ChartTriangle>,
}

/// A triangle in a chart.
#[derive(Clone, Copy, Debug)]
pub struct ChartTriangle {
    /// Place of the first of its indices.
    pub first_index: u32,
    /// Number of its chart.
    pub chart: u32,
    /// Corners, (s, t).
    pub corners: [DVec2; 3],
}

/// Where the first copy of a triangle is.
struct TriangleOnPatch {
    patch: usize,
    /// Corners in the patch's unit square.
    corners: [DVec2; 3],
    /// Square scene units.
    area: f32,
}

/// A triangle of a file at one copy, local space.
struct PlacedTriangle {
    positions: [Vec3; 3],
    /// Unit shading normals.
    normals: [Vec3; 3],
}

impl PlacedTriangle {
    fn new(scene: &BakedScene, first_index: usize, place: &Affine3A) -> Self {
        let vertices = [0, 1, 2].map(|k| scene.vertices[scene.indices[first_index + k] as usize]);
        let normal_from_model = Mat3::from(place.matrix3).inverse().transpose();
        Self {
            positions: vertices.map(|v| place.transform_point3(v.position.into())),
            normals: vertices
                .map(|v| (normal_from_model * octahedral::unpack_snorm16(v.normal)).normalize_or_zero()),
        }
    }

    fn at(&self, weights: [f32; 3]) -> (Vec3, Vec3) {
        let sum = |of: &[Vec3; 3]| of[0] * weights[0] + of[1] * weights[1] + of[2] * weights[2];
        (sum(&self.positions), sum(&self.normals).normalize_or_zero())
    }

    fn area(&self) -> f32 {
        let [a, b, c] = self.positions;
        0.5 * (b - a).cross(c - a).length()
    }

    /// The patch of a side.
    fn patch(&self, patches: &ScenePatches, is_back: bool, epsilon: f32) -> Option<(usize, DVec2)> {
        PLACES.into_iter().find_map(|weights| {
            let (position, normal) = self.at(weights);
            let normal = if is_back { -normal } else { normal };
            let found = patches.locate(position, normal, epsilon)?;
            Some((found.patch, found.st))
        })
    }
}

/// Finds the charts of all triangles. `epsilon` is the surfaces' offset of ray origins, scene units. Triangles of unlit materials, and
/// those of faces that are not patches in each copy, have none.
pub fn charts(scene: &BakedScene, patches: &ScenePatches, epsilon: f32) -> Vec<ModelCharts> {
    let mut models: Vec<Range<usize>> = Vec::new();
    for draw in 0..scene.meta.draws.len() {
        let copies = scene.copies_of(draw);
        if !models.contains(&copies) {
            models.push(copies);
        }
    }
    models.into_iter().map(|copies| of_model(scene, patches, copies, epsilon)).collect()
}

fn of_model(scene: &BakedScene, patches: &ScenePatches, copies: Range<usize>, epsilon: f32) -> ModelCharts {
    let places: Vec<Affine3A> = match copies.is_empty() {
        true => vec![Affine3A::IDENTITY],
        false => scene.instances[copies.clone()].iter().map(Instance::local_from_model).collect(),
    };
    let own = (0..scene.meta.draws.len()).filter(|draw| scene.copies_of(*draw) == copies);
    let triangles: Vec<(u32, u32)> = own
        .map(|draw| &scene.meta.draws[draw])
        .filter(|draw| !scene.meta.materials[draw.material as usize].extras.unlit)
        .flat_map(|draw| {
            let end = draw.first_index + draw.index_count;
            (draw.first_index..end).step_by(3).map(|first| (first, draw.material))
        })
        .collect();
    let located: Vec<Option<TriangleOnPatch>> = (triangles.par_iter())
        .map(|(first, _)| {
            let placed = PlacedTriangle::new(scene, *first as usize, &places[0]);
            let (patch, st) = placed.patch(patches, false, epsilon)?;
            let corners = placed.positions.map(|corner| patches.square_near(patch, corner, st, epsilon));
            Some(TriangleOnPatch { patch, corners, area: placed.area() })
        })
        .collect();
    // The greatest triangle of a chart finds the patches of the other copies.
    let mut greatest: HashMap<usize, (usize, f32)> = HashMap::new();
    for (i, on) in located.iter().enumerate().filter_map(|(i, one)| Some((i, one.as_ref()?))) {
        let best = greatest.entry(on.patch).or_insert((i, on.area));
        if on.area > best.1 {
            *best = (i, on.area);
        }
    }
    let mut found: Vec<(usize, usize)> = greatest.into_iter().map(|(patch, (i, _))| (patch, i)).collect();
    found.sort_unstable();
    let chart = |&(_, i): &(usize, usize)| {
        let (first, material) = triangles[i];
        let is_two_sided = scene.meta.materials[material as usize].double_sided;
        let sides = |place: &Affine3A| {
            let placed = PlacedTriangle::new(scene, first as usize, place);
            let of = |is_back| placed.patch(patches, is_back, epsilon).map(|(patch, _)| patch);
            [of(false), if is_two_sided { of(true) } else { None }]
        };
        Chart { material, patches: places.iter().map(sides).collect() }
    };
    let all: Vec<Chart> = found.par_iter().map(chart).collect();
    let is_whole = |chart: &Chart| chart.patches.iter().all(|sides| sides[0].is_some());
    let mut number_of: HashMap<usize, u32> = HashMap::new();
    let mut charts = Vec::new();
    for ((patch, _), chart) in found.into_iter().zip(all).filter(|(_, chart)| is_whole(chart)) {
        number_of.insert(patch, charts.len() as u32);
        charts.push(chart);
    }
    let in_chart = |((first_index, _), on): (&(u32, u32), &Option<TriangleOnPatch>)| {
        let TriangleOnPatch { patch, corners, .. } = on.as_ref()?;
        Some(ChartTriangle { first_index: *first_index, chart: *number_of.get(patch)?, corners: *corners })
    };
    ModelCharts { copies, charts, triangles: triangles.iter().zip(&located).filter_map(in_chart).collect() }
}
