//! Accessors: numbers of any component type, strided, sparse, normalised.

use super::source::{Source, length, offset};
use crate::scene::SceneError;
use gltf::json::accessor::{ComponentType, GenericComponentType, IndexComponentType, Type};
use gltf::json::validation::Checked;

/// Maximum element count of an accessor without data, which is all zeros, unless the file has more bytes.
const MANY_ZEROS: usize = 1 << 16;

/// Reads a component as f64; normalised integers become 0..1 or −1..1.
fn component(bytes: &[u8], kind: ComponentType, normalized: bool) -> f64 {
    let value = match kind {
        ComponentType::I8 => bytes[0] as i8 as f64,
        ComponentType::U8 => bytes[0] as f64,
        ComponentType::I16 => i16::from_le_bytes([bytes[0], bytes[1]]) as f64,
        ComponentType::U16 => u16::from_le_bytes([bytes[0], bytes[1]]) as f64,
        ComponentType::U32 => u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]) as f64,
        ComponentType::F32 => return f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]) as f64,
    };
    if normalized { value_of_normalized(value, kind) } else { value }
}

/// Value of a normalised integer: 0..1 or −1..1.
pub(super) fn value_of_normalized(value: f64, kind: ComponentType) -> f64 {
    let max = match kind {
        ComponentType::I8 => 127.0,
        ComponentType::U8 => 255.0,
        ComponentType::I16 => 32767.0,
        ComponentType::U16 => 65535.0,
        ComponentType::U32 => 4_294_967_295.0,
        ComponentType::F32 => return value,
    };
    (value / max).max(-1.0)
}

/// glTF name of a type.
pub(super) fn type_name(kind: Type) -> &'static str {
    match kind {
        Type::Scalar => "SCALAR",
        Type::Vec2 => "VEC2",
        Type::Vec3 => "VEC3",
        Type::Vec4 => "VEC4",
        Type::Mat2 => "MAT2",
        Type::Mat3 => "MAT3",
        Type::Mat4 => "MAT4",
    }
}

impl Source<'_> {
    /// Reads the elements of an accessor of type `kind`, `N` numbers per element. `what` names the accessor in errors.
    pub fn read<const N: usize>(
        &self,
        index: usize,
        kind: Type,
        what: &str,
    ) -> Result<Vec<[f64; N]>, SceneError> {
        let bad = |problem: &str| self.malformed(format!("{what} (accessor {index}) {problem}"));
        let accessor = self.root.accessors.get(index).ok_or_else(|| bad("does not exist"))?;
        let wanted = type_name(kind);
        match accessor.type_ {
            Checked::Valid(found) if found == kind => {}
            Checked::Valid(found) => {
                return Err(bad(&format!("is {} instead of {wanted}", type_name(found))));
            }
            Checked::Invalid => return Err(bad(&format!("is of an unknown type instead of {wanted}"))),
        }
        let Checked::Valid(GenericComponentType(component_type)) = accessor.component_type else {
            return Err(bad("has an unknown component type"));
        };
        let size = component_type.size();
        let count = length(accessor.count);
        let element = |bytes: &[u8]| -> [f64; N] {
            std::array::from_fn(|c| component(&bytes[c * size..], component_type, accessor.normalized))
        };
        let mut out = match accessor.buffer_view {
            Some(view) => {
                let (bytes, stride) = self.view(view.value())?;
                let stride = stride.unwrap_or(size * N);
                self.strided(bytes, offset(accessor.byte_offset), stride, size * N, count)
                    .ok_or_else(|| bad("lies outside its buffer view"))?
                    .map(element)
                    .collect()
            }
            None if count <= self.size().max(MANY_ZEROS) => vec![[0.0; N]; count],
            None => return Err(bad("has no data")),
        };
        if let Some(sparse) = &accessor.sparse {
            let outside = || bad("has sparse values outside their buffer view");
            let Checked::Valid(IndexComponentType(index_type)) = sparse.indices.component_type else {
                return Err(bad("has sparse indices of an unknown type"));
            };
            let (index_size, count) = (index_type.size(), length(sparse.count));
            let (index_bytes, _) = self.view(sparse.indices.buffer_view.value())?;
            let (value_bytes, _) = self.view(sparse.values.buffer_view.value())?;
            let indices = self
                .strided(index_bytes, length(sparse.indices.byte_offset), index_size, index_size, count)
                .ok_or_else(outside)?;
            let values = self
                .strided(value_bytes, length(sparse.values.byte_offset), size * N, size * N, count)
                .ok_or_else(outside)?;
            for (at, value) in indices.zip(values) {
                let at = component(at, index_type, false) as usize;
                *out.get_mut(at).ok_or_else(|| bad("has a sparse index out of range"))? = element(value);
            }
        }
        Ok(out)
    }

    /// Slices of `len` bytes, `stride` bytes apart; `None` if out of bounds.
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
        Ok(self.read::<1>(index, Type::Scalar, what)?.into_iter().map(|[i]| i as u32).collect())
    }
}
