//! Primitives to world-space triangles.

use super::material::Materials;
use super::node::Placed;
use super::schema::Primitive;
use super::source::Source;
use crate::scene::{SceneError, WorldMesh};
use glam::{DMat3, DVec2, DVec3, Vec2, Vec3};

/// Appends the triangles of mesh `index`, placed by `node`. Points and lines are left out; a
/// skinned or morphed mesh is taken as it rests.
pub(super) fn append(
    source: &Source,
    index: usize,
    node: &Placed,
    materials: &mut Materials,
    out: &mut WorldMesh,
) -> Result<(), SceneError> {
    let mesh = source.root.meshes.get(index);
    let mesh = mesh.ok_or_else(|| source.malformed(format!("there is no mesh {index}")))?;
    for (p, primitive) in mesh.primitives.iter().enumerate() {
        if matches!(primitive.mode.unwrap_or(4), 4..=6) {
            let what = format!("mesh {index} ({:?}), primitive {p}", mesh.name);
            append_primitive(source, primitive, &what, node, materials, out)?;
        }
    }
    Ok(())
}

fn append_primitive(
    source: &Source,
    primitive: &Primitive,
    what: &str,
    node: &Placed,
    materials: &mut Materials,
    out: &mut WorldMesh,
) -> Result<(), SceneError> {
    let bad = |problem: &str| source.malformed(format!("{what} {problem}"));
    let attribute = |name: &str| primitive.attributes.get(name).copied();
    let Some(position) = attribute("POSITION") else {
        return Ok(());
    };
    let positions = source.read::<3>(position, "VEC3", &format!("POSITION of {what}"))?;
    if !positions.iter().flatten().all(|x| x.is_finite()) {
        return Err(bad("has a position that is not a finite number"));
    }
    let count = positions.len();
    let normals = match attribute("NORMAL") {
        Some(a) => Some(source.read::<3>(a, "VEC3", &format!("NORMAL of {what}"))?),
        None => None,
    };
    let (material, uv_source) = materials.index(primitive.material)?;
    let uv_attribute = uv_source.and_then(|u| Some((u, attribute(&format!("TEXCOORD_{}", u.set))?)));
    let uvs: Vec<Vec2> = match uv_attribute {
        Some((u, a)) => source
            .read::<2>(a, "VEC2", &format!("TEXCOORD_{} of {what}", u.set))?
            .into_iter()
            .map(|[s, t]| {
                let uv = u.matrix.transform_point2(DVec2::new(s, t)).as_vec2();
                if uv.is_finite() { uv } else { Vec2::ZERO }
            })
            .collect(),
        None => vec![Vec2::ZERO; count],
    };
    if uvs.len() != count || normals.as_ref().is_some_and(|n| n.len() != count) {
        return Err(bad("has attributes of different lengths"));
    }
    let indices = match primitive.indices {
        Some(a) => source.read_indices(a, &format!("indices of {what}"))?,
        None => (0..count as u32).collect(),
    };
    if let Some(i) = indices.iter().find(|&&i| i as usize >= count) {
        return Err(bad(&format!("has the index {i}, but {count} vertices")));
    }
    let mut triangles = assemble(primitive.mode.unwrap_or(4), &indices);

    let linear = DMat3::from_mat4(node.world);
    let cofactor = DMat3::from_cols(
        linear.y_axis.cross(linear.z_axis),
        linear.z_axis.cross(linear.x_axis),
        linear.x_axis.cross(linear.y_axis),
    );
    let mirrored = linear.determinant() < 0.0;
    if mirrored {
        triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    let world: Vec<DVec3> = positions.iter().map(|&p| node.world.transform_point3(DVec3::from(p))).collect();
    if !world.iter().all(|p| p.is_finite()) {
        return Err(bad("is placed beyond the range of numbers"));
    }
    if out.positions.len() + triangles.len().saturating_mul(3) > u32::MAX as usize {
        let count = out.positions.len() + triangles.len() * 3;
        return Err(SceneError::TooLarge { file: source.file.clone(), count });
    }
    let first = out.positions.len() as u32;
    match normals {
        Some(normals) => {
            // The inverse transpose is the cofactor matrix over the determinant; only its sign counts.
            let sign = if mirrored { -1.0 } else { 1.0 };
            let unit = |&n: &[f64; 3]| {
                (cofactor * DVec3::from(n) * sign).try_normalize().unwrap_or(DVec3::ZERO).as_vec3()
            };
            out.normals.extend(normals.iter().map(unit));
            out.positions.extend(world);
            out.uvs.extend(uvs);
            out.triangles.extend(triangles.iter().map(|t| t.map(|i| i + first)));
        }
        None => {
            // glTF: without normals, flat ones; vertices are not shared.
            for t in &triangles {
                let [a, b, c] = t.map(|i| world[i as usize]);
                let flat = (b - a).cross(c - a).try_normalize().map_or(Vec3::ZERO, |n| n.as_vec3());
                let at = out.positions.len() as u32;
                out.triangles.push([at, at + 1, at + 2]);
                for &i in t {
                    out.positions.push(world[i as usize]);
                    out.normals.push(flat);
                    out.uvs.push(uvs[i as usize]);
                }
            }
        }
    }
    out.triangle_material.resize(out.triangles.len(), material);
    Ok(())
}

/// Triangles of a triangle list (4), strip (5) or fan (6), counter-clockwise as glTF has them.
fn assemble(mode: u32, indices: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        5 => indices
            .windows(3)
            .enumerate()
            .map(|(i, w)| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[0], w[2], w[1]] })
            .collect(),
        6 => indices.windows(2).skip(1).map(|w| [w[0], w[1], indices[0]]).collect(),
        _ => indices.as_chunks::<3>().0.to_vec(),
    }
}
