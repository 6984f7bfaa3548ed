//! A scene's triangles as rays need them: where the surface is flat, or as good as flat, a few large ones in place of many.
//!
//! What rays cost grows with the triangles that they walk by; what light does depends on the surface, not on how it is
//! cut up. Vertices are taken out one by one where the surface without them is no further from the one before than
//! [`TOLERANCE`] of the scene, less than rays are moved off surfaces by, and as far as the file rounds positions; normals,
//! texture coordinates and colours stay as they were to less than what shows. Seams between materials, textures and
//! faces stay where they are and are only straightened; so do borders, and what is joined stays joined. Scenes in which
//! every vertex counts come out as they went in. Models are simplified in their own space, where the largest copy has its size.
//!
//! * `patch` – some triangles and what they share;
//! * `ring` – the triangles around a vertex; `collapse` – whether it can go, and where to.

mod collapse;
mod patch;
mod ring;
#[cfg(test)]
mod tests;

use crate::morton;
use crate::scene::Scene;
use crate::weld::firsts;
use glam::{Vec2, Vec3};
use patch::{Look, Patch};
use rayon::prelude::*;
use rebounce_shared::rbn::meta::Material;
use std::sync::atomic::{AtomicU32, Ordering};

/// How far the simplified surface may be from the scene's, as a share of the diagonal of the scene's main part.
pub const TOLERANCE: f32 = 1e-6;

/// Triangles that one thread simplifies by themselves at first: they fit a processor's cache.
pub const TOGETHER: usize = 1 << 14;
/// Vertices that others have, too, wait for a round with so much larger patches.
const WIDER: usize = 4;
/// Rounds at most.
const ROUNDS: usize = 4;
/// The share of triangles that a round must take away for another one to be worth it.
const WORTH_IT: f32 = 0.1;
/// The share of places that patches may have together before their triangles are put in order.
const MIXED: f32 = 0.3;
/// No patch, and more than one.
const NOBODY: u32 = u32::MAX;
const MANY: u32 = u32::MAX - 1;

/// One triangle: corners of the scene, each three times a triangle's number and which of its corners.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cut {
    corners: [u32; 3],
    /// The scene's triangle that it was.
    number: u32,
    /// How far it may be from what it stands for, 1 being all that is allowed.
    error: f32,
}

/// What all patches read.
struct Source<'a> {
    scene: &'a Scene,
    /// For each vertex the first one at the same place.
    places: Vec<u32>,
    /// The length that [`TOLERANCE`] is here, scene units.
    tolerance: f32,
    /// For each material whether texture coordinates matter, and whether rays may go through.
    materials: Vec<Kind>,
}

/// What a material asks for.
#[derive(Clone, Copy, Debug)]
struct Kind {
    is_textured: bool,
    is_transparent: bool,
}

impl Source<'_> {
    /// The vertex of a corner.
    #[inline]
    fn vertex(&self, corner: u32) -> usize {
        self.scene.triangles[corner as usize / 3][corner as usize % 3] as usize
    }

    /// The place of a corner.
    #[inline]
    fn place(&self, corner: u32) -> u32 {
        self.places[self.vertex(corner)]
    }

    /// What a corner of a triangle of this material looks like.
    fn look(&self, corner: u32, material: u32) -> Look {
        let vertex = self.vertex(corner);
        let is_textured = self.materials[material as usize].is_textured;
        let colors = self.scene.corner_colors.get(corner as usize / 3);
        Look {
            normal: self.scene.normals[vertex],
            uv: if is_textured { self.scene.uvs[vertex] } else { Vec2::ZERO },
            color: colors.map_or(Vec3::ZERO, |colors| colors[corner as usize % 3]),
            material,
        }
    }
}

/// The triangles for rays: each corner is three times the number of one of the scene's triangles and which of its corners
/// it is, with its normal, texture coordinates, colour and material. All three corners have one material. In the scene's
/// order. `is_opaque` says of each material whether rays never go through it; triangles of others stay. A thread takes
/// `together` triangles at first, [`TOGETHER`] being fastest; the result depends on it, and on nothing else.
pub fn simplify(scene: &Scene, is_opaque: impl Fn(usize) -> bool, together: usize) -> Vec<[u32; 3]> {
    let ((low, high), main) = (scene.bounds(), scene.main_part());
    let kind = |(i, m): (usize, &Material)| Kind {
        is_textured: m.base_color_texture.is_some(),
        is_transparent: !is_opaque(i),
    };
    // Vertices of different models have nothing in common, whatever their numbers. Zero has two signs.
    let space = |i: u32| scene.models.partition_point(|model| model.vertices.start <= i) as u32;
    let position = |i: u32| {
        let [x, y, z] = (scene.positions[i as usize] + 0.0).to_array().map(f32::to_bits);
        [x, y, z, space(i)]
    };
    let source = Source {
        scene,
        places: firsts(scene.positions.len(), position),
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
            // What lies together is all over the file.
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

/// What a round leaves.
struct Round {
    left: Vec<Cut>,
    /// The share of places that more than one patch has.
    shared: f32,
}

/// Simplifies each patch of triangles but for what it shares with others.
fn round(source: &Source, triangles: &[Cut], together: usize) -> Round {
    let users: Vec<AtomicU32> =
        (0..source.places.len()).into_par_iter().map(|_| AtomicU32::new(NOBODY)).collect();
    triangles.par_chunks(together).enumerate().for_each(|(patch, some)| {
        let patch = patch as u32;
        for corner in some.iter().flat_map(|cut| cut.corners) {
            let user = &users[source.place(corner) as usize];
            // Whoever comes first: of two that differ many are left.
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
