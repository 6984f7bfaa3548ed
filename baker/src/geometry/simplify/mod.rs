//! Mesh simplification for ray casting: a few large triangles replace many small ones in flat or nearly flat regions.
//!
//! The cost of a ray grows with the triangles along its path; light transport depends on the surface, not on its
//! triangulation. Vertices are removed one by one as long as the surface stays within [`TOLERANCE`], a fraction of the
//! scene's size, of the previous surface: less than the offset of ray origins, and about the rounding of positions in
//! the file. Normals, texture coordinates and colours change by less than a visible difference. Seams between
//! materials, textures and faces stay in place and are only straightened; likewise borders. Connected surfaces stay
//! connected. If no vertex can be removed, the triangles stay unchanged. Models are simplified in model space, at the
//! size of the largest copy.
//!
//! * `patch` – triangles with shared vertices and looks;
//! * `ring` – the triangles around a vertex; `collapse` – whether a vertex can be removed, and its replacement.

mod collapse;
mod patch;
mod ring;
#[cfg(test)]
mod tests;

use crate::morton;
use crate::scene::Scene;
use crate::weld::canonical_indices;
use glam::{Vec2, Vec3};
use patch::{CornerAttributes, Patch};
use rayon::prelude::*;
use rebounce_shared::rbn::meta::Material;
use std::sync::atomic::{AtomicU32, Ordering};

/// Maximum distance between the simplified and the original surface, as a fraction of the diagonal of the scene's main
/// part.
pub const TOLERANCE: f32 = 1e-6;

/// Triangles per patch in the first round, simplified by a single thread: fits a processor's cache.
pub const TOGETHER: usize = 1 << 14;
/// Growth factor of patches from round to round: vertices shared between patches wait for a larger patch.
const WIDER: usize = 4;
/// Maximum number of rounds.
const ROUNDS: usize = 4;
/// Minimum fraction of triangles removed by a round, for another round to follow.
const WORTH_IT: f32 = 0.1;
/// Maximum fraction of places shared between patches before the triangles are sorted by position.
const MIXED: f32 = 0.3;
/// Patch number of a place in no patch (`NOBODY`) or in several patches (`MANY`).
const NOBODY: u32 = u32::MAX;
const MANY: u32 = u32::MAX - 1;

/// A triangle, by corners of the scene: 3 × triangle number + corner index.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cut {
    corners: [u32; 3],
    /// Number of the original triangle in the scene.
    number: u32,
    /// Maximum deviation from the original surface, as a fraction of the tolerance; at most 1.
    error: f32,
}

/// Input shared by the patches.
struct PatchSource<'a> {
    scene: &'a Scene,
    /// By vertex, the place: the first vertex at an equal position.
    places: Vec<u32>,
    /// [`TOLERANCE`] as a length, scene units.
    tolerance: f32,
    /// By material: whether texture coordinates matter, and whether rays may pass.
    materials: Vec<MaterialNeeds>,
}

/// Properties of a material relevant for simplification.
#[derive(Clone, Copy, Debug)]
struct MaterialNeeds {
    is_textured: bool,
    is_transparent: bool,
}

impl PatchSource<'_> {
    /// Returns the vertex of a corner.
    #[inline]
    fn vertex(&self, corner: u32) -> usize {
        self.scene.triangles[corner as usize / 3][corner as usize % 3] as usize
    }

    /// Returns the place of a corner.
    #[inline]
    fn place(&self, corner: u32) -> u32 {
        self.places[self.vertex(corner)]
    }

    /// Returns the look of a corner, for a triangle of this material.
    fn look(&self, corner: u32, material: u32) -> CornerAttributes {
        let vertex = self.vertex(corner);
        let is_textured = self.materials[material as usize].is_textured;
        let colors = self.scene.corner_colors.get(corner as usize / 3);
        CornerAttributes {
            normal: self.scene.normals[vertex],
            uv: if is_textured { self.scene.uvs[vertex] } else { Vec2::ZERO },
            color: colors.map_or(Vec3::ZERO, |colors| colors[corner as usize % 3]),
            material,
        }
    }
}

