//! Which of what a receiver gets becomes a link.

use super::tally::{Packed, Tally};

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
pub fn choose<A: Packed>(
    gathered: &Tally<A>,
    prediction: Option<&Tally<A>>,
    epsilon: f32,
    noise: f32,
) -> Vec<A::Link> {
    let mut row = Vec::new();
    let (mut carried, mut seen) = (A::default(), 0.0);
    // Place, sender and contents of the last link and of the smallest before it.
    let (mut last, mut smallest) = ((0, 0, A::default()), None::<(usize, u32, A)>);
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
            let (link, held) = carried.pack(sender);
            row.push(link);
            // What packing lost is carried over too.
            carried.add_scaled(-1.0, &held);
            if row.len() > 1 && smallest.is_none_or(|s| last.2.magnitude_squared() < s.2.magnitude_squared())
            {
                smallest = Some(last);
            }
            last = (row.len() - 1, sender, held);
            seen = 0.0;
        }
    }
    if let Some(link) = row.last_mut() {
        carried.add_scaled(1.0, &last.2);
        let (packed, held) = carried.pack(last.1);
        *link = packed;
        // What packing lost at the end goes where it is lost least: to the smallest link.
        if let Some((at, sender, mut amount)) = smallest {
            amount.add_scaled(1.0, &carried);
            amount.add_scaled(-1.0, &held);
            row[at] = amount.pack(sender).0;
        }
    } else if carried.magnitude_squared() > (LEAST_SUM * epsilon).powi(2) {
        row.push(carried.pack(strongest.0).0);
    }
    row
}
