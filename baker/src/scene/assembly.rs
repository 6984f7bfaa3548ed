//! Scenes from CAD assemblies: materials by part, a tessellation for pictures, [exact faces](super::brep) for rays.

use super::brep::{Brep, BrepFace, BrepInstance};
use super::groups::{MaterialGroup, NodeGroups, assign};
use super::model::{bounds_of_placed, divide};
use super::world_mesh::{WorldInstancedMesh, WorldMesh};
use super::{Scene, SceneError};
use glam::{DAffine3, DMat4, DVec3, Vec2, Vec3};
use rayon::prelude::*;
use rebounce_cad::model::{Assembly, Part, PartInstance};
use rebounce_cad::tessellate::{self, Tessellation};
use rebounce_shared::rbn::MAX_MATERIALS;
use rebounce_shared::rbn::meta::Material;
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// Linear RGB reflectance of faces without a colour: the grey of CAD programs.
pub const GREY: [f32; 3] = [0.6; 3];
/// Greatest distance of triangles in pictures from their face, as a share of the assembly's diagonal.
const OF_ASSEMBLY: f64 = 1e-4;
/// The same, as a share of the part's diagonal, which counts where it is less.
const OF_PART: f64 = 5e-4;

/// What an assembly does not say.
#[derive(Clone, Debug, PartialEq)]
pub struct AssemblySettings {
    /// Linear RGB reflectance of faces without a colour.
    pub grey: [f32; 3],
    /// Materials whose surfaces are reconstruction groups.
    pub groups: Vec<MaterialGroup>,
    /// Factor of the chord error of triangles in pictures.
    pub coarseness: f64,
}

impl Default for AssemblySettings {
    fn default() -> Self {
        Self { grey: GREY, groups: Vec::new(), coarseness: 1.0 }
    }
}

/// A part with its faces prepared and tessellated.
struct PreparedPart {
    /// Least and greatest corner; not finite without faces.
    bounds: [DVec3; 2],
    faces: Vec<BrepFace>,
    /// By face.
    triangles: Vec<Tessellation>,
}

/// Why faces of a part are left out, with their number.
type Flaws = BTreeMap<String, usize>;

impl Scene {
    /// Makes a scene of an assembly. `file` is the name in errors.
    ///
    /// # Errors
    /// [`SceneError`] without triangles, or with too many materials.
    pub fn of_assembly(
        file: &str,
        name: String,
        assembly: &Assembly,
        settings: &AssemblySettings,
    ) -> Result<Self, SceneError> {
        let mut scene = Self { name, left_out: assembly.notes.clone(), ..Self::default() };
        let materials = materials(&mut scene, assembly, settings.grey, file)?;
        let mut brep = Brep::default();
        let prepared = prepare(assembly, &materials, settings.coarseness, &mut scene.left_out);
        let mut ranges = Vec::new();
        let mut mesh = WorldMesh::default();
        for (number, part) in prepared.into_iter().enumerate() {
            let world_from_part: Vec<DAffine3> = (assembly.instances.iter())
                .filter(|instance| instance.part == number)
                .map(|instance| instance.world_from_part)
                .collect();
            place(&part, &world_from_part, &mut mesh);
            let first = brep.faces.len() as u32;
            brep.faces.extend(part.faces);
            ranges.push(first..brep.faces.len() as u32);
        }
        let lost = assign(&mut scene, &mut mesh, NodeGroups::default(), &settings.groups);
        let told_of = |name| format!("--group {name:?}: no part has this name");
        scene.notes.extend(lost.into_iter().map(told_of));
        mesh.finish(&mut scene);
        if scene.triangles.is_empty() {
            return Err(SceneError::Empty { file: file.to_owned() });
        }
        let local_from_world = DAffine3::from_translation(-DVec3::from(scene.origin));
        let placed = |instance: &PartInstance| BrepInstance {
            faces: ranges[instance.part].clone(),
            local_from_part: local_from_world * instance.world_from_part,
        };
        brep.instances = assembly.instances.iter().map(placed).collect();
        scene.brep = Some(Arc::new(brep));
        Ok(scene)
    }
}

/// Name of a part in materials and notes.
fn name_of(part: &Part, number: usize) -> String {
    if part.name.is_empty() { format!("part {}", number + 1) } else { part.name.clone() }
}

