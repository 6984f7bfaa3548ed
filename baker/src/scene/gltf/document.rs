//! The JSON of a glTF file: the `gltf` crate's document, and beside it what that document does not keep.

use super::exact::Exact;
use super::repair;
use gltf::json::Root;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

/// A parsed file.
pub(super) struct Document {
    pub root: Root,
    pub exact: Exact,
}

impl Document {
    /// Parses the JSON; an error says what is wrong with it and where. Indices are not checked here but where they are
    /// followed, so that a broken part that nothing uses does no harm.
    pub fn parse(json: &[u8]) -> Result<Self, String> {
        let mut value: Value = serde_json::from_slice(json).map_err(|e| e.to_string())?;
        let version = value.pointer("/asset/version").and_then(Value::as_str).unwrap_or_default();
        if !version.starts_with("2.") {
            return Err(format!("its asset version is {version:?}"));
        }
        repair::mend(&mut value);
        let exact = serde_path_to_error::deserialize(&value).map_err(|e| e.to_string())?;
        repair::complete(&mut value);
        let root = serde_path_to_error::deserialize(value).map_err(|e| e.to_string())?;
        Ok(Self { root, exact })
    }
}

/// What has extensions, of which the crate keeps those that it does not know as they stand in the file.
pub(super) trait Extensible {
    /// The extensions that the crate does not know, by their names.
    fn raw(&self) -> Option<&Map<String, Value>>;

    /// An extension that the crate does not know, as a `T`; an error says what is wrong in it.
    fn extension<T: DeserializeOwned>(&self, name: &str) -> Result<Option<T>, String> {
        let Some(value) = self.raw().and_then(|raw| raw.get(name)) else {
            return Ok(None);
        };
        let read = serde_path_to_error::deserialize::<_, T>(value);
        read.map(Some).map_err(|error| format!("has {name} that cannot be read: {error}"))
    }
}

macro_rules! extensible {
    ($($what:ty),*) => { $(
        impl Extensible for $what {
            fn raw(&self) -> Option<&Map<String, Value>> {
                self.extensions.as_ref().map(|extensions| &extensions.others)
            }
        }
    )* };
}

extensible!(
    Root,
    gltf::json::Buffer,
    gltf::json::Node,
    gltf::json::Texture,
    gltf::json::buffer::View,
    gltf::json::material::NormalTexture,
    gltf::json::mesh::Primitive
);
