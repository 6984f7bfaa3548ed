//! Accessors: numbers of any component type, strided, sparse, normalised.

use super::source::Source;
use crate::scene::SceneError;

/// An accessor without data behind it is all zeros; one of more elements than this and than the file has bytes is a
/// lie.
const MANY_ZEROS: usize = 1 << 16;

/// Size in bytes of a component type.
fn component_size(component_type: u32) -> Option<usize> {
    match component_type {
        5120 | 5121 => Some(1),
        5122 | 5123 => Some(2),
        5125 | 5126 => Some(4),
        _ => None,
    }
}

/// One component as an f64; normalised integers become 0..1 or −1..1.
fn component(bytes: &[u8], component_type: u32, normalized: bool) -> f64 {
    let value = match component_type {
        5120 => bytes[0] as i8 as f64,
        5121 => bytes[0] as f64,
        5122 => i16::from_le_bytes([bytes[0], bytes[1]]) as f64,
        5123 => u16::from_le_bytes([bytes[0], bytes[1]]) as f64,
        5125 => u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]) as f64,
        _ => return f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]) as f64,
    };
    if normalized { value_of_normalized(value, component_type) } else { value }
}

/// What a normalised integer stands for: 0..1 or −1..1.
pub(super) fn value_of_normalized(value: f64, component_type: u32) -> f64 {
    let max = match component_type {
        5120 => 127.0,
        5121 => 255.0,
        5122 => 32767.0,
        5123 => 65535.0,
        5125 => 4_294_967_295.0,
        _ => return value,
    };
    (value / max).max(-1.0)
}

impl Source {
    /// The elements of an accessor of this `kind` ("SCALAR", "VEC2", "VEC3"), as `N` numbers each.
    /// `what` names it in errors.
    pub fn read<const N: usize>(
        &self,
        index: usize,
        kind: &str,
        what: &str,
    ) -> Result<Vec<[f64; N]>, SceneError> {
        let bad = |problem: &str| self.malformed(format!("{what} (accessor {index}) {problem}"));
        let accessor = self.root.accessors.get(index).ok_or_else(|| bad("does not exist"))?;
        if accessor.kind != kind {
            return Err(bad(&format!("is {} instead of {kind}", accessor.kind)));
        }
        let size =
            component_size(accessor.component_type).ok_or_else(|| bad("has an unknown component type"))?;
        let element = |bytes: &[u8]| -> [f64; N] {
            std::array::from_fn(|c| {
                component(&bytes[c * size..], accessor.component_type, accessor.normalized)
            })
        };
        let mut out = match accessor.buffer_view {
            Some(view) => {
                let (bytes, stride) = self.view(view)?;
                let stride = stride.unwrap_or(size * N);
                self.strided(bytes, accessor.byte_offset, stride, size * N, accessor.count)
                    .ok_or_else(|| bad("lies outside its buffer view"))?
                    .map(element)
                    .collect()
            }
            None if accessor.count <= self.size().max(MANY_ZEROS) => vec![[0.0; N]; accessor.count],
            None => return Err(bad("has no data")),
        };
        if let Some(sparse) = &accessor.sparse {
            let outside = || bad("has sparse values outside their buffer view");
            let index_size = component_size(sparse.indices.component_type)
                .ok_or_else(|| bad("has sparse indices of an unknown type"))?;
            let (index_bytes, _) = self.view(sparse.indices.buffer_view)?;
            let (value_bytes, _) = self.view(sparse.values.buffer_view)?;
            let indices = self
                .strided(index_bytes, sparse.indices.byte_offset, index_size, index_size, sparse.count)
                .ok_or_else(outside)?;
            let values = self
                .strided(value_bytes, sparse.values.byte_offset, size * N, size * N, sparse.count)
                .ok_or_else(outside)?;
            for (at, value) in indices.zip(values) {
                let at = component(at, sparse.indices.component_type, false) as usize;
                *out.get_mut(at).ok_or_else(|| bad("has a sparse index out of range"))? = element(value);
            }
        }
        Ok(out)
    }

    /// Slices of `len` bytes, `stride` apart; `None` where they do not fit.
    fn strided<'a>(
        &self,
        bytes: &'a [u8],
        offset: usize,
        stride: usize,
        len: usize,
        count: usize,
    ) -> Option<impl Iterator<Item = &'a [u8]> + use<'a>> {
        if count > 0 {
            let last = count.checked_sub(1)?.checked_mul(stride)?.checked_add(offset)?;
            if stride == 0 || last.checked_add(len)? > bytes.len() {
                return None;
            }
        }
        Some((0..count).map(move |i| &bytes[offset + i * stride..][..len]))
    }

    /// Vertex indices of a primitive.
    pub fn read_indices(&self, index: usize, what: &str) -> Result<Vec<u32>, SceneError> {
        Ok(self.read::<1>(index, "SCALAR", what)?.into_iter().map(|[i]| i as u32).collect())
    }
}