/// Adds the materials of an assembly to a scene: one for each name and colour. Returns them by part and face.
fn materials(
    scene: &mut Scene,
    assembly: &Assembly,
    grey: [f32; 3],
    file: &str,
) -> Result<Vec<Vec<u32>>, SceneError> {
    let mut known: HashMap<(String, [u32; 3], bool), u32> = HashMap::new();
    let mut uncoloured = 0;
    let mut all = Vec::new();
    for (number, part) in assembly.parts.iter().enumerate() {
        let name = name_of(part, number);
        let mut of_faces = Vec::new();
        for (_, colour) in &part.faces {
            uncoloured += usize::from(colour.is_none());
            let colour = colour.unwrap_or(Vec3::from(grey));
            let key = (name.clone(), colour.to_array().map(f32::to_bits), part.is_closed);
            of_faces.push(*known.entry(key).or_insert_with(|| {
                scene.materials.push(Material {
                    name: name.clone(),
                    base_color: colour.extend(1.0).to_array(),
                    double_sided: !part.is_closed,
                    ..Material::default()
                });
                scene.materials.len() as u32 - 1
            }));
        }
        all.push(of_faces);
    }
    if uncoloured > 0 {
        let [r, g, b] = grey;
        let noun = if uncoloured == 1 { "face has" } else { "faces have" };
        scene.notes.push(format!(
            "{uncoloured} {noun} no colour: --albedo or --materials gives one, {r},{g},{b} now"
        ));
    }
    if let Some(first) = scene.materials.get(MAX_MATERIALS) {
        return Err(SceneError::TooManyMaterials {
            file: file.to_owned(),
            count: scene.materials.len(),
            limit: MAX_MATERIALS,
            name: first.name.clone(),
        });
    }
    Ok(all)
}

/// Prepares and tessellates the parts; says in `left_out` which faces cannot be.
fn prepare(
    assembly: &Assembly,
    materials: &[Vec<u32>],
    coarseness: f64,
    left_out: &mut Vec<String>,
) -> Vec<PreparedPart> {
    let cast = |(part, materials): (&Part, &Vec<u32>)| {
        let (mut faces, mut flaws) = (Vec::new(), Flaws::new());
        for ((face, _), material) in part.faces.iter().zip(materials) {
            match BrepFace::new(face.clone(), *material) {
                Ok(face) => faces.push(face),
                Err(error) => *flaws.entry(error.to_string()).or_default() += 1,
            }
        }
        let boxes = faces.iter().flat_map(|face| &face.pieces).map(|piece| piece.bounds);
        let empty = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let bounds = boxes.fold(empty, |[low, high], [least, most]| [low.min(least), high.max(most)]);
        (PreparedPart { bounds, faces, triangles: Vec::new() }, flaws)
    };
    let mut parts: Vec<(PreparedPart, Flaws)> = assembly.parts.par_iter().zip(materials).map(cast).collect();
    let [low, high] = bounds(&assembly.instances, |part| parts[part].0.bounds);
    let of_assembly = OF_ASSEMBLY * (high - low).length();
    parts.par_iter_mut().for_each(|(part, flaws)| {
        let [low, high] = part.bounds;
        let chord_error = coarseness * of_assembly.min(OF_PART * (high - low).length());
        let tessellated = (part.faces.par_iter())
            .map(|face| tessellate::trimmed(&face.face, chord_error).map_err(|error| error.to_string()))
            .collect::<Vec<_>>();
        let mut kept = Vec::new();
        for (face, triangles) in std::mem::take(&mut part.faces).into_iter().zip(tessellated) {
            match triangles {
                Ok(triangles) => {
                    kept.push(face);
                    part.triangles.push(triangles);
                }
                Err(error) => *flaws.entry(error).or_default() += 1,
            }
        }
        part.faces = kept;
    });
    let named = parts.into_iter().zip(&assembly.parts).enumerate();
    let mut out = Vec::new();
    for (number, ((prepared, flaws), part)) in named {
        let name = name_of(part, number);
        for (error, count) in flaws {
            let noun = if count == 1 { "face" } else { "faces" };
            left_out.push(format!("{count} {noun} of {name:?}: {error}"));
        }
        out.push(prepared);
    }
    out
}

