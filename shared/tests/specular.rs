//! How materials shine, in files: the section, and its rules.

use crate::rules::scene;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::rbn::meta::Material;
use rebounce_shared::rbn::specular::SpecularExtras;
use rebounce_shared::rbn::{SPECULAR_SECTION, container};

/// The scene with three materials, of which the second and third shine.
fn glossy() -> BakedScene {
    let mut scene = scene();
    scene.meta.materials = vec![Material::default(); 3];
    scene.meta.materials[1].specular_extras = SpecularExtras { ior: 0.0, ..SpecularExtras::default() };
    scene.meta.materials[2].specular_extras = SpecularExtras {
        ior: 1.33,
        specular_color: [0.5, 2.0, 0.0],
        clearcoat: 0.75,
        clearcoat_roughness: 0.25,
    };
    scene.relate().unwrap();
    scene
}

#[test]
fn specular_extras_have_a_section_of_their_own_that_other_files_are_without() {
    let scene = glossy();
    let bytes = scene.to_bytes().unwrap();
    assert_eq!(BakedScene::from_bytes(&bytes).unwrap(), scene);
    // The version is that of the file without: older readers pass over the section, and show plain highlights.
    assert_eq!(scene.version(), container::PUNCTUAL_LIGHTS);
    let mut plain = scene.clone();
    plain.meta.materials = vec![Material::default(); 3];
    let without = plain.to_bytes().unwrap();
    let named = |bytes: &[u8]| container::read(bytes).unwrap().iter().any(|s| s.name == SPECULAR_SECTION);
    assert!(named(&bytes) && !named(&without));
    let sections = container::read(&bytes).unwrap();
    let with = |change: &dyn Fn(&[u8]) -> Option<Vec<u8>>| {
        let parts = sections.iter().filter_map(|s| {
            let own = &bytes[s.offset..s.offset + s.len];
            Some((s.name, if s.name == SPECULAR_SECTION { change(own)? } else { own.to_vec() }))
        });
        let parts: Vec<_> = parts.collect();
        let parts: Vec<_> = parts.iter().map(|(name, own)| (*name, own.as_slice())).collect();
        container::write(scene.version(), &parts)
    };
    assert_eq!(with(&|_| None), without, "every other byte is the same");
    type Change<'a> = &'a dyn Fn(&[u8]) -> Option<Vec<u8>>;
    let wrong: [Change; 3] = [
        &|own| Some([own, &[0]].concat()),
        &|own| Some(own[..own.len() - 1].to_vec()),
        // Material index of the first record.
        &|own| Some([&own[..1], &[2], &own[2..]].concat()),
    ];
    for (i, change) in wrong.into_iter().enumerate() {
        let error = BakedScene::from_bytes(&with(change)).expect_err("refused").to_string();
        assert!(error.contains("MATG"), "{i}: {error}");
    }
}

#[test]
fn specular_extras_out_of_range_are_refused() {
    type Break = fn(&mut SpecularExtras);
    let breaks: [Break; 12] = [
        |g| g.ior = 0.5,
        |g| g.ior = -1.5,
        |g| g.ior = f32::NAN,
        |g| g.ior = 1e16,
        |g| g.specular_color[1] = -0.1,
        |g| g.specular_color[2] = f32::INFINITY,
        |g| g.specular_color[0] = f32::NAN,
        |g| g.clearcoat = 1.5,
        |g| g.clearcoat = -0.5,
        |g| g.clearcoat = f32::NAN,
        |g| g.clearcoat_roughness = 2.0,
        |g| g.clearcoat_roughness = f32::NAN,
    ];
    for (i, damage) in breaks.into_iter().enumerate() {
        let mut scene = glossy();
        damage(&mut scene.meta.materials[1].specular_extras);
        let error = scene.to_bytes().expect_err("refused").to_string();
        assert!(error.contains("MATG") && error.contains("material 1"), "{i}: {error}");
    }
}
