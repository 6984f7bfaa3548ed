//! Bounced light for a renderer that is not ours, in the browser.
//!
//! * `device` – the class `Device`: a GPU device that both renderers use;
//! * `light` – the class `BouncedLight`: a .rbn file and its lights, relit;
//! * `view` – the class `View`: its light at the pixels of a picture;
//! * `probes` – the class `Probes`: its light in the air.
//!
//! The other renderer draws places and normals of the visible surfaces into a texture; a `View` turns these into a
//! texture of irradiance, with the lookup of our own pictures.
#![cfg(target_arch = "wasm32")]

mod device;
mod light;
mod probes;
mod view;

pub use device::Device;
pub use light::BouncedLight;
pub use probes::Probes;
pub use view::View;

/// The browser's object behind a handle of wgpu.
fn object(handle: Option<&impl AsRef<wasm_bindgen::JsValue>>) -> wasm_bindgen::JsValue {
    handle.map_or(wasm_bindgen::JsValue::UNDEFINED, |handle| handle.as_ref().clone())
}
