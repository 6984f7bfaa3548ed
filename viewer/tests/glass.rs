//! Glass: surfaces seen through glass and lit through glass have the colour of the glass. Unlit surfaces: their
//! colour does not depend on the light.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use rebounce_shared::baked::BakedScene;
use rebounce_shared::camera::Camera;
use rebounce_shared::glam::Vec3;
use rebounce_shared::light::{COLOR, Light};
use rebounce_shared::octahedral::pack_snorm16;
use rebounce_shared::rbn::bulk::Vertex;
use rebounce_shared::rbn::extras::Extras;
use rebounce_shared::rbn::meta::{Alpha, DetailTexture, Draw, Material, Texture};
use rebounce_viewer::gpu::Gpu;
use rebounce_viewer::pipelines::Pipelines;
use rebounce_viewer::renderer::Renderer;
use rebounce_viewer::scene::GpuScene;
use rebounce_viewer::settings::{Mode, ToneMapping};
use std::rc::Rc;

const SIZE: u32 = 33;

fn glass(base: [f32; 3], extras: Extras) -> Material {
    let [r, g, b] = base;
    Material { base_color: [r, g, b, 1.0], double_sided: true, extras, ..Material::default() }
}

fn clear(base: [f32; 3]) -> Material {
    glass(base, Extras { transmission: 1.0, ..Extras::default() })
}

/// Adds a square of half side `half` to the scene, perpendicular to z.
fn pane(scene: &mut BakedScene, z: f32, half: f32, material: Material) {
    let (vertex, index) = (scene.vertices.len() as u32, scene.indices.len() as u32);
    for (a, b) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
        let position = [half * a, half * b, z];
        scene.vertices.push(Vertex { position, normal: pack_snorm16(Vec3::Z), uv: [0.5, 0.5] });
    }
    scene.indices.extend([0, 1, 2, 0, 2, 3].map(|i| vertex + i));
    scene.meta.draws.push(Draw {
        material: scene.meta.materials.len() as u32,
        first_index: index,
        index_count: 6,
    });
    scene.meta.materials.push(material);
}

/// A device, with pipelines shared by all renderers of a test.
type Device = (Gpu, Rc<Pipelines>);

fn device() -> Option<Device> {
    let gpu = common::gpu()?;
    let pipelines = Rc::new(Pipelines::new(&gpu).unwrap());
    Some((gpu, pipelines))
}

fn renderer((gpu, pipelines): &Device, scene: &BakedScene) -> Renderer {
    let mut renderer = Renderer::with(gpu.clone(), pipelines.clone());
    let loaded = pollster::block_on(GpuScene::upload(gpu, pipelines.loaders(), scene.clone())).unwrap();
    renderer.install(loaded).unwrap();
    renderer.set_tone_mapping(ToneMapping::Neutral);
    renderer.set_auto_exposure(false);
    renderer.set_still_pictures(1);
    renderer
}

/// The middle pixel, 8 bits, from a camera at `z` towards −z.
fn middle(renderer: &mut Renderer, z: f64) -> [u8; 3] {
    let (position, target) = ([0.03, 0.02, z], [0.03, 0.02, -1.0]);
    renderer.set_camera(Camera { position, target, up: [0.0, 1.0, 0.0], yfov_deg: 40.0 }).unwrap();
    let pixels = pollster::block_on(renderer.read_pixels(SIZE, SIZE).unwrap().wait()).unwrap();
    let at = 4 * ((SIZE / 2) * SIZE + SIZE / 2) as usize;
    [pixels[at], pixels[at + 1], pixels[at + 2]]
}

fn encoded(linear: Vec3) -> [u8; 3] {
    linear.to_array().map(|c| {
        let c = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
        (255.0 * c).round() as u8
    })
}

#[track_caller]
fn assert_near(found: [u8; 3], expected: [u8; 3], what: &str) {
    let most = found.iter().zip(expected).map(|(a, b)| a.abs_diff(b)).max().unwrap();
    assert!(most <= 1, "{what}: {found:?}, expected {expected:?}");
}

/// A dark room with an emissive wall in front of the camera; its blue is 0, a value that the tone curve preserves.
fn glowing(emission: [f32; 3]) -> BakedScene {
    let mut scene = common::room(&[3]);
    scene.meta.lights.clear();
    scene.meta.materials[4].emission = emission;
    scene
}

