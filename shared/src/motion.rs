//! Rigid motions of nodes, as SHOT.json and pages give them, and of the reconstruction groups that follow them.
//!
//! A node is turned about its own origin and then shifted, both in world space, from where the file has it. What is below it
//! moves along, and may be moved further.

use crate::rbn::groups::Groups;
use glam::{Affine3A, DAffine3, DQuat, DVec3, Vec3};

/// Motion of a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeMotion {
    /// Shift, world space.
    pub translation: [f64; 3],
    /// Turn about the world's y axis, degrees, from +z towards +x: counterclockwise seen from above; after `rotation`.
    pub rotation_y_deg: f64,
    /// Turn about any axis: a quaternion x, y, z, w in world space.
    pub rotation: [f64; 4],
}

impl Default for NodeMotion {
    /// No motion.
    fn default() -> Self {
        Self { translation: [0.0; 3], rotation_y_deg: 0.0, rotation: [0.0, 0.0, 0.0, 1.0] }
    }
}

impl NodeMotion {
    /// Whether all numbers are finite, and the quaternion is a rotation.
    pub fn is_usable(&self) -> bool {
        let Self { translation, rotation_y_deg, rotation } = self;
        let is_sane = |x: &f64| x.abs() < 1e15;
        translation.iter().chain([rotation_y_deg]).chain(rotation).all(is_sane)
            && DQuat::from_array(*rotation).length_squared() > 1e-12
    }

    /// The turn.
    fn turn(&self) -> DQuat {
        let angle = 0.5 * self.rotation_y_deg.to_radians();
        let (sine, cosine) = crate::elementary::Elementary::sine_cosine(angle);
        DQuat::from_xyzw(0.0, sine, 0.0, cosine) * DQuat::from_array(self.rotation).normalize()
    }

    /// Returns the motion of a node's surfaces; `origin` is the node's origin before it, and `above` the motion of its parent.
    fn of_world(&self, origin: DVec3, above: &DAffine3) -> DAffine3 {
        let origin = above.transform_point3(origin);
        let about = DAffine3::from_rotation_translation(self.turn(), DVec3::ZERO);
        let there = origin + DVec3::from(self.translation);
        DAffine3::from_translation(there) * about * DAffine3::from_translation(-origin) * *above
    }
}

/// Returns where the surfaces of nodes are from where the file has them, world space; in the order of the nodes. A node
/// beyond the end of `motions` does not move by itself.
pub fn world_motions(groups: &Groups, motions: &[NodeMotion]) -> Vec<DAffine3> {
    let mut world: Vec<DAffine3> = Vec::with_capacity(groups.nodes.len());
    for (i, node) in groups.nodes.iter().enumerate() {
        let above = node.parent.map_or(DAffine3::IDENTITY, |parent| world[parent as usize]);
        let motion = motions.get(i).filter(|motion| **motion != NodeMotion::default());
        world.push(motion.map_or(above, |motion| motion.of_world(DVec3::from(node.origin), &above)));
    }
    world
}

/// Motion of a reconstruction group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// From where the file has the group to where it is; local space on both sides.
    pub local_from_rest: Affine3A,
    /// The way back.
    pub rest_from_local: Affine3A,
}

impl Default for Motion {
    /// No motion.
    fn default() -> Self {
        Self { local_from_rest: Affine3A::IDENTITY, rest_from_local: Affine3A::IDENTITY }
    }
}

impl Motion {
    /// Whether the group is elsewhere than the file has it.
    pub fn is_moved(&self) -> bool {
        self.local_from_rest != Affine3A::IDENTITY
    }
}

/// Motions of all reconstruction groups.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Motions {
    /// By group, group 0 first; empty where nothing has moved.
    groups: Vec<Motion>,
}

