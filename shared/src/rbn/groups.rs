//! Reconstruction groups and the nodes that may move: section `RGRP`, bincode 2 standard configuration, and sections `MGRP`
//! and `PGRP`, the group of each material and of each point. Optional: without them all surfaces are group 0 and nothing
//! moves. A picture needs the groups of materials and points alone; without the feature `radiosity` nothing else is read.
//!
//! A function belongs to one reconstruction group and never reaches a surface of another (Lehtinen et al. 2007, *Meshless
//! Finite Elements for Hierarchical Global Illumination*, 6.1). Group 0 has all surfaces that no other group has. A material
//! belongs to one group: where several groups share a look, each has a material of its own.
//!
//! A group with a node moves rigidly with it: its triangles stand at [instances](super::bulk::Instance) of their own, which
//! the node's motion changes, and its points stay in the place that the file has them in.

use super::limits::MAX_BYTES;
#[cfg(feature = "radiosity")]
use super::limits::sane;
#[cfg(feature = "radiosity")]
use super::node_tracks;
use super::node_tracks::NodeAnimation;
use super::{RbnError, small};
use bincode::{Decode, Encode};

/// Greatest number of groups besides group 0: a number has ten bits beside a function's.
pub const MAX_GROUPS: usize = 1023;
/// Greatest density of a group, in either direction.
pub const MAX_DENSITY: f32 = 1024.0;

/// Reconstruction groups of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Groups {
    /// Nodes that may move, parents before children.
    pub nodes: Vec<Node>,
    /// Groups 1, 2, …; group 0 has no record.
    pub groups: Vec<Group>,
    /// Mean share of light that goes through each material; materials beyond the end are opaque.
    pub transmittance: Vec<f32>,
    /// Keyframes of the nodes.
    pub animations: Vec<NodeAnimation>,
    /// Group of each material, section `MGRP`; materials beyond the end are of group 0. Empty where there is no other.
    pub of_material: Vec<u32>,
}

/// A node that may move.
#[derive(Clone, Debug, Default, PartialEq, Encode, Decode)]
pub struct Node {
    /// Name; not unique.
    pub name: String,
    /// Index of the nearest node above that may move.
    pub parent: Option<u32>,
    /// Origin, about which it turns; world space.
    pub origin: [f64; 3],
}

/// A reconstruction group.
#[derive(Clone, Debug, Default, PartialEq, Encode, Decode)]
pub struct Group {
    /// Name.
    pub name: String,
    /// Functions for an area, relative to group 0.
    pub density: f32,
    /// Index of the node that it moves with; `None` for surfaces that stay.
    pub node: Option<u32>,
}

impl Groups {
    /// Whether there is no group besides group 0.
    pub fn is_empty(&self) -> bool {
        self.of_material.is_empty()
    }

    /// Group of a material.
    #[inline]
    pub fn of_material(&self, material: u32) -> u32 {
        self.of_material.get(material as usize).copied().unwrap_or(0)
    }

    /// Mean share of light that goes through a material.
    #[inline]
    pub fn transmittance_of(&self, material: u32) -> f32 {
        self.transmittance.get(material as usize).copied().unwrap_or(0.0)
    }

    /// Functions for an area in a group, relative to group 0.
    pub fn density(&self, group: u32) -> f32 {
        group.checked_sub(1).map_or(1.0, |group| self.groups[group as usize].density)
    }

    /// Node that a group moves with.
    pub fn node_of(&self, group: u32) -> Option<u32> {
        self.groups[group.checked_sub(1)? as usize].node
    }
}

/// Encodes section `RGRP`; `None` without groups.
///
/// # Errors
/// [`RbnError::TooLarge`] past [`MAX_BYTES`].
pub fn encode(groups: &Groups) -> Result<Option<Vec<u8>>, RbnError> {
    if *groups == Groups::default() {
        return Ok(None);
    }
    let Groups { nodes, groups, transmittance, animations, .. } = groups;
    let too_large =
        || format!("names and keyframes of nodes that may move need over {MAX_BYTES} bytes: shorten them");
    small::encode((nodes, groups, transmittance, animations), too_large).map(Some)
}

/// Contents of section `RGRP`.
#[cfg(feature = "radiosity")]
type GroupRecord = (Vec<Node>, Vec<Group>, Vec<f32>, Vec<NodeAnimation>);

/// Decodes section `RGRP`, for materials of these groups; the caller checks it.
///
/// # Errors
/// [`RbnError::Invalid`].
#[cfg(feature = "radiosity")]
pub fn decode(bytes: &[u8], of_material: Vec<u32>) -> Result<Groups, RbnError> {
    let (nodes, groups, transmittance, animations): GroupRecord = small::decode("RGRP", bytes)?;
    Ok(Groups { nodes, groups, transmittance, animations, of_material })
}

/// Checks groups of unknown origin, with the group of each point.
///
/// # Errors
/// [`RbnError::Invalid`].
#[cfg(feature = "radiosity")]
pub(crate) fn check(
    groups: &Groups,
    point_groups: &[u32],
    points: usize,
    materials: usize,
) -> Result<(), RbnError> {
    let is_group = |group: &u32| *group as usize <= groups.groups.len();
    let is_parent = |(i, node): (usize, &Node)| {
        node.parent.is_none_or(|parent| (parent as usize) < i) && node.origin.iter().all(|x| x.abs() < 1e30)
    };
    let is_sound = |group: &Group| {
        group.node.is_none_or(|node| (node as usize) < groups.nodes.len())
            && sane(group.density)
            && (1.0 / MAX_DENSITY..=MAX_DENSITY).contains(&group.density)
    };
    let sound = groups.groups.len() <= MAX_GROUPS
        && groups.is_empty() == groups.groups.is_empty()
        && groups.nodes.iter().enumerate().all(is_parent)
        && groups.groups.iter().all(is_sound)
        && groups.of_material.len() <= materials
        && groups.of_material.iter().all(is_group)
        && groups.transmittance.len() <= materials
        && groups.transmittance.iter().all(|share| (0.0..=1.0).contains(share))
        && groups.animations.iter().all(|animation| node_tracks::is_sound(animation, groups.nodes.len()));
    if !sound {
        return Err(RbnError::invalid("RGRP", "a group, or a node that may move"));
    }
    let fits = if groups.is_empty() { point_groups.is_empty() } else { point_groups.len() == points };
    if !fits || !point_groups.iter().all(is_group) {
        return Err(RbnError::invalid("PGRP", "it does not fit points and groups"));
    }
    Ok(())
}