#[test]
fn what_is_behind_glass_is_seen_in_its_colour() {
    let Some(device) = device() else { return };
    let (wall, first, second) = ([0.6, 0.5, 0.0], [0.5, 1.0, 0.3], [0.75, 0.4, 1.0]);
    let leaf = Extras {
        transmission: 0.5,
        transmission_tint: [1.0, 0.5, 1.0],
        scattered: 0.25,
        scattered_color: [0.8, 0.4, 1.0],
        ..Extras::default()
    };
    let veil = Material { alpha: Alpha::Blend, base_color: [0.0, 0.0, 0.0, 0.5], ..clear([0.0; 3]) };
    let grey = Material { extras: Extras::default(), emission: [0.2, 0.0, 0.0], ..veil.clone() };
    let metal = Material { metallic: 1.0, ..clear([1.0; 3]) };
    let of = |k: [f32; 3]| Vec3::from(k) * Vec3::from(wall);
    let cases: [(&str, Vec<Material>, Vec3); 7] = [
        ("one", vec![clear(first)], of(first)),
        ("two", vec![clear(first), clear(second)], of(first) * Vec3::from(second)),
        ("a leaf", vec![glass([0.6, 1.0, 1.0], leaf)], of([0.5 * 0.6 + 0.1, 0.25 + 0.05, 1.0])),
        ("half covered", vec![veil], of([0.5; 3])),
        // The pane's own light, and half of the light through the glass behind.
        ("grey before", vec![grey.clone(), clear(first)], vec3(0.1, 0.0, 0.0) + 0.5 * of(first)),
        ("grey behind", vec![clear(first), grey], Vec3::from(first) * vec3(0.1, 0.0, 0.0) + 0.5 * of(first)),
        ("metal", vec![metal], Vec3::ZERO),
    ];
    for (what, panes, expected) in cases {
        let mut scene = glowing(wall);
        for (i, material) in panes.into_iter().enumerate() {
            pane(&mut scene, 0.3 - 0.2 * i as f32, 0.5, material);
        }
        assert_near(middle(&mut renderer(&device, &scene), 0.9), encoded(expected), what);
    }
    device.0.check().unwrap();
}