impl Motions {
    /// Returns the motions of groups for motions of their nodes, in the order of the nodes; a node beyond the end does not
    /// move. `origin` is that of local space.
    pub fn new(groups: &Groups, nodes: &[NodeMotion], origin: [f64; 3]) -> Self {
        let world = world_motions(groups, nodes);
        if world.iter().all(|motion| *motion == DAffine3::IDENTITY) {
            return Self::default();
        }
        let origin = DVec3::from(origin);
        let of = |group: u32| {
            let Some(node) = groups.node_of(group) else { return Motion::default() };
            let world = world[node as usize];
            if world == DAffine3::IDENTITY {
                return Motion::default();
            }
            let local = DAffine3::from_translation(-origin) * world * DAffine3::from_translation(origin);
            let single = |motion: DAffine3| {
                let [x, y, z, at] = motion.to_cols_array_2d().map(|column| column.map(|x| x as f32));
                Affine3A::from_cols_array_2d(&[x, y, z, at])
            };
            Motion { local_from_rest: single(local), rest_from_local: single(local.inverse()) }
        };
        Self { groups: (0..=groups.groups.len() as u32).map(of).collect() }
    }

    /// Whether nothing has moved.
    pub fn is_empty(&self) -> bool {
        self.groups.is_empty()
    }

    /// Motion of a group.
    #[inline]
    pub fn of(&self, group: u32) -> Motion {
        self.groups.get(group as usize).copied().unwrap_or_default()
    }

    /// Returns a position and a normal of a group, where the file has them.
    #[inline]
    pub fn at_rest(&self, position: Vec3, normal: Vec3, group: u32) -> (Vec3, Vec3) {
        match self.groups.get(group as usize) {
            None => (position, normal),
            Some(Motion { rest_from_local, .. }) => {
                (rest_from_local.transform_point3(position), rest_from_local.transform_vector3(normal))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rbn::groups::{Group, Node};

    fn groups() -> Groups {
        let node = |origin, parent| Node { name: String::new(), parent, origin };
        let group = |node| Group { name: String::new(), density: 1.0, node };
        Groups {
            nodes: vec![node([1.0, 0.0, 0.0], None), node([2.0, 0.0, 0.0], Some(0)), node([9.0; 3], None)],
            groups: vec![group(Some(0)), group(Some(1)), group(Some(2)), group(None)],
            of_material: vec![1, 2, 3, 4],
            ..Groups::default()
        }
    }

    #[test]
    fn a_node_turns_about_its_origin_and_takes_what_is_below_along() {
        let turned =
            NodeMotion { translation: [0.0, 0.5, 0.0], rotation_y_deg: 90.0, ..NodeMotion::default() };
        let motions = Motions::new(&groups(), &[turned], [10.0, 0.0, 0.0]);
        // Local space is 10 units left of world space: the node's origin is at -9.
        let at =
            |group, x: f32| motions.of(group).local_from_rest.transform_point3(Vec3::new(x - 10.0, 0.0, 0.0));
        assert!((at(1, 1.0) - Vec3::new(-9.0, 0.5, 0.0)).length() < 1e-6);
        // +x goes to -z.
        assert!((at(1, 3.0) - Vec3::new(-9.0, 0.5, -2.0)).length() < 1e-5);
        assert_eq!(at(1, 3.0), at(2, 3.0));
        assert!(!motions.of(0).is_moved() && !motions.of(3).is_moved() && !motions.of(4).is_moved());
        let (position, normal) = motions.at_rest(at(2, 3.0), Vec3::NEG_Z, 2);
        assert!((position - Vec3::new(-7.0, 0.0, 0.0)).length() < 1e-5 && (normal - Vec3::X).length() < 1e-6);
        assert!(Motions::new(&groups(), &[NodeMotion::default(); 3], [0.0; 3]).is_empty());
    }

    #[test]
    fn a_child_is_moved_from_where_its_parent_has_taken_it() {
        let turned = NodeMotion { rotation_y_deg: 90.0, ..NodeMotion::default() };
        let back =
            NodeMotion { rotation_y_deg: -90.0, translation: [0.0, 0.0, 1.0], ..NodeMotion::default() };
        let motions = Motions::new(&groups(), &[turned, back], [0.0; 3]);
        // The parent takes the child's origin from (2, 0, 0) to (1, 0, -1); the child turns back, and is shifted.
        let at = motions.of(2).local_from_rest.transform_point3(Vec3::new(3.0, 0.0, 0.0));
        assert!((at - Vec3::new(2.0, 0.0, 0.0)).length() < 1e-5, "{at}");
        assert!(!NodeMotion { rotation: [0.0; 4], ..turned }.is_usable() && turned.is_usable());
    }
}