/// Returns the triangles for ray casting, in the scene's order. A corner is 3 × the number of a scene triangle + the
/// corner index, and refers to the scene's normal, texture coordinates, colour and material at the corner. The three
/// corners of a triangle share a material. `is_opaque` returns whether a material stops every ray; triangles of other
/// materials stay unchanged. `together` is the number of triangles per patch in the first round; [`TOGETHER`] is
/// fastest. No other setting changes the result.
pub fn simplify(scene: &Scene, is_opaque: impl Fn(usize) -> bool, together: usize) -> Vec<[u32; 3]> {
    let ((low, high), main) = (scene.bounds(), scene.main_part());
    let kind = |(i, m): (usize, &Material)| MaterialNeeds {
        is_textured: m.base_color_texture.is_some(),
        is_transparent: !is_opaque(i),
    };
    // Vertices of different models are never merged, even with equal coordinates. Zero has two signs.
    let space = |i: u32| scene.models.partition_point(|model| model.vertices.start <= i) as u32;
    let position = |i: u32| {
        let [x, y, z] = (scene.positions[i as usize] + 0.0).to_array().map(f32::to_bits);
        [x, y, z, space(i)]
    };
    let source = PatchSource {
        scene,
        places: canonical_indices(scene.positions.len(), position),
        tolerance: TOLERANCE * (main.1 - main.0).length(),
        materials: scene.materials.iter().enumerate().map(kind).collect(),
    };
    let corners = |t: u32| Cut { corners: [3 * t, 3 * t + 1, 3 * t + 2], number: t, error: 0.0 };
    let mut triangles: Vec<Cut> = (0..scene.triangles.len() as u32).into_par_iter().map(corners).collect();
    let (mut together, mut is_sorted) = (together.max(1), true);
    for _ in 0..ROUNDS {
        let before = triangles.len();
        let Round { left, shared } = round(&source, &triangles, together);
        triangles = left;
        let is_mixed = shared > MIXED;
        if before <= together || !is_mixed && (before - triangles.len()) as f32 <= WORTH_IT * before as f32 {
            break;
        }
        if is_mixed {
            // Triangles of a region are scattered over the file.
            let code = |cut: &Cut| morton::code(scene.positions[source.vertex(cut.corners[0])], low, high);
            triangles.par_sort_by_cached_key(|cut| (code(cut), cut.number));
            is_sorted = false;
        }
        together *= WIDER;
    }
    if !is_sorted {
        triangles.par_sort_unstable_by_key(|cut| cut.number);
    }
    triangles.into_iter().map(|cut| cut.corners).collect()
}

/// Result of a round.
struct Round {
    left: Vec<Cut>,
    /// Fraction of places shared by several patches.
    shared: f32,
}

/// Simplifies the patches in parallel; vertices shared between patches stay.
fn round(source: &PatchSource, triangles: &[Cut], together: usize) -> Round {
    let users: Vec<AtomicU32> =
        (0..source.places.len()).into_par_iter().map(|_| AtomicU32::new(NOBODY)).collect();
    triangles.par_chunks(together).enumerate().for_each(|(patch, some)| {
        let patch = patch as u32;
        for corner in some.iter().flat_map(|cut| cut.corners) {
            let user = &users[source.place(corner) as usize];
            // Independent of thread order: two different patches always result in `MANY`.
            let known = user.load(Ordering::Relaxed);
            if known == patch || known == MANY {
                continue;
            }
            if user.compare_exchange(NOBODY, patch, Ordering::Relaxed, Ordering::Relaxed).is_err() {
                user.store(MANY, Ordering::Relaxed);
            }
        }
    });
    let count =
        |is: fn(u32) -> bool| users.par_iter().filter(|user| is(user.load(Ordering::Relaxed))).count();
    let shared = count(|user| user == MANY) as f32 / count(|user| user != NOBODY).max(1) as f32;
    let is_shared = |place: u32| users[place as usize].load(Ordering::Relaxed) == MANY;
    let simplified = triangles.par_chunks(together).map(|some| {
        let mut patch = Patch::new(source, some, is_shared);
        collapse::collapse_all(&mut patch);
        patch.finish()
    });
    Round { left: simplified.collect::<Vec<_>>().concat(), shared }
}
