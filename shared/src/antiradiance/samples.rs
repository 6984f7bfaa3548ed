//! Where the light of an element leaves from: places on it that stand for equal or known shares of its area.
//!
//! Of a patch they are the middles of smaller triangles, of a cluster those of its largest descendants.

use super::hierarchy::{CHILDREN, Hierarchy};
use super::patches::Patch;
use glam::{Vec3, Vec4};

/// Places where few are enough.
pub const FEW: usize = CHILDREN;
/// Places of elements that are wide.
pub const MANY: usize = 16;

/// Places by element: local space, and the share of the area in w. A share of 0 is no place.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Samples {
    /// Few.
    pub few: Vec<[Vec4; FEW]>,
    /// Many.
    pub many: Vec<[Vec4; MANY]>,
}

impl Samples {
    /// Those of all elements.
    pub fn new(patches: &[Patch], hierarchy: &Hierarchy) -> Self {
        let count = hierarchy.elements.len();
        let mut out = Self { few: vec![[Vec4::ZERO; FEW]; count], many: vec![[Vec4::ZERO; MANY]; count] };
        (0..count).for_each(|i| out.follow(patches, hierarchy, i));
        out
    }

    /// Computes those of an element anew.
    pub fn follow(&mut self, patches: &[Patch], hierarchy: &Hierarchy, i: usize) {
        let element = &hierarchy.elements[i];
        if element.is_patch() {
            let patch = &patches[element.first as usize];
            self.few[i] = equal(patch.quarters());
            self.many[i] = equal(patch.sixteenths());
        } else {
            self.few[i] = descendants(hierarchy, i);
            self.many[i] = descendants(hierarchy, i);
        }
    }

    /// The places of an element for `wanted` of them.
    pub fn of(&self, element: usize, wanted: usize) -> &[Vec4] {
        if wanted > FEW { &self.many[element] } else { &self.few[element] }
    }
}

fn equal<const N: usize>(places: [Vec3; N]) -> [Vec4; N] {
    places.map(|place| place.extend(1.0 / N as f32))
}

/// At most N descendants of a cluster that cover it: the largest is divided as long as its children fit.
fn descendants<const N: usize>(hierarchy: &Hierarchy, cluster: usize) -> [Vec4; N] {
    let elements = &hierarchy.elements;
    let mut chosen: Vec<usize> = elements[cluster].children().take(N).collect();
    loop {
        let fits = |i: &usize| {
            let children = elements[*i].children as usize;
            children > 0 && chosen.len() - 1 + children <= N
        };
        let largest = (0..chosen.len()).filter(|at| fits(&chosen[*at]));
        let largest =
            largest.reduce(
                |most, at| {
                    if elements[chosen[at]].area > elements[chosen[most]].area { at } else { most }
                },
            );
        let Some(at) = largest else { break };
        let divided = chosen.swap_remove(at);
        chosen.extend(elements[divided].children());
    }
    let whole = elements[cluster].area.max(f32::MIN_POSITIVE);
    let mut out = [Vec4::ZERO; N];
    for (place, i) in out.iter_mut().zip(&chosen) {
        *place = elements[*i].position.extend(elements[*i].area / whole);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    #[test]
    fn shares_are_one_and_their_mean_is_the_middle() {
        let mut stream = Stream::new(1, 9);
        let patches: Vec<Patch> =
            (0..300).map(|_| Patch::around(stream.sphere(), Vec3::Y, stream.unit(), Vec3::ONE)).collect();
        let hierarchy = Hierarchy::new(&patches);
        let samples = Samples::new(&patches, &hierarchy);
        for (i, element) in hierarchy.elements.iter().enumerate() {
            for wanted in [1, 16] {
                let places = samples.of(i, wanted);
                let share: f32 = places.iter().map(|place| place.w).sum();
                let mean: Vec3 = places.iter().map(|place| place.w * place.truncate()).sum();
                assert!((share - 1.0).abs() < 1e-4 && mean.distance(element.position) < 1e-3);
            }
        }
        assert!(samples.many[0].iter().filter(|place| place.w > 0.0).count() > 12);
    }
}
