//! Files: scenes (glTF 2.0, STEP), pictures, SHOT.json, and atomic writes.
//!
//! * [`load()`] – loads a scene: a .gltf, .glb or .step file, or `builtin:NAME`; [`files`] – where its bytes come from;
//! * `gltf`, `step` – the readers; `other_format` – files of other formats, with advice for conversion to glTF;
//! * [`read_looks`] – looks of materials by name;
//! * [`save()`] – saves a baked file;
//! * [`mod@environment`] – light from infinitely far: .hdr, .exr, Ultra HDR .jpg;
//! * [`picture`] – EXR and PNG; [`shot`] – camera and lights for a picture;
//! * [`write`](mod@write) – replaces a file at once, or leaves the old file.

pub mod environment;
pub mod files;
#[cfg(feature = "gltf")]
mod gltf;
mod load;
mod material_looks;
mod options;
#[cfg(feature = "gltf")]
mod other_format;
pub mod picture;
mod save;
pub mod shot;
mod step;
pub mod write;

pub use files::Files;
#[cfg(feature = "gltf")]
pub use load::from_bytes;
pub use load::{load, load_by_name, load_from, load_with};
pub use material_looks::read_looks;
pub use options::{GroupOption, LoadOptions, PoseOption};
pub use save::{SaveError, save};
pub use step::is_step;
