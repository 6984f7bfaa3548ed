//! Merging of materials that look alike.

use crate::scene::world_mesh::WorldMesh;
use crate::scene::{Scene, SceneError};
use rebounce_shared::rbn::MAX_MATERIALS;
use rebounce_shared::rbn::meta::Material;
use std::collections::HashMap;

/// Merges materials that differ in name only, and are of one group of shining surfaces; the first name is kept. `file` is the scene's name in errors.
///
/// # Errors
/// [`SceneError::TooManyMaterials`].
pub(super) fn merge(scene: &mut Scene, mesh: &mut WorldMesh, file: &str) -> Result<(), SceneError> {
    let mut known: HashMap<String, u32> = HashMap::new();
    let mut kept: Vec<Material> = Vec::new();
    let mut place = Vec::with_capacity(scene.materials.len());
    let mut groups = Vec::new();
    let all = std::mem::take(&mut scene.materials).into_iter().zip(std::mem::take(&mut scene.light_groups));
    for (mut material, group) in all {
        let name = std::mem::take(&mut material.name);
        // Debug prints numbers exactly, so that reading returns the same number.
        let number = *known.entry(format!("{material:?} {group:?}")).or_insert(kept.len() as u32);
        if number as usize == kept.len() {
            kept.push(Material { name, ..material });
            groups.push(group);
        }
        place.push(number);
    }
    if let Some(first) = kept.get(MAX_MATERIALS) {
        return Err(SceneError::TooManyMaterials {
            file: file.to_owned(),
            count: kept.len(),
            limit: MAX_MATERIALS,
            name: first.name.clone(),
        });
    }
    let models = mesh.models.iter_mut().map(|model| &mut model.mesh.triangle_material);
    for material in std::iter::once(&mut mesh.triangle_material).chain(models).flatten() {
        *material = place[*material as usize];
    }
    (scene.materials, scene.light_groups) = (kept, groups);
    Ok(())
}
