//! Result of wavelet radiosity.

use super::basis::{Basis, Order};
use super::tree::Tree;
use glam::{DVec2, Vec3};

/// Irradiance of patches, as multiscaling functions on the leaves of quadtrees.
#[derive(Clone, Debug)]
pub struct WaveletSolution {
    pub(super) basis: Basis,
    pub(super) trees: Vec<Tree>,
    /// What it took.
    pub figures: Figures,
}

/// What a solution took.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figures {
    /// Leaves of the quadtrees that are not empty: final meshes of Alonso et al. 2001.
    pub leaf_cells: usize,
    /// Nodes of the quadtrees.
    pub cells: usize,
    /// RGB coefficients that are stored.
    pub coefficients: usize,
    /// Bytes of the quadtrees.
    pub bytes: usize,
    /// Patches that have shot before all did in the end.
    pub shooting_patches: usize,
    /// Shots.
    pub shots: usize,
    /// PatchVisibility rays between patches; those of the lamps do not count.
    pub rays: u64,
    /// Part of the initial power that has been shot, after each shot but those of all patches together in the
    /// end: 1 − unshot / initial, the sum of the channels.
    pub convergence: Vec<f64>,
}

impl WaveletSolution {
    /// Bounced irradiance of a point of a patch, linear RGB: all light that some patch has reflected. Without
    /// the direct light of lamps and of patches that shine.
    pub fn irradiance(&self, patch: usize, st: DVec2) -> Vec3 {
        self.at(patch, st)[1]
    }

    /// Direct irradiance of patches that shine.
    pub fn irradiance_of_emitters(&self, patch: usize, st: DVec2) -> Vec3 {
        self.at(patch, st)[0]
    }

    /// Order of the basis.
    pub fn order(&self) -> Order {
        self.basis.order()
    }

    /// Level of the smallest cells of a patch.
    pub fn depth(&self, patch: usize) -> u32 {
        self.trees.get(patch).map_or(0, Tree::depth)
    }

    fn at(&self, patch: usize, st: DVec2) -> [Vec3; 2] {
        let both = self.trees.get(patch).map(|tree| tree.irradiance(&self.basis, st));
        both.map_or([Vec3::ZERO; 2], |both| both.map(|irradiance| irradiance.as_vec3()))
    }
}
