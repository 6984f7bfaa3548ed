//! A file as an animation has it at a time: transforms of nodes and weights of morph targets, before anything else reads
//! them. Skins follow their joints.

use super::keyframes::{Curve, Motion, straight};
use super::source::Source;
use crate::io::options::{NO_ANIMATIONS, PoseOption};
use crate::scene::SceneError;
use gltf::json::animation::Animation;
use std::collections::BTreeMap;

/// Names in an error, at most.
const NAMED: usize = 16;

/// Poses all nodes that an animation moves. The first animation if the pose names none; a number counts from 0.
///
/// # Errors
/// [`SceneError::NoAnimation`], or keys that make no sense.
pub(super) fn apply(source: &mut Source, pose: &PoseOption) -> Result<(), SceneError> {
    let place = chosen(source, pose)?;
    let animation = source.root.animations[place].clone();
    let mut motions: BTreeMap<usize, Motion> = BTreeMap::new();
    let targets: Vec<(Option<usize>, String)> = source.exact.animations[place]
        .channels
        .iter()
        .map(|channel| (channel.target.node, channel.target.path.clone()))
        .collect();
    for (c, (channel, (node, path))) in animation.channels.iter().zip(targets).enumerate() {
        let what = format!("channel {c} of {:?}", name(&animation, place));
        let sampler = animation.samplers.get(channel.sampler.value());
        let sampler = sampler.ok_or_else(|| source.malformed(format!("{what} has no sampler")))?;
        let Some(node) = node.filter(|node| *node < source.root.nodes.len()) else { continue };
        let motion = motions.entry(node).or_default();
        match path.as_str() {
            "translation" => motion.translation = Some(Curve::read(source, sampler, &what)?),
            "rotation" => motion.rotation = Some(Curve::read(source, sampler, &what)?),
            "scale" => motion.scale = Some(Curve::read(source, sampler, &what)?),
            "weights" => {
                let curves = Curve::read_each(source, sampler, &what)?;
                let at = |curve: &Curve<1>| curve.at(pose.time, straight)[0] as f32;
                source.root.nodes[node].weights = Some(curves.iter().map(at).collect());
            }
            _ => {}
        }
    }
    for (node, motion) in motions {
        if motion.curves().next().is_some()
            && let Some(transform) = source.exact.nodes.get_mut(node)
        {
            transform.set_pose(motion.pose(transform.pose(), pose.time));
        }
    }
    Ok(())
}

/// Place of the animation in the file.
fn chosen(source: &Source, pose: &PoseOption) -> Result<usize, SceneError> {
    let animations = &source.root.animations;
    let found = match &pose.animation {
        None => (!animations.is_empty()).then_some(0),
        Some(wanted) => animations
            .iter()
            .position(|animation| animation.name.as_deref() == Some(wanted))
            .or_else(|| wanted.parse().ok().filter(|place| *place < animations.len())),
    };
    found.ok_or_else(|| SceneError::NoAnimation {
        file: source.file.clone(),
        wanted: pose.animation.clone().unwrap_or_default(),
        advice: match animations.len() {
            0 => NO_ANIMATIONS.to_owned(),
            _ => {
                let names = animations.iter().enumerate().take(NAMED);
                let names: Vec<String> = names.map(|(i, animation)| name(animation, i)).collect();
                format!("there are {}", names.join(", "))
            }
        },
    })
}

fn name(animation: &Animation, place: usize) -> String {
    animation.name.clone().filter(|name| !name.is_empty()).unwrap_or_else(|| place.to_string())
}
