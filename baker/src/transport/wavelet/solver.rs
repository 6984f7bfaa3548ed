//! Progressive shooting by Southwell relaxation, without links (Alonso et al. 2001, Algorithm 1).

use super::basis::Basis;
use super::clusters::Clusters;
use super::emitter::{Emitter, Radiosity, ShootingPatch};
use super::gather::PatchVisibility;
use super::gather_clusters::representatives;
use super::patch::{PatchPoint, PlacedPatch, WaveletPatch};
use super::receive::PatchReceiver;
use super::settings::{Tolerance, WaveletError, WaveletSettings};
use super::solution::{Figures, WaveletSolution};
use super::tree::{Arrival, ReceivedTree, Tree};
use crate::geometry::Surfaces;
use crate::job::watch::Stopped;
use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Points along a side of a patch at which the mean direct light is estimated.
const DIRECT_POINTS: usize = 4;
/// Level down to which spots of lamps are looked for. Lamps are points: their light ends sharply.
const SEARCHED: u32 = 3;

/// Bounced irradiance of patches under the direct light of lamps and their own.
///
/// `direct` is the irradiance of a point with this normal from lamps, with visibility. `progress` gets the
/// part of the power that has been shot, after each shot. The result does not depend on the number of
/// threads.
///
/// Of all patches, or clusters of many small ones, the one with the most unshot power shoots to all others,
/// and to itself unless it is a plane. Its own light and what it reflects are shots apart. Shots of little
/// power may have greater errors for it: the tolerance goes with the root of the power, so that the sum of
/// errors, if they are independent, is that of one shot with all the initial power. In the end all patches
/// shoot together what is left.
///
/// # Errors
/// [`WaveletError`] for patches that make no sense, or if `progress` stops it.
pub fn solve<S: Surfaces>(
    patches: &[WaveletPatch],
    surfaces: &S,
    direct: impl Fn(Vec3, Vec3) -> Vec3 + Sync,
    settings: &WaveletSettings,
    mut progress: impl FnMut(f64) -> Result<(), Stopped>,
) -> Result<WaveletSolution, WaveletError> {
    let go_on = |part: f64| progress(part).map(ControlFlow::Continue);
    solve_until(patches, surfaces, direct, settings, go_on)
}

/// As [`solve`], but `progress` may also be content with what has been shot.
///
/// # Errors
/// As [`solve`].
pub fn solve_until<S: Surfaces>(
    patches: &[WaveletPatch],
    surfaces: &S,
    direct: impl Fn(Vec3, Vec3) -> Vec3 + Sync,
    settings: &WaveletSettings,
    mut progress: impl FnMut(f64) -> Result<ControlFlow<()>, Stopped>,
) -> Result<WaveletSolution, WaveletError> {
    let basis = Basis::new(settings.order);
    let patches: Vec<PlacedPatch> = patches
        .par_iter()
        .enumerate()
        .map(|(i, patch)| PlacedPatch::new(patch, i))
        .collect::<Result<_, _>>()?;
    let visibility = PatchVisibility::new(surfaces);
    let mut scene = Shooting::new(&patches, &basis, settings, &visibility);
    scene.light_directly(&|point: &PatchPoint| {
        direct(point.seen_from.as_vec3(), point.seen_normal.as_vec3()).as_dvec3()
    });
    let initial = scene.unshot_power();
    let mut figures = Figures::default();
    let mut has_shot = vec![false; patches.len()];
    let mut remaining = initial;
    while initial > 0.0
        && remaining > (1.0 - settings.convergence) * initial
        && figures.shots < settings.max_shots
        && let Some((cluster, arrival)) = scene.next_shooters()
    {
        let shooters = scene.with_power(&scene.clusters.members[cluster], arrival);
        scene.shoot(&shooters, arrival, initial, figures.shots as u64, &visibility);
        for shooter in shooters {
            has_shot[shooter] = true;
        }
        figures.shots += 1;
        remaining = scene.unshot_power();
        figures.convergence.push(1.0 - remaining / initial);
        if progress(1.0 - remaining / initial)?.is_break() {
            break;
        }
    }
    // Small bright patches have little of the power, and much of the light on what is beside them.
    let all: Vec<usize> = (0..patches.len()).collect();
    for arrival in [Arrival::Emission, Arrival::Bounced] {
        let shooters = scene.with_power(&all, arrival);
        if !shooters.is_empty() && figures.shots < settings.max_shots {
            scene.shoot(&shooters, arrival, initial, figures.shots as u64, &visibility);
            figures.shots += 1;
        }
    }
    let mut trees = scene.trees;
    trees.par_iter_mut().for_each(|tree| tree.push_down(&basis));
    for tree in &trees {
        let [nodes, coefficients] = tree.counts();
        figures.leaf_cells += tree.leaves();
        figures.cells += nodes;
        figures.coefficients += coefficients;
        figures.bytes += tree.bytes();
    }
    figures.shooting_patches = has_shot.iter().filter(|shot| **shot).count();
    figures.rays = visibility.rays();
    Ok(WaveletSolution { basis, trees, figures })
}

