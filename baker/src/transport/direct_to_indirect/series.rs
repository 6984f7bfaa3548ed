//! The series of bounces C + C² + … between coarse points, for a few columns at a time.
//!
//! The sum of all bounces is the fixed point X = B + C X, with the first bounce B = C E. Summed
//! bounce by bounce, the residual shrinks by the share λ of light that a bounce keeps. Chebyshev's
//! iteration (Golub and Varga 1961) shrinks the residual by about λ / (1 + √(1 - λ²)) with each
//! sweep over the rows: 0.41 instead of 0.7. Chebyshev's iteration is for matrices with real
//! eigenvalues between -λ and λ. C, scaled by the points' reflectance, is symmetric up to noise,
//! because light transport is reciprocal. A limited number of bounces is summed bounce by bounce,
//! by the same sweeps.

use crate::lanes::{F32x8, LaneKernel, dispatch_loops};
use crate::transport::operator::IrradianceRow;
use glam::Vec3;

/// Coarse points (columns) per batch.
pub const BATCH: usize = 16;
/// Convergence threshold: the light that is still to come, over the light summed so far. The light
/// to come is estimated from the residual and the share that a bounce keeps: an upper bound. The
/// remaining error of the light is 0.002 in a kitchen and 0.005 in a hall.
const SETTLED: f32 = 0.02;
/// Greatest number of sweeps.
const MOST_SWEEPS: u32 = 64;
/// Divergence threshold: ratio of the residual to its least value so far. Noise can make C amplify
/// light in white rooms.
const UNSETTLED: f32 = 4.0;
/// Number of bounces for measuring the share of light that a bounce keeps, and the upper bound of
/// the share.
const MEASURED: u32 = 12;
const MOST_KEPT: f32 = 0.98;

/// Irradiance at a point: red, green and blue, for every column of a batch. Aligned to cache lines.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Light(pub [[f32; BATCH]; 3]);

impl Light {
    const NONE: Self = Self([[0.0; BATCH]; 3]);
}

/// The coarse rows of an operator, prepared for the series.
pub struct Series<'a> {
    rows: &'a [IrradianceRow],
    /// Receivers of the light of each point, with the transfer to each receiver.
    columns: Vec<IrradianceRow>,
    tints: &'a [Vec3],
    /// Number of bounces of the light, including the bounce over the links T; `None` for all
    /// bounces.
    wanted: Option<u32>,
    /// Share of the light that a bounce keeps (λ).
    kept: f32,
}

/// State of an iteration.
struct State {
    /// The sum so far, X, without the residual.
    sum: Vec<Light>,
    /// The residual B - (1 - C) X.
    left: Vec<Light>,
    /// Next increment of the sum.
    step: Vec<Light>,
    /// `step` times the points' tints, and a buffer for the next sweep.
    sent: [Vec<Light>; 2],
}

/// Coefficients of the next step: of the last step, and of the residual.
type Mix = [f32; 2];

impl<'a> Series<'a> {
    /// Prepares the series for these coarse rows and tints.
    pub fn new(rows: &'a [IrradianceRow], tints: &'a [Vec3], wanted: Option<u32>) -> Self {
        let mut columns = vec![IrradianceRow::new(); rows.len()];
        for (receiver, row) in (0..).zip(rows) {
            for &(sender, transfer) in row {
                columns[sender as usize].push((receiver, transfer));
            }
        }
        Self { rows, columns, tints, wanted, kept: kept(rows, tints) }
    }

