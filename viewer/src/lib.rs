//! The Rebounce renderer.
//!
//! Relights a baked scene ([`rebounce_shared::baked::BakedScene`]) on the GPU and draws the picture: in the browser
//! through WebGPU (the class `Viewer` of the module `wasm`), natively without a window.
//!
//! A frame, limited to changed passes: [`shadow`] maps, [`relight`] (the bounced light at every point),
//! [`gbuffer`], [`display`] (from points to pixels), [`blended`] surfaces, [`composite`], [`overlay`]. [`renderer`]
//! selects the passes; [`scene`] is a loaded file; [`controls`] moves camera and lights.

mod bindings;
pub mod blended;
pub mod blended_fit;
#[cfg(target_arch = "wasm32")]
mod browser;
pub mod cached_direct;
pub mod cascades;
pub mod composite;
pub mod controls;
pub mod display;
pub mod draw_batch;
pub mod error;
mod fronts;
pub mod gbuffer;
pub mod gpu;
mod ground;
pub mod materials;
pub mod oneshot;
pub mod overlay;
pub mod pace;
pub mod pipelines;
pub mod readback;
mod refusals;
pub mod relight;
pub mod renderer;
pub mod scene;
pub mod scope;
pub mod settings;
pub mod shaders;
pub mod shadow;
pub mod shadow_fit;
pub mod shadow_maps;
pub mod stats;
pub mod target;
pub mod textures;
pub mod timing;
pub mod triangles;
pub mod upload;
pub mod view;
#[cfg(target_arch = "wasm32")]
pub mod wasm;
#[cfg(any(target_arch = "wasm32", test))]
pub mod wire;

pub use error::ViewerError;
