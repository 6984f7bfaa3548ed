//! Parts of meshes before they are deformed: positions and normals, joints with weights, morph targets.

use super::primitive::PrimitiveReader;
use super::source::Source;
use crate::scene::SceneError;
use glam::DVec3;
use gltf::json::accessor::Type;
use gltf::json::mesh::{MorphTarget, Semantic};
use rebounce_shared::rbn::rig::WHOLE;

/// Joints of a vertex, with weights in 65535ths that add up to one.
pub(super) type Influences = [(u32, u32); 4];

/// A part of a mesh before it is deformed, mesh space.
pub(super) struct Bind {
    pub positions: Vec<DVec3>,
    /// As the file has them; without, the triangles are flat-shaded.
    pub normals: Option<Vec<DVec3>>,
    /// `None` for a part that follows its node.
    pub influences: Option<Vec<Influences>>,
    /// By morph target and vertex, what is added to positions and to normals.
    pub targets: Vec<Vec<[DVec3; 2]>>,
    /// Whether the deformation at rest turns triangles inside out, so that their corners have changed places.
    pub is_mirrored: bool,
    /// Number of vertices that had more joints.
    pub crowded: usize,
}

impl Bind {
    /// Reads joints, if the mesh `is_skinned`, and morph targets of a primitive.
    ///
    /// # Errors
    /// Attributes of another length.
    pub fn read(
        source: &Source,
        targets: &[MorphTarget],
        numbers: &PrimitiveReader,
        (positions, normals): (Vec<DVec3>, Option<Vec<DVec3>>),
        is_skinned: bool,
    ) -> Result<Self, SceneError> {
        let (count, mut crowded) = (positions.len(), 0);
        let influences = if is_skinned { influences(source, numbers, count, &mut crowded)? } else { None };
        let mut read = Vec::with_capacity(targets.len());
        for (t, target) in targets.iter().enumerate() {
            let mut moves = vec![[DVec3::ZERO; 2]; count];
            let accessors = [("POSITION", target.positions), ("NORMAL", target.normals)];
            for (part, (name, accessor)) in accessors.into_iter().enumerate() {
                let Some(accessor) = accessor else { continue };
                let values = target_moves(source, numbers, accessor.value(), (name, t), count)?;
                moves.iter_mut().zip(values).for_each(|(at, by)| at[part] = by);
            }
            read.push(moves);
        }
        Ok(Self { positions, normals, influences, targets: read, is_mirrored: false, crowded })
    }
}

/// Reads joints and weights; `None` without.
fn influences(
    source: &Source,
    numbers: &PrimitiveReader,
    count: usize,
    crowded: &mut usize,
) -> Result<Option<Vec<Influences>>, SceneError> {
    let mut all: Vec<Vec<(u32, f64)>> = vec![Vec::new(); count];
    let first = each_joint(source, numbers, count, |vertex, joint, weight| {
        let own = &mut all[vertex];
        match own.iter_mut().find(|(other, _)| *other == joint as u32) {
            Some((_, sum)) => *sum += weight,
            None => own.push((joint as u32, weight)),
        }
        Ok(())
    })?;
    let Some(first) = first else { return Ok(None) };
    let of_vertex = |(own, joint): (Vec<(u32, f64)>, f64)| {
        *crowded += usize::from(own.len() > 4);
        // A vertex without weights follows the first joint.
        greatest(own).unwrap_or([(joint as u32, WHOLE), (0, 0), (0, 0), (0, 0)])
    };
    Ok(Some(all.into_iter().zip(first).map(of_vertex).collect()))
}

