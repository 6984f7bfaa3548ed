//! Which of what a receiver gets becomes a link.

use super::tally::Tally;
use rebounce_shared::link::Link;

/// What is left of a row without links is one link if it is at least this share of ε: else a few such rows,
/// one under the other, would lose a noticeable part of the light.
const LEAST_SUM: f32 = 0.125;

/// The criterion of Fig. 5, ε, and two changes to it: a link must stand out of its own noise,
/// and what is dropped is carried over to the next sender along the space-filling curve until
/// it adds up to a link. So a row keeps its sum, and what a dropped link would have said is
/// said by a neighbour: senders that are too small to matter one by one act as one.
///
/// `of` says of a sender's sums what it gives and what coarser receivers expect it to give; the links are for the first
/// less the second. `noise` is the variance of a gathered sum per unit of it.
pub fn choose<const N: usize>(
    tally: &Tally<N>,
    of: impl Fn([f32; N]) -> (f32, f32),
    epsilon: f32,
    noise: f32,
) -> Vec<Link> {
    let mut row: Vec<Link> = Vec::new();
    let (mut carried, mut seen) = (0f32, 0f32);
    // Place, sender and amount of the last link and of the smallest before it.
    let (mut last, mut smallest) = ((0, 0, 0f32), None::<(usize, u32, f32)>);
    let mut strongest = (0, 0.0);
    tally.each(|sender, sums| {
        let (sum, expected) = of(sums);
        carried = carried + sum - expected;
        if sum > strongest.1 {
            strongest = (sender, sum);
        }
        // Rays that by chance all miss a small sender say as little as those that by chance hit it often:
        // what coarser receivers expect counts, too.
        let expected = sum.abs().max(expected.abs());
        if noise > 0.0 {
            seen += expected;
        }
        if carried * carried > (noise * seen).max(epsilon * epsilon) {
            let link = Link::pack(sender, carried);
            let held = link.amount();
            row.push(link);
            // What packing lost is carried over too.
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
        // What packing lost at the end goes where it is lost least: to the smallest link.
        if let Some((at, sender, amount)) = smallest {
            row[at] = Link::pack(sender, amount + carried - held);
        }
    } else if carried.abs() > LEAST_SUM * epsilon {
        row.push(Link::pack(strongest.0, carried));
    }
    row
}