    /// Returns the irradiance of every coarse point from the bounces of unit light at `senders`
    /// (coarse points, at most [`BATCH`]), without the unit light itself, and the number of bounces
    /// including the bounce over the links T.
    pub fn columns(&self, senders: &[u32]) -> (Vec<Light>, u32) {
        let none = || vec![Light::NONE; self.rows.len()];
        // The light has bounced over F already, and bounces over T to the receivers.
        if self.wanted.is_some_and(|wanted| wanted <= 2) {
            return (none(), 2);
        }
        let first = self.first(senders);
        let mut state = State { sum: none(), step: first.clone(), left: first, sent: [none(), none()] };
        for ((sent, step), tint) in state.sent[0].iter_mut().zip(&state.step).zip(self.tints) {
            *sent = tinted(step, *tint);
        }
        let mut mixes = ChebyshevCoefficients::new(self.kept);
        let mut sweeps = 0;
        let most = self.wanted.map_or(MOST_SWEEPS, |wanted| wanted - 3);
        let to_come = self.kept / (1.0 - self.kept);
        let mut least = f32::INFINITY;
        while sweeps < most {
            // For a limited number of bounces the residual of a sum is the last bounce, which is
            // the next step.
            let mix = if self.wanted.is_some() { [0.0, 1.0] } else { mixes.next() };
            let [left, sum] = self.sweep(&mut state, mix);
            sweeps += 1;
            least = least.min(left);
            let ends = to_come * left <= SETTLED * sum || left > UNSETTLED * least;
            if left == 0.0 || (ends && self.wanted.is_none()) {
                break;
            }
        }
        // The residual belongs to the sum. Dark entries may be slightly negative.
        for (sum, left) in state.sum.iter_mut().zip(&state.left) {
            for (sum, left) in sum.0.as_flattened_mut().iter_mut().zip(left.0.as_flattened()) {
                *sum = (*sum + left).max(0.0);
            }
        }
        (state.sum, 3 + sweeps)
    }

    /// The first bounce of unit light at these points.
    fn first(&self, senders: &[u32]) -> Vec<Light> {
        let mut first = vec![Light::NONE; self.rows.len()];
        for (b, sender) in senders.iter().enumerate() {
            let tint = self.tints[*sender as usize].to_array();
            for (receiver, transfer) in &self.columns[*sender as usize] {
                for (lane, tint) in first[*receiver as usize].0.iter_mut().zip(tint) {
                    lane[b] += transfer * tint;
                }
            }
        }
        first
    }

    /// Adds the step to the sum and computes the next step. Returns the totals of the residual's
    /// magnitude and of the sum.
    fn sweep(&self, state: &mut State, mix: Mix) -> [f32; 2] {
        dispatch_loops(Sweep { rows: self.rows, tints: self.tints, state, mix })
    }
}

/// Measures λ, the share of light that a bounce keeps: from uniform light, after several bounces,
/// in the channel with the largest share.
fn kept(rows: &[IrradianceRow], tints: &[Vec3]) -> f32 {
    let total = |light: &[Vec3]| light.iter().sum::<Vec3>();
    let mut light = vec![Vec3::ONE; rows.len()];
    let mut kept = Vec3::ZERO;
    for _ in 0..MEASURED {
        let bounced = |row: &IrradianceRow| -> Vec3 {
            row.iter()
                .map(|(sender, transfer)| *transfer * tints[*sender as usize] * light[*sender as usize])
                .sum()
        };
        let next: Vec<Vec3> = rows.iter().map(bounced).collect();
        kept = total(&next) / total(&light).max(Vec3::splat(f32::MIN_POSITIVE));
        light = next;
    }
    kept.max_element().clamp(0.0, MOST_KEPT)
}

/// Generates the coefficients of Chebyshev's iteration, step by step. With Chebyshev polynomials T
/// and k bounces done, `ratio` is T_k(1 / λ) / (λ T_{k + 1}(1 / λ)).
struct ChebyshevCoefficients {
    kept: f32,
    ratio: f32,
}

impl ChebyshevCoefficients {
    fn new(kept: f32) -> Self {
        Self { kept, ratio: 1.0 }
    }

    fn next(&mut self) -> Mix {
        let last = self.kept * self.kept * self.ratio;
        self.ratio = 1.0 / (2.0 - last);
        [last * self.ratio, 2.0 * self.ratio]
    }
}

/// Light that a point sends: irradiance times tint.
#[inline(always)]
fn tinted(light: &Light, tint: Vec3) -> Light {
    let mut sent = *light;
    for (lane, tint) in sent.0.iter_mut().zip(tint.to_array()) {
        lane.iter_mut().for_each(|x| *x *= tint);
    }
    sent
}

