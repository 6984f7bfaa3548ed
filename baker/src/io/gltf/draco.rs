//! KHR_draco_mesh_compression: attributes and indices of a primitive in a single compressed buffer view.

use super::accessor::value_of_normalized;
use super::source::Source;
use crate::scene::SceneError;
use draco_core::{DataType, DecodeLimits, DecoderBuffer, Mesh, MeshDecoder};
use gltf::json::accessor::ComponentType;
use serde::Deserialize;
use std::collections::BTreeMap;

/// Maximum decompressed size of a primitive, bytes: larger than any exporter writes.
const MOST_BYTES: u64 = 2 << 30;

/// The extension's name.
pub(super) const NAME: &str = "KHR_draco_mesh_compression";

/// A compressed primitive.
#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Draco {
    pub buffer_view: usize,
    /// Draco's attribute ids, by glTF attribute.
    pub attributes: BTreeMap<String, u32>,
}

/// A decompressed primitive.
pub(super) struct Decoded {
    mesh: Mesh,
    /// Draco's attribute ids, by glTF attribute.
    attributes: BTreeMap<String, u32>,
}

impl Decoded {
    /// Decompresses a primitive; `what` names the primitive in errors.
    pub fn new(source: &Source, packed: Draco, what: &str) -> Result<Self, SceneError> {
        let bad = |problem: String| source.malformed(format!("{what} (compressed by Draco) {problem}"));
        let (bytes, _) = source.view(packed.buffer_view)?;
        let most = MOST_BYTES / 12;
        let limits = DecodeLimits::default().with_max_points(most).with_max_faces(most);
        let mut buffer = DecoderBuffer::new(bytes).with_limits(limits.with_max_decoded_bytes(MOST_BYTES));
        let mut mesh = Mesh::new();
        MeshDecoder::new()
            .decode(&mut buffer, &mut mesh)
            .map_err(|error| bad(format!("cannot be decompressed ({error})")))?;
        Ok(Self { mesh, attributes: packed.attributes })
    }

    /// Vertex indices of the triangles, as a flat list.
    pub fn indices(&self) -> Vec<u32> {
        self.mesh.faces().iter().flatten().map(|i| i.0).collect()
    }

    /// Whether the attribute `name` is compressed.
    pub fn holds(&self, name: &str) -> bool {
        self.attributes.contains_key(name)
    }

    /// Reads a compressed attribute as `N` numbers per vertex; `None` if absent or of a different size.
    pub fn read<const N: usize>(&self, name: &str, normalized: bool) -> Option<Vec<[f64; N]>> {
        let attribute = self.mesh.attribute_by_unique_id(*self.attributes.get(name)?)?;
        if attribute.num_components() as usize != N {
            return None;
        }
        let kind = match attribute.data_type() {
            DataType::Int8 => ComponentType::I8,
            DataType::Uint8 => ComponentType::U8,
            DataType::Int16 => ComponentType::I16,
            DataType::Uint16 => ComponentType::U16,
            DataType::Uint32 => ComponentType::U32,
            _ => ComponentType::F32,
        };
        let value = |x: f32| if normalized { value_of_normalized(x as f64, kind) } else { x as f64 };
        let numbers = attribute.read_f32s(self.mesh.num_points(), N);
        Some(numbers.as_chunks::<N>().0.iter().map(|element| element.map(value)).collect())
    }
}
