//! The Rebounce renderer.
//!
//! Relights a baked scene ([`rebounce_shared::baked::BakedScene`]) on the GPU and draws the picture: in the browser
//! through WebGPU (the class `Viewer` of the module `wasm`), natively without a window.
//!
//! Modules in order; a module uses only earlier ones, and all use [`error`] and [`shaders`]:
//!
//! * [`gpu`] – the device, and buffers, bindings and readbacks of it;
//! * [`scene`] – a loaded file on the GPU, with its relighting: the bounced light at every point;
//! * [`probes`] – bounced light in the air, for other renderers;
//! * [`controls`] – moves camera and lights;
//! * [`passes`] – from lights and points to a picture;
//! * [`renderer`] – a frame: runs the passes whose inputs changed;
//! * `wasm` – the class for the browser.

pub mod controls;
pub mod error;
pub mod gpu;
pub mod passes;
#[cfg(feature = "guest")]
pub mod probes;
pub mod renderer;
pub mod scene;
pub mod shaders;
#[cfg(target_arch = "wasm32")]
pub mod wasm;
/// The rest of `wasm` needs a browser; this part is tested natively.
#[cfg(all(test, not(target_arch = "wasm32")))]
#[path = "wasm/wire.rs"]
mod wire;

pub use error::ViewerError;
// Short paths, for tests and programs; inside the crate modules are named where they are.
pub use gpu::{readback, scope};
pub use passes::{composite, display, settings, shadow};
pub use renderer::{pipelines, stats};
#[cfg(feature = "antiradiance")]
pub use scene::antiradiance;
#[cfg(feature = "radiosity")]
pub use scene::radiosity;
pub use scene::{blended_fit, materials, relight, upload, view};
