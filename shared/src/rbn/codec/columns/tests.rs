//! Round trips of columns, and rejection of damaged columns.

use super::*;
use crate::random::Stream;

fn vertices(rounded: bool) -> Vec<Vertex> {
    let mut s = Stream::new(3, rounded as u64);
    let mut number = move |scale: f32| {
        let x = scale * (s.unit() - 0.5);
        if rounded { (x * 1024.0).round() / 1024.0 + 0.0 } else { x }
    };
    (0..3000u32)
        .map(|i| Vertex {
            position: [number(30.0), number(0.01) + i as f32, if i % 9 == 0 { 0.0 } else { number(3.0) }],
            normal: ((i % 1000) * 31) | ((i.wrapping_mul(31) % 1057 * 31) << 16),
            uv: [number(1e4), -number(2.0)],
        })
        .collect()
}

#[test]
fn records_come_back_bit_by_bit() {
    let rounded = encode(&vertices(true));
    let others = encode(&vertices(false));
    assert_eq!(decode::<Vertex>(&rounded).unwrap(), vertices(true));
    assert_eq!(decode::<Vertex>(&others).unwrap(), vertices(false));
    assert!(rounded.len() < others.len() * 3 / 4, "{} {}", rounded.len(), others.len());
    // Arbitrary bits.
    let mut s = Stream::new(5, 0);
    for special in [0, 1, 0x8000_0000, 0x7f80_0000, 0x7fc0_0000, 0xff7f_ffff, 0x0080_0000, 0x4b80_0001] {
        let mut word = || if s.unit() < 0.5 { special } else { s.bits() as u32 & 0x7fff_ffff };
        let cuts: Vec<Cut> =
            (0..100).map(|_| Cut { towards: [word(), word(), special].map(f32::from_bits) }).collect();
        let back = decode::<Cut>(&encode(&cuts)).unwrap();
        assert_eq!(bytemuck::cast_slice::<_, u32>(&back), bytemuck::cast_slice::<_, u32>(&cuts));
        let points: Vec<Point> = (0..100)
            .map(|_| Point { normal: word(), cuts: word(), tint: word(), ..Point::default() })
            .collect();
        assert_eq!(decode::<Point>(&encode(&points)).unwrap(), points);
    }
    assert_eq!(decode::<u32>(&encode::<u32>(&[])).unwrap(), Vec::<u32>::new());
}

#[test]
fn floats_of_every_size_come_back_bit_by_bit() {
    let mut s = Stream::new(11, 0);
    for exponent in 0..=255u32 {
        // Columns of similar magnitude, with and without a common step.
        for zeros in [0, 3, 12, 20, 23] {
            let mut word = || {
                let bits = s.bits() as u32;
                let near = exponent.saturating_sub(bits >> 28 & 3);
                (bits & 0x8000_0000) | near << 23 | (bits & 0x7f_ffff) >> zeros << zeros
            };
            let cuts: Vec<Cut> =
                (0..40).map(|_| Cut { towards: [word(), word(), word()].map(f32::from_bits) }).collect();
            let back = decode::<Cut>(&encode(&cuts)).unwrap();
            assert_eq!(bytemuck::cast_slice::<_, u32>(&back), bytemuck::cast_slice::<_, u32>(&cuts));
        }
    }
}

#[test]
fn damaged_sections_are_refused_or_give_other_records() {
    let vertices = vertices(true);
    let packed = encode(&vertices);
    for i in (0..packed.len()).step_by(5) {
        let mut damaged = packed.clone();
        damaged[i] ^= 1 << (i % 8);
        if let Ok(other) = decode::<Vertex>(&damaged) {
            assert!(other != vertices || damaged[i] == packed[i], "byte {i}");
        }
        assert!(decode::<Vertex>(&packed[..i]).is_err());
    }
}

#[test]
fn a_section_that_promises_too_much_is_refused_before_it_is_made() {
    let packed = encode(&vec![5u32; 1_000_000]);
    assert_eq!(decode::<u32>(&packed).unwrap().len(), 1_000_000);
    assert!(decode::<u32>(&packed[..packed.len() - 1]).is_err());
    let mut lying = encode(&[1u32, 2, 3]);
    lying[..4].copy_from_slice(&u32::MAX.to_le_bytes());
    assert_eq!(decode::<u32>(&lying), Err(Damaged));
}
