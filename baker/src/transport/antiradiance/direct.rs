//! Direct irradiance of patches: lamps by shadow rays, the sky and shining surfaces as they come to the points of the file.

use super::near::Near;
use crate::geometry::Surfaces;
use crate::job::watch::{Stopped, Watch};
use crate::light::direct::at_point;
use crate::transport::radiosity::GroupSource;
use glam::Vec3;
use rayon::prelude::*;
use rebounce_shared::antiradiance::{AntiradianceSolver, DirectLight, Patch};
use rebounce_shared::light::{LightKind, LightSource};
use std::slice::from_ref;

/// Irradiance of a patch by lamps: the mean over the middles of its sixteenths.
pub fn of_patch<S: Surfaces>(surfaces: &S, lamps: &[LightSource], patch: &Patch) -> Vec3 {
    let places = patch.sixteenths();
    let sum: Vec3 = places.iter().map(|place| at_point(surfaces, lamps, *place, patch.normal)).sum();
    sum / places.len() as f32
}

/// Irradiance of each patch by one group of light.
///
/// # Errors
/// [`Stopped`].
pub fn of_lamps<S: Surfaces>(
    surfaces: &S,
    patches: &[Patch],
    group: &GroupSource,
    watch: &dyn Watch,
) -> Result<Vec<Vec3>, Stopped> {
    let lamps = &group.lighting.lamps;
    if lamps.is_empty() {
        return Ok(vec![Vec3::ZERO; patches.len()]);
    }
    let of_patch = |(i, patch): (usize, &Patch)| {
        if i % 64 == 0 {
            watch.step(0)?;
        }
        Ok(of_patch(surfaces, lamps, patch))
    };
    patches.par_iter().enumerate().map(of_patch).collect()
}

/// Direct light with the irradiance of glossy patches by bin: a lamp's in the bin of its direction, the rest of `irradiance` evenly
/// from all directions.
pub fn by_bin<S: Surfaces>(
    surfaces: &S,
    solver: &AntiradianceSolver<'_>,
    lamps: &[LightSource],
    irradiance: Vec<Vec3>,
) -> DirectLight {
    let bins = solver.bins.count();
    let mut rest = irradiance.clone();
    let mut of_lamps = vec![Vec3::ZERO; solver.lobes.gains.len()];
    let rows = of_lamps.par_chunks_exact_mut(bins).zip(&solver.lobes.patches);
    let sums: Vec<Vec3> = rows
        .map(|(row, patch)| {
            let patch = &solver.patches[*patch as usize];
            let mut sum = Vec3::ZERO;
            for lamp in lamps {
                let light = of_patch(surfaces, from_ref(lamp), patch);
                let way = match lamp.kind {
                    LightKind::Directional => lamp.direction,
                    _ => (patch.position() - lamp.position).normalize_or(-patch.normal),
                };
                row[solver.bins.bin_of(way)] += light;
                sum += light;
            }
            sum
        })
        .collect();
    for (patch, sum) in solver.lobes.patches.iter().zip(sums) {
        let rest = &mut rest[*patch as usize];
        *rest = (*rest - sum).max(Vec3::ZERO);
    }
    let mut light = solver.even_light(rest);
    light.by_bin.iter_mut().zip(of_lamps).for_each(|(sum, lamps)| *sum += lamps);
    DirectLight { irradiance, ..light }
}

/// Adds what comes to the points from the sky and from shining surfaces; `values` are the points'.
pub fn add_linked(patches: &[Patch], values: &[Vec3], points: &Near<'_>, out: &mut [Vec3]) {
    out.par_iter_mut().zip(patches).for_each(|(value, patch)| {
        *value += points.mean(patch.position(), patch.normal, values).unwrap_or(Vec3::ZERO);
    });
}