/// Least and greatest corner of the boxes of all instances, by the box of a part; parts without a finite one do not count.
fn bounds(instances: &[PartInstance], of_part: impl Fn(usize) -> [DVec3; 2]) -> [DVec3; 2] {
    let boxes =
        instances.iter().map(|placed| bounds_of_placed(&placed.world_from_part, of_part(placed.part)));
    let empty = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let finite = boxes.filter(|corners| corners.iter().all(|corner| corner.is_finite()));
    finite.fold(empty, |[low, high], [least, most]| [low.min(least), high.max(most)])
}

/// Adds the triangles of a part at its placements: as models where that saves much.
fn place(part: &PreparedPart, world_from_part: &[DAffine3], out: &mut WorldMesh) {
    let triangles = part.triangles.iter().map(|mesh| mesh.triangles.len()).sum();
    let matrices: Vec<DMat4> = world_from_part.iter().map(|place| DMat4::from(*place)).collect();
    let mut alone = vec![true; world_from_part.len()];
    for copies in divide(&matrices, triangles, part.bounds) {
        let mut mesh = WorldMesh::default();
        append(part, &DAffine3::from_mat4(copies.model_from_mesh), &mut mesh);
        out.in_models.0 += mesh.positions.len();
        out.in_models.1 += mesh.triangles.len();
        copies.placed.iter().for_each(|(number, _)| alone[*number] = false);
        let world_from_model = copies.placed.into_iter().map(|(_, place)| place).collect();
        out.models.push(WorldInstancedMesh { mesh, world_from_model, group: 0 });
    }
    for (place, _) in world_from_part.iter().zip(alone).filter(|(_, alone)| *alone) {
        append(part, place, out);
    }
}

/// Adds the triangles of a part's faces, with the exact normals at the vertices.
fn append(part: &PreparedPart, world_from_part: &DAffine3, out: &mut WorldMesh) {
    let is_mirrored = world_from_part.matrix3.determinant() < 0.0;
    let normal_from_part = world_from_part.matrix3.inverse().transpose();
    for (face, mesh) in part.faces.iter().zip(&part.triangles) {
        let first = out.positions.len() as u32;
        out.positions.extend(mesh.positions.iter().map(|p| world_from_part.transform_point3(*p)));
        let normal = |at| (normal_from_part * face.cast.normal(at)).normalize_or_zero().as_vec3();
        out.normals.extend(mesh.parameters.iter().map(|at| normal(*at)));
        out.uvs.extend(mesh.positions.iter().map(|_| Vec2::ZERO));
        let is_turned = face.face.is_reversed != is_mirrored;
        // At a pole, which is one point in space, some have no area.
        let has_area = |t: &&[u32; 3]| WorldMesh::has_area(t.map(|i| mesh.positions[i as usize]));
        out.triangles.extend(mesh.triangles.iter().filter(has_area).map(|&[a, b, c]| {
            let [a, b, c] = if is_turned { [a, c, b] } else { [a, b, c] };
            [first + a, first + b, first + c]
        }));
        out.triangle_material.resize(out.triangles.len(), face.material);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    #[test]
    fn the_box_of_turned_instances_has_all_corners_of_theirs() {
        let of_part = |part: usize| match part {
            0 => [DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0)],
            _ => [DVec3::INFINITY, DVec3::NEG_INFINITY],
        };
        let placed = |part, turn: f64, along: f64| PartInstance {
            part,
            path: Vec::new(),
            world_from_part: DAffine3::from_rotation_translation(
                DQuat::from_rotation_z(turn.to_radians()),
                along * DVec3::X,
            ),
        };
        // By 45 degrees, least and greatest corner come to lie above each other.
        let [low, high] = bounds(&[placed(0, 45.0, 0.0), placed(1, 0.0, 0.0)], of_part);
        let half = 0.5 * 2f64.sqrt();
        assert!(low.distance(DVec3::new(-half, 0.0, 0.0)) < 1e-15, "{low}");
        assert!(high.distance(DVec3::new(half, 2.0 * half, 0.0)) < 1e-15, "{high}");
        let instances: Vec<PartInstance> =
            (0..8).map(|i| placed(0, 40.0 * f64::from(i), 0.3 * f64::from(i))).collect();
        let [low, high] = bounds(&instances, of_part);
        for place in &instances {
            for corner in [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(1.0, 1.0, 0.0)] {
                let corner = place.world_from_part.transform_point3(corner);
                assert!((corner - low).min_element() > -1e-12 && (high - corner).min_element() > -1e-12);
            }
        }
    }
}
