//! Boundary representation (B-rep): the exact faces of a scene from CAD.

use super::Scene;
use glam::DAffine3;
use rebounce_cad::cast::{CastFace, FacePiece};
use rebounce_cad::face::Face;
use rebounce_cad::trim::TrimError;
use std::borrow::Cow;
use std::ops::Range;

/// Exact faces of a scene. The scene's triangles with the same materials are their tessellation, for pictures: rays meet
/// the faces.
#[derive(Clone, Debug, Default)]
pub struct Brep {
    /// Faces of the parts, each once, in the part's space.
    pub faces: Vec<BrepFace>,
    /// Where parts stand.
    pub instances: Vec<BrepInstance>,
}

/// A trimmed face of a part.
#[derive(Clone, Debug)]
pub struct BrepFace {
    /// Surface and domain.
    pub face: Face,
    /// The face, ready for rays.
    pub cast: CastFace,
    /// Its parts, for a bounding volume hierarchy.
    pub pieces: Vec<FacePiece>,
    /// Index of the scene's material; no triangle but those of faces has it.
    pub material: u32,
}

/// An occurrence of a part.
#[derive(Clone, Debug, PartialEq)]
pub struct BrepInstance {
    /// Range of the part's faces.
    pub faces: Range<u32>,
    /// Rigid transform, with a scale at most.
    pub local_from_part: DAffine3,
}

impl BrepFace {
    /// Prepares a face of a material.
    ///
    /// # Errors
    /// [`TrimError`] for loops that bound nothing.
    pub fn new(face: Face, material: u32) -> Result<Self, TrimError> {
        let (cast, pieces) = CastFace::new(&face)?;
        Ok(Self { face, cast, pieces, material })
    }
}

impl Scene {
    /// By material, whether rays meet exact faces instead of the triangles with it. What shines is met as triangles, whose
    /// sampling densities are known.
    pub fn is_exact(&self) -> Vec<bool> {
        let mut is_exact = vec![false; self.materials.len()];
        for face in self.brep.iter().flat_map(|brep| &brep.faces) {
            let number = face.material as usize;
            is_exact[number] = self.materials[number].emission == [0.0; 3];
        }
        is_exact
    }

    /// Returns the scene without the tessellation of exact faces.
    pub fn without_tessellation(&self) -> Cow<'_, Self> {
        let is_exact = self.is_exact();
        if !is_exact.contains(&true) {
            return Cow::Borrowed(self);
        }
        let kept: Vec<bool> = self.triangle_material.iter().map(|m| !is_exact[*m as usize]).collect();
        let before = |end: u32| kept[..end as usize].iter().filter(|kept| **kept).count() as u32;
        let mut models = self.models.clone();
        for model in &mut models {
            model.triangles = before(model.triangles.start)..before(model.triangles.end);
        }
        models.retain(|model| !model.triangles.is_empty());
        fn filtered<T: Copy>(all: &[T], kept: &[bool]) -> Vec<T> {
            all.iter().zip(kept).filter(|(_, kept)| **kept).map(|(one, _)| *one).collect()
        }
        Cow::Owned(Self {
            triangles: filtered(&self.triangles, &kept),
            triangle_material: filtered(&self.triangle_material, &kept),
            corner_colors: filtered(&self.corner_colors, &kept),
            models,
            ..self.clone()
        })
    }
}
