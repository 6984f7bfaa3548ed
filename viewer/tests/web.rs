//! The viewer's class and the shared crate in a browser.
#![cfg(target_arch = "wasm32")]

use js_sys::{Float32Array, Promise, Reflect, Uint8Array};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::camera::Camera;
use rebounce_shared::light::Light;
use rebounce_shared::rbn::bulk::{Point, Vertex};
use rebounce_shared::rbn::meta::{Animation, Draw, Interpolation, Level, Material, Meta, Property, Track};
use rebounce_shared::rbn::{LinkMatrix, RbnError, container};
use rebounce_viewer::wasm::{Viewer, wire};
use wasm_bindgen::convert::TryFromJsValue;
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_futures::JsFuture;
use wasm_bindgen_test::{wasm_bindgen_test, wasm_bindgen_test_configure};

wasm_bindgen_test_configure!(run_in_browser);

/// A triangle and a basis function: the smallest scene with content.
fn triangle() -> BakedScene {
    let corner = |x, y| Vertex { position: [x, y, 0.0], ..Vertex::default() };
    let mut scene = BakedScene {
        meta: Meta {
            scene_name: "triangle – Ünïcode".into(),
            origin: [1e6, -0.5, 0.25],
            bounds_max: [1.0, 1.0, 0.0],
            levels: vec![Level { first: 0, count: 1, disk_radius: 0.5, support_radius: 1.0 }],
            sender_levels: 1,
            direct_levels: 1,
            materials: vec![Material { base_color: [0.5, 0.25, 0.125, 1.0], ..Material::default() }],
            draws: vec![Draw { first_index: 0, index_count: 3, material: 0 }],
            cameras: vec![Camera {
                position: [1e6, 0.0, 3.0],
                target: [1e6, 0.0, 0.0],
                up: [0.0, 1.0, 0.0],
                yfov_deg: 50.0,
            }],
            lights: vec![Light::Point { position: [0.0; 3], intensity: 0.0, color: [1.0; 3], radius: 0.0 }],
            animations: vec![Animation {
                name: "glow".into(),
                duration: 2.0,
                tracks: vec![Track {
                    light: 0,
                    property: Property::Intensity,
                    interpolation: Interpolation::Step,
                    times: vec![0.0, 2.0],
                    values: vec![0.25, 4.0],
                }],
            }],
            ..Meta::default()
        },
        vertices: vec![corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0)],
        indices: vec![0, 1, 2],
        points: vec![Point { position: [0.3, 0.3, 0.0], radius: 1.0, normal: 0, cuts: 0, tint: 0 }],
        links: LinkMatrix::from_rows(&[Vec::new()]),
        ..BakedScene::default()
    };
    scene.relate().unwrap();
    scene
}

async fn viewer() -> Viewer {
    let canvas = js_sys::eval("document.createElement('canvas')").unwrap();
    let object = JsFuture::from(Viewer::create(canvas.unchecked_into())).await.unwrap();
    Viewer::try_from_js_value(object).map_err(|_| "not a Viewer").unwrap()
}

/// The error code for loading these bytes.
async fn refusal(viewer: &Viewer, bytes: &[u8]) -> String {
    let error = JsFuture::from(viewer.load(Uint8Array::from(bytes))).await.unwrap_err();
    assert!(error.is_instance_of::<js_sys::Error>(), "not an Error: {error:?}");
    code(&error)
}

fn code(error: &JsValue) -> String {
    Reflect::get(error, &"code".into()).unwrap().as_string().expect("an error has a code")
}

#[wasm_bindgen_test]
fn a_file_is_the_same_after_a_round_trip() {
    let scene = triangle();
    let bytes = scene.to_bytes().unwrap();
    assert_eq!(BakedScene::from_bytes(&bytes).unwrap(), scene);
    for len in (0..bytes.len()).step_by(7) {
        assert!(BakedScene::from_bytes(&bytes[..len]).is_err(), "cut to {len}");
    }
    let damaged = |at: usize| {
        let mut bytes = bytes.clone();
        bytes[at] ^= 1;
        BakedScene::from_bytes(&bytes)
    };
    assert!(matches!(damaged(0), Err(RbnError::NotRbn)));
    assert!(matches!(damaged(bytes.len() - 1), Err(RbnError::Checksum { .. })));
}

