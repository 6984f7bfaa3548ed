//! Conversion of keyframes of nodes and lights to world-space keyframes of the scene's lights, and of nodes that may move.

use super::node::{PlacedNode, placement};
use super::node_animation;
use super::pose::Pose;
use super::source::Source;
use crate::scene::SceneError;
use glam::{DMat4, DQuat};
use gltf::json::accessor::Type;
use gltf::json::animation::{Interpolation as Kind, Sampler};
use gltf::json::validation::Checked;
use rebounce_shared::elementary::Elementary;
use rebounce_shared::rbn::LARGEST;
use rebounce_shared::rbn::meta::{Animation, Interpolation, Property, Track};
use rebounce_shared::rbn::node_tracks::NodeAnimation;

/// Sampling rate, keys per second, of a light path that is not straight between keys: rotated, or moved by several
/// nodes.
const KEYS_A_SECOND: f64 = 30.0;
/// Maximum number of keys that resampling adds to a track.
const MOST_KEYS: usize = 1 << 16;

/// Keys of a sampler: times in seconds, and values of `W` numbers.
struct Curve<const W: usize> {
    kind: Kind,
    times: Vec<f64>,
    /// One value per key; for splines three: in-tangent, value, out-tangent.
    values: Vec<[f64; W]>,
}

impl<const W: usize> Curve<W> {
    fn read(source: &Source, sampler: &Sampler, what: &str) -> Result<Self, SceneError> {
        let kind = match sampler.interpolation {
            Checked::Valid(kind) => kind,
            Checked::Invalid => {
                let known = "glTF has STEP, LINEAR and CUBICSPLINE";
                return Err(source.malformed(format!("{what} has an unknown interpolation: {known}")));
            }
        };
        let times = source.read::<1>(sampler.input.value(), Type::Scalar, &format!("input of {what}"))?;
        let shape = [Type::Scalar, Type::Vec2, Type::Vec3, Type::Vec4][W - 1];
        let values = source.read::<W>(sampler.output.value(), shape, &format!("output of {what}"))?;
        let times: Vec<f64> = times.into_iter().map(|[t]| t).collect();
        let largest = f64::from(LARGEST);
        let finite = times.iter().chain(values.iter().flatten()).all(|x| x.abs() < largest);
        let ordered = times.windows(2).all(|t| t[0] < t[1]) && times.first().is_some_and(|t| *t >= 0.0);
        let each = if kind == Kind::CubicSpline { 3 } else { 1 };
        if !finite || !ordered || values.len() != each * times.len() {
            return Err(source.malformed(format!(
                "{what} has keys that are out of order, missing, not finite or far too large"
            )));
        }
        Ok(Self { kind, times, values })
    }

    /// Returns the value at `time`, clamped to the first and last key (glTF 2.0, 3.11).
    fn at(&self, time: f64, between: impl Fn([f64; W], [f64; W], f64) -> [f64; W]) -> [f64; W] {
        let value = |k: usize| self.values[if self.kind == Kind::CubicSpline { 3 * k + 1 } else { k }];
        let next = self.times.partition_point(|&t| t <= time);
        if next == 0 || next == self.times.len() {
            return value(next.saturating_sub(1));
        }
        let (k, step) = (next - 1, self.times[next] - self.times[next - 1]);
        let s = (time - self.times[k]) / step;
        match self.kind {
            Kind::Step => value(k),
            Kind::Linear => between(value(k), value(next), s),
            // glTF 2.0, appendix C.5.
            Kind::CubicSpline => {
                let (leaving, arriving) = (self.values[3 * k + 2], self.values[3 * next]);
                let (a, b) = (value(k), value(next));
                let (s2, s3) = (s * s, s * s * s);
                std::array::from_fn(|c| {
                    (2.0 * s3 - 3.0 * s2 + 1.0) * a[c]
                        + step * (s3 - 2.0 * s2 + s) * leaving[c]
                        + (3.0 * s2 - 2.0 * s3) * b[c]
                        + step * (s3 - s2) * arriving[c]
                })
            }
        }
    }
}

fn straight<const W: usize>(a: [f64; W], b: [f64; W], s: f64) -> [f64; W] {
    std::array::from_fn(|c| a[c] + s * (b[c] - a[c]))
}

