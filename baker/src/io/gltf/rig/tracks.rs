//! Keyframes of what deforms meshes, as the file has them.

use super::super::keyframes::Curve;
use super::super::node;
use super::super::notes::Told;
use super::RigBuilder;
use crate::scene::SceneError;
use gltf::json::animation::Interpolation as Kind;
use rebounce_shared::rig::{NodePose, RigAnimation, RigInterpolation, RigTarget, RigTrack};

/// The tracks of an animation of the file; `None` if it deforms nothing. Without a name it has the one that lights and nodes have
/// in it, too.
pub(super) fn of_animation(
    builder: &RigBuilder,
    place: usize,
    told: &mut Told,
) -> Result<Option<RigAnimation>, SceneError> {
    let source = builder.source;
    let animation = &source.root.animations[place];
    let name = animation.name.clone().filter(|name| !name.is_empty());
    let name = name.unwrap_or_else(|| format!("animation {place}"));
    let mut tracks = Vec::new();
    let targets = source.exact.animations[place].channels.iter().map(|channel| &channel.target);
    for (c, (channel, target)) in animation.channels.iter().zip(targets).enumerate() {
        let Some(index) = target.node.filter(|_| target.extensions.pointer.is_none()) else { continue };
        let what = format!("channel {c} of {name:?}");
        let sampler = animation.samplers.get(channel.sampler.value());
        let sampler = || sampler.ok_or_else(|| source.malformed(format!("{what} has no sampler")));
        let node = builder.nodes.get(&index).copied();
        let path = target.path.as_str();
        let track = match (path, node, builder.meshes.get(&index)) {
            ("weights", _, Some(&mesh)) => {
                let curves = Curve::<1>::read_each(source, sampler()?, &what)?;
                let targets = builder.rig.layout.meshes[mesh as usize].weights.len();
                weights(mesh, &curves, targets)
            }
            ("translation" | "rotation" | "scale", Some(node), _) => {
                let rest = &builder.rig.layout.nodes[node as usize].rest;
                if matches!(rest, NodePose::Matrix(_)) {
                    let problem = "it has a matrix, which animations cannot move";
                    told.notes.push(format!("{}: {problem}", node::name(source, index)));
                    continue;
                }
                Some(match path {
                    "translation" => {
                        track(RigTarget::Translation(node), &Curve::<3>::read(source, sampler()?, &what)?)
                    }
                    "scale" => track(RigTarget::Scale(node), &Curve::<3>::read(source, sampler()?, &what)?),
                    _ => track(RigTarget::Rotation(node), &Curve::<4>::read(source, sampler()?, &what)?),
                })
            }
            _ => None,
        };
        tracks.extend(track);
    }
    let duration = tracks.iter().filter_map(|track| track.times.last()).fold(0.0f32, |a, b| a.max(*b));
    Ok((!tracks.is_empty()).then_some(RigAnimation { name, duration, tracks }))
}

fn interpolation(kind: Kind) -> RigInterpolation {
    match kind {
        Kind::Linear => RigInterpolation::Linear,
        Kind::Step => RigInterpolation::Step,
        Kind::CubicSpline => RigInterpolation::CubicSpline,
    }
}

fn track<const W: usize>(target: RigTarget, curve: &Curve<W>) -> RigTrack {
    let row = |row: usize| curve.values[row].map(|x| x as f32).to_vec();
    assembled(target, curve.kind, &curve.times, row)
}

/// The track of a mesh's weights, from a curve for each target; targets beyond the curves have weight 0.
fn weights(mesh: u32, curves: &[Curve<1>], targets: usize) -> Option<RigTrack> {
    let first = curves.first()?;
    let row = |row: usize| {
        let weight = |t: usize| curves.get(t).map_or(0.0, |curve| curve.values[row][0] as f32);
        (0..targets).map(weight).collect()
    };
    Some(assembled(RigTarget::Weights(mesh), first.kind, &first.times, row))
}

/// Puts together the rows of a curve, one for each key, or three with splines. Keys at equal times in f32 are one.
fn assembled(target: RigTarget, kind: Kind, all: &[f64], row: impl Fn(usize) -> Vec<f32>) -> RigTrack {
    let each = if kind == Kind::CubicSpline { 3 } else { 1 };
    let (mut times, mut values): (Vec<f32>, Vec<f32>) = Default::default();
    for (key, time) in all.iter().map(|time| *time as f32).enumerate() {
        if times.last().is_none_or(|last| *last < time) {
            times.push(time);
            values.extend((each * key..each * (key + 1)).flat_map(&row));
        }
    }
    RigTrack { target, interpolation: interpolation(kind), times, values }
}
