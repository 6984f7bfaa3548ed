//! glTF 2.0 to [`Scene`].
//!
//! * `schema` – the JSON; `source` – the bytes; `accessor` – the numbers;
//! * `extensions` – what is refused; `material` – materials and textures;
//! * `mesh` – primitives to triangles; `node` – transforms, lights and cameras; `animation` – how lights move.

mod accessor;
mod animation;
mod extensions;
mod material;
mod mesh;
mod node;
mod schema;
mod source;

use super::{Scene, SceneError, WorldMesh};
use source::Source;
use std::path::Path;

/// Loads a .gltf or .glb file.
pub(super) fn load(path: &Path) -> Result<Scene, SceneError> {
    let source = Source::open(path)?;
    let name = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    convert(&source, name)
}

fn convert(source: &Source, name: String) -> Result<Scene, SceneError> {
    let mut scene = Scene { name, ..Scene::default() };
    let nodes = node::flatten(source)?;
    let mut materials = material::Materials::new(source);
    let mut mesh = WorldMesh::default();
    for node in &nodes {
        if let Some(index) = source.root.nodes[node.index].mesh {
            mesh::append(source, index, node, &mut materials, &mut mesh)?;
        }
    }
    if mesh.triangles.is_empty() {
        return Err(SceneError::Empty { file: source.file.clone() });
    }
    if mesh.positions.len() > u32::MAX as usize {
        return Err(SceneError::TooLarge { file: source.file.clone(), count: mesh.positions.len() });
    }
    materials.finish(&mut scene)?;
    mesh.finish(&mut scene);
    if scene.triangles.is_empty() {
        return Err(SceneError::Empty { file: source.file.clone() });
    }
    let (low, high) = scene.bounds();
    let size = (high - low).length() as f64;
    for node in &nodes {
        scene.lights.extend(node::light(source, node)?);
        scene.cameras.extend(node::camera(source, node, scene.origin, size)?);
    }
    scene.animations = animation::animations(source, &nodes, &mut scene.left_out)?;
    Ok(scene)
}

#[cfg(test)]
mod tests;
