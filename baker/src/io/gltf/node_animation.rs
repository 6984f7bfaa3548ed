//! Keyframes of nodes that may move, as motions from where the file has them.
//!
//! A node turns about its own origin and is shifted, world space, after what the nearest movable node above has done
//! ([`NodeMotion`](rebounce_shared::motion::NodeMotion)).

use super::keyframes::{Motion, fill, key_times, world_at};
use super::node::PlacedNode;
use super::source::Source;
use glam::{DMat3, DMat4, DQuat, DVec3};
use gltf::json::animation::Interpolation as Kind;
use rebounce_shared::rbn::LARGEST;
use rebounce_shared::rbn::meta::Interpolation;
use rebounce_shared::rbn::node_tracks::{NodeProperty, NodeTrack};

/// A rigid motion: a turn about an origin, which goes to another place.
struct Rigid {
    turn: DQuat,
    from: DVec3,
    to: DVec3,
}

impl Rigid {
    /// The motion between two places of a node, less changes of its size.
    fn between(rest: &DMat4, world: &DMat4) -> Self {
        let turn = orthonormal(world) * orthonormal(rest).inverse();
        Self { turn, from: rest.w_axis.truncate(), to: world.w_axis.truncate() }
    }

    fn place(&self, at: DVec3) -> DVec3 {
        self.to + self.turn * (at - self.from)
    }
}

/// Rotation of the axes x and y of a matrix, made upright on each other. A mirrored node turns as its mirror image does.
fn orthonormal(matrix: &DMat4) -> DQuat {
    let [x, y] = [matrix.x_axis, matrix.y_axis].map(|axis| axis.truncate());
    let x = x.normalize_or(DVec3::X);
    let y = (y - x * x.dot(y)).normalize_or(x.any_orthonormal_vector());
    DQuat::from_mat3(&DMat3::from_cols(x, y, x.cross(y))).normalize()
}

/// Returns the tracks of all nodes that may move; `places` has the place of each node among them.
pub(super) fn tracks(
    source: &Source,
    nodes: &[PlacedNode],
    motions: &[Motion],
    places: &[Option<u32>],
) -> Vec<NodeTrack> {
    let mut out = Vec::new();
    for (i, place) in places.iter().enumerate() {
        let Some(node) = *place else { continue };
        let chain: Vec<usize> = std::iter::successors(Some(i), |&p| nodes[p].parent).collect();
        let above = chain.iter().skip(1).position(|&p| places[p].is_some()).map(|at| at + 1);
        let own = &chain[..above.unwrap_or(chain.len())];
        // What stands still to the node above goes along with it.
        if own.iter().all(|&p| motions[p].curves().next().is_none()) {
            continue;
        }
        let mut times = key_times(motions, &chain);
        let curves = || chain.iter().flat_map(|&p| motions[p].curves());
        let is_step = curves().all(|(kind, _)| kind == Kind::Step);
        let moved = chain.iter().filter(|&&p| motions[p].curves().next().is_some()).count();
        let is_straight = moved == 1 && curves().all(|(kind, _)| kind == Kind::Linear);
        if !is_step && !is_straight {
            fill(&mut times);
        }
        let moves = |chain: &[usize], time: f64| {
            let rest = chain
                .iter()
                .rev()
                .fold(DMat4::IDENTITY, |parent, &p| parent * source.exact.nodes[nodes[p].index].local());
            Rigid::between(&rest, &world_at(source, nodes, motions, chain, time))
        };
        let keys: Vec<(DQuat, DVec3)> = times
            .iter()
            .map(|&time| {
                let whole = moves(&chain, time);
                match above.map(|at| moves(&chain[at..], time)) {
                    None => (whole.turn, whole.to - whole.from),
                    Some(above) => (whole.turn * above.turn.inverse(), whole.to - above.place(whole.from)),
                }
            })
            .collect();
        let interpolation = if is_step { Interpolation::Step } else { Interpolation::Linear };
        // Keys at equal times in f32 are one.
        let kept: Vec<usize> =
            (0..times.len()).filter(|&k| k == 0 || times[k] as f32 > times[k - 1] as f32).collect();
        let times: Vec<f32> = kept.iter().map(|&k| times[k] as f32).collect();
        let (mut shifts, mut turns) = (Vec::new(), Vec::new());
        for k in kept {
            let (turn, shift) = keys[k];
            let turn = if turn.w < 0.0 { -turn } else { turn };
            shifts.extend(shift.to_array().map(|x| x as f32));
            turns.extend(turn.to_array().map(|x| x as f32));
        }
        for (property, values) in [(NodeProperty::Translation, shifts), (NodeProperty::Rotation, turns)] {
            let is_at_rest = |(i, x): (usize, &f32)| (x - rest_of(property, i)).abs() < 1e-6;
            let moves = !values.iter().enumerate().all(is_at_rest);
            if moves && values.iter().all(|x| x.abs() < LARGEST) {
                out.push(NodeTrack { node, property, interpolation, times: times.clone(), values });
            }
        }
    }
    out
}

/// Number `i` of keys of a node that is where the file has it.
fn rest_of(property: NodeProperty, i: usize) -> f32 {
    if property == NodeProperty::Rotation && i % 4 == 3 { 1.0 } else { 0.0 }
}