/// Patches and what they have received.
struct Shooting<'a> {
    patches: &'a [PlacedPatch<'a>],
    basis: &'a Basis,
    settings: WaveletSettings,
    clusters: Clusters,
    /// By patch, the one at whose middle it receives from patches.
    representatives: Vec<usize>,
    trees: Vec<Tree>,
    /// Power of the patches' own light that has not been shot.
    emission: Vec<DVec3>,
    /// Power of the reflection that has not been shot.
    reflection: Vec<DVec3>,
    /// Of all faces.
    area: f64,
}

impl<'a> Shooting<'a> {
    fn new<S: Surfaces>(
        patches: &'a [PlacedPatch<'a>],
        basis: &'a Basis,
        settings: &'a WaveletSettings,
        visibility: &PatchVisibility<S>,
    ) -> Self {
        let functions = basis.order().functions();
        let clusters = Clusters::new(patches);
        let min_cell_area = settings.min_cell_area.max(clusters.least_area);
        let settings = WaveletSettings { min_cell_area, ..*settings };
        Self {
            patches,
            basis,
            settings,
            representatives: representatives(patches, clusters.least_area, &|a, b| visibility.is_clear(a, b)),
            clusters,
            trees: patches.par_iter().map(|patch| Tree::new(functions, patch.mesh)).collect(),
            emission: patches.iter().map(|patch| patch.real_area * patch.emission).collect(),
            reflection: vec![DVec3::ZERO; patches.len()],
            area: patches.iter().map(|patch| patch.real_area).sum(),
        }
    }

    /// Of irradiance, where a power, the sum of the channels, is shared out.
    fn tolerance(&self, power: f64) -> Tolerance {
        let relative = self.settings.epsilon;
        Tolerance { least: relative * power / (3.0 * self.area), relative }
    }

    /// Power that has not been shot, the sum of the channels.
    fn unshot_power(&self) -> f64 {
        self.emission.iter().chain(&self.reflection).map(|power| power.element_sum().max(0.0)).sum()
    }

    /// Power of a patch that has not been shot.
    fn power(&mut self, patch: usize, arrival: Arrival) -> &mut DVec3 {
        if arrival == Arrival::Emission { &mut self.emission[patch] } else { &mut self.reflection[patch] }
    }

    /// The cluster and the kind of light with the most unshot power; `None` if there is none.
    fn next_shooters(&self) -> Option<(usize, Arrival)> {
        let mut best = None;
        let mut most = 0.0;
        for (powers, arrival) in [(&self.emission, Arrival::Emission), (&self.reflection, Arrival::Bounced)] {
            for (cluster, members) in self.clusters.members.iter().enumerate() {
                let power = members.iter().map(|patch| powers[*patch].element_sum().max(0.0)).sum();
                if power > most {
                    most = power;
                    best = Some((cluster, arrival));
                }
            }
        }
        best
    }

    /// Those of some patches that have anything to shoot.
    fn with_power(&self, patches: &[usize], arrival: Arrival) -> Vec<usize> {
        let powers = if arrival == Arrival::Emission { &self.emission } else { &self.reflection };
        patches.iter().copied().filter(|patch| powers[*patch].element_sum() > 0.0).collect()
    }

    /// Whether a patch is no more than a cell among many.
    fn is_small(&self, patch: &PlacedPatch) -> bool {
        patch.real_area < self.clusters.least_area
    }

    /// Adds received light to all trees: that of the patch's representative; of lamps, of the patch itself.
    fn merge(&mut self, received: &[Option<ReceivedTree>], arrival: Arrival) {
        let add = |(index, tree): (usize, &mut Tree)| {
            let patch = &self.patches[index];
            let at = if arrival == Arrival::Lamps { index } else { self.representatives[index] };
            let mean = received[at]
                .as_ref()
                .map_or(DVec3::ZERO, |received| tree.merge(received, arrival, patch.mesh, self.basis));
            patch.area * patch.albedo * mean
        };
        let powers: Vec<DVec3> = self.trees.par_iter_mut().enumerate().map(add).collect();
        for (sum, power) in self.reflection.iter_mut().zip(powers) {
            *sum += power;
        }
    }

    /// The light of lamps, which the patches have yet to reflect.
    fn light_directly(&mut self, direct: &(impl Fn(&PatchPoint) -> DVec3 + Sync)) {
        let count = DIRECT_POINTS * DIRECT_POINTS;
        let of_patch = |patch: &PlacedPatch| {
            if self.is_small(patch) {
                return patch.real_area * direct(&patch.middle);
            }
            let (mut sum, mut whole) = (DVec3::ZERO, 0.0);
            for i in 0..count {
                let cell = DVec2::new((i % DIRECT_POINTS) as f64, (i / DIRECT_POINTS) as f64);
                let st = (cell + 0.5) / DIRECT_POINTS as f64;
                let density = patch.mesh.density(st);
                sum += density * direct(&patch.point_with_nearest(st, 1.0 / DIRECT_POINTS as f64));
                whole += density;
            }
            patch.real_area * sum / whole
        };
        let powers: Vec<DVec3> = self.patches.par_iter().map(of_patch).collect();
        let emitted: DVec3 = self.emission.iter().sum();
        let power = emitted + powers.iter().sum::<DVec3>();
        let tolerance = self.tolerance(power.element_sum());
        let received = self.patches.par_iter().map(|patch| {
            let (basis, settings) = (self.basis, &self.settings);
            let receiver =
                PatchReceiver { patch, basis, settings, light: direct, tolerance, searched: SEARCHED };
            if self.is_small(patch) { receiver.receive_in_the_middle() } else { receiver.receive() }
        });
        let received: Vec<_> = received.collect();
        self.merge(&received, Arrival::Lamps);
    }

    /// Some patches shoot.
    fn shoot<S: Surfaces>(
        &mut self,
        shooters: &[usize],
        arrival: Arrival,
        initial: f64,
        seed: u64,
        visibility: &PatchVisibility<S>,
    ) {
        let powers = shooters.iter().map(|shooter| std::mem::take(self.power(*shooter, arrival)));
        let power = powers.sum::<DVec3>().element_sum();
        let member = |shooter: &usize| {
            let patch = &self.patches[*shooter];
            let radiosity = if arrival == Arrival::Emission {
                Radiosity::Constant(patch.emission)
            } else {
                Radiosity::Reflected {
                    albedo: patch.albedo,
                    unshot: self.trees[*shooter].take_unshot(self.basis),
                }
            };
            ShootingPatch { patch, radiosity }
        };
        let members = shooters.iter().map(member).collect();
        let emitter = Emitter::new(members, self.basis, self.settings.max_emitter_level, seed);
        let tolerance = self.tolerance((power * initial).sqrt());
        let to = |(index, patch): (usize, &PlacedPatch)| {
            let is_itself = shooters == [index];
            if self.representatives[index] != index
                || is_itself && patch.mesh.is_planar()
                || patch.is_behind(emitter.ball)
                || emitter.is_behind(patch.ball)
            {
                return None;
            }
            let light = |point: &PatchPoint| {
                let point = visibility.moved_before_walls(*point);
                visibility.irradiance(&emitter, &point, &tolerance)
            };
            let (basis, settings) = (self.basis, &self.settings);
            let receiver = PatchReceiver { patch, basis, settings, light, tolerance, searched: 0 };
            let [most, variation] = emitter.reach(patch);
            if self.is_small(patch) || variation <= 0.5 * tolerance.least {
                receiver.receive_in_the_middle()
            } else if most <= 0.5 * tolerance.least {
                receiver.receive_coarsely()
            } else {
                receiver.receive()
            }
        };
        let received: Vec<_> = self.patches.par_iter().enumerate().map(to).collect();
        self.merge(&received, arrival);
    }
}
