//! How materials shine: indices of refraction, specular colours, clear layers.

use super::*;
use rebounce_shared::rbn::meta::Material;
use rebounce_shared::rbn::specular::SpecularExtras;

/// The only material of a scene whose material has these extensions.
fn with_extensions(extensions: &str) -> (Material, Vec<String>) {
    let scene = textured_with(&format!(r#""name":"jar","extensions":{{{extensions}}}"#));
    (scene.materials[0].clone(), scene.left_out)
}

#[test]
fn indices_of_refraction_specular_colours_and_clear_layers_are_read() {
    let plain = with_extensions("").0;
    assert_eq!((plain.specular, plain.specular_extras), (1.0, SpecularExtras::default()));
    // Absent numbers are glTF's, and those of no consequence make no difference.
    for nothing in [
        r#""KHR_materials_ior":{},"KHR_materials_clearcoat":{},"KHR_materials_specular":{}"#,
        r#""KHR_materials_ior":{"ior":1.5},"KHR_materials_clearcoat":{"clearcoatRoughnessFactor":0.5,
            "clearcoatTexture":{"index":0}}"#,
    ] {
        assert_eq!(with_extensions(nothing), (plain.clone(), vec![]));
    }
    let (m, left_out) = with_extensions(
        r#""KHR_materials_ior":{"ior":1.25},"KHR_materials_clearcoat":{"clearcoatFactor":0.75,
        "clearcoatRoughnessFactor":0.25},"KHR_materials_specular":{"specularFactor":0.5,
        "specularColorFactor":[0.5,1,2]}"#,
    );
    let extras = SpecularExtras {
        ior: 1.25,
        specular_color: [0.5, 1.0, 2.0],
        clearcoat: 0.75,
        clearcoat_roughness: 0.25,
    };
    assert_eq!((m.specular, m.specular_extras, left_out), (0.5, extras, vec![]));
    // (0.25 / 2.25)², by strength and colour.
    let expected = Vec3::new(0.5, 1.0, 2.0) * (0.5 / 81.0);
    assert!(
        m.specular_extras.head_on(m.specular).distance(expected) < 1e-6,
        "{}",
        m.specular_extras.head_on(m.specular)
    );
    // Zero stands for a mirror; other numbers out of range are the nearest in range.
    for (said, read) in [("0", 0.0), ("0.5", 1.0), ("-3", 1.0), ("1", 1.0), ("2.5", 2.5)] {
        let (m, _) = with_extensions(&format!(r#""KHR_materials_ior":{{"ior":{said}}}"#));
        assert_eq!(m.specular_extras.ior, read, "{said}");
    }
    let (m, _) = with_extensions(
        r#""KHR_materials_clearcoat":{"clearcoatFactor":7,"clearcoatRoughnessFactor":-1},
        "KHR_materials_specular":{"specularFactor":-2,"specularColorFactor":[-1,0.5,1]}"#,
    );
    let extras =
        SpecularExtras { clearcoat: 1.0, specular_color: [0.0, 0.5, 1.0], ..SpecularExtras::default() };
    assert_eq!((m.specular, m.specular_extras), (0.0, extras));
    // What is unlit has none.
    let (m, left_out) = with_extensions(
        r#""KHR_materials_unlit":{},"KHR_materials_ior":{"ior":2},
        "KHR_materials_clearcoat":{"clearcoatFactor":1,"clearcoatTexture":{"index":0}}"#,
    );
    assert_eq!((m.specular, m.specular_extras, left_out), (0.0, SpecularExtras::default(), vec![]));
}

#[test]
fn textures_of_clear_layers_and_of_specular_strength_are_named_as_left_out() {
    let (m, left_out) = with_extensions(
        r#""KHR_materials_clearcoat":{"clearcoatFactor":1,"clearcoatTexture":{"index":0},
        "clearcoatRoughnessTexture":{"index":0},"clearcoatNormalTexture":{"index":0,"scale":0.5}},
        "KHR_materials_specular":{"specularTexture":{"index":0},"specularColorTexture":{"index":0}}"#,
    );
    assert_eq!((m.specular_extras.clearcoat, m.specular), (1.0, 1.0));
    let whats = ["specular", "specular colour", "clearcoat", "clearcoat roughness", "clearcoat normal"];
    // Alike notes are one line from the fourth on.
    let [line] = &left_out[..] else { panic!("{left_out:?}") };
    assert!(line.contains("5 in all") && line.ends_with("its factor is taken"), "{line}");
    assert!(whats[..3].iter().all(|what| line.contains(&format!("the {what} texture"))), "{line}");
    let (_, left_out) = with_extensions(
        r#""KHR_materials_clearcoat":{"clearcoatFactor":1,"clearcoatNormalTexture":{"index":0}}"#,
    );
    assert!(left_out[0].starts_with("the clearcoat normal texture of material \"jar\""), "{left_out:?}");
}

#[test]
fn specular_factors_that_are_no_numbers_are_refused_by_material() {
    for (extensions, says) in [
        (r#""KHR_materials_ior":{"ior":1e30}"#, "factor"),
        (r#""KHR_materials_ior":{"ior":"glass"}"#, "KHR_materials_ior"),
        (r#""KHR_materials_clearcoat":{"clearcoatFactor":-1e20}"#, "factor"),
        (r#""KHR_materials_clearcoat":{"clearcoatFactor":[1]}"#, "KHR_materials_clearcoat"),
        (r#""KHR_materials_specular":{"specularColorFactor":[1,1e16,1]}"#, "factor"),
    ] {
        let json = square("", r#","indices":1,"material":0"#, "");
        let json = json.strip_suffix('}').unwrap();
        let material = format!(r#"{json},"materials":[{{"name":"jar","extensions":{{{extensions}}}}}]}}"#);
        let error = parse(&material).unwrap_err().to_string();
        assert!(error.contains("\"jar\"") && error.contains(says), "{error}");
    }
}