/// The irradiance of a point from the light sent by all points.
#[inline(always)]
fn arriving(row: &IrradianceRow, sent: &[Light]) -> Light {
    let mut sum = [[0f32; BATCH]; 3];
    for (sender, transfer) in row {
        let light = sent[*sender as usize].0.as_flattened();
        for (sum, light) in sum.as_flattened_mut().iter_mut().zip(light) {
            *sum += transfer * light;
        }
    }
    Light(sum)
}

#[inline(always)]
fn sweep(rows: &[IrradianceRow], tints: &[Vec3], state: &mut State, [of_last, of_left]: Mix) -> [f32; 2] {
    let State { sum, left, step, sent: [sent, next] } = state;
    let (mut is_left, mut has_come) = ([[0f32; BATCH]; 3], [[0f32; BATCH]; 3]);
    let points = sum.iter_mut().zip(left).zip(step).zip(next.iter_mut());
    for (((((sum, left), step), next), row), tint) in points.zip(rows).zip(tints) {
        let arriving = arriving(row, sent);
        for c in 0..3 {
            for b in 0..BATCH {
                sum.0[c][b] += step.0[c][b];
                left.0[c][b] += arriving.0[c][b] - step.0[c][b];
                step.0[c][b] = of_last * step.0[c][b] + of_left * left.0[c][b];
                is_left[c][b] += left.0[c][b].abs();
                has_come[c][b] += sum.0[c][b];
            }
        }
        *next = tinted(step, *tint);
    }
    std::mem::swap(sent, next);
    [is_left, has_come].map(|each| each.as_flattened().iter().sum())
}

/// Arguments of [`sweep`].
struct Sweep<'a> {
    rows: &'a [IrradianceRow],
    tints: &'a [Vec3],
    state: &'a mut State,
    mix: Mix,
}

