//! Which patches shoot together: many small ones that lie near each other and face alike.

use super::patch::PlacedPatch;

/// Up to so many patches, each shoots alone.
const FEW: usize = 256;
/// Patches whose area is more than this part of all shoot alone; together they have no more than it.
const MOST_AREA: f64 = 1.0 / 64.0;
/// Cells are not divided below this part of the area of all patches that are not large: so many would be
/// enough, if they were of a few faces.
const LEAST_AREA: f64 = 1.0 / 4096.0;
/// Directions count as places at this part of the scene's extent.
const DIRECTIONS: f64 = 0.125;

/// Where a patch or a part of one is, and a multiple of its normal: what is near in it can stand for each
/// other (Walter et al., Lightcuts, 2005).
pub(super) type PositionAndNormal = [f64; 6];

/// The patches of a scene, put together.
pub(super) struct Clusters {
    /// Numbers of the patches of each.
    pub members: Vec<Vec<usize>>,
    /// Cells that are smaller are not divided; patches that are, receive at one point.
    pub least_area: f64,
}

impl Clusters {
    pub(super) fn new(patches: &[PlacedPatch]) -> Self {
        let all = 0..patches.len();
        if patches.len() <= FEW {
            return Self { members: all.map(|patch| vec![patch]).collect(), least_area: 0.0 };
        }
        clustered(patches)
    }
}

fn clustered(patches: &[PlacedPatch]) -> Clusters {
    let all = 0..patches.len();
    let most = MOST_AREA * patches.iter().map(|patch| patch.real_area).sum::<f64>();
    let (large, mut small): (Vec<usize>, Vec<usize>) =
        all.partition(|&patch| patches[patch].real_area > most);
    let of_small: f64 = small.iter().map(|&patch| patches[patch].real_area).sum();
    let mut out: Vec<Vec<usize>> = large.into_iter().map(|patch| vec![patch]).collect();
    let scale = DIRECTIONS * extent(patches);
    let place = |&patch: &usize| place_of(&patches[patch], scale);
    add_clusters(&mut small, &|patch| patches[patch].real_area, most, &place, &mut out);
    Clusters { members: out, least_area: LEAST_AREA * of_small }
}

/// The place of a patch, where directions are multiplied by `scale`.
pub(super) fn place_of(patch: &PlacedPatch, scale: f64) -> PositionAndNormal {
    let [x, y, z] = patch.middle.position.to_array();
    let [along_x, along_y, along_z] = (scale * patch.middle.normal).to_array();
    [x, y, z, along_x, along_y, along_z]
}

fn extent(patches: &[PlacedPatch]) -> f64 {
    let centre = patches.iter().map(|patch| patch.ball.0).sum::<glam::DVec3>() / patches.len() as f64;
    patches.iter().map(|patch| patch.ball.0.distance(centre)).fold(0.0, f64::max)
}

fn add_clusters(
    members: &mut [usize],
    area: &impl Fn(usize) -> f64,
    most: f64,
    place: &impl Fn(&usize) -> PositionAndNormal,
    out: &mut Vec<Vec<usize>>,
) {
    if members.len() < 2 || members.iter().map(|&patch| area(patch)).sum::<f64>() <= most {
        out.extend((!members.is_empty()).then(|| members.to_vec()));
        return;
    }
    let [first, second] = halves(members, place);
    add_clusters(first, area, most, place, out);
    add_clusters(second, area, most, place, out);
}

/// Two halves, apart along the axis on which the places extend most.
pub(super) fn halves<T>(items: &mut [T], place: impl Fn(&T) -> PositionAndNormal) -> [&mut [T]; 2] {
    let mut low = [f64::INFINITY; 6];
    let mut high = [f64::NEG_INFINITY; 6];
    for item in items.iter() {
        for (axis, at) in place(item).into_iter().enumerate() {
            low[axis] = low[axis].min(at);
            high[axis] = high[axis].max(at);
        }
    }
    let width = |axis: &usize| high[*axis] - low[*axis];
    let axis = (0..6).max_by(|a, b| width(a).total_cmp(&width(b))).unwrap_or(0);
    items.sort_by(|a, b| place(a)[axis].total_cmp(&place(b)[axis]));
    let (first, second) = items.split_at_mut(items.len() / 2);
    [first, second]
}
