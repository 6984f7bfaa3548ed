//! A cube of texels: six faces of `side` x `side`, in the order +x, −x, +y, −y, +z, −z, oriented as WebGPU's cube textures are.
//! The viewer's cube.wgsl has the same directions.

use glam::{Vec2, Vec3};
use std::f32::consts::FRAC_PI_2;

/// Texels of a cube, by number: face after face, row after row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cube {
    /// Texels along an edge.
    pub side: usize,
}

/// Returns the direction, not of unit length, of a place on a face; coordinates from −1 to 1 on it.
fn toward(face: usize, at: Vec2) -> Vec3 {
    match face {
        0 => Vec3::new(1.0, -at.y, -at.x),
        1 => Vec3::new(-1.0, -at.y, at.x),
        2 => Vec3::new(at.x, 1.0, at.y),
        3 => Vec3::new(at.x, -1.0, -at.y),
        4 => Vec3::new(at.x, -at.y, 1.0),
        _ => Vec3::new(-at.x, -at.y, -1.0),
    }
}

/// Returns the face of a direction, and the place on it.
fn place(direction: Vec3) -> (usize, Vec2) {
    let size = direction.abs();
    let Vec3 { x, y, z } = direction;
    let (face, at, major) = match () {
        () if size.x >= size.y && size.x >= size.z => match x >= 0.0 {
            true => (0, Vec2::new(-z, -y), size.x),
            false => (1, Vec2::new(z, -y), size.x),
        },
        () if size.y >= size.z => match y >= 0.0 {
            true => (2, Vec2::new(x, z), size.y),
            false => (3, Vec2::new(x, -z), size.y),
        },
        () => match z >= 0.0 {
            true => (4, Vec2::new(x, -y), size.z),
            false => (5, Vec2::new(-x, -y), size.z),
        },
    };
    (face, at / major)
}

impl Cube {
    /// Number of texels.
    pub fn texels(self) -> usize {
        6 * self.side * self.side
    }

    /// Mean angle between neighbouring texels, radians.
    pub fn angle(self) -> f32 {
        FRAC_PI_2 / self.side as f32
    }

    /// Unit direction of the centre of a texel.
    pub fn direction(self, texel: usize) -> Vec3 {
        let (face, within) = (texel / (self.side * self.side), texel % (self.side * self.side));
        let at = Vec2::new((within % self.side) as f32, (within / self.side) as f32);
        toward(face, (at + 0.5) * (2.0 / self.side as f32) - 1.0).normalize()
    }

    /// Solid angle of a texel, sr.
    pub fn solid_angle(self, direction: Vec3) -> f32 {
        let (_, at) = place(direction);
        4.0 / ((self.side * self.side) as f32 * (1.0 + at.length_squared()).powf(1.5))
    }

    /// Number of the texel in a direction.
    pub fn nearest(self, direction: Vec3) -> usize {
        let (face, at) = place(direction);
        let column = |x: f32| (((x + 1.0) * 0.5 * self.side as f32) as usize).min(self.side - 1);
        (face * self.side + column(at.y)) * self.side + column(at.x)
    }

    /// The four texels around a direction, with bilinear weights. Beyond an edge they are the neighbouring face's.
    pub fn around(self, direction: Vec3) -> [(usize, f32); 4] {
        let (face, at) = place(direction);
        let at = (at + 1.0) * (0.5 * self.side as f32) - 0.5;
        let (low, part) = (at.floor(), at - at.floor());
        let within = 0.0..self.side as f32;
        [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(x, y)| {
            let (column, row) = (low.x + x, low.y + y);
            let weight = (1.0 - (part.x - x).abs()) * (1.0 - (part.y - y).abs());
            let texel = if within.contains(&column) && within.contains(&row) {
                (face * self.side + row as usize) * self.side + column as usize
            } else {
                let beyond = (Vec2::new(column, row) + 0.5) * (2.0 / self.side as f32) - 1.0;
                self.nearest(toward(face, beyond))
            };
            (texel, weight)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;
    use std::f32::consts::TAU;

    #[test]
    fn texels_are_found_in_their_directions_and_cover_the_sphere() {
        let cube = Cube { side: 16 };
        let mut whole = 0.0;
        for texel in 0..cube.texels() {
            let direction = cube.direction(texel);
            assert_eq!(cube.nearest(direction), texel);
            let (own, weight) = cube.around(direction)[0];
            assert!(own == texel && (weight - 1.0).abs() < 1e-4 || weight < 1e-4, "{texel}");
            whole += cube.solid_angle(direction);
        }
        assert!((whole / (2.0 * TAU) - 1.0).abs() < 1e-3, "{whole}");
    }

    #[test]
    fn interpolated_directions_are_the_direction_across_edges_too() {
        let cube = Cube { side: 32 };
        let mut stream = Stream::new(3, 0);
        for _ in 0..2000 {
            let direction = stream.sphere();
            let around = cube.around(direction);
            let total: f32 = around.iter().map(|(_, weight)| weight).sum();
            assert!((total - 1.0).abs() < 1e-4);
            let mean: Vec3 = around.iter().map(|(texel, weight)| cube.direction(*texel) * *weight).sum();
            assert!(mean.normalize().dot(direction) > (0.7 * cube.angle()).cos(), "{direction}");
        }
    }
}
