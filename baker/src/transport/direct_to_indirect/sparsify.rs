//! Row sparsification: selects the entries of a receiver's gathered row that become links. The
//! criterion of Fig. 5 (an entry over ε), with error diffusion along the senders' space-filling
//! curve: an entry below ε is added to the next sender, so that a row keeps its sum.

use super::accumulator::SparseAccumulator;
use rebounce_shared::link::{Link, Sent};

/// Least sum, as a share of ε, for which a row without links becomes a single link. Without this
/// link, a few nested rows of dropped sums would lose a noticeable part of the light.
const LEAST_SUM: f32 = 0.125;

/// Converts a gathered row to links. The criterion of Fig. 5, ε, with two changes: a link must
/// exceed its own noise, and dropped amounts are carried over to the next sender along the
/// space-filling curve until the sum exceeds the threshold. Therefore a row keeps its sum, and
/// senders that are too small individually are merged into the link of a neighbour.
///
/// `of` maps a sender's sums to the gathered and the predicted irradiance; links hold gathered
/// minus predicted. `noise` is the variance of a gathered sum per unit of the sum, times the
/// squared significance.
pub fn sparsify<const N: usize>(
    tally: &SparseAccumulator<N>,
    of: impl Fn([f32; N]) -> (f32, f32),
    epsilon: f32,
    noise: f32,
) -> Vec<Link> {
    let mut row: Vec<Link> = Vec::new();
    let (mut carried, mut seen) = (0f32, 0f32);
    // Position, sender and amount of the last link, and of the smallest link before the last.
    let (mut last, mut smallest) = ((0, 0, 0f32), None::<(usize, u32, f32)>);
    let mut strongest = (0, 0.0);
    tally.each(|sender, sums| {
        let (sum, expected) = of(sums);
        carried = carried + sum - expected;
        if sum > strongest.1 {
            strongest = (sender, sum);
        }
        // Rays that all miss a small sender by chance are as unreliable as rays that hit it often
        // by chance: the prediction counts as well.
        let expected = sum.abs().max(expected.abs());
        if noise > 0.0 {
            seen += expected;
        }
        if carried * carried > (noise * seen).max(epsilon * epsilon) {
            let link = Link::pack(sender, carried);
            let held = link.amount();
            row.push(link);
            // The packing error is carried over too.
            carried -= held;
            if row.len() > 1 && smallest.is_none_or(|s| last.2.abs() < s.2.abs()) {
                smallest = Some(last);
            }
            last = (row.len() - 1, sender, held);
            seen = 0.0;
        }
    });
    if let Some(link) = row.last_mut() {
        carried += last.2;
        *link = Link::pack(last.1, carried);
        let held = link.amount();
        // The packing error of the last link is added to the smallest link, whose packing error is
        // least.
        if let Some((at, sender, amount)) = smallest {
            row[at] = Link::pack(sender, amount + carried - held);
        }
    } else if carried.abs() > LEAST_SUM * epsilon {
        row.push(Link::pack(strongest.0, carried));
    }
    row
}

/// Indices of a sender's sums as read by [`sparsify_pooled`]: the receiver's own
/// [`Difference`](super::neighbourhood::Difference), amount (`OWN`) and magnitude, and amount and
/// magnitude (`POOLED_MAGNITUDE`) of the mean over the neighbourhood.
const OWN: usize = 0;
const POOLED_MAGNITUDE: usize = 3;

/// Noise thresholds of [`sparsify_pooled`], as variances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PooledNoise {
    /// Threshold for the mean difference of a link, per unit of magnitude.
    pub pooled: f32,
    /// Threshold for replacing the mean by the receiver's own difference, per unit of magnitude.
    pub own: f32,
    /// Threshold for the sum of a row without links.
    pub sum: f32,
}

