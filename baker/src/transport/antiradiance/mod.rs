//! Bounced light of given lights without visibility between surfaces (Dachsbacher et al. 2007): the light of a scene's lamps
//! by shadow rays, all else by [`rebounce_shared::antiradiance`].
//!
//! * [`scene_patches`] – the triangles of a scene, divided to patches;
//! * [`direct`] – light of the lamps at the patches;
//! * [`near`] – from patches to points, and back;
//! * [`figures`] – what a solution took;
//! * [`pool`] – the threads of this process;
//! * [`fixed`] – solutions at the points of a file.

pub mod direct;
pub mod figures;
pub mod fixed;
pub mod near;
pub mod pool;
pub mod scene_patches;

pub use figures::AntiradianceWork;
pub use fixed::{Antiradiance, AntiradianceError, AntiradianceSettings};
pub use pool::Pool;
pub use scene_patches::patches_of;
