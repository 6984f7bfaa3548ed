//! The container of a .glb file (glTF 2.0, section 4), and accessors in its buffer.

use super::ExportError;
use serde_json::{Value, json};

/// Type numbers of components: 32-bit floats, unsigned 32-bit integers.
const FLOAT: u32 = 5126;
const UNSIGNED: u32 = 5125;
/// Targets of buffer views: vertices, indices.
const ARRAY: u32 = 34962;
const ELEMENTS: u32 = 34963;

/// Binary part of a file, with its views and accessors.
#[derive(Default)]
pub(super) struct Buffer {
    bytes: Vec<u8>,
    pub views: Vec<Value>,
    pub accessors: Vec<Value>,
}

impl Buffer {
    /// Adds bytes at a multiple of four; returns the number of the view.
    pub fn view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let mut view = json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.bytes.extend_from_slice(bytes);
        self.views.push(view);
        self.views.len() - 1
    }

    /// Adds vectors of floats, with their bounds if wanted; returns the number of the accessor.
    pub fn vectors<const N: usize>(&mut self, values: &[[f32; N]], bounded: bool) -> usize {
        let bytes: Vec<u8> = values.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        let view = self.view(&bytes, Some(ARRAY));
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][N - 1];
        let mut accessor =
            json!({ "bufferView": view, "componentType": FLOAT, "count": values.len(), "type": kind });
        if bounded {
            let bound = |start: f32, pick: fn(f32, f32) -> f32| {
                values.iter().fold([start; N], |a, b| std::array::from_fn(|i| pick(a[i], b[i]))).to_vec()
            };
            accessor["min"] = bound(f32::INFINITY, f32::min).into();
            accessor["max"] = bound(f32::NEG_INFINITY, f32::max).into();
        }
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// Adds vertex indices of triangles; returns the number of the accessor.
    pub fn triangles(&mut self, triangles: &[[u32; 3]]) -> usize {
        let bytes: Vec<u8> = triangles.iter().flatten().flat_map(|i| i.to_le_bytes()).collect();
        let view = self.view(&bytes, Some(ELEMENTS));
        let count = 3 * triangles.len();
        self.accessors
            .push(json!({ "bufferView": view, "componentType": UNSIGNED, "count": count, "type": "SCALAR" }));
        self.accessors.len() - 1
    }

    /// Number of bytes.
    pub fn len(&self) -> usize {
        self.bytes.len()
    }

    /// Returns the file: `root` as JSON and the bytes.
    ///
    /// # Errors
    /// [`ExportError::TooLarge`].
    pub fn file(mut self, root: &Value) -> Result<Vec<u8>, ExportError> {
        let mut text = root.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let length = 12 + 8 + text.len() as u64 + 8 + self.bytes.len() as u64;
        let length = u32::try_from(length).map_err(|_| ExportError::TooLarge(length))?;
        let mut out = Vec::with_capacity(length as usize);
        let word = |number: u32| number.to_le_bytes();
        out.extend([*b"glTF", word(2), word(length), word(text.len() as u32), *b"JSON"].as_flattened());
        out.extend(text);
        out.extend([word(self.bytes.len() as u32), *b"BIN\0"].as_flattened());
        out.extend(self.bytes);
        Ok(out)
    }
}
