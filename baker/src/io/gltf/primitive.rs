//! Attributes and indices of a primitive, from accessors or Draco.

use super::accessor::type_name;
use super::draco::{self, Decoded};
use super::source::Source;
use crate::scene::SceneError;
use gltf::json::Index;
use gltf::json::accessor::{Accessor, Type};
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;

/// Reader of a primitive.
pub(super) struct PrimitiveReader<'a> {
    source: &'a Source<'a>,
    primitive: &'a Primitive,
    /// Name of the primitive in errors.
    what: &'a str,
    draco: Option<Decoded>,
}

impl<'a> PrimitiveReader<'a> {
    /// Decompresses a Draco primitive, unless the file has an uncompressed copy.
    pub fn new(source: &'a Source<'a>, primitive: &'a Primitive, what: &'a str) -> Result<Self, SceneError> {
        let mut numbers = Self { source, primitive, what, draco: None };
        let copied = |a: &Accessor| a.buffer_view.is_some() || a.sparse.is_some();
        if numbers.accessor(&Semantic::Positions).is_some_and(copied) {
            return Ok(numbers);
        }
        if let Some(packed) = source.read_extension(primitive, &[draco::NAME], what)? {
            numbers.draco = Some(Decoded::new(source, packed, what)?);
        }
        Ok(numbers)
    }

    /// Name of the primitive in errors.
    pub fn what(&self) -> &'a str {
        self.what
    }

    fn index(&self, name: &Semantic) -> Option<usize> {
        self.primitive.attributes.get(&Checked::Valid(name.clone())).map(Index::value)
    }

    fn accessor(&self, name: &Semantic) -> Option<&'a Accessor> {
        self.source.root.accessors.get(self.index(name)?)
    }

    /// Whether the primitive has the attribute `name` with type `kind`.
    pub fn is(&self, name: &Semantic, kind: Type) -> bool {
        self.accessor(name).is_some_and(|a| a.type_ == Checked::Valid(kind))
    }

    /// Reads the attribute `name` of type `kind` as `N` numbers per vertex; `None` if absent.
    pub fn read<const N: usize>(
        &self,
        name: &Semantic,
        kind: Type,
    ) -> Result<Option<Vec<[f64; N]>>, SceneError> {
        let Some(index) = self.index(name) else {
            return Ok(None);
        };
        let normalized = self.accessor(name).is_some_and(|a| a.normalized);
        let name = name.to_string();
        if let Some(draco) = self.draco.as_ref().filter(|d| d.holds(&name)) {
            let problem =
                || format!("{name} of {} is not {} in what Draco compressed", self.what, type_name(kind));
            let read = draco.read(&name, normalized);
            return read.map(Some).ok_or_else(|| self.source.malformed(problem()));
        }
        self.source.read(index, kind, &format!("{name} of {}", self.what)).map(Some)
    }

    /// Returns the vertex indices of the triangles, below `count`, counter-clockwise as in glTF.
    pub fn triangles(&self, count: usize) -> Result<Vec<[u32; 3]>, SceneError> {
        let mode = match self.primitive.mode {
            Checked::Valid(mode) => mode,
            Checked::Invalid => Mode::Triangles,
        };
        let (mode, indices) = match (&self.draco, self.primitive.indices) {
            // Draco decodes strips to a list.
            (Some(draco), _) => (Mode::Triangles, draco.indices()),
            (None, Some(a)) => {
                (mode, self.source.read_indices(a.value(), &format!("indices of {}", self.what))?)
            }
            (None, None) => (mode, (0..count as u32).collect()),
        };
        if let Some(i) = indices.iter().find(|&&i| i as usize >= count) {
            let problem = format!("{} has the index {i}, but {count} vertices", self.what);
            return Err(self.source.malformed(problem));
        }
        Ok(triangles(mode, &indices))
    }
}

/// Triangles of a triangle list, strip or fan.
fn triangles(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => indices
            .windows(3)
            .enumerate()
            .map(|(i, w)| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[0], w[2], w[1]] })
            .collect(),
        Mode::TriangleFan => indices.windows(2).skip(1).map(|w| [w[0], w[1], indices[0]]).collect(),
        _ => indices.as_chunks::<3>().0.to_vec(),
    }
}
