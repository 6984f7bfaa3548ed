//! A box around a cube map: the cheap correction of parallax. What the map sees is taken to be on the sides of the box
//! (Lagarde and Zanuttini, *Local Image-based Lighting with Parallax-corrected Cubemaps*, 2012).

use glam::Vec3;
use rebounce_shared::cube_map::cube::Cube;
use rebounce_shared::cube_map::march::{Distances, RayEnd};

/// Sides of a box along the axes, from the place of the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParallaxBox {
    /// Least corner; its coordinates are below 0, infinite towards the sky.
    pub low: Vec3,
    /// Greatest corner, likewise.
    pub high: Vec3,
}

impl ParallaxBox {
    /// Fits a box: its sides are at the median of what the texels of each face see.
    pub fn fitted(distances: &Distances) -> Self {
        let Cube { side } = distances.cube;
        let median = |face: usize| {
            let texels = face * side * side..(face + 1) * side * side;
            let mut depths: Vec<f32> =
                texels.map(|i| distances.texels[i] * distances.cube.direction(i)[face / 2].abs()).collect();
            depths.sort_by(f32::total_cmp);
            depths[depths.len() / 2]
        };
        let of = |back: usize| Vec3::from_array([0, 1, 2].map(|axis| median(2 * axis + back)));
        Self { low: -of(1), high: of(0) }
    }

    /// End of a ray of unit direction from a place, which is from that of the map.
    pub fn meet(&self, from: Vec3, direction: Vec3) -> RayEnd {
        let from = from.clamp(self.low, self.high);
        let along = (0..3)
            .filter(|axis| direction[*axis] != 0.0)
            .map(|axis| {
                let side = if direction[axis] > 0.0 { self.high } else { self.low };
                (side[axis] - from[axis]) / direction[axis]
            })
            .fold(f32::INFINITY, f32::min);
        let place = if along.is_finite() { from + along * direction } else { direction };
        let from_map = if along.is_finite() { place.length() } else { f32::INFINITY };
        RayEnd { seen_from_map: place, along, from_map, is_sure: true }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    #[test]
    fn in_a_box_rays_end_on_the_box_that_is_fitted() {
        let cube = Cube { side: 32 };
        let room = ParallaxBox { low: Vec3::new(-1.0, -0.5, -2.0), high: Vec3::new(3.0, 1.0, 1.5) };
        let distance = |i: usize| room.meet(Vec3::ZERO, cube.direction(i)).from_map;
        let distances = Distances { cube, texels: (0..cube.texels()).map(distance).collect() };
        // Each side is the median of its face where it fills half of it.
        let square = ParallaxBox { low: Vec3::splat(-1.0), high: Vec3::splat(1.0) };
        let of = |i: usize| square.meet(Vec3::ZERO, cube.direction(i)).from_map;
        let fitted = ParallaxBox::fitted(&Distances { cube, texels: (0..cube.texels()).map(of).collect() });
        assert!(fitted.low.distance(square.low) < 1e-4 && fitted.high.distance(square.high) < 1e-4);
        let mut stream = Stream::new(7, 0);
        for _ in 0..200 {
            let from = room.low + (room.high - room.low) * Vec3::from_array([(); 3].map(|()| stream.unit()));
            let direction = stream.sphere();
            let met = room.meet(from, direction);
            assert!((from + met.along * direction).distance(met.seen_from_map) < 1e-4);
            // The map sees the same place there.
            assert!((distances.at(met.seen_from_map) / met.from_map - 1.0).abs() < 0.15);
        }
    }

    #[test]
    fn towards_the_sky_there_is_no_parallax() {
        let room = ParallaxBox { low: Vec3::splat(-1.0), high: Vec3::INFINITY };
        let direction = Vec3::new(0.1, 0.8, 0.2).normalize();
        let met = room.meet(Vec3::new(0.5, 0.5, 0.0), direction);
        assert_eq!((met.seen_from_map, met.along), (direction, f32::INFINITY));
    }
}
