//! Every backend of this processor gives the bits of the scalar one.

use super::scalar::ScalarF32x8;
use super::*;
use crate::random::Stream;

/// Runs a kernel with the scalar backend, and with the widest of this processor.
pub fn with_each<K: LaneKernel + Copy>(kernel: K) -> [K::Output; 2] {
    [ScalarF32x8::enter(kernel), dispatch(kernel)]
}

/// Three operands.
#[derive(Clone, Copy)]
struct Operands([[f32; LANES]; 3]);

/// Results of all operations of a backend.
#[derive(Debug, PartialEq)]
struct Results {
    /// Bits of the results of arithmetic; of a NaN, [`f32::NAN`]'s.
    arithmetic: Vec<[u32; LANES]>,
    /// Bits of the other results.
    exact: Vec<[u32; LANES]>,
    masks: Vec<u32>,
}

impl LaneKernel for Operands {
    type Output = Results;

    #[inline(always)]
    fn run<V: F32x8>(self) -> Results {
        let [a, b, c] = self.0.map(V::from_array);
        let canonical = |x: f32| if x.is_nan() { f32::NAN.to_bits() } else { x.to_bits() };
        let arithmetic = [a + b, a - b, a * b, a / b, a * b + c, (a - b) * c];
        let exact = [
            V::splat(self.0[0][3]),
            a & b,
            a | b,
            a.and_not(b),
            a.min(b),
            a.max(b),
            a.least(),
            a.greatest(),
            a.swap_halves(),
            a.swap_quarters(),
            a.swap_neighbours(),
            V::select(a.lt(b), b, c),
            V::select(a.le(c) | b.ge(c), a, c),
            V::select(a.ge(c) & b.eq(c), c, b),
        ];
        let masks = [a.lt(b), a.le(b), a.ge(b), a.eq(b), a.lt(b) | b.lt(c), a.le(b) & b.le(c)];
        Results {
            arithmetic: arithmetic.map(|x| x.to_array().map(canonical)).to_vec(),
            exact: exact.map(|x| x.to_array().map(f32::to_bits)).to_vec(),
            masks: masks.iter().map(|mask| mask.movemask()).chain([a.movemask(), c.movemask()]).collect(),
        }
    }
}

/// Numbers of any bits, a few numbers that are often equal, and those with rules of their own.
fn operand(stream: &mut Stream) -> f32 {
    const SPECIAL: [f32; 10] = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::NAN,
        f32::MIN_POSITIVE,
        f32::MAX,
        1e-40,
    ];
    match stream.bits() % 4 {
        0 => SPECIAL[stream.bits() as usize % SPECIAL.len()],
        1 => f32::from_bits(stream.bits() as u32),
        2 => (stream.bits() % 3) as f32 - 1.0,
        _ => 2.0 * stream.unit() - 1.0,
    }
}

#[test]
fn every_backend_gives_the_bits_of_the_scalar_one() {
    let mut stream = Stream::new(8, 8);
    for _ in 0..20_000 {
        let operands = Operands([(); 3].map(|()| [(); LANES].map(|()| operand(&mut stream))));
        let [scalar, widest] = with_each(operands);
        assert_eq!(scalar, widest, "{:?}", operands.0);
    }
}

#[test]
fn minimum_and_maximum_are_those_of_x86() {
    let (a, b) =
        ([1.0, f32::NAN, 1.0, 0.0, -0.0, -1.0, 2.0, 3.0], [f32::NAN, 1.0, 2.0, -0.0, 0.0, 1.0, 1.0, 3.0]);
    for found in with_each(Operands([a, b, a])) {
        let [min, max] = [4, 5].map(|place| found.exact[place].map(f32::from_bits));
        assert!(min[0].is_nan() && max[0].is_nan());
        assert_eq!(min[1..], [1.0, 1.0, -0.0, 0.0, -1.0, 1.0, 3.0]);
        assert_eq!(max[1..], [1.0, 2.0, -0.0, 0.0, 1.0, 2.0, 3.0]);
        assert!([min[3], max[3]].iter().all(|x| x.is_sign_negative()));
        assert!([min[4], max[4]].iter().all(|x| x.is_sign_positive()));
    }
}
