//! The bytes of a glTF file: buffers, their views, data URIs and files beside it.

use super::container::{base64_decoded, percent_decoded, split_glb};
use super::meshopt;
use super::schema::Root;
use crate::scene::SceneError;
use rebounce_shared::rbn::container::MAGIC;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// A parsed glTF file with the bytes of its buffers.
pub(super) struct Source {
    /// What errors call the file.
    pub file: String,
    dir: PathBuf,
    pub root: Root,
    /// A buffer that only stands for decompressed bytes has none.
    buffers: Vec<Vec<u8>>,
    /// By buffer view; the compressed ones, as soon as something reads them.
    unpacked: Vec<OnceLock<Vec<u8>>>,
}

impl Source {
    /// Parses the JSON, refuses what is not supported, and reads all buffers.
    pub fn open(path: &Path) -> Result<Self, SceneError> {
        let file = path.display().to_string();
        let bytes = std::fs::read(path).map_err(|source| SceneError::Read { path: file.clone(), source })?;
        let dir = path.parent().map(Path::to_path_buf).unwrap_or_default();
        Self::parse(file, dir, &bytes)
    }

    /// The same from bytes; files that it names are looked for in `dir`.
    pub fn parse(file: String, dir: PathBuf, bytes: &[u8]) -> Result<Self, SceneError> {
        let not_gltf = |problem: String| SceneError::NotGltf { file: file.clone(), problem };
        if bytes.starts_with(&MAGIC) {
            return Err(SceneError::Baked { file });
        }
        let (json, chunk) = if bytes.starts_with(b"glTF") {
            split_glb(bytes).map_err(not_gltf)?
        } else {
            // A byte-order mark is not JSON, but some exporters write one.
            (bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), None)
        };
        let root: Root = serde_json::from_slice(json).map_err(|e| not_gltf(e.to_string()))?;
        if !root.asset.version.starts_with("2.") {
            return Err(not_gltf(format!("its asset version is {:?}", root.asset.version)));
        }
        super::extensions::check(&file, &root.extensions_required)?;
        let unpacked = root.buffer_views.iter().map(|_| OnceLock::new()).collect();
        let mut source = Self { file, dir, root, buffers: Vec::new(), unpacked };
        for i in 0..source.root.buffers.len() {
            let buffer = &source.root.buffers[i];
            let meshopt = &buffer.extensions;
            if meshopt.meshopt.fallback || meshopt.meshopt_before_khronos.fallback {
                // It stands for what is compressed elsewhere.
                source.buffers.push(Vec::new());
                continue;
            }
            let bytes = match (&buffer.uri, chunk) {
                (Some(uri), _) => source.uri(uri)?,
                (None, Some(chunk)) if i == 0 => chunk.to_vec(),
                _ => return Err(source.malformed(format!("buffer {i} has no data"))),
            };
            if bytes.len() < buffer.byte_length {
                let problem =
                    format!("buffer {i} should have {} bytes, has {}", buffer.byte_length, bytes.len());
                return Err(source.malformed(problem));
            }
            source.buffers.push(bytes);
        }
        Ok(source)
    }

    /// An error that says what is wrong in this file.
    pub fn malformed(&self, problem: impl Into<String>) -> SceneError {
        SceneError::Malformed { file: self.file.clone(), problem: problem.into() }
    }

    /// The bytes behind a URI: a data URI or a file beside this one.
    pub fn uri(&self, uri: &str) -> Result<Vec<u8>, SceneError> {
        if let Some(data) = uri.strip_prefix("data:") {
            let (head, body) =
                data.split_once(',').ok_or_else(|| self.malformed("a data URI has no comma"))?;
            let body = percent_decoded(body);
            return if head.ends_with(";base64") {
                base64_decoded(&body).ok_or_else(|| self.malformed("a data URI is not base64"))
            } else {
                Ok(body.into_owned())
            };
        }
        if uri.contains("://") {
            return Err(
                self.malformed(format!("{uri} is on the network: download it and pack it into a .glb"))
            );
        }
        let read = |name: &str| std::fs::read(self.dir.join(name));
        let decoded = percent_decoded(uri);
        let name = String::from_utf8_lossy(&decoded);
        // Some exporters forget to encode; a name that holds % as it stands is the second guess.
        read(&name).or_else(|e| read(uri).map_err(|_| e)).map_err(|source| SceneError::Beside {
            file: self.file.clone(),
            path: self.dir.join(name.as_ref()).display().to_string(),
            source,
        })
    }

    /// Bytes of all buffers together: what a count can be measured by that has no bytes of its own.
    pub fn size(&self) -> usize {
        self.buffers.iter().map(Vec::len).sum()
    }

    /// The bytes of a buffer view, decompressed, and how far apart its elements are if it says so.
    pub fn view(&self, index: usize) -> Result<(&[u8], Option<usize>), SceneError> {
        let bad = |problem: &str| self.malformed(format!("buffer view {index} {problem}"));
        let view = self.root.buffer_views.get(index);
        let view = view.ok_or_else(|| self.malformed(format!("there is no buffer view {index}")))?;
        let outside = || bad("lies outside its buffer");
        let meshopt = &view.extensions;
        let Some(packed) = meshopt.meshopt.as_ref().or(meshopt.meshopt_before_khronos.as_ref()) else {
            let bytes = self.slice(view.buffer, view.byte_offset, view.byte_length).ok_or_else(outside)?;
            return Ok((bytes, view.byte_stride));
        };
        let cell = &self.unpacked[index];
        if cell.get().is_none() {
            let bytes =
                self.slice(packed.buffer, packed.byte_offset, packed.byte_length).ok_or_else(outside)?;
            let bytes = meshopt::decode(packed, bytes)
                .map_err(|problem| bad(&format!("(compressed by meshopt) {problem}")))?;
            cell.get_or_init(|| bytes);
        }
        let stride = if packed.mode == "ATTRIBUTES" { Some(packed.byte_stride) } else { None };
        Ok((cell.get().map_or(&[], Vec::as_slice), stride))
    }

    fn slice(&self, buffer: usize, offset: usize, len: usize) -> Option<&[u8]> {
        self.buffers.get(buffer)?.get(offset..offset.checked_add(len)?)
    }
}