#[wasm_bindgen_test]
async fn files_that_are_none_are_refused_with_a_code() {
    let viewer = viewer().await;
    let whole = triangle().to_bytes().unwrap();
    assert_eq!(refusal(&viewer, b"").await, "not-rbn");
    assert_eq!(refusal(&viewer, b"glTF, which is something else").await, "not-rbn");
    assert_eq!(refusal(&viewer, &whole[..whole.len() / 2]).await, "truncated");
    let mut damaged = whole.clone();
    damaged[whole.len() / 2] ^= 1;
    assert_eq!(refusal(&viewer, &damaged).await, "corrupt");
    // A file of another version may have checksums of another kind: the version is checked first.
    for (version, said) in [(container::VERSION + 1, "newer-version"), (5, "older-version")] {
        let mut other = whole.clone();
        other[8..12].copy_from_slice(&version.to_le_bytes());
        assert_eq!(refusal(&viewer, &other).await, said);
    }
    viewer.dispose();
}

#[wasm_bindgen_test]
async fn wrong_arguments_throw_errors_with_codes() {
    let viewer = viewer().await;
    assert_eq!(code(&viewer.set_shot(&[], &[]).unwrap_err()), "bad-json");
    assert_eq!(code(&viewer.set_camera(&[0.0; 3]).unwrap_err()), "bad-json");
    assert_eq!(code(&viewer.set_lights(&[7.0; 13]).unwrap_err()), "bad-json");
    let read: Promise = viewer.read_indirect(8, 8);
    assert_eq!(code(&JsFuture::from(read).await.unwrap_err()), "no-scene");
    viewer.dispose();
}

#[wasm_bindgen_test]
async fn without_lights_there_is_no_light_and_the_first_one_shines() {
    let viewer = viewer().await;
    JsFuture::from(viewer.load(Uint8Array::from(&triangle().to_bytes().unwrap()[..]))).await.unwrap();
    let image = JsFuture::from(viewer.read_indirect(16, 16)).await.unwrap();
    let image = image.unchecked_into::<Float32Array>().to_vec();
    assert_eq!(image.len(), 16 * 16 * 4);
    assert!(image.chunks(4).all(|pixel| pixel[..3] == [0.0; 3]), "light from nowhere");
    let covered = image.chunks(4).filter(|pixel| pixel[3] > 0.0).count();
    assert!(covered > 0 && covered < 256, "{covered} of 256 pixels are covered");
    // The first light of a scene without lights.
    let light =
        Light::Point { position: [1_000_000.3, 0.3, 2.0], intensity: 10.0, color: [1.0; 3], radius: 0.0 };
    viewer.set_lights(&wire::light_numbers(&[light])).unwrap();
    let picture = JsFuture::from(viewer.read_pixels(16, 16)).await.unwrap();
    let picture = picture.unchecked_into::<Uint8Array>().to_vec();
    assert!(picture.chunks(4).any(|pixel| pixel[0] > 0), "the light shines on nothing");
    viewer.dispose();
}

#[wasm_bindgen_test]
async fn a_page_sees_the_animations_of_the_file() {
    let viewer = viewer().await;
    JsFuture::from(viewer.load(Uint8Array::from(&triangle().to_bytes().unwrap()[..]))).await.unwrap();
    let json = js_sys::JSON::stringify(&viewer.animations()).unwrap().as_string().unwrap();
    let expected = r#"[{"name":"glow","duration":2,"tracks":[{"light":0,"property":"intensity","interpolation":"step","times":{"0":0,"1":2},"values":{"0":0.25,"1":4}}]}]"#;
    assert_eq!(json, expected);
    viewer.dispose();
}
