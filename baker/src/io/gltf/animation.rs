//! Conversion of keyframes of nodes and lights to world-space keyframes of the scene's lights, and of nodes that may move.

use super::keyframes::{Curve, Motion, fill, key_times, straight, world_at};
use super::node::{PlacedNode, placement};
use super::node_animation;
use super::source::Source;
use crate::scene::SceneError;
use glam::DMat4;
use gltf::json::animation::{Interpolation as Kind, Sampler};
use rebounce_shared::rbn::LARGEST;
use rebounce_shared::rbn::meta::{Animation, Interpolation, Property, Track};
use rebounce_shared::rbn::node_tracks::NodeAnimation;

/// What animations may move.
pub(super) struct Animated<'a> {
    /// Nodes of the scene.
    pub(super) nodes: &'a [PlacedNode],
    /// Lights in scene order: index of the light's node in `nodes`, and the glTF light.
    pub(super) lights: &'a [(usize, usize)],
    /// Of each node, its place among those that may move.
    pub(super) places: &'a [Option<u32>],
    /// Of each animation, whether it deforms a mesh.
    pub(super) deform: &'a [bool],
}

/// Returns the animations of lights, and of nodes that may move. Those of other geometry are left out: the bake holds it still.
pub(super) fn animations(
    source: &Source,
    animated: &Animated,
    left_out: &mut Vec<String>,
) -> Result<(Vec<Animation>, Vec<NodeAnimation>), SceneError> {
    let Animated { nodes, lights, places, deform } = *animated;
    let (mut out, mut of_nodes) = (Vec::new(), Vec::new());
    for (a, animation) in source.root.animations.iter().enumerate() {
        let name = animation.name.clone().filter(|name| !name.is_empty());
        let name = name.unwrap_or_else(|| format!("animation {a}"));
        let mut motions: Vec<Motion> = nodes.iter().map(|_| Motion::default()).collect();
        let mut tracks = Vec::new();
        let targets = source.exact.animations[a].channels.iter().map(|channel| &channel.target);
        for (c, (channel, target)) in animation.channels.iter().zip(targets).enumerate() {
            let what = format!("channel {c} of {name:?}");
            let sampler = animation.samplers.get(channel.sampler.value());
            let sampler = sampler.ok_or_else(|| source.malformed(format!("{what} has no sampler")))?;
            if let Some(pointer) = &target.extensions.pointer {
                of_light(source, &pointer.pointer, sampler, &what, lights, &mut tracks)?;
                continue;
            }
            let Some(place) = target.node.and_then(|n| nodes.iter().position(|p| p.index == n)) else {
                continue;
            };
            let motion = &mut motions[place];
            match target.path.as_str() {
                "translation" => motion.translation = Some(Curve::read(source, sampler, &what)?),
                "rotation" => motion.rotation = Some(Curve::read(source, sampler, &what)?),
                "scale" => motion.scale = Some(Curve::read(source, sampler, &what)?),
                _ => {}
            }
        }
        for (light, &(place, kind)) in lights.iter().enumerate() {
            tracks.extend(way(source, nodes, &motions, light, place, kind));
        }
        let moving = node_animation::tracks(source, nodes, &motions, places);
        if nodes
            .iter()
            .zip(&motions)
            .zip(places)
            .any(|((_, motion), place)| place.is_some() && motion.scales())
        {
            left_out.push(format!("{name:?}: nodes that may move keep their size"));
        }
        if tracks.is_empty() && moving.is_empty() && deform.get(a) == Some(&true) {
            continue;
        }
        if tracks.is_empty() && moving.is_empty() {
            left_out.push(format!(
                "{name:?}: it moves no light and deforms no mesh, and nodes stand still but those named with --group, or with --solver radiosity"
            ));
            continue;
        }
        let latest = |times: &mut dyn Iterator<Item = &Vec<f32>>| {
            times.filter_map(|times| times.last()).fold(0.0f32, |a, b| a.max(*b))
        };
        if !moving.is_empty() {
            let duration = latest(&mut moving.iter().map(|track| &track.times));
            of_nodes.push(NodeAnimation { name: name.clone(), duration, tracks: moving });
        }
        if !tracks.is_empty() {
            let duration = latest(&mut tracks.iter().map(|track| &track.times));
            out.push(Animation { name, duration, tracks });
        }
    }
    Ok((out, of_nodes))
}

