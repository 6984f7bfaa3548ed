//! Scenes of exact CAD surfaces ([`rebounce_cad::demo`]), with a lamp and a camera each.

use super::camera;
use crate::scene::assembly::AssemblySettings;
use crate::scene::{Scene, SceneError};
use rebounce_shared::light::Light;

/// Where a scene is seen from, and its lamp.
struct DemoView {
    /// Position, target and vertical field of view in degrees.
    camera: ([f64; 3], [f64; 3], f64),
    /// Position, target, half angle in degrees, candela.
    lamp: ([f64; 3], [f64; 3], f64, f64),
}

/// The names after `builtin:`.
pub(super) const NAMES: [&str; 4] = rebounce_cad::demo::NAMES;

/// Generates the scene of this name, one of [`NAMES`].
pub(super) fn scene(name: &str) -> Result<Scene, SceneError> {
    let view = match name {
        "teapot" => DemoView {
            camera: ([0.35, 1.05, 0.75], [0.0, 0.77, -0.05], 32.0),
            lamp: ([0.5, 1.9, 0.6], [0.0, 0.75, -0.1], 40.0, 14.0),
        },
        "tori" => DemoView {
            camera: ([0.0, 1.3, 3.2], [0.0, 0.35, 0.0], 38.0),
            lamp: ([0.8, 2.4, 1.0], [-0.1, 0.2, -0.1], 38.0, 25.0),
        },
        "chess" => DemoView {
            camera: ([0.25, 0.4, 0.62], [0.0, 0.03, 0.02], 34.0),
            lamp: ([-0.4, 0.9, 0.3], [0.0, 0.0, 0.0], 40.0, 4.0),
        },
        _ => DemoView {
            camera: ([4.0, 2.2, 32.0], [0.0, 6.0, 0.0], 38.0),
            lamp: ([-14.0, 18.0, 24.0], [-1.0, 6.0, -2.0], 42.0, 6000.0),
        },
    };
    let assembly = rebounce_cad::demo::assembly(name).unwrap_or_default();
    let file = format!("builtin:{name}");
    let mut scene = Scene::of_assembly(&file, name.to_owned(), &assembly, &AssemblySettings::default())?;
    let (position, target, yfov_deg) = view.camera;
    scene.cameras.push(camera(position, target, yfov_deg));
    let (position, target, outer_cone_deg, intensity) = view.lamp;
    scene.lights.push(Light::Spot {
        position,
        direction: std::array::from_fn(|i| target[i] - position[i]),
        outer_cone_deg,
        inner_cone_deg: Some(0.8 * outer_cone_deg),
        intensity,
        color: [1.0, 0.97, 0.92],
        radius: 0.0,
    });
    Ok(scene)
}
