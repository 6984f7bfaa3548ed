//! Effects of materials on light: windows, unlit surfaces, and the maximum number of materials.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common::quads;
use rebounce_shared::baked::BakedScene;

use glam::{DVec3, Vec3, vec3};
use quads::{Quad, glb};
use rebounce::bake::{BakeSettings, Preset, bake};
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::geometry::{Ray, Surfaces};
use rebounce::io::picture::Only;
use rebounce::light::direct;
use rebounce::light::illumination::Illumination;
use rebounce::random::Stream;
use rebounce::scene::{Scene, SceneError};
use rebounce::verify::path_trace::{Settings, radiance};
use rebounce::verify::render::Relit;
use rebounce_shared::light::Light;
use rebounce_shared::rbn;

/// JSON members of a non-metallic material with the given base colour.
fn matt([r, g, b]: [f32; 3], more: &str) -> String {
    format!(
        r#"{{"name":"pane","pbrMetallicRoughness":{{"baseColorFactor":[{r},{g},{b},1],"metallicFactor":0}}{more}}}"#
    )
}

/// A white room, 2 m wide, with a window as the wall at x = −1: panes at the given positions, of the given
/// material, under a sun that shines through the window at 45°.
fn room(panes: &[f32], pane: String, picture: Option<&[u8]>) -> Scene {
    let mut quads = Vec::new();
    for (axis, side) in [(0, 1.0f32), (1, -1.0), (1, 1.0), (2, -1.0), (2, 1.0)] {
        let (mut middle, mut u, mut v) = (Vec3::ZERO, Vec3::ZERO, Vec3::ZERO);
        (middle[axis], u[(axis + 1) % 3], v[(axis + 2) % 3]) = (side, -side, 1.0);
        quads.push(Quad { middle, u, v, material: 0 });
    }
    for (i, x) in panes.iter().enumerate() {
        // The first pane faces into the room; the faces of a solid face away from each other.
        let u = Vec3::Y * if i % 2 == 0 { 1.0 } else { -1.0 };
        quads.push(Quad { middle: vec3(*x, 0.0, 0.0), u, v: Vec3::Z, material: 1 });
    }
    let bytes = glb(&quads, &[matt([0.5; 3], ""), pane], picture, "");
    let mut scene = rebounce::io::from_bytes("room", &bytes).unwrap();
    let direction = [1.0, -1.0, 0.0];
    scene.lights = vec![Light::Directional { direction, intensity: 10.0, color: [1.0; 3], radius_deg: 0.0 }];
    scene
}

/// Direct irradiance at a place of the floor in the sun through the window.
fn on_the_floor(scene: &Scene) -> Vec3 {
    let lights: Vec<_> = scene.lights.iter().map(|light| light.source(scene.origin)).collect();
    let at = (DVec3::new(-0.3, -1.0, 0.3) - DVec3::from(scene.origin)).as_vec3();
    direct::at_point(&TriangleSurfaces::from_scene(scene), &lights, at, Vec3::Y)
}