fn around(a: [f64; 4], b: [f64; 4], s: f64) -> [f64; 4] {
    let [a, b] = [a, b].map(|q| DQuat::from_array(q).normalize());
    if a.is_finite() && b.is_finite() { slerp(a, b, s).to_array() } else { [0.0, 0.0, 0.0, 1.0] }
}

/// Spherical linear interpolation of unit quaternions the shorter way round (Shoemake 1985).
fn slerp(a: DQuat, b: DQuat, s: f64) -> DQuat {
    let cosine = a.dot(b);
    let (cosine, b) = if cosine < 0.0 { (-cosine, -b) } else { (cosine, b) };
    if cosine > 1.0 - f64::EPSILON {
        return (a * (1.0 - s) + b * s).normalize();
    }
    let angle = cosine.arc_cosine();
    (a * ((1.0 - s) * angle).sine() + b * (s * angle).sine()) * angle.sine().recip()
}

/// Animation curves of a node.
#[derive(Default)]
pub(super) struct Motion {
    translation: Option<Curve<3>>,
    rotation: Option<Curve<4>>,
    scale: Option<Curve<3>>,
}

impl Motion {
    pub(super) fn curves(&self) -> impl Iterator<Item = (Kind, &[f64])> {
        let translation = self.translation.iter().map(|c| (c.kind, c.times.as_slice()));
        let rotation = self.rotation.iter().map(|c| (c.kind, c.times.as_slice()));
        translation.chain(rotation).chain(self.scale.iter().map(|c| (c.kind, c.times.as_slice())))
    }

    /// Whether it changes the node's size.
    pub(super) fn scales(&self) -> bool {
        self.scale.is_some()
    }

    fn pose(&self, rest: Pose, time: f64) -> Pose {
        Pose {
            translation: self.translation.as_ref().map_or(rest.translation, |c| c.at(time, straight)),
            rotation: self.rotation.as_ref().map_or(rest.rotation, |c| c.at(time, around)),
            scale: self.scale.as_ref().map_or(rest.scale, |c| c.at(time, straight)),
        }
    }
}

/// What animations may move.
pub(super) struct Animated<'a> {
    /// Nodes of the scene.
    pub(super) nodes: &'a [PlacedNode],
    /// Lights in scene order: index of the light's node in `nodes`, and the glTF light.
    pub(super) lights: &'a [(usize, usize)],
    /// Of each node, its place among those that may move.
    pub(super) places: &'a [Option<u32>],
}

/// Returns the animations of lights, and of nodes that may move. Those of other geometry are left out: the bake holds it still.
pub(super) fn animations(
    source: &Source,
    animated: &Animated,
    left_out: &mut Vec<String>,
) -> Result<(Vec<Animation>, Vec<NodeAnimation>), SceneError> {
    let Animated { nodes, lights, places } = *animated;
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
        if tracks.is_empty() && moving.is_empty() {
            left_out.push(format!(
                "{name:?}: it moves no light, and nodes stand still but those named with --group, or with --solver radiosity"
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

/// Times of all keys along a chain of nodes, rising.
pub(super) fn key_times(motions: &[Motion], chain: &[usize]) -> Vec<f64> {
    let curves = chain.iter().flat_map(|&p| motions[p].curves());
    let mut times: Vec<f64> = curves.flat_map(|(_, times)| times.iter().copied()).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    times
}

/// World matrix of the first node of a chain, which goes up to the root, at a time.
pub(super) fn world_at(
    source: &Source,
    nodes: &[PlacedNode],
    motions: &[Motion],
    chain: &[usize],
    time: f64,
) -> DMat4 {
    chain.iter().rev().fold(DMat4::IDENTITY, |parent, &p| {
        let rest = &source.exact.nodes[nodes[p].index];
        let still = motions[p].curves().next().is_none();
        let local = if still { rest.local() } else { motions[p].pose(rest.pose(), time).matrix() };
        parent * local
    })
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

/// Adds keys between the first and the last of the ascending `times`.
pub(super) fn fill(times: &mut Vec<f64>) {
    let (Some(&first), Some(&last)) = (times.first(), times.last()) else { return };
    let more = (((last - first) * KEYS_A_SECOND).ceil() as usize).min(MOST_KEYS);
    times.extend((0..more).map(|k| first + (last - first) * k as f64 / more as f64));
    times.sort_by(f64::total_cmp);
    times.dedup();
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
