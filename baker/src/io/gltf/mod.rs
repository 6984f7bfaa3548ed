//! glTF 2.0 to [`Scene`].
//!
//! * `document`, `exact`, `repair` – JSON: parsing by the `gltf` crate, values that the crate loses, malformed input;
//!   `container`, `source`, `beside` – bytes of buffers and images; `accessor` – accessor elements;
//! * `meshopt`, `draco` – decompression; `extensions` – supported and refused extensions;
//! * `material`, `texture_info`, `specular`, `transmission` – materials, texture references, highlights, transmission; `picture` – image
//!   selection; `merge` – merging of equal materials;
//! * `primitive`, `mesh` – triangles in mesh space; `rest` – morph targets and skins; `deforming`, `bind`, `rig` – what animations
//!   deform of them;
//! * `instances`, `place` – world-space placement; `choice` – scene selection; `notes` – messages about a file; `node`, `pose` – transforms and cameras;
//! * `posed` – the file as an animation has it at a time;
//! * `groups` – reconstruction groups;
//! * `light`, `light_group`, `punctual`, `area_light`, `image_based`, `enclosed` – lights, and lamps enclosed by a mesh; `animation` – animated lights.

mod accessor;
mod animation;
mod area_light;
mod beside;
mod bind;
mod choice;
mod container;
mod deforming;
mod document;
mod draco;
mod enclosed;
mod exact;
mod extensions;
mod groups;
mod image_based;
mod instances;
mod keyframes;
mod light;
mod light_group;
mod material;
mod merge;
mod mesh;
mod meshopt;
mod node;
mod node_animation;
mod notes;
mod picture;
mod place;
mod pose;
mod posed;
mod primitive;
mod punctual;
mod repair;
mod rest;
mod rig;
mod source;
mod specular;
mod texture_info;
mod transmission;

use super::Files;
use super::files::Disk;
use super::options::{LoadOptions, UNUSED_ALBEDO};
use crate::scene::groups::{GroupedMeshes, NodeGroups};
use crate::scene::world_mesh::WorldMesh;
use crate::scene::{Scene, SceneError};
use enclosed::Lamps;
use glam::DMat4;
use merge::merge;
use mesh::MeshPart;
use notes::{Told, grouped};
use place::PlacementNotes;
use rebounce_shared::rbn::{MAX_COPIES, MAX_TRIANGLES};
use rest::{AnimatedParts, Rest, Skins};
use rig::RigBuilder;
use source::Source;
use std::collections::BTreeMap;
use std::iter::Zip;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Bounding-box diagonals, scene units, for which 32-bit floats suffice.
const SIZES: std::ops::RangeInclusive<f64> = 1e-9..=1e12;
/// Threshold for the ratio of a mesh's longest triangle side to the scene's median side. A mesh over the threshold is
/// reported: positions are rounded to a share of the scene's extent.
const HUGE: f64 = 1e5;

/// Maximum number of mesh placements.
const MOST_PLACES: usize = MAX_COPIES as usize;

/// Loads a .gltf or .glb file.
pub(super) fn load(files: &dyn Files, path: &Path, options: &LoadOptions) -> Result<Scene, SceneError> {
    let mut source = Source::open(files, path)?;
    if let Some(pose) = &options.pose {
        posed::apply(&mut source, pose)?;
    }
    let name = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    convert_with(&source, name, options)
}

/// Loads a file's bytes.
pub(super) fn from_bytes(name: &str, bytes: &[u8]) -> Result<Scene, SceneError> {
    let source = Source::parse(name.to_owned(), &Disk, PathBuf::new(), bytes)?;
    convert(&source, name.to_owned())
}

fn convert(source: &Source, name: String) -> Result<Scene, SceneError> {
    convert_with(source, name, &LoadOptions::default())
}

