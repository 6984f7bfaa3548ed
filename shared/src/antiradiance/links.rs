//! Links: which elements exchange light (antiradiance paper, section 3.2).
//!
//! The oracle: elements exchange light as wholes where both are narrower than a bin, seen from each other. The paper asks
//! for the sender alone; a wide receiver next to a narrow sender would spread its light over all of its area. Light is not
//! asked for, so that links stay when lights move.

use super::bins::Bins;
use super::hierarchy::Hierarchy;
use super::patches::Patch;
use glam::Vec3;
use std::f32::consts::PI;

/// Sine of the least angle above a patch's plane at which light comes to it.
pub const GRAZING: f32 = 1e-3;

/// Links by receiver.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Links {
    /// First link of each element, and the number of links at the end.
    pub offsets: Vec<u32>,
    /// Senders.
    pub senders: Vec<u32>,
}

impl Links {
    /// Refines from the root. `width` is the greatest solid angle of an element of a link, in bins.
    pub fn new(patches: &[Patch], hierarchy: &Hierarchy, bins: &Bins, width: f32) -> Self {
        let root = if hierarchy.elements.is_empty() { Vec::new() } else { vec![[0, 0]] };
        Self::between(patches, hierarchy, bins, width, root)
    }

    /// Refines from pairs of elements; a pair of one element twice is all light within it.
    pub fn between(
        patches: &[Patch],
        hierarchy: &Hierarchy,
        bins: &Bins,
        width: f32,
        open: Vec<[usize; 2]>,
    ) -> Self {
        let mut pairs = Pairs { open, found: Vec::new() };
        pairs.refine(patches, (hierarchy, bins), width, usize::MAX);
        Self::of_pairs(hierarchy.elements.len(), &pairs.found)
    }

    /// Sorts pairs of receiver and sender by receiver.
    pub(super) fn of_pairs(elements: usize, pairs: &[[u32; 2]]) -> Self {
        let mut offsets = vec![0u32; elements + 1];
        pairs.iter().for_each(|[receiver, _]| offsets[*receiver as usize + 1] += 1);
        for i in 0..elements {
            offsets[i + 1] += offsets[i];
        }
        let mut next = offsets.clone();
        let mut senders = vec![0; pairs.len()];
        for [receiver, sender] in pairs {
            let at = &mut next[*receiver as usize];
            senders[*at as usize] = *sender;
            *at += 1;
        }
        Self { offsets, senders }
    }

    /// Number of links.
    pub fn count(&self) -> usize {
        self.senders.len()
    }

    /// Senders of a receiver.
    pub fn of(&self, receiver: usize) -> &[u32] {
        &self.senders[self.offsets[receiver] as usize..self.offsets[receiver + 1] as usize]
    }
}

/// An unfinished refinement.
#[derive(Clone, Debug, Default)]
pub(super) struct Pairs {
    /// Pairs that are not refined yet.
    pub open: Vec<[usize; 2]>,
    /// Receivers and senders of links.
    pub found: Vec<[u32; 2]>,
}

impl Pairs {
    /// Refines at most `most` pairs.
    pub fn refine(
        &mut self,
        patches: &[Patch],
        (hierarchy, bins): (&Hierarchy, &Bins),
        width: f32,
        most: usize,
    ) {
        Oracle { patches, hierarchy, most: width * bins.solid_angle() }.refine(self, most);
    }
}

/// The refinement oracle.
struct Oracle<'a> {
    patches: &'a [Patch],
    hierarchy: &'a Hierarchy,
    /// Greatest solid angle of an element, sr.
    most: f32,
}

