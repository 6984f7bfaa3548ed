//! Subresource Integrity: hashes that a page can hold the package's files to.

use anyhow::{Context, Result};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest, Sha256, Sha384};
use std::collections::BTreeMap;

/// Placeholder in engine/module.ts for the hash of the wasm file.
const WASM: &str = "sha256-of-the-wasm";
/// The hashes of the modules, in the form of an import map.
pub const LIST: &str = "integrity.json";

type Files = BTreeMap<String, Vec<u8>>;

/// Writes the hash of the wasm file into the module that fetches the file: hashes of the modules then cover the
/// wasm.
///
/// # Errors
/// If a file is missing, or the placeholder is missing.
pub fn seal(files: &mut Files, module: &str, wasm: &str) -> Result<()> {
    let hash =
        format!("sha256-{}", STANDARD.encode(Sha256::digest(files.get(wasm).context(wasm.to_owned())?)));
    let script = files.get_mut(module).context(module.to_owned())?;
    let text = String::from_utf8(std::mem::take(script)).with_context(|| module.to_owned())?;
    let place = format!("{module} does not say {WASM:?}");
    *script = text.contains(WASM).then(|| text.replace(WASM, &hash)).context(place)?.into_bytes();
    Ok(())
}

/// `{"integrity": {"./NAME.js": "sha384-…"}}` of the modules, for [`LIST`].
///
/// # Errors
/// Only errors of the JSON writer.
pub fn list(files: &Files) -> Result<Vec<u8>> {
    let hashes: BTreeMap<String, String> = files
        .iter()
        .filter(|(name, _)| name.ends_with(".js"))
        .map(|(name, bytes)| {
            (format!("./{name}"), format!("sha384-{}", STANDARD.encode(Sha384::digest(bytes))))
        })
        .collect();
    let mut text = serde_json::to_vec_pretty(&serde_json::json!({ "integrity": hashes }))?;
    text.push(b'\n');
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_module_names_its_wasm_and_the_list_the_modules() {
        let mut files = Files::from([
            ("a.js".to_owned(), b"fetch(x, \"sha256-of-the-wasm\")".to_vec()),
            ("b.wasm".to_owned(), b"abc".to_vec()),
        ]);
        seal(&mut files, "a.js", "b.wasm").unwrap();
        // FIPS 180-2, appendix B.1.
        let sealed = b"fetch(x, \"sha256-ungWv48Bz+pBQUDeXa4iI7ADYaOWF3qctBD/YfIAFa0=\")";
        assert_eq!(files["a.js"], sealed);
        let list: serde_json::Value = serde_json::from_slice(&list(&files).unwrap()).unwrap();
        let hash = list["integrity"]["./a.js"].as_str().unwrap();
        assert!(hash.starts_with("sha384-") && hash.len() == 7 + 64, "{hash}");
        assert_eq!(list["integrity"].as_object().unwrap().len(), 1);
        assert!(seal(&mut files, "a.js", "b.wasm").is_err(), "sealed twice");
    }
}