fn convert_with(source: &Source, name: String, options: &LoadOptions) -> Result<Scene, SceneError> {
    let mut scene = Scene { name, ..Scene::default() };
    let mut told = Told { left_out: extensions::unread(&source.root), notes: Vec::new() };
    let (taken, roots) = choice::roots(source, options.scene.as_deref(), &mut told)?;
    let nodes = node::flatten(source, roots)?;
    let lights = light::placed(source, &nodes, &mut told)?;
    for &(place, index) in &lights {
        scene.lights.push(light::of(source, &nodes[place], index, &mut told)?);
        scene.light_names.push(light::own_name(source, &nodes[place], index));
    }
    let mut moved = lights.clone();
    let mut lamps = Lamps::new(lights.iter().map(|(_, index)| *index).zip(&scene.lights));
    for area_light::PlacedAreaLight { place, light, name } in area_light::placed(source, &nodes, &mut told)? {
        // Pointers of animations name no area light.
        moved.push((place, usize::MAX));
        scene.lights.push(light);
        scene.light_names.push(name);
    }
    let surroundings =
        taken.map(|taken| image_based::of_scene(source, taken, &mut told)).transpose()?.flatten();
    if let Some(image_based::SceneEnvironment { light, name, environment }) = surroundings {
        scene.lights.push(light);
        scene.light_names.push(name);
        scene.environment = Some(environment);
    }
    let mut materials = material::Materials::new(source, options.albedo);
    let mut mesh = WorldMesh::default();
    let light_groups = light_group::names(source, &nodes, &options.light_groups, &mut told);
    let animated = match options.pose.is_some() || options.is_still {
        true => vec![None; nodes.len()],
        false => deforming::nodes(source, &nodes, &mut told)?,
    };
    let deforms: Vec<bool> = animated.iter().map(Option::is_some).collect();
    let (node_groups, of_node, places) = groups::of_nodes(source, &nodes, &deforms, options, &mut told);
    let grouped_nodes = Nodes { nodes: &nodes, light_groups, groups: &node_groups, of_node, animated };
    let mut rig = RigBuilder::new(source);
    let out = &mut PlacedParts { mesh: &mut mesh, rig: &mut rig };
    let seen = place_all(source, &grouped_nodes, &mut materials, &mut lamps, out, &mut told)?;
    let deform;
    (mesh.rig, deform) = rig.finish(&mut told)?;
    if mesh.triangles.is_empty() && mesh.models.is_empty() {
        return Err(SceneError::Empty { file: source.file.clone() });
    }
    if options.albedo.is_some() && !materials.has_default() {
        told.notes.push(UNUSED_ALBEDO.to_owned());
    }
    materials.finish(&mut scene)?;
    merge(&mut scene, &mut mesh, &source.file)?;
    let by_material = groups::of_materials(source, &nodes, &deforms, &node_groups, options);
    let lost = crate::scene::groups::assign(&mut scene, &mut mesh, node_groups, &by_material);
    let told_of = |name| format!("--group {name:?}: no node and no material of the scene has this name");
    told.notes.extend(lost.into_iter().map(told_of));
    scene.left_out.append(&mut told.left_out);
    mesh.finish(&mut scene);
    if scene.triangles.is_empty() {
        return Err(SceneError::Empty { file: source.file.clone() });
    }
    let placed = scene.triangles_placed();
    if placed > MAX_TRIANGLES {
        let (file, what) = (source.file.clone(), "triangles with all copies");
        return Err(SceneError::TooLarge {
            file,
            what,
            count: placed as usize,
            limit: MAX_TRIANGLES as usize,
        });
    }
    note_odd_triangles(source, &mut scene, &seen);
    let (low, high) = scene.bounds();
    let size = (high - low).as_dvec3().length();
    if !SIZES.contains(&size) {
        let problem = format!("its triangles are {size:e} units across, beyond the range of numbers");
        return Err(source.malformed(problem));
    }
    let (low, high) = scene.main_part();
    let main_size = (high - low).as_dvec3().length();
    for node in &nodes {
        if let Some(camera) = node::camera(source, node, scene.origin, main_size)? {
            scene.cameras.push(camera);
            scene.camera_names.push(node::camera_name(source, node));
        }
    }
    let moved = animation::Animated { nodes: &nodes, lights: &moved, places: &places, deform: &deform };
    (scene.animations, scene.groups.animations) = animation::animations(source, &moved, &mut scene.left_out)?;
    if scene.groups.is_empty() {
        scene.groups.animations.clear();
    }
    told.notes.extend(lamps.enclosed.iter().filter_map(|lamp| lamp.note(source, size)));
    told.notes.extend(source.notes());
    told.notes.append(&mut scene.notes);
    scene.left_out = grouped(scene.left_out);
    scene.notes = grouped(told.notes);
    Ok(scene)
}

