//! The JSON of a glTF file: the `gltf` crate's document, and the values that the document loses.

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
    /// Parses the JSON; an error has the problem and the JSON path. Indices are checked on use, not here: a broken part
    /// without users does no harm.
    pub fn parse(json: &str) -> Result<Self, Refused> {
        let mut value: Value = serde_json::from_str(json).map_err(|e| e.to_string())?;
        check_version(&mut value)?;
        repair::mend(&mut value);
        let exact = deserialized(&value)?;
        repair::complete(&mut value);
        let root = deserialized(&value)?;
        Ok(Self { root, exact })
    }
}

/// Reason for refusing a file.
pub(super) enum Refused {
    /// An older version of glTF.
    Old(String),
    /// Not glTF 2.0; the string describes the file.
    Not(String),
}

impl From<String> for Refused {
    fn from(problem: String) -> Self {
        Self::Not(problem)
    }
}

/// Reads a value as a `T`; the error has the problem and, with the feature `json-paths`, the JSON path.
fn deserialized<T: DeserializeOwned>(value: &Value) -> Result<T, String> {
    #[cfg(feature = "json-paths")]
    return serde_path_to_error::deserialize(value).map_err(|error| error.to_string());
    #[cfg(not(feature = "json-paths"))]
    return T::deserialize(value).map_err(|error| error.to_string());
}

/// Refuses versions other than 2.x, before reading the rest.
fn check_version(root: &mut Value) -> Result<(), Refused> {
    // Exporters may write numbers.
    for member in ["version", "minVersion"] {
        let version = root.get_mut("asset").and_then(|asset| asset.get_mut(member));
        if let Some(version) = version.filter(|version| version.is_number()) {
            *version = Value::String(version.to_string());
        }
    }
    let asset = |member: &str| root.get("asset").and_then(|asset| asset.get(member)?.as_str());
    let major = |version: &str| version.trim().split('.').next().and_then(|n| n.parse::<u32>().ok());
    let Some(version) = asset("version") else {
        // glTF 1.0 has objects keyed by name instead of arrays.
        let by_name =
            ["nodes", "meshes", "accessors"].iter().any(|list| root.get(list).is_some_and(Value::is_object));
        return Err(match by_name || root.get("techniques").is_some() {
            true => Refused::Old("1.0".to_owned()),
            false => Refused::Not("it does not say its version (asset.version)".to_owned()),
        });
    };
    match major(version) {
        Some(2) => {}
        Some(0 | 1) => return Err(Refused::Old(version.trim().to_owned())),
        _ => return Err(Refused::Not(format!("its asset version is {version:?}"))),
    }
    match asset("minVersion").map(str::trim) {
        None | Some("2" | "2.0") => Ok(()),
        Some(least) if major(least).is_some_and(|major| major < 2) => Ok(()),
        Some(least) => Err(Refused::Not(format!(
            "it is meant for readers of glTF {least} and newer alone (asset.minVersion)"
        ))),
    }
}

/// An object with extensions; the crate keeps unknown extensions as raw JSON.
pub(super) trait Extensible {
    /// Extensions unknown to the crate, by name.
    fn raw(&self) -> Option<&Map<String, Value>>;

    /// Reads an extension unknown to the crate as a `T`; the error describes the problem.
    fn extension<T: DeserializeOwned>(&self, name: &str) -> Result<Option<T>, String> {
        let Some(value) = self.raw().and_then(|raw| raw.get(name)) else {
            return Ok(None);
        };
        deserialized(value).map(Some).map_err(|error| format!("has {name} that cannot be read: {error}"))
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
    gltf::json::Material,
    gltf::json::Node,
    gltf::json::Scene,
    gltf::json::Texture,
    gltf::json::buffer::View,
    gltf::json::material::NormalTexture,
    gltf::json::mesh::Primitive
);