/// Calls `each` with the vertex, the joint and the weight, for all weights over 0 of a primitive, set after set (glTF 2.0, 3.7.3.1).
/// Returns the first joint of each vertex; `None` without joints.
///
/// # Errors
/// Attributes of another length than `count`, and those of `each`.
pub(super) fn each_joint(
    source: &Source,
    numbers: &PrimitiveReader,
    count: usize,
    mut each: impl FnMut(usize, f64, f64) -> Result<(), SceneError>,
) -> Result<Option<Vec<f64>>, SceneError> {
    let mut first = Vec::new();
    for set in 0.. {
        let joints = numbers.read::<4>(&Semantic::Joints(set), Type::Vec4)?;
        let weights = numbers.read::<4>(&Semantic::Weights(set), Type::Vec4)?;
        let Some((joints, weights)) = joints.zip(weights) else { break };
        if joints.len() != count || weights.len() != count {
            return Err(source.malformed(format!("{} has attributes of different lengths", numbers.what())));
        }
        for (vertex, (joints, weights)) in joints.iter().zip(&weights).enumerate() {
            for (&joint, &weight) in joints.iter().zip(weights).filter(|(_, weight)| **weight > 0.0) {
                each(vertex, joint, weight)?;
            }
        }
        if set == 0 {
            first = joints.iter().map(|[joint, ..]| *joint).collect();
        }
    }
    Ok((!first.is_empty()).then_some(first))
}

/// Reads the displacements of a morph target: of positions or of normals, by `name`.
///
/// # Errors
/// Another number of them than `count`.
pub(super) fn target_moves(
    source: &Source,
    numbers: &PrimitiveReader,
    accessor: usize,
    (name, target): (&str, usize),
    count: usize,
) -> Result<Vec<DVec3>, SceneError> {
    let what = format!("{name} of morph target {target} of {}", numbers.what());
    let moves = source.read::<3>(accessor, Type::Vec3, &what)?;
    if moves.len() != count {
        return Err(source.malformed(format!("{what} has another length than {name}")));
    }
    Ok(moves.into_iter().map(DVec3::from).collect())
}

/// The four greatest weights in 65535ths, with the sum 65535; `None` where all weights are 0. The remainder of rounding down goes to
/// the weights with the greatest fractions.
fn greatest(mut own: Vec<(u32, f64)>) -> Option<Influences> {
    own.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    own.truncate(4);
    let sum: f64 = own.iter().map(|(_, weight)| weight).sum();
    if !(sum > 0.0 && sum.is_finite()) {
        return None;
    }
    let exact: Vec<f64> = own.iter().map(|(_, weight)| weight / sum * f64::from(WHOLE)).collect();
    let mut out = [(0, 0); 4];
    for ((out, (joint, _)), exact) in out.iter_mut().zip(&own).zip(&exact) {
        *out = (*joint, exact.floor() as u32);
    }
    let mut order: Vec<usize> = (0..own.len()).collect();
    order.sort_by(|a, b| exact[*b].fract().total_cmp(&exact[*a].fract()).then(a.cmp(b)));
    let missing = WHOLE.saturating_sub(out.iter().map(|(_, weight)| weight).sum()) as usize;
    order.iter().cycle().take(missing).for_each(|place| out[*place].1 += 1);
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_four_greatest_weights_are_kept_and_add_up() {
        assert_eq!(greatest(vec![(3, 0.0)]), None);
        assert_eq!(greatest(vec![(3, 0.5)]), Some([(3, 65_535), (0, 0), (0, 0), (0, 0)]));
        let third = greatest(vec![(1, 0.2), (2, 0.2), (7, 0.2)]).unwrap();
        assert_eq!(third, [(1, 21_845), (2, 21_845), (7, 21_845), (0, 0)]);
        let many = greatest(vec![(0, 0.1), (1, 0.3), (2, 0.05), (3, 0.25), (4, 0.15), (5, 0.15)]).unwrap();
        assert_eq!(many.map(|(joint, _)| joint), [1, 3, 4, 5]);
        assert_eq!(many.iter().map(|(_, weight)| weight).sum::<u32>(), WHOLE);
        assert!((many[0].1 as f64 - 65_535.0 * 0.3 / 0.85).abs() <= 1.0);
    }
}
