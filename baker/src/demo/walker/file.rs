//! Parts of a .glb file: the binary chunk with its accessors, and the container.

use serde_json::{Value, json};

/// The binary chunk, with views and accessors.
#[derive(Default)]
pub(super) struct Chunk {
    pub(super) bytes: Vec<u8>,
    pub(super) views: Vec<Value>,
    pub(super) accessors: Vec<Value>,
}

impl Chunk {
    /// Adds an accessor; returns its number.
    pub(super) fn add(
        &mut self,
        bytes: &[u8],
        component: u32,
        kind: &str,
        count: usize,
        range: Option<[Value; 2]>,
    ) -> usize {
        self.views.push(json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()}));
        self.bytes.extend(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let view = self.views.len() - 1;
        let mut accessor =
            json!({"bufferView": view, "componentType": component, "count": count, "type": kind});
        if let Some([low, high]) = range {
            (accessor["min"], accessor["max"]) = (low, high);
        }
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// Adds an accessor of floats, with their range.
    pub(super) fn floats(&mut self, numbers: &[f32], kind: &str, width: usize) -> usize {
        let column = |pick: fn(f32, f32) -> f32| -> Value {
            (0..width)
                .map(|i| numbers.iter().skip(i).step_by(width).copied().reduce(pick).unwrap_or(0.0))
                .collect()
        };
        let range = [column(f32::min), column(f32::max)];
        self.add(bytemuck::cast_slice(numbers), 5126, kind, numbers.len() / width, Some(range))
    }
}

/// Puts JSON and bytes into a container.
pub(super) fn container(mut json: Vec<u8>, bytes: Vec<u8>) -> Vec<u8> {
    json.resize(json.len().next_multiple_of(4), b' ');
    let length = 12 + 8 + json.len() + 8 + bytes.len();
    let mut out = b"glTF".to_vec();
    for word in [2, length as u32, json.len() as u32] {
        out.extend(word.to_le_bytes());
    }
    out.extend(b"JSON");
    out.extend(json);
    out.extend((bytes.len() as u32).to_le_bytes());
    out.extend(b"BIN\0");
    out.extend(bytes);
    out
}
