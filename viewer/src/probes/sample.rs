//! Irradiance at a place from the probes around it: the twin of the shaders of those who read the probes.

use super::grid::Grid;
use super::harmonics::{self, COUNT};
use super::rows::{PLANES, Rows};
use glam::{IVec2, Vec2, Vec3, Vec3A};
use rebounce_shared::octahedral;

/// How far behind a plane a place may be before it counts as behind, in spacings.
pub const TOLERANCE: f32 = 0.02;
/// Depth behind a plane, in spacings, at which a weight falls by a factor e.
pub const FADE: f32 = 0.004;
/// A probe right behind a surface has this weight of one before it.
pub const BEHIND: f32 = 0.1;
/// Least weight by visibility: where no probe sees a place, all count.
pub const LEAST: f32 = 1e-26;

/// Irradiance at a place with a unit normal, local space; `radiance` by probe.
pub fn irradiance(grid: &Grid, rows: &Rows, radiance: &[[Vec3; COUNT]], place: Vec3, normal: Vec3) -> Vec3 {
    let counts = Vec3A::from(grid.counts.map(|count| count as f32));
    let at = (Vec3A::from((place - grid.first) / grid.spacing)).max(Vec3A::ZERO).min(counts - 1.0);
    let base = at.floor().min((counts - 2.0).max(Vec3A::ZERO));
    let share = at - base;
    let (mut sum, mut total) = ([Vec3::ZERO; COUNT], 0.0);
    for corner in 0..8u32 {
        let offset = Vec3A::new((corner & 1) as f32, (corner >> 1 & 1) as f32, (corner >> 2) as f32);
        let cell = (base + offset).min(counts - 1.0);
        let probe = (cell.x + counts.x * (cell.y + counts.y * cell.z)) as usize;
        let [x, y, z, is_free] = rows.moved[probe];
        if is_free == 0.0 {
            continue;
        }
        let near = Vec3A::ONE - (offset - share).abs();
        let from = place - (grid.place(probe) + Vec3::new(x, y, z));
        let facing = 0.5 - 0.5 * normal.dot(from.normalize_or_zero());
        let weight = near.max(Vec3A::splat(1e-3)).element_product()
            * (BEHIND + (1.0 - BEHIND) * facing * facing)
            * visibility(rows, probe, from, grid.spacing);
        total += weight;
        sum.iter_mut().zip(&radiance[probe]).for_each(|(sum, radiance)| *sum += *radiance * weight);
    }
    if total <= 0.0 {
        return Vec3::ZERO;
    }
    harmonics::irradiance(&sum.map(|sum| sum / total), normal)
}

/// Weight of a probe by how far a place is behind the surfaces that it sees: between the four texels around its direction.
fn visibility(rows: &Rows, probe: usize, from: Vec3, spacing: f32) -> f32 {
    let at = (octahedral::encode(from.normalize_or(Vec3::Y)) * 0.5 + 0.5) * PLANES as f32 - 0.5;
    let (base, share) = (at.floor(), at - at.floor());
    let mut visible = 0.0;
    for corner in 0..4 {
        let offset = Vec2::new((corner & 1) as f32, (corner >> 1) as f32);
        let near = 1.0 - (offset - share).abs();
        let [x, y, z, distance] = rows.planes[probe * PLANES * PLANES + texel((base + offset).as_ivec2())];
        let behind = -(Vec3::new(x, y, z).dot(from) + distance) / spacing - TOLERANCE;
        visible += near.x * near.y * (-behind.max(0.0) / FADE).exp();
    }
    visible.max(LEAST)
}

/// Number of a texel of a map, wrapped around its border.
fn texel(at: IVec2) -> usize {
    let side = PLANES as i32;
    let mut at = at;
    if at.x < 0 || at.x >= side {
        at = IVec2::new(at.x.clamp(0, side - 1), side - 1 - at.y);
    }
    if at.y < 0 || at.y >= side {
        at = IVec2::new(side - 1 - at.x, at.y.clamp(0, side - 1));
    }
    (at.y * side + at.x) as usize
}
