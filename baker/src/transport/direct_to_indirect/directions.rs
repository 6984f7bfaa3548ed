//! Ray directions of a hemispherical gather.
//!
//! Irradiance weighs directions by their cosine. Directions are drawn from the mixture density
//! `p(ω) = (2βz + 1 − β) / 2π`, with z the cosine, so that grazing directions, where senders are
//! small and near, have enough rays. The samples are a Fibonacci lattice, which has the least error
//! of R2, jittered strata and Fibonacci at every count from 256 to 4096. The samples are sorted so
//! that neighbours in the list are neighbours on the hemisphere, and shifted per receiver.
//!
//! Adjacent receivers are blended in the picture, so their shifts fill the gap between two
//! directions evenly (the R2 sequence, Roberts 2018, along the points' space-filling curve).
//! Several adjacent receivers sample distant light like a single receiver with the rays of all of
//! them.

use crate::random::Stream;
use glam::{Vec2, Vec3};
use rebounce_shared::elementary::Elementary;

/// Share β of the cosine-weighted directions.
const COSINE_SHARE: f32 = 0.8;

/// Directions per block (SIMD lanes).
pub const LANES: usize = 8;
/// A scalar of every direction in a block.
pub type Lanes = [f32; LANES];

/// Samples of the unit square, to be shifted and mapped to hemispheres.
#[derive(Clone, Debug)]
pub struct Directions {
    /// First coordinate, and cosine and sine of 2π times the second coordinate; the last block is
    /// padded with zeros.
    square: Vec<[Lanes; 3]>,
    count: usize,
    /// Two short lattice vectors that span a lattice cell, the domain of distinct shifts.
    steps: [Vec2; 2],
}

/// A block of up to [`LANES`] directions.
pub struct Block {
    /// Unit directions by axis, local space.
    pub direction: [Lanes; 3],
    /// Cosine to the normal times the ray's weight, before normalisation by the sum over all
    /// directions.
    pub share: Lanes,
    /// Number of directions in the block.
    pub len: usize,
}

/// Mapping from the unit square to a receiver's hemisphere.
struct Frame {
    tangent: Vec3,
    bitangent: Vec3,
    normal: Vec3,
    shift: f32,
}

impl Frame {
    #[inline(always)]
    fn block(&self, [x, cos, sin]: &[Lanes; 3], len: usize) -> Block {
        const B: f32 = COSINE_SHARE;
        let mut block = Block { direction: [[0.0; LANES]; 3], share: [0.0; LANES], len };
        for i in 0..LANES {
            let x = x[i] + self.shift;
            let x = if x >= 1.0 { x - 1.0 } else { x };
            // The cosine's distribution function is βz² + (1 − β)z.
            let cosine = (((1.0 - B) * (1.0 - B) + 4.0 * B * x).sqrt() - (1.0 - B)) / (2.0 * B);
            let cosine = cosine.clamp(1e-4, 1.0);
            let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
            let (along, across) = (sine * cos[i], sine * sin[i]);
            for axis in 0..3 {
                block.direction[axis][i] =
                    self.tangent[axis] * along + self.bitangent[axis] * across + self.normal[axis] * cosine;
            }
            block.share[i] = cosine * (2.0 / (2.0 * B * cosine + 1.0 - B));
        }
        block
    }
}

impl Directions {
    /// Creates a lattice of `count` directions.
    pub fn new(count: u32) -> Self {
        let mut square: Vec<Vec2> = (0..count)
            .map(|i| {
                let [x, y] = lattice(i, count);
                Vec2::new((x + 0.5 / count as f64) as f32, y as f32)
            })
            .collect();
        // Rows of roughly square tiles, traversed back and forth.
        let tiles = (count as f32).sqrt().ceil().max(1.0) / 2.0;
        let order = |p: &Vec2| {
            let row = (p.x * tiles) as u32;
            let column = (p.y * tiles) as u32;
            (row, if row.is_multiple_of(2) { column } else { u32::MAX - column })
        };
        square.sort_by_key(order);
        let side_by_side = |some: &[Vec2]| {
            let mut lanes = [[0.0; LANES]; 3];
            for (i, p) in some.iter().enumerate() {
                let (sin, cos) = (p.y * std::f32::consts::TAU).sine_cosine();
                (lanes[0][i], lanes[1][i], lanes[2][i]) = (p.x, cos, sin);
            }
            lanes
        };
        Self {
            count: square.len(),
            square: square.chunks(LANES).map(side_by_side).collect(),
            steps: steps(count),
        }
    }

    /// Number of directions.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether the number of directions is 0.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Shift of a receiver's samples in the unit square.
    fn shift(&self, receiver: usize, seed: u64) -> Vec2 {
        // 1 / ρ and 1 / ρ² of the plastic number ρ (R2 sequence): the first n points are the most
        // even for every n.
        const PLASTIC: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_3];
        let from = Stream::new(seed, 0).square();
        let along = |from: f32, part: f64| (from as f64 + receiver as f64 * part).fract() as f32;
        let [one, other] = self.steps;
        // A shift by an integer has no effect.
        (one * along(from.x, PLASTIC[0]) + other * along(from.y, PLASTIC[1])).fract_gl()
    }

    /// Returns the directions around a receiver's unit normal, in blocks. Directions of receivers
    /// with adjacent numbers interleave.
    #[inline(always)]
    pub fn blocks(&self, normal: Vec3, receiver: usize, seed: u64) -> impl Iterator<Item = Block> + '_ {
        let shift = self.shift(receiver, seed);
        let (tangent, bitangent) = normal.any_orthonormal_pair();
        // A shift of the second coordinate rotates the hemisphere.
        let (sin, cos) = (shift.y * std::f32::consts::TAU).sine_cosine();
        let (tangent, bitangent) = (tangent * cos + bitangent * sin, bitangent * cos - tangent * sin);
        let frame = Frame { tangent, bitangent, normal, shift: shift.x };
        let first = (0..self.count).step_by(LANES);
        self.square
            .iter()
            .zip(first)
            .map(move |(lanes, first)| frame.block(lanes, LANES.min(self.count - first)))
    }
}