impl Oracle<'_> {
    fn refine(&self, Pairs { open, found }: &mut Pairs, most: usize) {
        let elements = &self.hierarchy.elements;
        for _ in 0..most {
            let Some([a, b]) = open.pop() else { return };
            if a == b {
                // Light within a cluster goes between its children.
                let children = elements[a].children();
                for i in children.clone() {
                    open.push([i, i]);
                    open.extend((i + 1..children.end).map(|j| [i, j]));
                }
                continue;
            }
            let divided = if self.is_narrow(a, b) { None } else { self.divided(a, b) };
            if let Some(divided) = divided {
                let other = if divided == a { b } else { a };
                open.extend(elements[divided].children().map(|child| [child, other]));
                continue;
            }
            for [receiver, sender] in [[a, b], [b, a]] {
                if self.receives(receiver, sender) {
                    found.push([receiver as u32, sender as u32]);
                }
            }
        }
    }

    /// Whether both are narrower than a bin.
    fn is_narrow(&self, a: usize, b: usize) -> bool {
        let [a, b] = [a, b].map(|i| &self.hierarchy.elements[i]);
        let wider = a.radius.max(b.radius);
        PI * wider * wider < self.most * a.position.distance_squared(b.position)
    }

    /// The one of a pair to divide: the wider that is a cluster.
    fn divided(&self, a: usize, b: usize) -> Option<usize> {
        let elements = &self.hierarchy.elements;
        let clusters = [a, b].into_iter().filter(|i| !elements[*i].is_patch());
        clusters.reduce(|most, i| if elements[i].radius > elements[most].radius { i } else { most })
    }

    /// Whether light of the sender can come to the front of the receiver.
    fn receives(&self, receiver: usize, sender: usize) -> bool {
        let [receiver, sender] = [receiver, sender].map(|i| &self.hierarchy.elements[i]);
        if !receiver.is_flat() {
            return true;
        }
        let normal = receiver.normal;
        let above = |place: Vec3| {
            let way = place - receiver.position;
            normal.dot(way) > GRAZING * way.length()
        };
        if sender.is_patch() {
            self.patches[sender.first as usize].corners.into_iter().any(above)
        } else if sender.normal == normal {
            // Of one plane or of two.
            above(sender.position)
        } else {
            normal.dot(sender.position - receiver.position) > -sender.radius
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    /// Patches that all face everything: on a ball, facing inwards.
    fn ball(count: usize) -> Vec<Patch> {
        let mut stream = Stream::new(1, 5);
        let patch = |at: Vec3| Patch::around(at, -at, 12.0 / count as f32, Vec3::ONE);
        (0..count).map(|_| patch(stream.sphere())).collect()
    }

    #[test]
    fn every_pair_of_patches_is_linked_once_at_some_level() {
        let patches = ball(120);
        let hierarchy = Hierarchy::new(&patches);
        let links = Links::new(&patches, &hierarchy, &Bins::new(128), 1.0);
        let elements = &hierarchy.elements;
        let chain = |patch: usize| {
            let first = hierarchy.element_of[patch] as usize;
            std::iter::successors(Some(first), |i| {
                elements.get(elements[*i].parent as usize).map(|_| elements[*i].parent as usize)
            })
        };
        for a in 0..patches.len() {
            for b in (0..patches.len()).filter(|b| *b != a) {
                let senders: Vec<usize> = chain(b).collect();
                let found: usize = chain(a)
                    .map(|i| {
                        links.of(i).iter().filter(|sender| senders.contains(&(**sender as usize))).count()
                    })
                    .sum();
                assert_eq!(found, 1, "{a} {b}");
            }
        }
    }

    #[test]
    fn elements_of_links_are_narrow_and_clusters_save_links() {
        let patches = ball(2000);
        let (hierarchy, bins) = (Hierarchy::new(&patches), Bins::new(64));
        let links = Links::new(&patches, &hierarchy, &bins, 1.0);
        let elements = &hierarchy.elements;
        for receiver in 0..elements.len() {
            for sender in links.of(receiver) {
                let sender = &elements[*sender as usize];
                let receiver = &elements[receiver];
                let square = sender.position.distance_squared(receiver.position);
                let angle = PI * sender.radius.max(receiver.radius).powi(2) / square;
                assert!(angle < bins.solid_angle() || sender.is_patch() && receiver.is_patch());
            }
        }
        assert!(links.count() < 2000 * 2000 / 4, "{}", links.count());
    }

    #[test]
    fn patches_of_one_plane_have_no_links() {
        let patches: Vec<Patch> = (0..100)
            .map(|i| Patch::around(Vec3::new((i / 10) as f32, 0.0, (i % 10) as f32), Vec3::Y, 1.0, Vec3::ONE))
            .collect();
        let hierarchy = Hierarchy::new(&patches);
        let links = Links::new(&patches, &hierarchy, &Bins::new(1024), 0.01);
        assert_eq!(links.count(), 0);
    }
}
