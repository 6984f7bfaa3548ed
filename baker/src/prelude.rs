//! What most programs need: `use rebounce::prelude::*;`.

pub use crate::bake::{BakeError, BakeReport, BakeSettings, Baker, Observer, Preset, Progress, bake};
pub use crate::io::{LoadOptions, load, load_with, save};
pub use crate::scene::{Scene, SceneError};
pub use rebounce_shared::baked::BakedScene;
pub use rebounce_shared::camera::Camera;
pub use rebounce_shared::light::Light;
