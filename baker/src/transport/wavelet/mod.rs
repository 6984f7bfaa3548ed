//! Wavelet radiosity on virtual meshes: bounced light of given lights on exact, trimmed, curved surfaces.
//!
//! Alonso, Cuny, Petitjean, Paul, Lazard, Wies: The Virtual Mesh: A Geometric Abstraction for Efficiently
//! Computing Radiosity (2001), sections 4 and 5; the refinement oracle is that of Cuny, Alonso, Holzschuch: A
//! novel approach makes higher order wavelets really efficient for radiosity (2000).
//!
//! | module | what it has |
//! |---|---|
//! | `basis`, `cell` | Legendre polynomials on cells of a quadtree, two-scale coefficients |
//! | `patch` | faces in the scene, nearest real points |
//! | `tree` | irradiance in quadtrees: push, pull, residuals |
//! | `emitter`, `emitter_cell`, `gather` | quadrature over the cells of a patch that shoots, and visibility |
//! | `clusters`, `light_tree` | many small patches that shoot together |
//! | `gather_clusters` | representatives of small receivers |
//! | `node_bounds` | boxes and normal cones of what shoots |
//! | `form_factor` | Lambert's formula, for near cells of planes |
//! | `receive` | refinement oracle of receivers |
//! | `solver`, `solution` | Southwell relaxation, its result |
//! | `lightmap` | the solution as a texture of packed unit squares |
//! | `scene_patches`, `fixed` | the patches of a scene; its solution at the points of a file |
//! | `complex_polygons` | triangles of a mesh put together to planar faces with holes |

mod basis;
mod cell;
mod clusters;
pub mod complex_polygons;
mod emitter;
mod emitter_cell;
mod fixed;
mod form_factor;
mod gather;
mod gather_clusters;
mod light_tree;
pub mod lightmap;
mod node_bounds;
mod patch;
mod receive;
mod scene_patches;
mod settings;
mod solution;
mod solver;
#[cfg(test)]
mod tests;
mod tree;

pub use basis::Order;
pub use complex_polygons::complex_polygons;
pub use fixed::{WaveletGroups, WaveletRadiosity, WaveletRadiosityError};
pub use patch::WaveletPatch;
pub use scene_patches::{PatchCoordinates, ScenePatches};
pub use settings::{WaveletError, WaveletSettings};
pub use solution::{Figures, WaveletSolution};
pub use solver::{solve, solve_until};
