//! Fewer links in a row: the smallest give their light to the nearest others.

use glam::Vec3;
use rebounce_shared::rbn::gloss_links::GlossLink;

/// A link before it is packed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LinkSum {
    /// The sender's index.
    pub sender: u32,
    /// Integral of radiance over solid angle for unit light of the sender.
    pub amount: f32,
    /// Integral of the direction by the same measure.
    pub directions: Vec3,
}

/// Adds up links of the same sender; the result ascends by sender.
pub(super) fn by_sender(mut links: Vec<LinkSum>) -> Vec<LinkSum> {
    // Stable, so that the order of sums is that of the rays.
    links.sort_by_key(|link| link.sender);
    links.dedup_by(|next, kept| {
        let is_same = next.sender == kept.sender;
        if is_same {
            kept.amount += next.amount;
            kept.directions += next.directions;
        }
        is_same
    });
    links
}

/// Merges links until at most `most` are left: the smallest is added to the one whose sender is nearest by `distance`, which
/// keeps its sender. The sums of amounts and of directions stay.
pub(super) fn merged(
    mut links: Vec<LinkSum>,
    most: usize,
    distance: impl Fn(u32, u32) -> f32,
) -> Vec<LinkSum> {
    while links.len() > most.max(1) {
        let least = links.iter().enumerate().min_by(|a, b| a.1.amount.total_cmp(&b.1.amount));
        let Some(least) = least.map(|(place, _)| place) else { break };
        let small = links.remove(least);
        let nearest = links
            .iter_mut()
            .min_by(|a, b| distance(small.sender, a.sender).total_cmp(&distance(small.sender, b.sender)));
        if let Some(nearest) = nearest {
            nearest.amount += small.amount;
            nearest.directions += small.directions;
        }
    }
    links
}

/// Packs a row. Rounding errors of amounts are carried over to the next link, so that the row's sum stays.
pub(super) fn packed(links: &[LinkSum]) -> Vec<GlossLink> {
    let mut carried = 0.0;
    let pack = |link: &LinkSum| {
        let wanted = link.amount + carried;
        let length = link.directions.length() / link.amount;
        let direction = link.directions.try_normalize()?;
        let out = GlossLink::pack(link.sender, direction, wanted, length);
        carried = wanted - out.amount();
        (out.amount() > 0.0).then_some(out)
    };
    links.iter().filter_map(pack).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    fn row(seed: u64) -> Vec<LinkSum> {
        let mut stream = Stream::new(seed, 0);
        let link = |_| {
            let amount = 1e-3 + stream.unit() * 0.02;
            let sender = (stream.unit() * 300.0) as u32;
            LinkSum { sender, amount, directions: stream.sphere() * (amount * stream.unit().max(0.1)) }
        };
        (0..900).map(link).collect()
    }

    fn sums(links: &[LinkSum]) -> (f32, Vec3) {
        links.iter().fold((0.0, Vec3::ZERO), |(a, d), link| (a + link.amount, d + link.directions))
    }

    #[test]
    fn merging_keeps_the_sums_of_a_row_and_packing_that_of_the_amounts() {
        for seed in 0..8 {
            let all = row(seed);
            let (amount, directions) = sums(&all);
            let by_sender = by_sender(all);
            assert!(by_sender.is_sorted_by(|a, b| a.sender < b.sender));
            let merged = merged(by_sender, 60, |a, b| a.abs_diff(b) as f32);
            assert_eq!(merged.len(), 60);
            let (kept, kept_directions) = sums(&merged);
            assert!((kept / amount - 1.0).abs() < 1e-4 && kept_directions.distance(directions) < 1e-3);
            let packed = packed(&merged);
            let sum: f32 = packed.iter().map(|link| link.amount()).sum();
            // What is carried past the end is at most half a code of the last link.
            assert!((sum / amount - 1.0).abs() < 0.002, "{sum}, not {amount}");
        }
    }

    #[test]
    fn a_small_link_goes_to_the_nearest_sender() {
        let link = |sender, amount| LinkSum { sender, amount, directions: amount * Vec3::X };
        let links = vec![link(3, 1.0), link(10, 0.1), link(12, 2.0)];
        let merged = merged(links, 2, |a, b| a.abs_diff(b) as f32);
        assert_eq!(merged.iter().map(|link| link.sender).collect::<Vec<_>>(), [3, 12]);
        assert!((merged[1].amount - 2.1).abs() < 1e-6);
    }
}
