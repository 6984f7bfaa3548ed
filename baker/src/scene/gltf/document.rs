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
    pub fn parse(json: &str) -> Result<Self, Refused> {
        let mut value: Value = serde_json::from_str(json).map_err(|e| e.to_string())?;
        check_version(&mut value)?;
        repair::mend(&mut value);
        let exact = serde_path_to_error::deserialize(&value).map_err(|e| e.to_string())?;
        repair::complete(&mut value);
        let root = serde_path_to_error::deserialize(value).map_err(|e| e.to_string())?;
        Ok(Self { root, exact })
    }
}

/// Why a file is refused.
pub(super) enum Refused {
    /// It is glTF of this version.
    Old(String),
    /// It is not glTF 2.0; says what it is.
    Not(String),
}

impl From<String> for Refused {
    fn from(problem: String) -> Self {
        Self::Not(problem)
    }
}

/// Refuses all versions but 2.x, before anything else is looked at.
fn check_version(root: &mut Value) -> Result<(), Refused> {
    // Some exporters write numbers.
    for member in ["version", "minVersion"] {
        let version = root.get_mut("asset").and_then(|asset| asset.get_mut(member));
        if let Some(version) = version.filter(|version| version.is_number()) {
            *version = Value::String(version.to_string());
        }
    }
    let asset = |member: &str| root.get("asset").and_then(|asset| asset.get(member)?.as_str());
    let major = |version: &str| version.trim().split('.').next().and_then(|n| n.parse::<u32>().ok());
    let Some(version) = asset("version") else {
        // Before 2.0 all was kept by names instead of in lists.
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
    gltf::json::Material,
    gltf::json::Node,
    gltf::json::Scene,
    gltf::json::Texture,
    gltf::json::buffer::View,
    gltf::json::material::NormalTexture,
    gltf::json::mesh::Primitive
);
