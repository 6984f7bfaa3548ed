//! The numbers of a primitive, whether accessors or Draco hold them.

use super::draco::Decoded;
use super::schema::{Accessor, Primitive};
use super::source::Source;
use crate::scene::SceneError;

/// A primitive to be read.
pub(super) struct Numbers<'a> {
    source: &'a Source,
    primitive: &'a Primitive,
    /// What errors call it.
    what: &'a str,
    draco: Option<Decoded<'a>>,
}

impl<'a> Numbers<'a> {
    /// Decompresses the primitive where it is compressed and the file has no copy that is not.
    pub fn new(source: &'a Source, primitive: &'a Primitive, what: &'a str) -> Result<Self, SceneError> {
        let mut numbers = Self { source, primitive, what, draco: None };
        let copied = |a: &Accessor| a.buffer_view.is_some() || a.sparse.is_some();
        let plain = numbers.accessor("POSITION").is_some_and(copied);
        if let Some(packed) = primitive.extensions.draco.as_ref().filter(|_| !plain) {
            numbers.draco = Some(Decoded::new(source, packed, what)?);
        }
        Ok(numbers)
    }

    fn accessor(&self, name: &str) -> Option<&'a Accessor> {
        self.source.root.accessors.get(*self.primitive.attributes.get(name)?)
    }

    /// Whether the primitive has an attribute of this kind ("VEC3").
    pub fn is(&self, name: &str, kind: &str) -> bool {
        self.accessor(name).is_some_and(|a| a.kind == kind)
    }

    /// An attribute of this `kind`, as `N` numbers a vertex.
    pub fn read<const N: usize>(&self, name: &str, kind: &str) -> Result<Option<Vec<[f64; N]>>, SceneError> {
        let Some(&index) = self.primitive.attributes.get(name) else {
            return Ok(None);
        };
        let normalized = self.accessor(name).is_some_and(|a| a.normalized);
        if let Some(draco) = self.draco.as_ref().filter(|d| d.holds(name)) {
            let problem = format!("{name} of {} is not {kind} in what Draco compressed", self.what);
            return draco.read(name, normalized).map(Some).ok_or_else(|| self.source.malformed(problem));
        }
        self.source.read(index, kind, &format!("{name} of {}", self.what)).map(Some)
    }

    /// The corners of its triangles, of which `count` vertices may be used, counter-clockwise as glTF has them.
    pub fn triangles(&self, count: usize) -> Result<Vec<[u32; 3]>, SceneError> {
        let mode = self.primitive.mode.unwrap_or(4);
        let (mode, indices) = match (&self.draco, self.primitive.indices) {
            // Draco makes a list of strips.
            (Some(draco), _) => (4, draco.indices()),
            (None, Some(a)) => (mode, self.source.read_indices(a, &format!("indices of {}", self.what))?),
            (None, None) => (mode, (0..count as u32).collect()),
        };
        if let Some(i) = indices.iter().find(|&&i| i as usize >= count) {
            let problem = format!("{} has the index {i}, but {count} vertices", self.what);
            return Err(self.source.malformed(problem));
        }
        Ok(triangles(mode, &indices))
    }
}

/// Triangles of a triangle list (4), strip (5) or fan (6).
fn triangles(mode: u32, indices: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        5 => indices
            .windows(3)
            .enumerate()
            .map(|(i, w)| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[0], w[2], w[1]] })
            .collect(),
        6 => indices.windows(2).skip(1).map(|w| [w[0], w[1], indices[0]]).collect(),
        _ => indices.as_chunks::<3>().0.to_vec(),
    }
}