/// Nodes of the scene with their groups.
struct Nodes<'a> {
    nodes: &'a [node::PlacedNode],
    /// Group of shining surfaces of each node, if one is named.
    light_groups: Vec<Option<Rc<str>>>,
    groups: &'a NodeGroups,
    /// Group of each node.
    of_node: Vec<u32>,
    /// What animations change of the deformation of each node's mesh, if they do.
    animated: Vec<Option<AnimatedParts>>,
}

/// What is placed so far.
struct PlacedParts<'a, 'b> {
    mesh: &'a mut WorldMesh,
    rig: &'a mut RigBuilder<'b>,
}

/// Mesh index, index of the deforming node, if any, group of shining surfaces, if its nodes name one, and group of nodes.
type Shape = (usize, Option<usize>, Option<Rc<str>>, u32);

/// Places all meshes in node order. A mesh is read once per deformation and kept until the last node with the mesh is
/// placed; a mesh with many placements becomes a model.
fn place_all(
    source: &Source,
    Nodes { nodes, light_groups, groups, of_node, animated }: &Nodes<'_>,
    materials: &mut material::Materials,
    lamps: &mut Lamps,
    PlacedParts { mesh: out, rig }: &mut PlacedParts<'_, '_>,
    told: &mut Told,
) -> Result<BTreeMap<usize, PlacementNotes>, SceneError> {
    let mut places: BTreeMap<Shape, Vec<DMat4>> = BTreeMap::new();
    let mut rests: BTreeMap<usize, Rest> = BTreeMap::new();
    let mut skins = Skins::default();
    // Shape of every node with a mesh, and the number of placements added by the node.
    let mut placed: Vec<(Shape, usize)> = Vec::new();
    let mut animated_nodes: BTreeMap<usize, &node::PlacedNode> = BTreeMap::new();
    let mut count = 0;
    for (((node, light_group), group), animated) in nodes.iter().zip(light_groups).zip(of_node).zip(animated)
    {
        let Some(index) = source.root.nodes[node.index].mesh else { continue };
        let index = index.value();
        let mut more = instances::of(source, node)?;
        let mut rest = Rest::of_node(source, node.index, index, node.world, &mut skins)?;
        if let Some(animated) = animated {
            rest = Some(rest.unwrap_or_else(|| Rest::of_mesh(source, index)).animated(*animated));
            animated_nodes.insert(node.index, node);
        }
        if rest.as_ref().is_some_and(Rest::is_skinned) {
            if more.len() > 1 {
                let problem = "it has a skin, whose joints place it once";
                told.left_out.push(format!("{} instances of node {}: {problem}", more.len() - 1, node.index));
            }
            more = vec![DMat4::IDENTITY];
        }
        count += more.len();
        if count > MOST_PLACES {
            let (file, what) = (source.file.clone(), "places of meshes");
            return Err(SceneError::TooLarge { file, what, count, limit: MOST_PLACES });
        }
        let shape = (index, rest.is_some().then_some(node.index), light_group.clone(), *group);
        rests.extend(rest.map(|rest| (node.index, rest)));
        placed.push((shape.clone(), more.len()));
        places.entry(shape).or_default().extend(more);
    }
    let mut known: BTreeMap<Shape, (Vec<MeshPart>, Alone)> = BTreeMap::new();
    let mut seen: BTreeMap<usize, PlacementNotes> = BTreeMap::new();
    let mut grouped = GroupedMeshes::default();
    for (shape, count) in placed {
        let (index, deforming, light_group, group) = &shape;
        let (index, deforming, group) = (*index, *deforming, *group);
        let seen = seen.entry(index).or_default();
        let animated = deforming.and_then(|node| animated_nodes.get(&node));
        if let Some(node) = animated {
            let rest = deforming.and_then(|node| rests.remove(&node)).unwrap_or_default();
            let parts = mesh::read(source, index, &rest, (materials, light_group.as_deref()), told)?;
            let places = places.remove(&shape).unwrap_or_default();
            let opaque: Vec<&MeshPart> =
                parts.iter().filter(|part| materials.is_opaque(part.material)).collect();
            lamps.look(index, &opaque, &places);
            let matrix = places.first().copied().unwrap_or(DMat4::IDENTITY);
            let (vertex, triangle) = (out.positions.len(), out.triangles.len());
            for part in &parts {
                place::append(source, part, &matrix, out, seen)?;
            }
            out.triangle_group.resize(triangle, 0);
            out.triangle_group.resize(out.triangles.len(), group);
            rig.add(node, &rest, &parts, &matrix, vertex as u32, told)?;
            continue;
        }
        let (parts, mut alone) = match known.remove(&shape) {
            Some(found) => found,
            None => {
                let rest = deforming.and_then(|node| rests.remove(&node));
                let rest = rest.unwrap_or_else(|| Rest::of_mesh(source, index));
                let parts = mesh::read(source, index, &rest, (materials, light_group.as_deref()), told)?;
                let places = places.remove(&shape).unwrap_or_default();
                let opaque: Vec<&MeshPart> =
                    parts.iter().filter(|part| materials.is_opaque(part.material)).collect();
                lamps.look(index, &opaque, &places);
                let taken = place::models(source, (&parts, group), &places, out, seen)?;
                (parts, places.into_iter().zip(taken))
            }
        };
        for (matrix, _) in alone.by_ref().take(count).filter(|(_, is_taken)| !is_taken) {
            for part in &parts {
                if group == 0 {
                    place::append(source, part, &matrix, out, seen)?;
                    continue;
                }
                let (mesh, pivot) = grouped.of(groups, group);
                place::append(source, part, &(DMat4::from_translation(-pivot) * matrix), mesh, seen)?;
            }
        }
        if alone.len() > 0 {
            known.insert(shape, (parts, alone));
        }
    }
    grouped.finish(groups, out);
    Ok(seen)
}