impl LaneKernel for Sweep<'_> {
    type Output = [f32; 2];

    #[inline(always)]
    fn run<V: F32x8>(self) -> [f32; 2] {
        sweep(self.rows, self.tints, self.state, self.mix)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::dispatch;
    use crate::random::Stream;

    /// Points with symmetric transport, whose rows sum to at most a given share.
    fn points(count: u32, kept: f32) -> (Vec<IrradianceRow>, Vec<Vec3>) {
        let mut stream = Stream::new(5, count as u64);
        let mut some = || stream.unit();
        let areas: Vec<f32> = (0..count).map(|_| 0.5 + some()).collect();
        let mut rows = vec![vec![0f32; count as usize]; count as usize];
        for i in 0..count as usize {
            for k in 0..i {
                if some() < 0.4 {
                    let seen = some();
                    (rows[i][k], rows[k][i]) = (seen * areas[k], seen * areas[i]);
                }
            }
        }
        let most = rows.iter().map(|row| row.iter().sum::<f32>()).fold(0f32, f32::max);
        let row = |row: Vec<f32>| {
            (0..).zip(row).filter(|entry| entry.1 != 0.0).map(|(k, x)| (k, kept * x / most)).collect()
        };
        let tints = (0..count).map(|_| Vec3::new(1.0, some(), 0.5 * some())).collect();
        (rows.into_iter().map(row).collect(), tints)
    }

    /// Sum of a number of bounces of unit light at a point, bounce by bounce, in double precision.
    fn one_by_one(rows: &[IrradianceRow], tints: &[Vec3], sender: usize, bounces: usize) -> Vec<[f64; 3]> {
        let tint = |k: usize, c: usize| tints[k][c] as f64;
        let mut light = vec![[0.0; 3]; rows.len()];
        light[sender] = [1.0; 3];
        let mut sum = vec![[0.0; 3]; rows.len()];
        for _ in 0..bounces {
            let row = |row: &IrradianceRow| {
                let of = |c: usize| {
                    let entry =
                        |(k, x): &(u32, f32)| *x as f64 * tint(*k as usize, c) * light[*k as usize][c];
                    row.iter().map(entry).sum::<f64>()
                };
                [of(0), of(1), of(2)]
            };
            light = rows.iter().map(row).collect();
            for (sum, light) in sum.iter_mut().zip(&light) {
                (0..3).for_each(|c| sum[c] += light[c]);
            }
        }
        sum
    }

    /// Relative error of columns.
    fn off(series: &Series, senders: &[u32], bounces: usize) -> f64 {
        let (found, _) = series.columns(senders);
        let (mut off, mut all) = (0.0, 0.0);
        for (b, sender) in senders.iter().enumerate() {
            let wanted = one_by_one(series.rows, series.tints, *sender as usize, bounces);
            for (found, wanted) in found.iter().zip(wanted) {
                for (found, wanted) in found.0.iter().zip(wanted) {
                    assert!(found[b] >= 0.0);
                    off += (found[b] as f64 - wanted).abs();
                    all += wanted;
                }
            }
        }
        off / all
    }

    #[test]
    fn all_bounces_settle_to_what_they_add_up_to() {
        for (count, kept) in [(60, 0.3), (150, 0.7), (150, 0.95), (90, 1.0)] {
            let (rows, tints) = points(count, kept);
            let series = Series::new(&rows, &tints, None);
            assert!(series.kept <= kept + 1e-6, "{} of {kept}", series.kept);
            let senders: Vec<u32> = (0..count).step_by(3).take(BATCH).collect();
            let off = off(&series, &senders, 2000);
            assert!(off < SETTLED as f64, "{kept}: {off}");
        }
    }

    #[test]
    fn so_many_bounces_are_so_many() {
        let (rows, tints) = points(80, 0.8);
        for wanted in 2..8 {
            let series = Series::new(&rows, &tints, Some(wanted));
            let (found, bounces) = series.columns(&[3, 4, 7]);
            assert_eq!(bounces, wanted);
            match wanted {
                2 => assert!(found.iter().all(|light| *light == Light::NONE)),
                _ => assert!(off(&series, &[3, 4, 7], wanted as usize - 2) < 1e-5, "{wanted}"),
            }
        }
    }

    #[test]
    fn light_that_no_bounce_takes_anything_from_ends_all_the_same() {
        // Two mirrors that see only each other: light is kept entirely, or amplified.
        for given in [1.0, 1.01, 1.05, 1.3] {
            let rows = vec![vec![(1, given)], vec![(0, given)]];
            let series = Series::new(&rows, &[Vec3::ONE; 2], None);
            let (found, bounces) = series.columns(&[0]);
            assert!(bounces <= 3 + MOST_SWEEPS);
            let is_some = |light: &Light| light.0[0][0] > 1.0 && light.0[0][0] < 500.0;
            assert!(found.iter().all(is_some), "{given}: {found:?}");
        }
    }

    #[test]
    fn light_bounces_alike_however_many_numbers_are_added_at_once() {
        let (rows, tints) = points(90, 0.9);
        let mut stream = Stream::new(6, 0);
        let mut some = || -> Vec<Light> {
            (0..90).map(|_| Light([(); 3].map(|_| [(); BATCH].map(|_| 2.0 * stream.unit() - 0.5)))).collect()
        };
        let (sum, left, step) = (some(), some(), some());
        let sent = [some(), some()];
        let swept = |sweep: &dyn Fn(&mut State) -> [f32; 2]| -> Vec<u32> {
            let mut state =
                State { sum: sum.clone(), left: left.clone(), step: step.clone(), sent: sent.clone() };
            let ends = sweep(&mut state);
            let all = [&state.sum, &state.left, &state.step, &state.sent[0]];
            let lanes = all.into_iter().flatten().flat_map(|light| light.0.as_flattened());
            lanes.chain(&ends).map(|x| x.to_bits()).collect()
        };
        let mix = [0.3, 1.2];
        let wanted = swept(&|state| sweep(&rows, &tints, state, mix));
        let series = Series::new(&rows, &tints, None);
        assert_eq!(swept(&|state| series.sweep(state, mix)), wanted);
        let found = swept(&|state| dispatch(Sweep { rows: &rows, tints: &tints, state, mix }));
        assert_eq!(found, wanted);
    }
}
