//! glTF 2.0 to [`Scene`].
//!
//! * `schema` – the JSON; `container`, `source` – the bytes; `accessor` – the numbers;
//! * `meshopt`, `draco` – compressed numbers; `extensions` – what is refused;
//! * `material` – materials and textures; `transmission` – light that goes through; `picture` – which image of a texture is taken;
//! * `primitive`, `mesh` – triangles in their own space; `instances`, `place` – in the world;
//! * `node` – transforms, lights and cameras; `animation` – how lights move.

mod accessor;
mod animation;
mod container;
mod draco;
mod extensions;
mod instances;
mod material;
mod mesh;
mod meshopt;
mod node;
mod picture;
mod place;
mod primitive;
mod schema;
mod source;
mod transmission;

use super::merge::merge;
use super::{Scene, SceneError, WorldMesh};
use glam::DMat4;
use mesh::Part;
use place::Seen;
use rebounce_shared::rbn::{MAX_COPIES, MAX_TRIANGLES};
use source::Source;
use std::collections::BTreeMap;
use std::iter::Zip;
use std::path::{Path, PathBuf};

/// Sizes of a scene, in its units, that 32-bit numbers are good for.
const SIZES: std::ops::RangeInclusive<f64> = 1e-9..=1e12;
/// Triangles so many times as long as the middle one are noted: positions are rounded to a share of the whole.
const HUGE: f64 = 1e5;

/// Places where meshes stand, at most.
const MOST_PLACES: usize = MAX_COPIES as usize;

/// Loads a .gltf or .glb file.
pub(super) fn load(path: &Path) -> Result<Scene, SceneError> {
    let source = Source::open(path)?;
    let name = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    convert(&source, name)
}

/// Loads a file's bytes.
pub(super) fn from_bytes(name: &str, bytes: &[u8]) -> Result<Scene, SceneError> {
    let source = Source::parse(name.to_owned(), PathBuf::new(), bytes)?;
    convert(&source, name.to_owned())
}

fn convert(source: &Source, name: String) -> Result<Scene, SceneError> {
    let mut scene = Scene { name, ..Scene::default() };
    let nodes = node::flatten(source)?;
    let mut materials = material::Materials::new(source);
    let mut mesh = WorldMesh::default();
    let mut left_out = Vec::new();
    let seen = place_all(source, &nodes, &mut materials, &mut mesh, &mut left_out)?;
    if mesh.triangles.is_empty() && mesh.models.is_empty() {
        return Err(SceneError::Empty { file: source.file.clone() });
    }
    materials.finish(&mut scene)?;
    merge(&mut scene, &mut mesh, &source.file)?;
    scene.left_out.extend(left_out);
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
    for node in &nodes {
        scene.lights.extend(node::light(source, node)?);
        scene.cameras.extend(node::camera(source, node, scene.origin, size)?);
    }
    scene.animations = animation::animations(source, &nodes, &mut scene.left_out)?;
    Ok(scene)
}

/// Places all meshes, in the order of the nodes. A mesh is read once and kept as long as nodes will need it; one that stands
/// in many places becomes a model.
fn place_all(
    source: &Source,
    nodes: &[node::Placed],
    materials: &mut material::Materials,
    out: &mut WorldMesh,
    left_out: &mut Vec<String>,
) -> Result<BTreeMap<usize, Seen>, SceneError> {
    let mut places: BTreeMap<usize, Vec<DMat4>> = BTreeMap::new();
    // The mesh of each node that has one, and how many places it adds.
    let mut placed: Vec<(usize, usize)> = Vec::new();
    let mut count = 0;
    for node in nodes {
        let Some(index) = source.root.nodes[node.index].mesh else { continue };
        let more = instances::of(source, node)?;
        count += more.len();
        if count > MOST_PLACES {
            let (file, what) = (source.file.clone(), "places of meshes");
            return Err(SceneError::TooLarge { file, what, count, limit: MOST_PLACES });
        }
        placed.push((index, more.len()));
        places.entry(index).or_default().extend(more);
    }
    let mut known: BTreeMap<usize, (Vec<Part>, Alone)> = BTreeMap::new();
    let mut seen: BTreeMap<usize, Seen> = BTreeMap::new();
    for (index, count) in placed {
        let seen = seen.entry(index).or_default();
        let (parts, mut alone) = match known.remove(&index) {
            Some(found) => found,
            None => {
                let parts = mesh::read(source, index, materials, left_out)?;
                let places = places.remove(&index).unwrap_or_default();
                let taken = place::models(source, &parts, &places, out, seen)?;
                (parts, places.into_iter().zip(taken))
            }
        };
        for (matrix, _) in alone.by_ref().take(count).filter(|(_, is_taken)| !is_taken) {
            for part in &parts {
                place::append(source, part, &matrix, out, seen)?;
            }
        }
        if alone.len() > 0 {
            known.insert(index, (parts, alone));
        }
    }
    Ok(seen)
}

/// The places of a mesh that are still to come, and whether a model stands there.
type Alone = Zip<std::vec::IntoIter<DMat4>, std::vec::IntoIter<bool>>;

/// Notes triangles that are left out because they have no area, and those that make all others inexact.
fn note_odd_triangles(source: &Source, scene: &mut Scene, seen: &BTreeMap<usize, Seen>) {
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