/// Point `i` of the Fibonacci lattice of `count` points in the unit square.
fn lattice(i: u32, count: u32) -> [f64; 2] {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    [i as f64 / count as f64, (i as f64 * GOLDEN).fract()]
}

/// The shortest lattice vector, and the shortest lattice vector in a different direction.
fn steps(count: u32) -> [Vec2; 2] {
    let wrapped = |i: u32| {
        let [x, y] = lattice(i, count);
        [x, y - y.round()]
    };
    let length = |step: &[f64; 2]| step[0] * step[0] + step[1] * step[1];
    // A step around the unit square is always available as a second direction.
    let mut all: Vec<[f64; 2]> = (1..count).map(wrapped).chain([[0.0, 1.0], [1.0, 0.0]]).collect();
    all.sort_by(|a, b| length(a).total_cmp(&length(b)));
    let one = all[0];
    // A lattice cell has an area of 1 / count; parallel steps span no area.
    let is_another = |step: &&[f64; 2]| (one[0] * step[1] - one[1] * step[0]).abs() > 0.5 / count as f64;
    let other = all.iter().find(is_another).copied().unwrap_or([-one[1], one[0]]);
    [one, other].map(|step| Vec2::new(step[0] as f32, step[1] as f32))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ray direction and its share, as in a [`Block`].
    struct Direction {
        direction: Vec3,
        share: f32,
    }

    impl Directions {
        /// The directions of all blocks.
        fn around(&self, normal: Vec3, receiver: usize, seed: u64) -> impl Iterator<Item = Direction> + '_ {
            self.blocks(normal, receiver, seed).flat_map(|block| {
                let Block { direction: [x, y, z], share, len } = block;
                (0..len).map(move |i| Direction { direction: Vec3::new(x[i], y[i], z[i]), share: share[i] })
            })
        }
    }

    #[test]
    fn the_mixture_integrates_cosine_and_tangent_exactly_enough() {
        for count in [250, 256, 4096] {
            let directions = Directions::new(count);
            for receiver in 0..20 {
                let normal = Vec3::new(0.48, 0.6, -0.64);
                let (mut cosines, mut vector, mut some) = (0.0, Vec3::ZERO, 0);
                for d in directions.around(normal, receiver, 1) {
                    assert!((d.direction.length() - 1.0).abs() < 1e-4);
                    cosines += d.share / count as f32;
                    vector += d.direction * (d.share / d.direction.dot(normal) / count as f32);
                    some += 1;
                }
                assert_eq!(some, count);
                // ∫ ω dω / π over the hemisphere is the normal.
                assert!((cosines - 1.0).abs() < 0.01, "{cosines}");
                assert!((vector - normal).length() < 0.05, "{vector}");
            }
        }
    }

    #[test]
    fn steps_span_one_cell_of_the_lattice() {
        for count in [1, 2, 3, 7, 64, 448, 512, 1000, 4096] {
            let [one, other] = steps(count);
            let cells = (one.perp_dot(other) * count as f32).abs();
            assert!((cells - 1.0).abs() < 0.01, "{count}: {cells}");
            assert!(one.length() <= other.length());
            // The cell is not elongated: both steps have similar lengths. (The lattice of two
            // points is elongated.)
            assert!(count < 3 || other.length() < 3.0 * one.length(), "{count}: {one} {other}");
        }
    }

    #[test]
    fn neighbours_share_what_is_small_and_far_evenly() {
        // A lit spot that is hit by two rays of a receiver.
        let (normal, spot, cosine) = (Vec3::Y, Vec3::new(0.5, 0.7, -0.3).normalize(), 0.997);
        let directions = Directions::new(512);
        let share = |receiver: usize, seed: u64| {
            let of = |inside: bool| {
                let some = directions.around(normal, receiver, seed);
                let some = some.filter(|d| !inside || d.direction.dot(spot) > cosine);
                some.map(|d| d.share).sum::<f32>()
            };
            of(true) / of(false)
        };
        let together = |receivers: &dyn Fn(usize) -> usize, seed| {
            (0..12).map(|k| share(receivers(k), seed)).sum::<f32>() / 12.0
        };
        let spread = |values: &[f32]| {
            let mean = values.iter().sum::<f32>() / values.len() as f32;
            (values.iter().map(|v| (v - mean).powi(2)).sum::<f32>() / values.len() as f32).sqrt() / mean
        };
        let mut stream = Stream::new(9, 9);
        let (mut near, mut random) = (Vec::new(), Vec::new());
        for seed in 0..100 {
            let first = stream.bits() as usize % 100_000;
            near.push(together(&|k| first + k, seed));
            let any: Vec<usize> = (0..12).map(|_| stream.bits() as usize % 100_000).collect();
            random.push(together(&|k| any[k], seed));
        }
        assert!(spread(&near) < 0.6 * spread(&random), "{} {}", spread(&near), spread(&random));
    }
}
