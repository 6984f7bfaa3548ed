//! The inputs of a bake's result, by name.

use super::BakeSettings;
use crate::job::checkpoint::Identity;
use crate::sampling::{PlaceSettings, Points};
use crate::scene::{InstancedMesh, Scene};
use crate::transport::OperatorSettings;
use rebounce_shared::rbn::{container, groups, rig as rigs};
use sha2::{Digest, Sha256};
use std::fmt::Debug;

impl Identity {
    /// Returns the identity of a bake of `scene` with `settings` by this program.
    pub fn new(scene: &Scene, settings: &BakeSettings) -> Self {
        // Destructured in full, so that no new field is forgotten.
        let BakeSettings {
            preset,
            viewpoints,
            camera,
            solver,
            purpose,
            transfer,
            place,
            operator,
            sources,
            gloss,
            direct_levels,
        } = settings.clone().normalised();
        let PlaceSettings {
            levels,
            coarse_radius,
            functions,
            coarse_overlap,
            fine_overlap,
            patience,
            seed,
            groups: _,
        } = place;
        let OperatorSettings {
            refinement,
            sender_levels,
            epsilon,
            reflected,
            levels: epsilon_levels,
            rays,
            significance,
            pooled_levels,
            bounces,
            later_levels,
            far_levels,
            seed: operator_seed,
        } = operator;
        let program = format!(
            "{} ({}-{}, format {})",
            env!("CARGO_PKG_VERSION"),
            env!("REBOUNCE_SOURCES"),
            rebounce_shared::SOURCES,
            container::VERSION
        );
        let parts: [(&str, &dyn Debug); 27] = [
            ("preset", &preset.name()),
            ("viewpoints", &viewpoints),
            ("camera", &camera),
            ("levels", &levels),
            ("coarse radius", &coarse_radius),
            ("functions", &functions),
            ("coarse overlap", &coarse_overlap),
            ("fine overlap", &fine_overlap),
            ("patience", &patience),
            ("seed", &seed),
            ("sender levels", &sender_levels),
            ("epsilon", &epsilon),
            ("reflected", &reflected),
            ("epsilon levels", &epsilon_levels),
            ("rays", &rays),
            ("significance", &significance),
            ("pooled levels", &pooled_levels),
            ("bounces", &bounces),
            ("later levels", &later_levels),
            ("far levels", &far_levels),
            ("direct levels", &direct_levels),
            ("sources", &sources),
            ("gloss", &gloss),
            ("solver", &solver),
            ("refinement", &refinement),
            ("purpose", &purpose),
            ("transfer", &transfer),
        ];
        let mut named = vec![
            ("program".to_owned(), program),
            ("scene".to_owned(), format!("{} ({})", scene.name, digest(scene))),
        ];
        named.extend(parts.map(|(name, value)| (name.to_owned(), format!("{value:?}"))));
        named.push(("operator seed".to_owned(), operator_seed.to_string()));
        Self::of(named)
    }
}

/// Returns a digest of scene, settings, points, cuts and samples, to compare between processes. Every process places all
/// points: sharing the placement would save no time.
pub(super) fn digest_of_points(scene: &Scene, settings: &BakeSettings, points: &Points) -> [u8; 32] {
    let mut hash = Sha256::new();
    hash.update(Identity::new(scene, settings).to_json());
    for point in &points.points {
        hash.update(bytemuck::bytes_of(&[point.position, point.normal, point.geometric_normal]));
        hash.update(point.group.to_le_bytes());
    }
    points.cuts.iter().for_each(|cuts| hash.update(bytemuck::cast_slice(cuts)));
    hash.update(&points.samples);
    hash.finalize().into()
}

/// Returns a digest of the scene's contents, 16 hexadecimal digits.
fn digest(scene: &Scene) -> String {
    let Scene {
        name,
        origin,
        positions,
        normals,
        uvs,
        triangles,
        triangle_material,
        corner_colors,
        models,
        brep,
        materials,
        light_groups,
        groups,
        rig,
        textures,
        lights,
        cameras,
        environment,
        emission_is_shown_only,
        light_names,
        camera_names,
        animations,
        left_out: _,
        notes: _,
        degenerate_triangles: _,
    } = scene;
    let mut hash = Sha256::new();
    let mut add = |bytes: &[u8]| {
        hash.update((bytes.len() as u64).to_le_bytes());
        hash.update(bytes);
    };
    add(bytemuck::cast_slice(positions));
    add(bytemuck::cast_slice(normals));
    add(bytemuck::cast_slice(uvs));
    add(bytemuck::cast_slice(triangles));
    add(bytemuck::cast_slice(triangle_material));
    add(bytemuck::cast_slice(corner_colors));
    for InstancedMesh { triangles, vertices, local_from_model, bounds } in models {
        let places: Vec<[f32; 12]> = local_from_model.iter().map(glam::Affine3A::to_cols_array).collect();
        add(bytemuck::cast_slice(&places));
        add(format!("{triangles:?} {vertices:?} {bounds:?}").as_bytes());
    }
    for face in brep.iter().flat_map(|brep| &brep.faces) {
        add(format!("{:?} {}", face.face, face.material).as_bytes());
    }
    for instance in brep.iter().flat_map(|brep| &brep.instances) {
        add(format!("{instance:?}").as_bytes());
    }
    // Debug output of numbers reads back exactly.
    add(format!("{name:?} {origin:?} {materials:?} {lights:?} {cameras:?} {animations:?}").as_bytes());
    add(format!("{light_names:?} {camera_names:?} {light_groups:?} {emission_is_shown_only}").as_bytes());
    if let Ok(Some(bytes)) = groups::encode(groups) {
        add(&bytes);
        add(bytemuck::cast_slice(&groups.of_material));
    }
    if let Some(layout) = rigs::encode(&rig.layout).ok().filter(|_| !rig.is_empty()) {
        add(&layout);
        add(bytemuck::cast_slice(&rig.vertices));
        add(bytemuck::cast_slice(&rig.deltas));
    }
    if let Some(environment) = environment {
        add(&environment.width.to_le_bytes());
        add(bytemuck::cast_slice(&environment.pixels));
    }
    for texture in textures {
        add(format!("{:?} {}", texture.meta, texture.texels.is_some()).as_bytes());
        add(&texture.bytes);
    }
    hash.finalize().iter().take(8).map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::super::Preset;
    use super::*;

    #[test]
    fn another_scene_or_setting_is_named() {
        let scene = crate::io::load("builtin:cornell-box").unwrap();
        let settings = BakeSettings::new(Preset::Draft);
        let one = Identity::new(&scene, &settings);
        assert_eq!(one.difference(&Identity::new(&scene, &settings)), None);
        let mut other = settings.clone();
        other.place.functions = 77;
        let said = one.difference(&Identity::new(&scene, &other)).unwrap();
        assert_eq!(said, "functions 25000, not 77");
        let mut moved = scene.clone();
        moved.positions[0].x += 1e-3;
        let said = one.difference(&Identity::new(&moved, &settings)).unwrap();
        assert!(said.starts_with("scene cornell-box (") && said.contains(", not cornell-box ("), "{said}");
        let mut lit = scene.clone();
        lit.lights.clear();
        assert!(one.difference(&Identity::new(&lit, &settings)).unwrap().starts_with("scene "));
    }
}
