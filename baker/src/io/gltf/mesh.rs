//! Meshes of the file, in mesh space.

use super::bind::Bind;
use super::material::Materials;
use super::notes::Told;
use super::primitive::PrimitiveReader;
use super::rest::Rest;
use super::source::Source;
use crate::scene::SceneError;
use glam::{DVec2, DVec3, Vec2, Vec4};
use gltf::json::accessor::Type;
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;
use rebounce_shared::rbn::LARGEST;

/// Triangles of a primitive, in mesh space; in world space if skinned.
pub(super) struct MeshPart {
    /// Name of the part in errors.
    pub what: String,
    pub positions: Vec<DVec3>,
    /// One per vertex, zero where not finite; without normals the triangles are flat-shaded.
    pub normals: Option<Vec<DVec3>>,
    /// Coordinates for the material's first texture, one per vertex.
    pub uvs: Vec<Vec2>,
    /// Linear RGB and alpha from 0 to 1, one per vertex; `None` if all are white.
    pub colors: Option<Vec<Vec4>>,
    pub triangles: Vec<[u32; 3]>,
    pub material: u32,
    /// The part before it is deformed, if animations do that.
    pub bind: Option<Bind>,
}

/// Name of a mesh in errors.
pub(super) fn name(source: &Source, index: usize) -> String {
    let name = source.root.meshes.get(index).and_then(|mesh| mesh.name.as_deref());
    format!("mesh {index} ({:?})", name.unwrap_or_default())
}

/// Reads the parts of mesh `index`, deformed by `rest`; shining ones are of `group`, if there is one. Points and lines are left out, with a message.
pub(super) fn read(
    source: &Source,
    index: usize,
    rest: &Rest,
    (materials, group): (&mut Materials, Option<&str>),
    told: &mut Told,
) -> Result<Vec<MeshPart>, SceneError> {
    let mesh = source.root.meshes.get(index);
    let mesh = mesh.ok_or_else(|| source.malformed(format!("there is no mesh {index}")))?;
    let mut parts = Vec::new();
    let mut thin = 0;
    for (p, primitive) in mesh.primitives.iter().enumerate() {
        let what = format!("{}, primitive {p}", name(source, index));
        match primitive.mode {
            Checked::Valid(Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) => {
                parts.extend(part(source, primitive, what, rest, (materials, group), told)?);
            }
            Checked::Valid(Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip) => thin += 1,
            Checked::Invalid => {
                return Err(source.malformed(format!("{what} has an unknown mode: glTF has 0 to 6")));
            }
        }
    }
    if thin > 0 {
        told.left_out.push(format!("{thin} primitives of {}: they are points or lines", name(source, index)));
    }
    Ok(parts)
}

fn part(
    source: &Source,
    primitive: &Primitive,
    what: String,
    rest: &Rest,
    (materials, group): (&mut Materials, Option<&str>),
    told: &mut Told,
) -> Result<Option<MeshPart>, SceneError> {
    let numbers = PrimitiveReader::new(source, primitive, &what)?;
    let Some(positions) = numbers.read::<3>(&Semantic::Positions, Type::Vec3)? else {
        told.left_out.push(format!("{what}: it has no positions"));
        return Ok(None);
    };
    if !positions.iter().flatten().all(|x| x.is_finite()) {
        return Err(source.malformed(format!("{what} has a position that is not a finite number")));
    }
    let count = positions.len();
    let mut unusable = 0;
    let normals = numbers.read::<3>(&Semantic::Normals, Type::Vec3)?;
    let mut normals: Option<Vec<DVec3>> = normals.map(|normals| {
        let finite = |n: [f64; 3]| Some(DVec3::from(n)).filter(|n| n.is_finite());
        normals.into_iter().map(|n| finite(n).unwrap_or_else(|| counted(&mut unusable))).collect()
    });
    let (material, uv_source) = materials.index(primitive.material.map(|m| m.value()), group)?;
    let uvs = match uv_source {
        Some(u) => numbers.read::<2>(&Semantic::TexCoords(u.set), Type::Vec2)?.map(|uvs| (u, uvs)),
        None => None,
    };
    let uvs: Vec<Vec2> = match uvs {
        Some((u, uvs)) => {
            let moved = uvs.into_iter().map(|[s, t]| u.matrix.transform_point2(DVec2::new(s, t)).as_vec2());
            moved
                .map(|uv| if uv.abs().max_element() < LARGEST { uv } else { counted(&mut unusable) })
                .collect()
        }
        None => {
            // Without coordinates, all are zero, as in browsers.
            let uv = uv_source.map(|u| u.matrix.transform_point2(DVec2::ZERO).as_vec2());
            if let Some(u) = uv_source {
                let name = materials.name(material);
                told.notes.push(format!(
                    "{what} has no TEXCOORD_{}, which its material {name:?} asks for: its textures are one colour, \
                     that of one texel",
                    u.set
                ));
            }
            vec![uv.filter(|uv| uv.abs().max_element() < LARGEST).unwrap_or(Vec2::ZERO); count]
        }
    };
    let colors = colors(&numbers, &mut unusable)?;
    if primitive.material.is_none() && colors.is_none() && materials.has_white_default() {
        told.notes.push(format!(
            "{what} has no material: such surfaces are white in glTF, with an albedo of 1, which is that of no real one; \
             --albedo 0.8 gives them another"
        ));
    }
    let same = |len: usize| len == count;
    if !same(uvs.len())
        || !normals.as_ref().is_none_or(|n| same(n.len()))
        || !colors.as_ref().is_none_or(|c| same(c.len()))
    {
        return Err(source.malformed(format!("{what} has attributes of different lengths")));
    }
    if unusable > 0 {
        told.left_out.push(format!(
            "{unusable} normals, texture coordinates or colours of {what}: they are not finite numbers"
        ));
    }
    let mut triangles = numbers.triangles(count)?;
    let mut positions: Vec<DVec3> = positions.into_iter().map(DVec3::from).collect();
    let mut bind = rest.bind(source, primitive, &numbers, &positions, normals.as_deref())?;
    if rest.apply(source, primitive, &numbers, &mut positions, normals.as_deref_mut())? {
        triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
        bind.iter_mut().for_each(|bind| bind.is_mirrored = true);
    }
    Ok(Some(MeshPart { what, positions, normals, uvs, colors, triangles, material, bind }))
}

/// Returns the default in place of a non-finite value, and increments `count`.
fn counted<T: Default>(count: &mut usize) -> T {
    *count += 1;
    T::default()
}

/// Returns the vertex colours; `None` if all are white.
fn colors(numbers: &PrimitiveReader, unusable: &mut usize) -> Result<Option<Vec<Vec4>>, SceneError> {
    let read = if numbers.is(&Semantic::Colors(0), Type::Vec3) {
        let opaque = |rgb: Vec<[f64; 3]>| rgb.into_iter().map(|[r, g, b]| [r, g, b, 1.0]).collect();
        numbers.read::<3>(&Semantic::Colors(0), Type::Vec3)?.map(opaque)
    } else {
        numbers.read::<4>(&Semantic::Colors(0), Type::Vec4)?
    };
    let Some(read) = read else {
        return Ok(None);
    };
    let bounded = |c: [f64; 4]| {
        let color = Vec4::from_array(c.map(|x| x as f32));
        // A colour over 1 would create energy.
        if color.is_finite() { color.clamp(Vec4::ZERO, Vec4::ONE) } else { counted::<Vec4>(unusable) + 1.0 }
    };
    let colors: Vec<Vec4> = read.into_iter().map(bounded).collect();
    Ok(colors.iter().any(|c| *c != Vec4::ONE).then_some(colors))
}