/// Remaining placements of a mesh, and whether a model covers the placement.
type Alone = Zip<std::vec::IntoIter<DMat4>, std::vec::IntoIter<bool>>;

/// Adds to `left_out`: degenerate triangles, and triangles so long that small triangles lose precision.
fn note_odd_triangles(source: &Source, scene: &mut Scene, seen: &BTreeMap<usize, PlacementNotes>) {
    let listed = |odd: Vec<(usize, String)>| {
        let named: Vec<String> =
            odd.iter().take(3).map(|(i, count)| format!("{}{count}", mesh::name(source, *i))).collect();
        let more = if odd.len() > 3 { format!(" and {} more meshes", odd.len() - 3) } else { String::new() };
        format!("{}{more}", named.join(", "))
    };
    let flat = seen.iter().filter(|(_, s)| s.degenerate > 0);
    let flat: Vec<_> = flat.map(|(i, s)| (*i, format!(": {}", s.degenerate))).collect();
    if !flat.is_empty() {
        let count = scene.degenerate_triangles;
        scene.left_out.push(format!("{count} triangles without area, of {}", listed(flat)));
    }
    let mut sides: Vec<f32> = (scene.triangles.iter())
        .map(|t| scene.positions[t[0] as usize].distance(scene.positions[t[1] as usize]))
        .collect();
    let middle = sides.len() / 2;
    let median = *sides.select_nth_unstable_by(middle, f32::total_cmp).1 as f64;
    let huge = seen.iter().filter(|(_, s)| s.longest > HUGE * median);
    let huge: Vec<_> = huge.map(|(i, s)| (*i, format!(" ({:.0} units)", s.longest))).collect();
    if !huge.is_empty() {
        scene.left_out.push(format!(
            "exactness of small triangles: some of {} are over {HUGE} times as long as the scene's middle one \
             ({median:.2e} units), so that small ones are rounded",
            listed(huge)
        ));
    }
}

#[cfg(test)]
mod tests;
