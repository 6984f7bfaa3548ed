//! Looks of materials from a JSON file: `{"vase": {"color": [0.8, 0.2, 0.1], "roughness": 0.4}}`.

use super::Files;
use crate::scene::SceneError;
use crate::scene::material_look::MaterialLook;
use std::collections::BTreeMap;
use std::path::Path;

/// Reads looks by the name of a part or a material.
///
/// # Errors
/// [`SceneError::Looks`] for a text that is something else, or numbers out of range; [`SceneError::Read`].
pub fn read_looks(files: &dyn Files, path: &Path) -> Result<BTreeMap<String, MaterialLook>, SceneError> {
    let file = path.display().to_string();
    let bytes = files.read(path).map_err(|source| SceneError::Read { path: file.clone(), source })?;
    let bytes = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(&bytes);
    let invalid = |problem: String| SceneError::Looks { file: file.clone(), problem };
    let looks: BTreeMap<String, MaterialLook> =
        serde_json::from_slice(bytes).map_err(|error| invalid(error.to_string()))?;
    for (name, look) in &looks {
        if let Some(problem) = look.problem() {
            return Err(invalid(format!("{name:?}: {problem}")));
        }
    }
    Ok(looks)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::files::Memory;

    fn read(text: &str) -> Result<BTreeMap<String, MaterialLook>, String> {
        let files: Memory = [("looks.json", text.as_bytes().to_vec())].into_iter().collect();
        read_looks(&files, Path::new("looks.json")).map_err(|error| error.to_string())
    }

    #[test]
    fn looks_are_read_and_mistakes_are_told() {
        let looks = read(
            r#"{"vase": {"color": [0.8, 0.2, 0.1], "roughness": 0.4}, "lamp": {"emission": [9, 9, 8]}}"#,
        );
        let looks = looks.unwrap();
        assert_eq!(looks["vase"].roughness, Some(0.4));
        assert_eq!(looks["lamp"].emission, Some([9.0, 9.0, 8.0]));
        for (text, part) in [
            (r#"{"vase": {"colour": [0, 0, 0]}}"#, "unknown field `colour`"),
            (r#"{"vase": {"color": [0, 2, 0]}}"#, "\"vase\": color is three numbers from 0 to 1"),
            (r#"{"vase": {"emission": [0, -2, 0]}}"#, "emission is"),
            ("[]", "looks.json"),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.contains(part) && error.contains("looks.json"), "{error}");
        }
    }
}
