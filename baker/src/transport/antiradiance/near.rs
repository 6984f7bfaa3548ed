//! Values between places on surfaces: the mean of near ones that face the same way, by area and distance (splatting of
//! Dachsbacher et al. 2007, section 4.3).

use glam::{IVec3, Vec3};
use rebounce_shared::antiradiance::Patch;
use std::collections::HashMap;

/// Least cosine of normals that face the same way.
const SAME: f32 = 0.8;
/// Most distance from the plane of a place, as a share of the reach.
const OFF: f32 = 0.35;
/// Times that the reach is doubled where nothing is near.
const DOUBLINGS: u32 = 6;

/// A place with an area.
#[derive(Clone, Copy, Debug)]
pub struct AreaPoint {
    /// Local space.
    pub position: Vec3,
    /// Unit normal.
    pub normal: Vec3,
    /// Area, any unit.
    pub area: f32,
}

impl From<&Patch> for AreaPoint {
    fn from(patch: &Patch) -> Self {
        Self { position: patch.position(), normal: patch.normal, area: patch.area() }
    }
}

/// Places by cells of a grid.
pub struct Near<'a> {
    places: &'a [AreaPoint],
    reach: f32,
    /// By doubling of the reach: indices of the places of each cell.
    grids: Vec<HashMap<IVec3, Vec<u32>>>,
}

impl<'a> Near<'a> {
    /// Sorts places into grids; `reach` is how far a place has a weight, scene units.
    pub fn new(places: &'a [AreaPoint], reach: f32) -> Self {
        let mut grids = Vec::new();
        for doubling in 0..DOUBLINGS {
            let side = reach * (1u32 << doubling) as f32;
            let mut grid: HashMap<IVec3, Vec<u32>> = HashMap::new();
            for (number, place) in (0..).zip(places) {
                grid.entry((place.position / side).floor().as_ivec3()).or_default().push(number);
            }
            grids.push(grid);
        }
        Self { places, reach, grids }
    }

    /// Mean of the values of near places; `None` where none is near.
    pub fn mean(&self, position: Vec3, normal: Vec3, values: &[Vec3]) -> Option<Vec3> {
        (0..DOUBLINGS).find_map(|doubling| self.mean_within(doubling, position, normal, values))
    }

    fn mean_within(&self, doubling: u32, position: Vec3, normal: Vec3, values: &[Vec3]) -> Option<Vec3> {
        let reach = self.reach * (1u32 << doubling) as f32;
        let own = (position / reach).floor().as_ivec3();
        let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
        for number in 0..27 {
            let cell = own + IVec3::new(number % 3 - 1, number / 3 % 3 - 1, number / 9 - 1);
            for i in self.grids[doubling as usize].get(&cell).into_iter().flatten() {
                let place = &self.places[*i as usize];
                let way = place.position - position;
                let share = way.length_squared() / (reach * reach);
                let is_off = way.dot(normal).abs().max(way.dot(place.normal).abs()) > OFF * reach;
                if share >= 1.0 || is_off || place.normal.dot(normal) < SAME {
                    continue;
                }
                let weight = place.area * (1.0 - share) * (1.0 - share);
                sum += weight * values[*i as usize];
                weights += weight;
            }
        }
        (weights > 0.0).then(|| sum / weights)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_keep_constants_and_do_not_go_round_corners() {
        let place = |i: u32, normal: Vec3| AreaPoint {
            position: Vec3::new((i % 10) as f32, 0.0, (i / 10) as f32),
            normal,
            area: 1.0,
        };
        let places: Vec<AreaPoint> =
            (0..200).map(|i| place(i % 100, if i < 100 { Vec3::Y } else { Vec3::NEG_Y })).collect();
        let values: Vec<Vec3> =
            (0..200).map(|i| if i < 100 { Vec3::ONE } else { Vec3::new(0.0, 5.0, 0.0) }).collect();
        let near = Near::new(&places, 1.5);
        for at in [Vec3::new(4.3, 0.0, 5.1), Vec3::new(-3.0, 0.0, 0.0)] {
            assert!(near.mean(at, Vec3::Y, &values).unwrap().distance(Vec3::ONE) < 1e-6);
            assert!(near.mean(at, Vec3::X, &values).is_none());
        }
    }
}
