//! Progressive shooting by Southwell relaxation, without links (Alonso et al. 2001, Algorithm 1).

use super::basis::Basis;
use super::emitter::{Emitter, Radiosity};
use super::gather::PatchVisibility;
use super::patch::{PatchPoint, PlacedPatch, WaveletPatch};
use super::receive::PatchReceiver;
use super::settings::{Tolerance, WaveletError, WaveletSettings};
use super::solution::{Figures, WaveletSolution};
use super::tree::{Arrival, ReceivedTree, Tree};
use crate::geometry::Surfaces;
use crate::job::watch::Stopped;
use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;

/// Points along a side of a patch at which the mean direct light is estimated.
const DIRECT_POINTS: usize = 4;

/// Bounced irradiance of patches under the direct light of lamps and their own.
///
/// `direct` is the irradiance of a point with this normal from lamps, with visibility. `progress` gets the
/// part of the power that has been shot, after each shot. The result does not depend on the number of
/// threads.
///
/// Of all patches the one with the most unshot power shoots to all others, and to itself if it is curved. Its
/// own light and what it reflects are shots apart. Shots of little power may have greater errors for it: the
/// tolerance goes with the root of the power, so that the sum of errors, if they are independent, is that of
/// one shot with all the initial power.
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
    let basis = Basis::new(settings.order);
    let patches: Vec<PlacedPatch> =
        patches.iter().enumerate().map(|(i, patch)| PlacedPatch::new(patch, i)).collect::<Result<_, _>>()?;
    let visibility = PatchVisibility::new(surfaces);
    let mut scene = Shooting::new(&patches, &basis, settings);
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
        && let Some((shooter, arrival)) = scene.next_shooter()
    {
        scene.shoot(shooter, arrival, initial, &visibility);
        has_shot[shooter] = true;
        figures.shots += 1;
        remaining = scene.unshot_power();
        figures.convergence.push(1.0 - remaining / initial);
        progress(1.0 - remaining / initial)?;
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
    settings: &'a WaveletSettings,
    trees: Vec<Tree>,
    /// Power of the patches' own light that has not been shot.
    emission: Vec<DVec3>,
    /// Power of the reflection that has not been shot.
    reflection: Vec<DVec3>,
    /// Of all faces.
    area: f64,
}

impl<'a> Shooting<'a> {
    fn new(patches: &'a [PlacedPatch<'a>], basis: &'a Basis, settings: &'a WaveletSettings) -> Self {
        let functions = basis.order().functions();
        Self {
            patches,
            basis,
            settings,
            trees: patches.iter().map(|patch| Tree::new(functions, patch.mesh)).collect(),
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

    /// The patch and the kind of light with the most unshot power; `None` if there is none.
    fn next_shooter(&self) -> Option<(usize, Arrival)> {
        let mut best = None;
        let mut most = 0.0;
        for (powers, arrival) in [(&self.emission, Arrival::Emission), (&self.reflection, Arrival::Bounced)] {
            for (patch, power) in powers.iter().enumerate() {
                if power.element_sum() > most {
                    most = power.element_sum();
                    best = Some((patch, arrival));
                }
            }
        }
        best
    }

    /// Adds what all patches have received.
    fn merge(&mut self, received: Vec<Option<ReceivedTree>>, arrival: Arrival) {
        for (index, received) in received.into_iter().enumerate() {
            if let Some(received) = received {
                let patch = &self.patches[index];
                let mean = self.trees[index].merge(&received, arrival, patch.mesh);
                self.reflection[index] += patch.area * patch.albedo * mean;
            }
        }
    }

    /// The light of lamps, which the patches have yet to reflect.
    fn light_directly(&mut self, direct: &(impl Fn(&PatchPoint) -> DVec3 + Sync)) {
        let count = DIRECT_POINTS * DIRECT_POINTS;
        let of_patch = |patch: &PlacedPatch| {
            let mut sum = DVec3::ZERO;
            for i in 0..count {
                let cell = DVec2::new((i % DIRECT_POINTS) as f64, (i / DIRECT_POINTS) as f64);
                let st = (cell + 0.5) / DIRECT_POINTS as f64;
                sum += direct(&patch.point_with_nearest(st, 1.0 / DIRECT_POINTS as f64));
            }
            patch.real_area * sum / count as f64
        };
        let powers: Vec<DVec3> = self.patches.par_iter().map(of_patch).collect();
        let emitted: DVec3 = self.emission.iter().sum();
        let power = emitted + powers.iter().sum::<DVec3>();
        let tolerance = self.tolerance(power.element_sum());
        let received = self.patches.par_iter().map(|patch| {
            let (basis, settings) = (self.basis, self.settings);
            PatchReceiver { patch, basis, settings, light: direct, tolerance }.receive()
        });
        let received = received.collect();
        self.merge(received, Arrival::Lamps);
    }

    /// One patch shoots.
    fn shoot<S: Surfaces>(
        &mut self,
        shooter: usize,
        arrival: Arrival,
        initial: f64,
        visibility: &PatchVisibility<S>,
    ) {
        let patch = &self.patches[shooter];
        let (radiosity, power) = if arrival == Arrival::Emission {
            let power = std::mem::take(&mut self.emission[shooter]);
            (Radiosity::Constant(patch.emission), power)
        } else {
            let unshot = self.trees[shooter].take_unshot(self.basis);
            let power = std::mem::take(&mut self.reflection[shooter]);
            (Radiosity::Reflected { albedo: patch.albedo, unshot }, power)
        };
        let tolerance = self.tolerance((power.element_sum() * initial).sqrt());
        let emitter = Emitter::new(patch, self.basis, radiosity, self.settings.max_emitter_level);
        let to = |(index, patch): (usize, &PlacedPatch)| {
            if index == shooter && patch.mesh.is_planar() {
                return None;
            }
            let light = |point: &PatchPoint| {
                let point = visibility.moved_before_walls(*point);
                visibility.irradiance(&emitter, &point, &tolerance)
            };
            let (basis, settings) = (self.basis, self.settings);
            let receiver = PatchReceiver { patch, basis, settings, light, tolerance };
            let (centre, radius) = patch.ball;
            let nearest = (centre.distance(emitter.patch.ball.0) - radius).max(0.0);
            let outward = (centre - emitter.patch.ball.0).normalize_or_zero();
            if emitter.root().bound(emitter.patch.ball.0 + nearest * outward) <= 0.5 * tolerance.least {
                receiver.receive_coarsely()
            } else {
                receiver.receive()
            }
        };
        let received = self.patches.par_iter().enumerate().map(to).collect();
        self.merge(received, arrival);
    }
}
