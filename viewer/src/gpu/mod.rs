//! The GPU device and what is built on it alone; knows no scene.
//!
//! * `device` – the device, its limits, its errors;
//! * `scope` – ownership of buffers and textures;
//! * `bindings` – bind groups, buffers, pipelines;
//! * `readback` – copies back to the CPU;
//! * `refusals` – error scopes;
//! * `oneshot` – a single answer from a callback;
//! * `browser` – the browser's own WebGPU objects.

pub(crate) mod bindings;
#[cfg(target_arch = "wasm32")]
pub(crate) mod browser;
mod device;
pub mod oneshot;
pub mod readback;
mod refusals;
pub mod scope;

#[cfg(target_arch = "wasm32")]
pub use browser::wrapped;
pub use device::{Gpu, LIMITS, MAX_BINDING, MAX_LAYERS, Opened, Requested};