/// A transmissive material: base colour and extensions.
fn glass(base: [f32; 3], extensions: &str) -> String {
    matt(base, &format!(r#","extensions":{{{extensions}}}"#))
}

const CLEAR: &str = r#""KHR_materials_transmission":{"transmissionFactor":1}"#;

#[test]
fn windows_let_their_share_through_in_their_colour() {
    let sun = on_the_floor(&room(&[], matt([1.0; 3], ""), None));
    assert!((sun - 10.0 * 0.5f32.sqrt()).abs().max_element() < 1e-4, "{sun}");
    let half = r#""KHR_materials_transmission":{"transmissionFactor":0.5}"#;
    let red = [0.8, 0.2, 0.1];
    let volume = format!(
        r#"{CLEAR},"KHR_materials_volume":{{"thicknessFactor":0.02,"attenuationDistance":0.01,"attenuationColor":[0.5,0.7,1]}}"#
    );
    let leaf = r#""KHR_materials_diffuse_transmission":{"diffuseTransmissionFactor":0.25,"diffuseTransmissionColorFactor":[0.4,0.8,0.2]}"#;
    let both = format!("{half},{leaf}");
    let metal = glass([1.0; 3], CLEAR).replace(r#""metallicFactor":0"#, r#""metallicFactor":0.75"#);
    let cases: [(&str, &[f32], String, Vec3); 10] = [
        ("clear", &[-1.0], glass([1.0; 3], CLEAR), Vec3::ONE),
        ("half", &[-1.0], glass([1.0; 3], half), Vec3::splat(0.5)),
        ("red", &[-1.0], glass(red, CLEAR), Vec3::from(red)),
        ("a box, red", &[-1.0, -1.05], glass(red, CLEAR), Vec3::from(red) * Vec3::from(red)),
        ("a box with a volume", &[-1.0, -1.05], glass([1.0; 3], &volume), vec3(0.25, 0.49, 1.0)),
        ("a leaf", &[-1.0], glass([1.0; 3], leaf), vec3(0.1, 0.2, 0.05)),
        ("both", &[-1.0], glass([1.0; 3], &both), Vec3::splat(0.5) + 0.5 * vec3(0.1, 0.2, 0.05)),
        ("three quarters metal", &[-1.0], metal, Vec3::splat(0.25)),
        ("a wall", &[-1.0], matt([1.0; 3], ""), Vec3::ZERO),
        (
            "half covered",
            &[-1.0],
            glass([0.8; 3], CLEAR).replace("0.8,1]", "0.8,0.5],\"x\":0").replacen(
                r#""name""#,
                r#""alphaMode":"BLEND","name""#,
                1,
            ),
            Vec3::splat(0.9),
        ),
    ];
    for (what, panes, pane, share) in cases {
        let found = on_the_floor(&room(panes, pane, None)) / sun;
        assert!((found - share).abs().max_element() < 1e-4, "{what}: {found}, not {share}");
    }
}

#[test]
fn a_texture_says_where_light_goes_through() {
    // Left half red 0, right half red 255, across the window.
    let mut picture = image::RgbImage::new(2, 1);
    picture.put_pixel(1, 0, image::Rgb([255, 0, 0]));
    let mut png = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut png, image::ImageFormat::Png).unwrap();
    let extension =
        r#""KHR_materials_transmission":{"transmissionFactor":0.5,"transmissionTexture":{"index":0}}"#;
    let scene = room(&[-1.0], glass([1.0; 3], extension), Some(png.get_ref()));
    let surfaces = TriangleSurfaces::from_scene(&scene);
    // The texture's u axis points up.
    let through = |y: f32| {
        let [from, to] = [-1.5, -0.5].map(|x| vec3(x, y, 0.2) - DVec3::from(scene.origin).as_vec3());
        surfaces.transmittance(from, to)
    };
    assert_eq!([through(0.5), through(-0.5)], [Vec3::splat(0.5), Vec3::ZERO]);
    // The baked file must have the same transmittance.
    let (file, _) = bake(&scene, &quick(), &()).unwrap();
    let file = BakedScene::from_bytes(&file.to_bytes().unwrap()).unwrap();
    assert_eq!(file.version(), rbn::container::PUNCTUAL_LIGHTS);
    assert_eq!(file.meta.materials, scene.materials);
    let kept = TriangleSurfaces::from_baked(&file).unwrap();
    let [from, to] = [-1.5, -0.5].map(|x| vec3(x, 0.5, 0.2) - DVec3::from(scene.origin).as_vec3());
    assert_eq!(kept.transmittance(from, to), Vec3::splat(0.5));
}

fn quick() -> BakeSettings {
    let mut settings = BakeSettings::new(Preset::Draft);
    settings.viewpoints = vec![[0.3, 0.0, 0.0]];
    settings.place.functions = 1500;
    settings.operator.rays = vec![512, 256, 256, 128, 128];
    settings
}

/// Mean radiance around the room's middle, by components of light: from a baked file, and from the path tracer.
fn seen(scene: &Scene, only: Only) -> [Vec3; 2] {
    let (file, _) = bake(scene, &quick(), &()).unwrap();
    let surfaces = TriangleSurfaces::from_baked(&file).unwrap();
    let relit = Relit::new(&file, &surfaces, &scene.lights, true);
    let illumination = Illumination::of(&surfaces, &scene.lights, scene.origin, 1.0);
    let origin = -DVec3::from(scene.origin).as_vec3();
    let mut sums = [Vec3::ZERO; 2];
    const RAYS: u64 = 60_000;
    for i in 0..RAYS {
        let mut stream = Stream::new(5, i);
        // Towards the room, away from the window.
        let direction = (stream.sphere() + 1.1 * Vec3::X).normalize();
        let ray = Ray { origin, direction, max_distance: f32::INFINITY, spread: 0.0 };
        sums[0] += relit.radiance(&surfaces, &ray, only, &mut stream);
        sums[1] +=
            radiance(&surfaces, &illumination, ray, Settings { only, ..Settings::default() }, &mut stream);
    }
    sums.map(|sum| sum / RAYS as f32)
}

#[test]
fn a_room_behind_a_window_has_the_window_s_share_of_the_open_room_s_light() {
    // A pane without reflection returns no light, like a hole.
    let tint = [0.75, 0.5, 0.25];
    let open = seen(&room(&[], matt([1.0; 3], ""), None), Only::All);
    let pane = seen(&room(&[-1.0], glass(tint, CLEAR), None), Only::All);
    for (what, (pane, open)) in ["baked", "traced"].into_iter().zip(pane.into_iter().zip(open)) {
        let share = pane / open;
        assert!((share - Vec3::from(tint)).abs().max_element() < 0.015, "{what}: {share}");
    }
    // A pane that reflects the untransmitted light keeps the room brighter than by the transmitted share; bake and
    // path tracer agree.
    let milky = r#""KHR_materials_transmission":{"transmissionFactor":0.5}"#;
    let [baked, traced] = seen(&room(&[-1.0], glass([0.9; 3], milky), None), Only::All);
    assert!(((baked / traced) - 1.0).abs().max_element() < 0.03, "{baked} {traced}");
    let share = traced.x / open[1].x;
    assert!((0.46..0.75).contains(&share), "{share}");
}

#[test]
fn a_colour_that_is_seen_through_glass_is_tinted() {
    let tint = [0.75, 0.5, 0.25];
    // The floor through the window, from outside.
    let look = |scene: &Scene| {
        let surfaces = TriangleSurfaces::from_scene(scene);
        let illumination = Illumination::of(&surfaces, &scene.lights, scene.origin, 1.0);
        let origin = vec3(-3.0, 0.8, 0.1) - DVec3::from(scene.origin).as_vec3();
        let direction = (vec3(-0.5, -1.0, 0.1) - vec3(-3.0, 0.8, 0.1)).normalize();
        let ray = Ray { origin, direction, max_distance: f32::INFINITY, spread: 0.0 };
        let settings = Settings { only: Only::Direct, ..Settings::default() };
        let of = |i| radiance(&surfaces, &illumination, ray, settings, &mut Stream::new(9, i));
        (0..20_000).map(of).sum::<Vec3>() / 20_000.0
    };
    let open = look(&room(&[], matt([1.0; 3], ""), None));
    let tint_of = |panes: &[f32]| look(&room(panes, glass(tint, CLEAR), None)) / open;
    let expect = |share: Vec3, times: f32| {
        let expected = Vec3::from(tint).powf(times);
        assert!((share / expected - 1.0).abs().max_element() < 0.03, "{share}, not {expected}");
    };
    // A pane facing into the room: the sun is tinted, the back face is invisible to the eye.
    expect(tint_of(&[-1.0]), 1.0);
    // A solid of two faces: both faces tint the sun, and the eye sees the outer face.
    expect(tint_of(&[-0.98, -1.02]), 3.0);
}

/// The windows of `shared/cases`, if present: the room behind a clear pane of two faces is as bright as the open
/// room; behind two faces of alpha 0.1, the room has 0.81 of the light.
#[test]
fn windows_of_files_let_the_sun_in() {
    let floor = |name: &str| {
        let path = format!("{}/../../shared/cases/winglass/{name}.glb", env!("CARGO_MANIFEST_DIR"));
        let scene = rebounce::io::load(&path).ok()?;
        let lights: Vec<_> = scene.lights.iter().map(|light| light.source(scene.origin)).collect();
        let surfaces = TriangleSurfaces::from_scene(&scene);
        let places =
            (0..400).map(|i| DVec3::new((i % 20) as f64 * 0.19 - 1.9, 0.0, (i / 20) as f64 * 0.24 - 2.3));
        let light = places.map(|place| {
            let at = (place - DVec3::from(scene.origin)).as_vec3();
            direct::at_point(&surfaces, &lights, at, Vec3::Y).x
        });
        Some(light.sum::<f32>())
    };
    let [Some(open), Some(clear), Some(blended)] = ["win_open", "win_transmission", "win_blend"].map(floor)
    else {
        return eprintln!("shared/cases/winglass is not here");
    };
    assert!(open > 100.0 && clear == open, "{clear} of {open}");
    assert!((blended / open - 0.81).abs() < 1e-4, "{blended} of {open}");
}

#[test]
fn no_pane_makes_light() {
    let mut stream = Stream::new(3, 3);
    for _ in 0..2000 {
        let mut unit = || (1.25 * stream.unit() - 0.125).clamp(0.0, 1.0);
        let mut color = || [unit(), unit(), unit()];
        let extras = rbn::extras::Extras {
            transmission_tint: color(),
            scattered_color: color(),
            transmission: unit(),
            scattered: unit(),
            ..Default::default()
        };
        let base = Vec3::new(unit(), unit(), unit());
        let passage = extras.passage(base, unit(), unit(), unit());
        let all = passage.through + passage.reflected * base;
        assert!(all.max_element() < 1.0 + 1e-6 && all.min_element() >= 0.0, "{extras:?}: {all}");
    }
}

#[test]
fn an_unlit_surface_shows_its_colour_and_bounces_light_like_others() {
    let color = [0.2, 0.4, 0.6];
    let unlit = matt(color, r#","emissiveFactor":[1,1,1],"extensions":{"KHR_materials_unlit":{}}"#);
    let scene = room(&[-1.0], unlit, None);
    let surfaces = TriangleSurfaces::from_scene(&scene);
    let origin = -DVec3::from(scene.origin).as_vec3();
    let lamp = Light::Point { position: [0.2, 0.1, 0.0], intensity: 3.0, color: [1.0; 3], radius: 0.0 };
    let (file, _) = bake(&Scene { lights: vec![lamp.clone()], ..scene.clone() }, &quick(), &()).unwrap();
    for lights in [vec![], vec![lamp.clone()]] {
        let relit = Relit::new(&file, &surfaces, &lights, true);
        let illumination = Illumination::of(&surfaces, &lights, scene.origin, 1.0);
        let ray = Ray { origin, direction: -Vec3::X, max_distance: f32::INFINITY, spread: 0.0 };
        for (only, expected) in
            [(Only::All, Vec3::from(color)), (Only::Direct, Vec3::ZERO), (Only::Indirect, Vec3::ZERO)]
        {
            let mut stream = Stream::new(1, 1);
            assert_eq!(relit.radiance(&surfaces, &ray, only, &mut stream), expected);
            let settings = Settings { only, ..Settings::default() };
            assert_eq!(radiance(&surfaces, &illumination, ray, settings, &mut stream), expected);
        }
    }
    // The floor before the wall receives light from the wall as from an ordinary wall of equal colour.
    let indirect = |pane: String| {
        let scene = Scene { lights: vec![lamp.clone()], ..room(&[-1.0], pane, None) };
        seen(&scene, Only::Indirect)
    };
    let unlit = indirect(matt(color, r#","extensions":{"KHR_materials_unlit":{}}"#));
    assert_eq!(unlit, indirect(matt(color, "")));
}

/// `count` small squares, each with its own material.
fn tiles(count: usize, material: impl Fn(usize) -> String) -> Vec<u8> {
    let quads: Vec<Quad> = (0..count)
        .map(|material| {
            let middle = vec3((material % 256) as f32, 0.0, (material / 256) as f32);
            Quad { middle, u: Vec3::X * 0.4, v: Vec3::NEG_Z * 0.4, material }
        })
        .collect();
    let materials: Vec<String> = (0..count).map(material).collect();
    glb(&quads, &materials, None, "")
}

#[test]
fn equal_materials_become_one_and_too_many_different_ones_are_refused() {
    let named = |i: usize, red: f32| {
        format!(r#"{{"name":"m{i}","pbrMetallicRoughness":{{"baseColorFactor":[{red},0,0,1]}}}}"#)
    };
    let alike = tiles(70_000, |i| named(i, if i == 9 { 0.25 } else { 0.5 }));
    let scene = rebounce::io::from_bytes("alike.glb", &alike).unwrap();
    let found: Vec<_> = scene.materials.iter().map(|m| (m.name.as_str(), m.base_color[0])).collect();
    assert_eq!(found, [("m0", 0.5), ("m9", 0.25)]);
    assert_eq!((scene.triangle_material[18], scene.triangle_material[20]), (1, 0));
    assert_eq!(scene.triangle_material.iter().filter(|m| **m == 1).count(), 2);

    let different = tiles(65_537, |i| named(i, i as f32 / 131_072.0));
    let error = rebounce::io::from_bytes("many.glb", &different).unwrap_err();
    assert!(matches!(error, SceneError::TooManyMaterials { count: 65_537, limit: 65_535, .. }), "{error}");
    let said = error.to_string();
    for words in ["many.glb", "65537", "65535", "m65535", "one material"] {
        assert!(said.contains(words), "{words}: {said}");
    }
}
