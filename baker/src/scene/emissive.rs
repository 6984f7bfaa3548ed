//! Groups of emissive surfaces: a light per material, or per name that nodes of the file give.

use super::Scene;
use rebounce_shared::light::Light;
use rebounce_shared::rbn::sources::{EmissiveGroup, MAX_GROUPS};
use std::collections::HashMap;

/// Returns the groups of a scene's emissive surfaces, in the order of the materials; their steps are not yet known.
pub fn emissive_groups(scene: &Scene) -> Vec<EmissiveGroup> {
    if scene.emission_is_shown_only {
        return Vec::new();
    }
    let mut is_used = vec![false; scene.materials.len()];
    scene.triangle_material.iter().for_each(|material| is_used[*material as usize] = true);
    let materials = (0u32..).zip(&scene.materials).zip(is_used);
    let shining = materials.filter(|((_, material), is_used)| {
        *is_used && material.emission != [0.0; 3] && !material.extras.unlit
    });
    let mut groups: Vec<EmissiveGroup> = Vec::new();
    // Place of each named group.
    let mut named: HashMap<&str, usize> = HashMap::new();
    for ((number, material), _) in shining {
        let name = scene.light_groups.get(number as usize).and_then(Option::as_deref);
        let place = name.map_or(groups.len(), |name| *named.entry(name).or_insert(groups.len()));
        if place == groups.len() {
            let name = name.unwrap_or(&material.name).to_owned();
            groups.push(EmissiveGroup { name, ..EmissiveGroup::default() });
        }
        groups[place].materials.push(number);
    }
    // A file has room for so many: the last one takes in the others.
    let others = groups.split_off(groups.len().min(MAX_GROUPS));
    if let Some(last) = groups.last_mut() {
        last.materials.extend(others.into_iter().flat_map(|group| group.materials));
    }
    groups
}

impl Scene {
    /// Returns the scene's own lights, world space, and a light for each group of emissive surfaces, with their names.
    pub fn all_lights(&self) -> (Vec<Light>, Vec<String>) {
        let mut lights = self.lights.clone();
        let mut names = self.light_names.clone();
        names.resize(lights.len(), String::new());
        for (group, emissive) in (0u32..).zip(emissive_groups(self)) {
            lights.push(Light::Emissive { group, intensity: 1.0, color: [1.0; 3] });
            names.push(emissive.name);
        }
        (lights, names)
    }
}
