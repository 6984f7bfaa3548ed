//! The renderer in the browser.
//!
//! * `viewer` – the class `Viewer`: a scene on a canvas; with
//!   * `settings` – settings;
//!   * `input` – pointers, wheel, keys;
//!   * `read` – pictures, counts and statistics;
//!   * `nodes` – nodes that move;
//!   * `shared` – the page's device; `callbacks` – what the page is told;
//! * `wire` – cameras and lights as lists of numbers;
//! * `page` – errors and promises; `math` – the page's sine.
//!
//! The class is a feature, `element`: other wasm modules use the renderer without it. Every failure is a JavaScript
//! `Error` with a `code` from [`ViewerError::code`](crate::ViewerError::code).

#[cfg(feature = "element")]
mod callbacks;
#[cfg(all(feature = "element", feature = "radiosity"))]
mod gloss;
#[cfg(feature = "element")]
mod input;
mod math;
#[cfg(all(feature = "element", feature = "radiosity"))]
mod nodes;
pub mod page;
#[cfg(feature = "element")]
mod read;
#[cfg(feature = "element")]
mod settings;
#[cfg(feature = "element")]
mod shared;
#[cfg(feature = "element")]
mod viewer;
pub mod wire;

#[cfg(feature = "element")]
pub use viewer::Viewer;

use page::coded;
use wasm_bindgen::prelude::*;

/// Half the code size of the standard allocator.
#[global_allocator]
static ALLOCATOR: talc::wasm::WasmDynamicTalc = talc::wasm::new_wasm_dynamic_allocator();

/// Runs once when the module is loaded: turns a panic into an `Error` with the code `internal` and the panic's
/// message, instead of a bare trap.
#[wasm_bindgen(start)]
pub fn start() {
    std::panic::set_hook(Box::new(|info| {
        wasm_bindgen::throw_val(coded("internal", &format!("internal error: {info}; please report it")))
    }));
}
