//! Settings of the placement of points.

use rebounce_shared::rbn::groups::Groups;

/// Settings of the placement of points.
#[derive(Clone, Debug)]
pub struct PlaceSettings {
    /// Number of levels.
    pub levels: usize,
    /// Poisson-disk radius of level 0, scene units; `None`: chosen for `functions`.
    pub coarse_radius: Option<f32>,
    /// Approximate number of functions on the finest level.
    pub functions: usize,
    /// Support over disk radius on all levels but the finest.
    pub coarse_overlap: f32,
    /// Support over disk radius on the finest level.
    pub fine_overlap: f32,
    /// Number of candidates per point, averaged over the last few points of a level, at which the level ends.
    pub patience: u64,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Reconstruction groups, group 0 first; empty where there is no other.
    pub groups: Vec<GroupPlacement>,
}

impl Default for PlaceSettings {
    /// The paper's numbers, except for the overlap of the finest level and `patience`: the paper ends a level after
    /// 2,000 failures in a row, by chance early or late.
    fn default() -> Self {
        Self {
            levels: 6,
            coarse_radius: None,
            functions: 120_000,
            coarse_overlap: 1.5,
            fine_overlap: 2.0,
            patience: 250,
            seed: 1,
            groups: Vec::new(),
        }
    }
}

impl PlaceSettings {
    /// Radii in each reconstruction group, relative to the level's.
    pub fn scales(&self) -> Vec<f32> {
        self.groups.iter().map(|group| group.density.sqrt().recip()).collect()
    }
}

/// Placement of points on a reconstruction group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroupPlacement {
    /// Functions for an area, relative to group 0.
    pub density: f32,
    /// Whether the group may move.
    pub moves: bool,
}

impl GroupPlacement {
    /// The placements of a scene's groups, group 0 first; empty without groups.
    pub fn of_groups(groups: &Groups) -> Vec<Self> {
        let own = groups.groups.iter();
        let own = own.map(|group| Self { density: group.density, moves: group.node.is_some() });
        let rest = (!groups.is_empty()).then_some(Self { density: 1.0, moves: false });
        rest.into_iter().chain(own).collect()
    }
}
