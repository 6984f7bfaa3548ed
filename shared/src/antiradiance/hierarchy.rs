//! Hierarchy of elements: patches, and clusters above them (antiradiance paper, section 3.2).
//!
//! Breadth first: levels are ranges, children follow each other, a parent comes before its children. Push and pull go
//! level by level, each element of a level by itself; the paper's order is depth first.
//!
//! Normals divide before places do, so that a wide cluster faces one way: one around an edge of two walls would send the
//! antiradiance of each wall along the wall itself, where it is mistaken for a shadow.

use super::patches::Patch;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use std::ops::Range;

/// Most children of a cluster.
pub const CHILDREN: usize = 4;
/// Index of no element.
pub const NONE: u32 = u32::MAX;

/// A patch or a cluster.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Element {
    /// Middle: of a cluster, the mean of its patches by area. Local space.
    pub position: Vec3,
    /// Greatest distance of its surface from the middle.
    pub radius: f32,
    /// Unit normal of all its patches; zero where they differ.
    pub normal: Vec3,
    /// Area of all its patches, square scene units.
    pub area: f32,
    /// Index of the cluster it is in; [`NONE`] of the root.
    pub parent: u32,
    /// Of a cluster, the first child; of a patch, its index in the patches.
    pub first: u32,
    /// Number of children; 0 of a patch.
    pub children: u32,
    /// Of a glossy patch, its number among them; [`NONE`] of all else.
    pub glossy: u32,
}

/// Greatest difference of the normals of a cluster along an axis, above which they divide it.
const SPREAD: f32 = 0.5;
/// Cosine of normals that count as one.
const SAME: f32 = 0.999_99;

impl Element {
    /// Whether it is a patch.
    pub fn is_patch(&self) -> bool {
        self.children == 0
    }

    /// Whether all of it faces one way.
    pub fn is_flat(&self) -> bool {
        self.normal != Vec3::ZERO
    }

    /// Indices of the children.
    pub fn children(&self) -> Range<usize> {
        let first = self.first as usize;
        if self.is_patch() { 0..0 } else { first..first + self.children as usize }
    }
}

/// All elements.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hierarchy {
    /// Elements, the root first, level after level.
    pub elements: Vec<Element>,
    /// First element of each level, and the number of elements at the end.
    pub levels: Vec<u32>,
    /// Element of each patch.
    pub element_of: Vec<u32>,
}

impl Hierarchy {
    /// Clusters patches: halves by their normals, then by the longest side of the box of their middles, twice for each level.
    pub fn new(patches: &[Patch]) -> Self {
        Self::parted(patches, patches.len())
    }

    /// As [`Self::new`], with the first `still` patches in one child of the root, element 1, and all others in another, 2; all
    /// in the root where there is nothing else.
    pub fn parted(patches: &[Patch], still: usize) -> Self {
        let is_parted = still > 0 && still < patches.len();
        let mut out = Self { element_of: vec![NONE; patches.len()], ..Self::default() };
        if patches.is_empty() {
            out.levels.push(0);
            return out;
        }
        let places: Vec<[Vec3; 2]> = patches.iter().map(|patch| [patch.position(), patch.normal]).collect();
        let mut order: Vec<u32> = (0..patches.len() as u32).collect();
        let glossy = glossy_numbers(patches);
        let mut level = vec![(NONE, 0..patches.len())];
        while !level.is_empty() {
            out.levels.push(out.elements.len() as u32);
            let begin = out.elements.len();
            let mut next = Vec::new();
            for (at, (parent, range)) in level.iter().enumerate() {
                let own = (begin + at) as u32;
                let mut element = Element { parent: *parent, glossy: NONE, ..Element::default() };
                if range.len() == 1 {
                    element.first = order[range.start];
                    element.glossy = glossy[element.first as usize];
                    out.element_of[element.first as usize] = own;
                } else {
                    let parts = match own {
                        0 if is_parted => vec![0..still, still..patches.len()],
                        _ => quarters(&places, &mut order, range.clone()),
                    };
                    element.first = (begin + level.len() + next.len()) as u32;
                    element.children = parts.len() as u32;
                    next.extend(parts.into_iter().map(|part| (own, part)));
                }
                measure(&mut element, patches, order[range.clone()].iter());
                out.elements.push(element);
            }
            level = next;
        }
        out.levels.push(out.elements.len() as u32);
        out
    }

    /// Measures elements anew after their patches have moved, given by their rising indices. Clusters keep their children.
    pub fn follow(&mut self, patches: &[Patch], moved: &[u32]) {
        let mut own = vec![Vec::new(); self.elements.len()];
        for i in moved.iter().rev().map(|i| *i as usize) {
            let mut element = self.elements[i];
            if element.is_patch() {
                own[i] = vec![element.first];
            }
            measure(&mut element, patches, own[i].iter());
            self.elements[i] = element;
            let patches = std::mem::take(&mut own[i]);
            if let Some(parent) = own.get_mut(element.parent as usize) {
                parent.extend(patches);
            }
        }
    }

    /// Elements of a level.
    pub fn level(&self, level: usize) -> Range<usize> {
        self.levels[level] as usize..self.levels[level + 1] as usize
    }

