//! Keyframes of nodes that may move, part of section `RGRP`.

use super::meta::Interpolation;
use bincode::{Decode, Encode};

/// Keyframes of nodes that are played together; those of lights with the same name belong to them
/// ([`Animation`](super::meta::Animation)).
#[derive(Clone, Debug, Default, PartialEq, Encode, Decode)]
pub struct NodeAnimation {
    /// Its glTF name.
    pub name: String,
    /// Seconds.
    pub duration: f32,
    /// Animated properties.
    pub tracks: Vec<NodeTrack>,
}

/// Keyframes of a property of a node.
#[derive(Clone, Debug, PartialEq, Encode, Decode)]
pub struct NodeTrack {
    /// Index of the node among those that may move.
    pub node: u32,
    /// Animated property.
    pub property: NodeProperty,
    /// Interpolation between keys.
    pub interpolation: Interpolation,
    /// Key times, seconds, strictly ascending; at least one key.
    pub times: Vec<f32>,
    /// [`NodeProperty::width`] numbers per key.
    pub values: Vec<f32>,
}

/// Animated property of a node: part of a [`NodeMotion`](crate::motion::NodeMotion).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Encode, Decode)]
pub enum NodeProperty {
    /// Shift, world space.
    Translation,
    /// Turn: a unit quaternion x, y, z, w. Between keys the shorter way round.
    Rotation,
}

impl NodeProperty {
    /// Number of values per key.
    pub fn width(self) -> usize {
        match self {
            Self::Translation => 3,
            Self::Rotation => 4,
        }
    }

    /// Name of the property.
    pub fn name(self) -> &'static str {
        match self {
            Self::Translation => "translation",
            Self::Rotation => "rotation",
        }
    }
}

/// Whether animations of unknown origin can be played, for so many nodes.
#[cfg(feature = "radiosity")]
pub(super) fn is_sound(animation: &NodeAnimation, nodes: usize) -> bool {
    use super::limits::sane;
    animation.duration >= 0.0
        && sane(animation.duration)
        && animation.tracks.iter().all(|track| {
            let rises = track.times.windows(2).all(|pair| pair[0] < pair[1]);
            (track.node as usize) < nodes
                && rises
                && track.times.first().is_some_and(|first| *first >= 0.0)
                && track.values.len() == track.property.width() * track.times.len()
                && track.times.iter().chain(&track.values).all(|x| sane(*x))
        })
}
