//! Directions of a gather's rays: cosine-distributed, of low discrepancy, shifted for each receiver and pass. Twin of
//! `hemisphere.wgsl`.

use crate::elementary::Elementary;
use crate::footprint::tangents;
use glam::{Vec2, Vec3};

/// Mixes 32 bits (PCG, Jarzynski and Olano 2020).
#[inline]
pub fn hash(x: u32) -> u32 {
    let state = x.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

/// A number from 0 up to 1 out of 32 bits.
#[inline]
fn unit(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / (1u32 << 24) as f32)
}

/// Place `k` of `count` of Hammersley's point set in the unit square, shifted (Cranley and Patterson 1976).
#[inline]
pub fn square(k: u32, count: u32, shift: Vec2) -> Vec2 {
    (Vec2::new((k as f32 + 0.5) / count as f32, unit(k.reverse_bits())) + shift).fract()
}

/// Shift of a receiver's directions.
#[inline]
pub fn shift(receiver: u32, pass: u32) -> Vec2 {
    let first = hash(receiver ^ hash(pass));
    Vec2::new(unit(first), unit(hash(first)))
}

/// Direction for a place in the unit square, on the hemisphere around a unit normal (Malley's method).
#[inline]
pub fn direction(place: Vec2, normal: Vec3) -> Vec3 {
    let (first, second) = tangents(normal);
    let (sine, cosine) = (std::f32::consts::TAU * place.y).sine_cosine();
    place.x.sqrt() * (first * cosine + second * sine) + normal * (1.0 - place.x).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_have_the_mean_cosine_of_a_lambertian_surface_and_differ_by_receiver() {
        let normal = Vec3::new(0.36, -0.48, 0.8);
        for receiver in 0..20 {
            let shift = shift(receiver, 3);
            let all = (0..512).map(|k| direction(square(k, 512, shift), normal));
            let mean = all.sum::<Vec3>() / 512.0;
            assert!((mean - normal * (2.0 / 3.0)).length() < 0.01, "{mean}");
        }
        assert_ne!(shift(1, 3), shift(2, 3));
        assert_ne!(shift(1, 3), shift(1, 4));
    }
}