/// [`sparsify`] for a receiver with a neighbourhood. A link exists where the mean difference
/// exceeds ε and its noise. The link holds the receiver's own difference where the own difference
/// deviates from the mean by more than its standard deviation, and the mean otherwise. The row's
/// sum is the receiver's own sum if any link holds an own difference, and otherwise `sum`, the mean
/// sum of the neighbourhood.
pub fn sparsify_pooled(
    tally: &SparseAccumulator<4>,
    sum: f32,
    epsilon: f32,
    noise: PooledNoise,
) -> Vec<Link> {
    let mut row: Vec<Link> = Vec::new();
    let (mut sums, mut own_sum, mut has_other) = ([0f32; 4], 0f32, false);
    let (mut held, mut strongest) = (0f32, (0, 0f32));
    tally.each(|sender, more| {
        sums.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
        own_sum += more[OWN];
        if more[POOLED_MAGNITUDE] > strongest.1 {
            strongest = (sender, more[POOLED_MAGNITUDE]);
        }
        let [own, own_magnitude, pooled, magnitude] = sums;
        if pooled * pooled > (noise.pooled * magnitude).max(epsilon * epsilon) {
            let is_other = (own - pooled).powi(2) > noise.own * own_magnitude;
            let amount = if is_other { own } else { pooled };
            has_other |= is_other;
            let link = Link::pack(sender, amount);
            row.push(link);
            held += link.amount();
            // The packing error is carried over.
            sums = [amount - link.amount(), 0.0, amount - link.amount(), 0.0];
        }
    });
    // The row keeps its sum: the remainder is added to the strongest sender, and the packing error
    // to the smallest link. The strongest sender is near and of typical brightness; a lit sender
    // far away would turn the remainder into a spot.
    let left = if has_other { own_sum } else { sum } - held;
    if row.is_empty() {
        if left.abs() > LEAST_SUM * epsilon && left * left > noise.sum {
            row.push(Link::pack(strongest.0, left));
        }
        return row;
    }
    let smallest = |a: &usize, b: &usize| row[*a].amount().abs().total_cmp(&row[*b].amount().abs());
    let smallest = (0..row.len()).min_by(smallest).map(|at| row[at].sender());
    let mut left = left;
    for sender in [Some(strongest.0 as usize), smallest].into_iter().flatten() {
        let at = row.partition_point(|link| link.sender() < sender);
        if row.get(at).is_none_or(|link| link.sender() != sender) {
            row.insert(at, Link::pack(sender as u32, 0.0));
        }
        let before = row[at].amount();
        row[at] = Link::pack(sender as u32, before + left);
        left -= row[at].amount() - before;
    }
    row
}

#[cfg(test)]
mod tests {
    use super::*;

    const EPSILON: f32 = 0.01;

    /// Links of senders with these own and mean differences; the magnitude of every sender is 0.01.
    fn links(senders: &[(u32, f32, f32)], noise: f32) -> Vec<(usize, f32)> {
        let mut tally = SparseAccumulator::new(1000);
        for &(sender, own, pooled) in senders {
            tally.add_each(sender as usize, [own, 0.01, pooled, 0.01]);
        }
        let sum = senders.iter().map(|sender| sender.2).sum();
        let noise = PooledNoise { pooled: noise, own: 1.0 / 512.0, sum: noise };
        let links = sparsify_pooled(&tally, sum, EPSILON, noise);
        links.iter().map(|link| (link.sender(), link.amount())).collect()
    }

    #[test]
    fn one_receivers_noise_makes_no_link() {
        let alone: Vec<(u32, f32, f32)> =
            (0..100).map(|k| (k, if k % 7 == 0 { 0.03 } else { -0.005 }, 0.0)).collect();
        assert_eq!(links(&alone, 0.0), []);
    }

    #[test]
    fn neighbours_that_agree_make_links_that_keep_their_sum() {
        let agreed: Vec<(u32, f32, f32)> = (0..100).map(|k| (k, 0.004, 0.004)).collect();
        let found = links(&agreed, 0.0);
        assert!(found.len() > 20, "{}", found.len());
        let sum: f32 = found.iter().map(|link| link.1).sum();
        assert!((sum - 0.4).abs() < 0.01, "{sum}");
        // Equal input below its noise.
        assert_eq!(links(&agreed, 1.0), []);
    }

    #[test]
    fn a_receiver_that_differs_from_its_neighbours_says_its_own() {
        assert!((links(&[(5, 0.08, 0.02)], 0.0)[0].1 - 0.08).abs() < 0.004);
        assert!((links(&[(5, 0.021, 0.02)], 0.0)[0].1 - 0.02).abs() < 0.001);
    }
}
