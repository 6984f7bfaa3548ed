//! The Rebounce renderer.
//!
//! It relights a baked scene ([`rebounce_shared::rbn::Scene`]) on the GPU and draws it: in the
//! browser through WebGPU (the class `Viewer` of the module `wasm`), natively without a window.

pub mod controls;
pub mod error;
pub mod gpu;
pub mod oneshot;
pub mod readback;
pub mod renderer;
#[cfg(target_arch = "wasm32")]
pub mod wasm;

pub use error::ViewerError;
