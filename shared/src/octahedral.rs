//! Unit vectors packed by the octahedral map (Cigolle et al., *A Survey of Efficient
//! Representations for Independent Unit Vectors*, JCGT 2014).

use glam::{Vec2, Vec3};

/// The octahedral map: a unit vector to the square `[-1, 1]²`.
#[inline]
pub fn encode(v: Vec3) -> Vec2 {
    let p = Vec2::new(v.x, v.y) / (v.x.abs() + v.y.abs() + v.z.abs());
    if v.z < 0.0 {
        Vec2::new((1.0 - p.y.abs()) * 1f32.copysign(p.x), (1.0 - p.x.abs()) * 1f32.copysign(p.y))
    } else {
        p
    }
}

/// The inverse of [`encode`]; the result has unit length.
#[inline]
pub fn decode(p: Vec2) -> Vec3 {
    let z = 1.0 - p.x.abs() - p.y.abs();
    let fold = (-z).max(0.0);
    Vec3::new(p.x - fold * 1f32.copysign(p.x), p.y - fold * 1f32.copysign(p.y), z).normalize()
}

/// A unit vector in two signed normalised 16-bit numbers, x in the low half
/// (WebGPU's `snorm16x2`, WGSL's `unpack2x16snorm`). Error at most 0.004 degrees.
#[inline]
pub fn pack_snorm16(v: Vec3) -> u32 {
    let p = encode(v);
    let quantise = |x: f32| (x.clamp(-1.0, 1.0) * 32767.0).round() as i16 as u16 as u32;
    quantise(p.x) | quantise(p.y) << 16
}

/// Step of the coordinates of directions in a file; 32767 represents 1.
pub const NORMAL_STEP: i16 = 31;

/// As [`pack_snorm16`], rounded to multiples of [`NORMAL_STEP`]: 11 bits a coordinate. Directions along the axes stay
/// exact. Error at most 0.1 degrees.
pub fn pack_rounded(v: Vec3) -> u32 {
    let p = encode(v);
    let most = (32767 / NORMAL_STEP) as f32;
    let quantise = |x: f32| ((x.clamp(-1.0, 1.0) * most).round() as i16 * NORMAL_STEP) as u16 as u32;
    quantise(p.x) | quantise(p.y) << 16
}

/// The inverse of [`pack_snorm16`].
#[inline]
pub fn unpack_snorm16(bits: u32) -> Vec3 {
    let value = |b: u32| (b as u16 as i16 as f32 / 32767.0).max(-1.0);
    decode(Vec2::new(value(bits), value(bits >> 16)))
}

/// Code of a coordinate of 0 in [`pack_bytes`], and codes to that of 1.
const MIDDLE: f32 = 127.0;

/// A unit vector in two bytes, x in the low one: 127 for 0 and 254 for 1. Directions along the axes stay exact. Error at most
/// 0.9 degrees.
pub fn pack_bytes(v: Vec3) -> u32 {
    let p = (encode(v) * MIDDLE + MIDDLE).round();
    p.x as u8 as u32 | (p.y as u8 as u32) << 8
}

/// The inverse of [`pack_bytes`]; higher bits do not count.
pub fn unpack_bytes(bits: u32) -> Vec3 {
    let value = |b: u32| ((b & 255) as f32 / MIDDLE - 1.0).min(1.0);
    decode(Vec2::new(value(bits), value(bits >> 8)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn directions() -> impl Iterator<Item = Vec3> {
        (0..20_000).map(|i| {
            let z = 1.0 - 2.0 * (i as f32 + 0.5) / 20_000.0;
            let angle = i as f32 * 2.399_963_2;
            let r = (1.0 - z * z).sqrt();
            Vec3::new(r * angle.cos(), r * angle.sin(), z)
        })
    }

    #[test]
    fn round_trip_stays_within_the_stated_angle() {
        for v in directions() {
            assert!(unpack_snorm16(pack_snorm16(v)).angle_between(v).to_degrees() < 0.05);
        }
    }

    #[test]
    fn axes_survive() {
        for v in [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z] {
            assert!(unpack_snorm16(pack_snorm16(v)).distance(v) < 1e-4);
        }
    }
}
