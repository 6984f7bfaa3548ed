//! The files that a command names, read and checked by JavaScript.

use super::host::{Host, with_host};
use js_sys::{Array, Reflect, Uint8Array};
use rebounce::io::Files;
use rebounce::io::write::WriteError;
use rebounce_args::paths::Places;
use std::io::{Error, ErrorKind, Result};
use std::path::Path;
use wasm_bindgen::prelude::*;

#[wasm_bindgen]
extern "C" {
    /// What the command's JavaScript does besides: `CommandHost` of `baker/npm/src/wasm/host.ts`.
    #[wasm_bindgen(extends = Host)]
    type CommandHost;

    /// Reads a file. Throws an error of Node.js.
    #[wasm_bindgen(method, catch)]
    fn read(this: &CommandHost, path: &str) -> std::result::Result<Uint8Array, JsValue>;

    /// Whether there is a file or a folder.
    #[wasm_bindgen(method)]
    fn exists(this: &CommandHost, path: &str) -> bool;

    /// Names of the files and folders in a folder.
    #[wasm_bindgen(method)]
    fn names(this: &CommandHost, folder: &str) -> Array;

    /// Returns the first bytes of a regular file, or nothing.
    #[wasm_bindgen(method, js_name = firstBytes)]
    fn first_bytes(this: &CommandHost, path: &str, count: usize) -> Option<Uint8Array>;

    /// Whether two paths name a single file.
    #[wasm_bindgen(method, js_name = isSame)]
    fn is_same(this: &CommandHost, a: &str, b: &str) -> bool;

    /// Checks in advance whether a file can be written: returns nothing, or `"not-a-file"`, `"no-folder"`, or why its
    /// folder cannot be written to.
    #[wasm_bindgen(method, js_name = checkPlace)]
    fn check_place(this: &CommandHost, path: &str) -> Option<String>;
}

/// The file system, as JavaScript shows it.
pub struct HostFiles;

/// Calls `ask` with what reads files.
fn with_files<T: Default>(ask: impl FnOnce(&CommandHost) -> T) -> T {
    with_host(|host| ask(host.unchecked_ref())).unwrap_or_default()
}

impl Files for HostFiles {
    fn read(&self, path: &Path) -> Result<Vec<u8>> {
        let bytes = with_host(|host| {
            let host: &CommandHost = host.unchecked_ref();
            host.read(&path.to_string_lossy()).map(|bytes| bytes.to_vec()).map_err(|error| io_error(&error))
        });
        bytes.unwrap_or_else(|| Err(ErrorKind::NotFound.into()))
    }

    fn exists(&self, path: &Path) -> bool {
        with_files(|host| host.exists(&path.to_string_lossy()))
    }

    fn names(&self, folder: &Path) -> Vec<String> {
        with_files(|host| {
            host.names(&folder.to_string_lossy()).iter().filter_map(|name| name.as_string()).collect()
        })
    }
}

impl Places for HostFiles {
    fn first_bytes(&self, path: &Path, count: usize) -> Option<Vec<u8>> {
        with_files(|host| host.first_bytes(&path.to_string_lossy(), count).map(|bytes| bytes.to_vec()))
    }

    fn is_same(&self, a: &Path, b: &Path) -> bool {
        with_files(|host| host.is_same(&a.to_string_lossy(), &b.to_string_lossy()))
    }

    fn check_place(&self, path: &Path) -> std::result::Result<(), WriteError> {
        let Some(problem) = with_files(|host| host.check_place(&path.to_string_lossy())) else {
            return Ok(());
        };
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let folder = folder.unwrap_or(Path::new(".")).to_owned();
        Err(match problem.as_str() {
            "not-a-file" => WriteError::NotAFile(path.to_owned()),
            "no-folder" => {
                let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
                WriteError::NoFolder { folder, name }
            }
            why => WriteError::Folder { folder, source: Error::other(why.to_owned()) },
        })
    }
}

/// Turns an error of Node.js into one of Rust.
fn io_error(error: &JsValue) -> Error {
    let member = |name: &str| Reflect::get(error, &name.into()).ok().and_then(|value| value.as_string());
    let kind = match member("code").as_deref() {
        Some("ENOENT") => ErrorKind::NotFound,
        Some("EACCES" | "EPERM") => ErrorKind::PermissionDenied,
        Some("EISDIR") => ErrorKind::IsADirectory,
        _ => ErrorKind::Other,
    };
    // `ENOENT: no such file or directory, open 'room.glb'`: the message names the file again.
    let message = member("message").unwrap_or_default();
    let message = message.split_once(": ").map_or(message.as_str(), |(_, rest)| rest);
    let mut said: Vec<char> = message.split(", ").next().unwrap_or_default().chars().collect();
    said.iter_mut().take(1).for_each(|first| first.make_ascii_uppercase());
    let said: String = said.into_iter().collect();
    // As the native program prints it.
    let number = Reflect::get(error, &"errno".into()).ok().and_then(|value| value.as_f64());
    Error::new(kind, number.map_or(said.clone(), |number| format!("{said} (os error {})", number.abs())))
}
