//! Which of what a receiver gets becomes a link.

use super::tally::{Amount, Tally};
use rebounce_shared::link::{Link, RowWriter};

/// What is left of a row without links is one link if it is at least this share of ε: else a few such rows,
/// one under the other, would lose a noticeable part of the light.
const LEAST_SUM: f32 = 0.125;

/// The criterion of Fig. 5, ε, and two changes to it: a link must stand out of its own noise,
/// and what is dropped is carried over to the next sender along the space-filling curve until
/// it adds up to a link. So a row keeps its sum, and what a dropped link would have said is
/// said by a neighbour: senders that are too small to matter one by one act as one.
///
/// Gives the links for `gathered` less `prediction`; `noise` is the variance of a gathered sum per
/// unit of it.
pub fn choose<A: Amount>(
    gathered: &Tally<A>,
    prediction: Option<&Tally<A>>,
    epsilon: f32,
    noise: f32,
    pack: impl Fn(&A) -> (Link, A),
) -> Vec<Link> {
    let mut row = Vec::new();
    let mut writer = RowWriter::default();
    let (mut carried, mut held_last, mut seen) = (A::default(), A::default(), 0.0);
    let mut strongest = (0, 0.0);
    for sender in gathered.touched_with(prediction) {
        let sum = gathered.get(sender);
        carried.add_scaled(1.0, sum);
        let strength = sum.magnitude_squared();
        if strength > strongest.1 {
            strongest = (sender, strength);
        }
        // Rays that by chance all miss a small sender say as little as those that by chance hit it often:
        // what coarser receivers expect counts, too.
        let mut expected = strength;
        if let Some(prediction) = prediction {
            let sum = prediction.get(sender);
            carried.add_scaled(-1.0, sum);
            expected = expected.max(sum.magnitude_squared());
        }
        if noise > 0.0 {
            seen += expected.sqrt();
        }
        if carried.magnitude_squared() > (noise * seen).max(epsilon * epsilon) {
            let (link, held) = pack(&carried);
            writer.push(&mut row, sender, link);
            // What packing lost is carried over too.
            carried.add_scaled(-1.0, &held);
            held_last = held;
            seen = 0.0;
        }
    }
    if let Some(last) = row.last_mut() {
        carried.add_scaled(1.0, &held_last);
        *last = pack(&carried).0.at(last.column());
    } else if carried.magnitude_squared() > (LEAST_SUM * epsilon).powi(2) {
        writer.push(&mut row, strongest.0, pack(&carried).0);
    }
    row
}