fn vec3(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

/// The wall's colour under a lamp behind the camera. The lamp shines through `panes`, also behind the camera;
/// `color` scales the lamp's light.
fn lit(device: &Device, light: &Light, panes: &[Material], color: [f32; 3]) -> [u8; 3] {
    let mut scene = common::room(&[3]);
    scene.meta.materials[4].base_color = [0.5, 0.5, 0.5, 1.0];
    scene.meta.lights = vec![light.with(COLOR.at, &color.map(f64::from))];
    for (i, material) in panes.iter().enumerate() {
        pane(&mut scene, 0.6 - 0.15 * i as f32, 0.9, material.clone());
    }
    let mut renderer = renderer(device, &scene);
    renderer.set_mode(Mode::Direct);
    middle(&mut renderer, -0.5)
}

#[test]
fn light_behind_glass_has_its_colour() {
    let Some(device) = device() else { return };
    let (position, white, color) = ([0.1, 0.05, 0.8], [1f32; 3], [1.0; 3]);
    let lights = [
        Light::Spot {
            position,
            direction: [0.0, 0.0, -1.0],
            outer_cone_deg: 40.0,
            inner_cone_deg: Some(39.0),
            intensity: 8.0,
            color,
            radius: 0.0,
        },
        Light::Point { position, intensity: 8.0, color, radius: 0.0 },
    ];
    let (first, second) = ([0.9, 0.6, 0.4], [0.5, 0.9, 0.7]);
    let both = (Vec3::from(first) * Vec3::from(second)).to_array();
    for light in &lights {
        let open = lit(&device, light, &[], white);
        assert!(open.iter().all(|c| (120..220).contains(c)), "badly exposed: {open:?}");
        assert_near(lit(&device, light, &[clear(first)], white), lit(&device, light, &[], first), "one");
        let two = lit(&device, light, &[clear(first), clear(second)], white);
        assert_near(two, lit(&device, light, &[], both), "two");
        let metal = Material { metallic: 1.0, ..clear([1.0; 3]) };
        assert_eq!(lit(&device, light, &[metal], white), [0; 3]);
    }
    // No pane in front of the glass: the lamp is between glass and wall.
    let Light::Point { .. } = &lights[1] else { panic!() };
    let near = Light::Point { position: [0.1, 0.05, 0.2], intensity: 4.0, color, radius: 0.0 };
    assert_near(
        lit(&device, &near, &[clear(first)], white),
        lit(&device, &near, &[], white),
        "behind the lamp",
    );
    device.0.check().unwrap();
}

#[test]
fn textures_say_what_goes_through_and_what_is_metal() {
    let Some(device) = device() else { return };
    let seen = |transmission: bool, metal: bool| {
        let mut scene = glowing([0.6, 0.5, 0.0]);
        // Red and blue are half.
        let mut png = std::io::Cursor::new(Vec::new());
        let picture = image::RgbImage::from_pixel(2, 2, image::Rgb([128, 0, 128]));
        picture.write_to(&mut png, image::ImageFormat::Png).unwrap();
        scene.texture_bytes = png.into_inner();
        let len = scene.texture_bytes.len() as u64;
        let mime = "image/png".to_owned();
        scene.meta.textures =
            vec![Texture { mime, len, width: 2, height: 2, data: true, ..Texture::default() }];
        let detail = |is: bool| {
            let uv_from_vertex = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
            is.then_some(DetailTexture { texture: 0, uv_from_vertex })
        };
        let mut material = clear([1.0; 3]);
        material.metallic = metal as u32 as f32;
        material.metallic_roughness_texture = detail(metal);
        material.extras.transmission_texture = detail(transmission);
        pane(&mut scene, 0.3, 0.5, material);
        middle(&mut renderer(&device, &scene), 0.9)
    };
    let half = 128.0 / 255.0;
    for (transmission, metal, share) in [(true, false, half), (false, true, 1.0 - half)] {
        assert_near(seen(transmission, metal), encoded(share * vec3(0.6, 0.5, 0.0)), "half");
    }
    device.0.check().unwrap();
}

#[test]
fn unlit_surfaces_show_their_colour_at_any_exposure() {
    let Some(device) = device() else { return };
    let unlit = Extras { unlit: true, ..Extras::default() };
    let color = [0.9, 0.3, 0.1];
    let shown = |change: &dyn Fn(&mut BakedScene, &mut Renderer), panes: &[Material]| {
        let mut scene = common::room(&[3]);
        scene.meta.materials[4] = glass(color, unlit);
        for (i, material) in panes.iter().enumerate() {
            pane(&mut scene, 0.3 - 0.2 * i as f32, 0.5, material.clone());
        }
        let mut renderer = renderer(&device, &scene);
        change(&mut scene, &mut renderer);
        middle(&mut renderer, 0.9)
    };
    let expected = encoded(color.into());
    assert_near(shown(&|_, _| (), &[]), expected, "plain");
    assert_near(shown(&|_, r| r.set_auto_exposure(true), &[]), expected, "automatic");
    assert_near(shown(&|_, r| r.set_exposure(5.0).unwrap(), &[]), expected, "bright");
    assert_near(shown(&|_, r| r.set_tone_mapping(ToneMapping::Agx), &[]), expected, "AgX");
    assert_near(shown(&|_, r| r.set_lights(vec![]).unwrap(), &[]), expected, "dark");
    for mode in [Mode::Direct, Mode::Indirect] {
        assert_eq!(shown(&|_, r| r.set_mode(mode), &[]), [0; 3], "neither direct nor bounced light");
    }
    // Through glass, and through an unlit pane with a texture that covers half; in the dark, because panes reflect.
    let dark = |_: &mut BakedScene, r: &mut Renderer| r.set_lights(vec![]).unwrap();
    let tint = [0.5, 1.0, 0.25];
    let through = Vec3::from(tint) * Vec3::from(color);
    assert_near(shown(&dark, &[clear(tint)]), encoded(through), "glass");
    let half = Material { alpha: Alpha::Blend, base_color: [0.2, 0.8, 0.4, 0.5], ..glass([0.0; 3], unlit) };
    let over = 0.5 * vec3(0.2, 0.8, 0.4);
    assert_near(
        shown(&dark, std::slice::from_ref(&half)),
        encoded(over + 0.5 * Vec3::from(color)),
        "a picture",
    );
    let both = Vec3::from(tint) * (over + 0.5 * Vec3::from(color));
    assert_near(shown(&dark, &[clear(tint), half]), encoded(both), "a picture behind glass");
    device.0.check().unwrap();
}

#[test]
fn only_scenes_with_glass_pay_for_it() {
    let Some(device) = device() else { return };
    let bytes = |material: Material| {
        let mut scene = common::room(&[3]);
        pane(&mut scene, 0.3, 0.5, material);
        let mut renderer = renderer(&device, &scene);
        middle(&mut renderer, 0.9);
        let stats = renderer.stats();
        (stats.bytes.shadows, stats.shadow_size)
    };
    // A lamp in the room: six maps; a placeholder texel for colours, and two for cascades.
    let (plain, size) = bytes(Material { extras: Extras::default(), ..clear([1.0; 3]) });
    assert_eq!(plain, 6 * 4 * u64::from(size).pow(2) + 8 + 12);
    let (tinted, size) = bytes(clear([1.0; 3]));
    assert_eq!(tinted, 6 * 6 * u64::from(size).pow(2) + 12);
    device.0.check().unwrap();
}
