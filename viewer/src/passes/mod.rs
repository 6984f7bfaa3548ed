//! The passes of a frame that need lights or a camera. Each draws a scene on the GPU; `renderer/frame.rs` has the order,
//! with the [relighting](crate::scene::relight) of the points between shadows and G-buffer.
//!
//! * `shadow` – shadow maps of the lights;
//! * `cached_direct` – the lights whose direct light at the points is evaluated anew;
//! * `gbuffer` – albedo, normals, material and depth of the visible surfaces;
//! * `display` – from points to pixels; `lightmap` – from a lightmap to pixels;
//! * `rest_places` – where the file has what deforms;
//! * `reflections` – what glossy surfaces reflect;
//! * `blended` – glass, curtains, decals;
//! * `composite` – shading, exposure, tone mapping;
//! * `overlay` – points and handles over the picture.
//!
//! Beside them `settings`: what a user chooses of the picture, and `timing`: milliseconds per pass.

pub mod blended;
pub mod cached_direct;
pub mod composite;
pub mod display;
pub mod gbuffer;
#[cfg(feature = "radiosity")]
pub mod lightmap;
pub mod overlay;
#[cfg(feature = "radiosity")]
pub mod reflections;
#[cfg(feature = "radiosity")]
pub mod rest_places;
pub mod settings;
pub mod shadow;
pub mod timing;