/// Returns the tracks of a light moved by nodes: position unless directional, direction unless a point light.
fn way(
    source: &Source,
    nodes: &[PlacedNode],
    motions: &[Motion],
    light: usize,
    place: usize,
    kind: usize,
) -> Vec<Track> {
    let chain: Vec<usize> = std::iter::successors(Some(place), |&p| nodes[p].parent).collect();
    let curves = || chain.iter().flat_map(|&p| motions[p].curves());
    let mut times = key_times(motions, &chain);
    if times.is_empty() {
        return Vec::new();
    }
    let step = curves().all(|(kind, _)| kind == Kind::Step);
    let straight = curves().all(|(kind, _)| kind == Kind::Linear)
        && chain.iter().all(|&p| motions[p].rotation.is_none() && motions[p].scale.is_none())
        && chain.iter().filter(|&&p| motions[p].translation.is_some()).count() == 1;
    if !step && !straight {
        fill(&mut times);
    }
    let worlds: Vec<DMat4> =
        times.iter().map(|&time| world_at(source, nodes, motions, &chain, time)).collect();
    let interpolation = if step { Interpolation::Step } else { Interpolation::Linear };
    let kind = source.lights.get(kind).map_or("", |l| l.kind.as_str());
    let track = |property, value: fn(&DMat4) -> [f64; 3]| {
        let values: Vec<f32> = worlds.iter().flat_map(|world| value(world).map(|x| x as f32)).collect();
        let moves = values.as_chunks::<3>().0.windows(2).any(|v| v[0] != v[1]);
        let sound = values.iter().all(|x| x.abs() < LARGEST);
        let times = times.iter().map(|&t| t as f32).collect();
        (moves && sound).then_some(Track { light: light as u32, property, interpolation, times, values })
    };
    let position = track(Property::Position, |world| placement(world).0).filter(|_| kind != "directional");
    let direction = track(Property::Direction, |world| placement(world).1).filter(|_| kind != "point");
    position.into_iter().chain(direction).map(distinct).collect()
}

/// Adds tracks for a light's intensity or colour, targeted by KHR_animation_pointer.
fn of_light(
    source: &Source,
    pointer: &str,
    sampler: &Sampler,
    what: &str,
    lights: &[(usize, usize)],
    tracks: &mut Vec<Track>,
) -> Result<(), SceneError> {
    let Some((index, member)) = pointer
        .strip_prefix("/extensions/KHR_lights_punctual/lights/")
        .and_then(|rest| rest.split_once('/'))
        .and_then(|(index, member)| Some((index.parse::<usize>().ok()?, member)))
    else {
        return Ok(());
    };
    let (property, interpolation, times, values) = match member {
        "intensity" => keys(Property::Intensity, &Curve::<1>::read(source, sampler, what)?),
        "color" => keys(Property::Color, &Curve::<3>::read(source, sampler, what)?),
        _ => return Ok(()),
    };
    for (light, _) in lights.iter().enumerate().filter(|(_, (_, kind))| *kind == index) {
        let (times, values) = (times.clone(), values.clone());
        tracks.push(distinct(Track { light: light as u32, property, interpolation, times, values }));
    }
    Ok(())
}

fn keys<const W: usize>(
    property: Property,
    curve: &Curve<W>,
) -> (Property, Interpolation, Vec<f32>, Vec<f32>) {
    let mut times = curve.times.clone();
    if curve.kind == Kind::CubicSpline {
        fill(&mut times);
    }
    // A spline may swing below zero, a light cannot.
    let value = |&t: &f64| curve.at(t, straight).map(|x| (x as f32).max(0.0));
    let interpolation = if curve.kind == Kind::Step { Interpolation::Step } else { Interpolation::Linear };
    let values = times.iter().flat_map(value).collect();
    (property, interpolation, times.iter().map(|&t| t as f32).collect(), values)
}

/// Removes keys at equal times in f32.
fn distinct(mut track: Track) -> Track {
    let width = track.property.width();
    let keep: Vec<usize> =
        (0..track.times.len()).filter(|&k| k == 0 || track.times[k] > track.times[k - 1]).collect();
    track.values = keep.iter().flat_map(|&k| track.values[k * width..(k + 1) * width].to_vec()).collect();
    track.times = keep.into_iter().map(|k| track.times[k]).collect();
    track
}
