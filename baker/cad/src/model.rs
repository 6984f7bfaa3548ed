//! Assembly of parts.

use crate::face::Face;
use glam::{DAffine3, Vec3};

/// What a file holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Assembly {
    /// Parts, each once.
    pub parts: Vec<Part>,
    /// Where parts stand.
    pub instances: Vec<PartInstance>,
    /// What could not be read, a sentence each: `3 faces of "housing": offset surfaces are not read`.
    pub notes: Vec<String>,
}

/// A solid or an open shell.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Part {
    /// Name of the product, or empty.
    pub name: String,
    /// Faces, and the colour of each.
    pub faces: Vec<(Face, FaceColour)>,
    /// Whether the faces close a body: normals point out of it.
    pub is_closed: bool,
}

/// Colour of a face, linear RGB; `None` where the file has none.
pub type FaceColour = Option<Vec3>;

/// An occurrence of a part.
#[derive(Clone, Debug, PartialEq)]
pub struct PartInstance {
    /// Index of the part.
    pub part: usize,
    /// Names from the root of the assembly to the occurrence.
    pub path: Vec<String>,
    /// Placement, metres, y up.
    pub world_from_part: DAffine3,
}