    /// Number of levels.
    pub fn depth(&self) -> usize {
        self.levels.len().saturating_sub(1)
    }
}

/// By patch, its number among the glossy ones; [`NONE`] of matt ones.
fn glossy_numbers(patches: &[Patch]) -> Vec<u32> {
    let mut count = 0;
    let number = |patch: &Patch| match patch.roughness {
        Some(_) => {
            count += 1;
            count - 1
        }
        None => NONE,
    };
    patches.iter().map(number).collect()
}

/// Up to four parts of a range of the order, none empty. `places` are middles and normals.
fn quarters(places: &[[Vec3; 2]], order: &mut [u32], range: Range<usize>) -> Vec<Range<usize>> {
    let [low, high] = halves(places, order, range);
    let mut parts = Vec::with_capacity(CHILDREN);
    for half in [low, high] {
        if half.len() > 1 {
            parts.extend(halves(places, order, half));
        } else {
            parts.push(half);
        }
    }
    parts
}

/// Divides a range of at least two: by the middle of the normals where they differ, else at the median of places.
fn halves(places: &[[Vec3; 2]], order: &mut [u32], range: Range<usize>) -> [Range<usize>; 2] {
    let own = &mut order[range.clone()];
    let [middles, normals] = [0, 1].map(|which| longest(own.iter().map(|i| places[*i as usize][which])));
    let divided = if normals.size > SPREAD {
        let component = |i: &u32| places[*i as usize][1][normals.axis];
        own.sort_unstable_by(|a, b| component(a).total_cmp(&component(b)).then_with(|| a.cmp(b)));
        own.partition_point(|i| component(i) < normals.middle).clamp(1, own.len() - 1)
    } else {
        let component = |i: &u32| places[*i as usize][0][middles.axis];
        let middle = own.len() / 2;
        own.select_nth_unstable_by(middle, |a, b| {
            component(a).total_cmp(&component(b)).then_with(|| a.cmp(b))
        });
        middle
    };
    [range.start..range.start + divided, range.start + divided..range.end]
}

/// The longest side of the box of some vectors.
struct Longest {
    axis: usize,
    size: f32,
    middle: f32,
}

fn longest(vectors: impl Iterator<Item = Vec3>) -> Longest {
    let (low, high) =
        vectors.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), own| (low.min(own), high.max(own)));
    let size = high - low;
    let axis = (0..3).fold(0, |most, axis| if size[axis] > size[most] { axis } else { most });
    Longest { axis, size: size[axis], middle: 0.5 * (low[axis] + high[axis]) }
}

/// Sets area, middle, radius and normal from these patches.
fn measure<'a>(element: &mut Element, patches: &[Patch], own: impl Iterator<Item = &'a u32> + Clone) {
    let own = || own.clone().map(|i| &patches[*i as usize]);
    element.area = own().map(Patch::area).sum();
    let sum: Vec3 = own().map(|patch| patch.area() * patch.position()).sum();
    let plain: Vec3 = own().map(Patch::position).sum::<Vec3>() / own().count().max(1) as f32;
    element.position = if element.area > 0.0 { sum / element.area } else { plain };
    let far = own().flat_map(|patch| patch.corners).map(|corner| corner.distance_squared(element.position));
    element.radius = far.fold(0.0, f32::max).sqrt();
    let first = own().next().map_or(Vec3::ZERO, |patch| patch.normal);
    element.normal = if own().all(|patch| patch.normal.dot(first) > SAME) { first } else { Vec3::ZERO };
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    #[test]
    fn clusters_hold_their_children_and_areas_add_up() {
        let mut stream = Stream::new(1, 7);
        let patches: Vec<Patch> =
            (0..1000).map(|_| Patch::around(stream.sphere(), Vec3::Y, 0.01, Vec3::ONE)).collect();
        let hierarchy = Hierarchy::new(&patches);
        let elements = &hierarchy.elements;
        assert_eq!(elements.iter().filter(|element| element.is_patch()).count(), 1000);
        assert!(elements.len() < 1400);
        for (i, element) in elements.iter().enumerate().filter(|(_, element)| !element.is_patch()) {
            let children = || elements[element.children()].iter();
            assert!(children().all(|child| child.parent as usize == i));
            let area: f32 = children().map(|child| child.area).sum();
            assert!((area - element.area).abs() < 1e-3 * area);
            assert!(children().all(|child| child.position.distance(element.position) < element.radius));
        }
        for (i, own) in hierarchy.element_of.iter().enumerate() {
            assert_eq!(elements[*own as usize].first as usize, i);
        }
        let levels = (0..hierarchy.depth()).map(|level| hierarchy.level(level).len());
        assert_eq!(levels.sum::<usize>(), elements.len());
    }

    #[test]
    fn one_patch_and_none_are_hierarchies() {
        assert_eq!(Hierarchy::new(&[]).depth(), 0);
        let one = Hierarchy::new(&[Patch::around(Vec3::ONE, Vec3::X, 1.0, Vec3::ONE)]);
        assert!(one.elements.len() == 1 && one.depth() == 1 && one.elements[0].is_patch());
    }
}
