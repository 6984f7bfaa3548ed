//! Animation curves of nodes, as the scene's file has them.

use super::node::PlacedNode;
use super::pose::Pose;
use super::source::Source;
use crate::scene::SceneError;
use glam::DMat4;
use gltf::json::accessor::Type;
use gltf::json::animation::{Interpolation as Kind, Sampler};
use gltf::json::validation::Checked;
use rebounce_shared::rbn::LARGEST;
use rebounce_shared::rig::keys::{between_rotations, cubic_hermite};

/// Sampling rate, keys per second, of a light path that is not straight between keys: rotated, or moved by several
/// nodes.
const KEYS_A_SECOND: f64 = 30.0;
/// Maximum number of keys that resampling adds to a track.
const MOST_KEYS: usize = 1 << 16;

/// Keys of a sampler: times in seconds, and values of `W` numbers.
pub(super) struct Curve<const W: usize> {
    pub(super) kind: Kind,
    pub(super) times: Vec<f64>,
    /// One value per key; for splines three: in-tangent, value, out-tangent.
    pub(super) values: Vec<[f64; W]>,
}

impl<const W: usize> Curve<W> {
    pub(super) fn read(source: &Source, sampler: &Sampler, what: &str) -> Result<Self, SceneError> {
        let kind = kind(source, sampler, what)?;
        let times = source.read::<1>(sampler.input.value(), Type::Scalar, &format!("input of {what}"))?;
        let shape = [Type::Scalar, Type::Vec2, Type::Vec3, Type::Vec4][W - 1];
        let values = source.read::<W>(sampler.output.value(), shape, &format!("output of {what}"))?;
        let times: Vec<f64> = times.into_iter().map(|[t]| t).collect();
        Self { kind, times, values }.checked(source, what)
    }

    fn checked(self, source: &Source, what: &str) -> Result<Self, SceneError> {
        let Self { kind, times, values } = &self;
        let largest = f64::from(LARGEST);
        let finite = times.iter().chain(values.iter().flatten()).all(|x| x.abs() < largest);
        let ordered = times.windows(2).all(|t| t[0] < t[1]) && times.first().is_some_and(|t| *t >= 0.0);
        let each = if *kind == Kind::CubicSpline { 3 } else { 1 };
        if !finite || !ordered || values.len() != each * times.len() {
            return Err(source.malformed(format!(
                "{what} has keys that are out of order, missing, not finite or far too large"
            )));
        }
        Ok(self)
    }

    /// As [`Self::read`], of a sampler with several values of `W` numbers a key, one after the other: a curve of each. Those of
    /// splines are all in-tangents of a key, then all values, then all out-tangents (glTF 2.0, 3.11).
    pub(super) fn read_each(source: &Source, sampler: &Sampler, what: &str) -> Result<Vec<Self>, SceneError> {
        let times = source.read::<1>(sampler.input.value(), Type::Scalar, &format!("input of {what}"))?;
        let shape = [Type::Scalar, Type::Vec2, Type::Vec3, Type::Vec4][W - 1];
        let values = source.read::<W>(sampler.output.value(), shape, &format!("output of {what}"))?;
        let kind = kind(source, sampler, what)?;
        let each = if kind == Kind::CubicSpline { 3 } else { 1 };
        let rows = each * times.len();
        let count = values.len() / rows.max(1);
        let times: Vec<f64> = times.into_iter().map(|[t]| t).collect();
        if values.len() != count * rows {
            return Err(source.malformed(format!("{what} has not as many values for each key")));
        }
        let of = |i: usize| {
            let values = values.iter().skip(i).step_by(count).copied().collect();
            Self { kind, times: times.clone(), values }.checked(source, what)
        };
        (0..count).map(of).collect()
    }

    /// Returns the value at `time`, clamped to the first and last key (glTF 2.0, 3.11).
    pub(super) fn at(&self, time: f64, between: impl Fn([f64; W], [f64; W], f64) -> [f64; W]) -> [f64; W] {
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
                std::array::from_fn(|c| cubic_hermite([a[c], leaving[c]], [arriving[c], b[c]], step, s))
            }
        }
    }
}

fn kind(source: &Source, sampler: &Sampler, what: &str) -> Result<Kind, SceneError> {
    match sampler.interpolation {
        Checked::Valid(kind) => Ok(kind),
        Checked::Invalid => {
            let known = "glTF has STEP, LINEAR and CUBICSPLINE";
            Err(source.malformed(format!("{what} has an unknown interpolation: {known}")))
        }
    }
}

pub(super) fn straight<const W: usize>(a: [f64; W], b: [f64; W], s: f64) -> [f64; W] {
    std::array::from_fn(|c| a[c] + s * (b[c] - a[c]))
}

/// Animation curves of a node.
#[derive(Default)]
pub(super) struct Motion {
    pub(super) translation: Option<Curve<3>>,
    pub(super) rotation: Option<Curve<4>>,
    pub(super) scale: Option<Curve<3>>,
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

    /// The transform at a time; `rest` where nothing moves.
    pub(super) fn pose(&self, rest: Pose, time: f64) -> Pose {
        Pose {
            translation: self.translation.as_ref().map_or(rest.translation, |c| c.at(time, straight)),
            rotation: self.rotation.as_ref().map_or(rest.rotation, |c| c.at(time, between_rotations)),
            scale: self.scale.as_ref().map_or(rest.scale, |c| c.at(time, straight)),
        }
    }
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

/// Adds keys between the first and the last of the ascending `times`.
pub(super) fn fill(times: &mut Vec<f64>) {
    let (Some(&first), Some(&last)) = (times.first(), times.last()) else { return };
    let more = (((last - first) * KEYS_A_SECOND).ceil() as usize).min(MOST_KEYS);
    times.extend((0..more).map(|k| first + (last - first) * k as f64 / more as f64));
    times.sort_by(f64::total_cmp);
    times.dedup();
}
