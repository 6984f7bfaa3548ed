//! Bytes of a glTF file: buffers, buffer views, data URIs and external files.

use super::beside;
use super::container::{base64_decoded, percent_decoded, split_glb, text};
use super::document::{Document, Extensible, Refused};
use super::exact::Exact;
use super::meshopt::{self, Meshopt};
use super::punctual::{Lights, NAME, PunctualLight};
use crate::io::Files;
use crate::scene::SceneError;
use gltf::json::Root;
use gltf::json::validation::USize64;
use rebounce_shared::rbn::container::MAGIC;
use serde::de::DeserializeOwned;
use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock, PoisonError};

/// A parsed glTF file with the bytes of its buffers.
pub(super) struct Source<'a> {
    /// Name of the file in errors.
    pub file: String,
    files: &'a dyn Files,
    dir: PathBuf,
    pub root: Root,
    /// Values that `root` rounds or cannot hold.
    pub exact: Exact,
    /// Lights of KHR_lights_punctual.
    pub lights: Vec<PunctualLight>,
    /// Bytes by buffer; empty for a fallback buffer of meshopt compression.
    buffers: Vec<Vec<u8>>,
    /// Decompressed bytes by buffer view; set on the first read of a compressed view.
    unpacked: Vec<OnceLock<Vec<u8>>>,
    notes: Mutex<Vec<String>>,
}

impl<'a> Source<'a> {
    /// Reads and parses a file: refuses unsupported extensions, and reads all buffers.
    pub fn open(files: &'a dyn Files, path: &Path) -> Result<Self, SceneError> {
        let file = path.display().to_string();
        let bytes = files.read(path).map_err(|source| SceneError::Read { path: file.clone(), source })?;
        let dir = path.parent().map(Path::to_path_buf).unwrap_or_default();
        Self::parse(file, files, dir, &bytes).map_err(|error| match error {
            SceneError::NotGltf { .. } => SceneError::other_format(path).unwrap_or(error),
            _ => error,
        })
    }

    /// Like `open`, from bytes; external files are looked up among `files`, in `dir`.
    pub fn parse(file: String, files: &'a dyn Files, dir: PathBuf, bytes: &[u8]) -> Result<Self, SceneError> {
        let not_gltf = |problem: String| SceneError::NotGltf { file: file.clone(), problem };
        if bytes.starts_with(&MAGIC) {
            return Err(SceneError::Baked { file });
        }
        let (json, chunk) = if bytes.starts_with(b"glTF") {
            if bytes.get(4..8) == Some(&[1, 0, 0, 0]) {
                return Err(SceneError::Old { file, version: "1.0".to_owned() });
            }
            split_glb(bytes).map_err(not_gltf)?
        } else {
            (bytes, None)
        };
        let document = Document::parse(&text(json)).map_err(|refused| match refused {
            Refused::Old(version) => SceneError::Old { file: file.clone(), version },
            Refused::Not(problem) => not_gltf(problem),
        });
        let Document { root, exact } = document?;
        super::extensions::check(&file, &root.extensions_required)?;
        let unpacked = root.buffer_views.iter().map(|_| OnceLock::new()).collect();
        let (lights, buffers, notes) = Default::default();
        let mut source = Self { file, files, dir, root, exact, lights, buffers, unpacked, notes };
        let lights: Option<Lights> = source.read_extension(&source.root, &[NAME], "the file")?;
        source.lights = lights.unwrap_or_default().lights;
        for i in 0..source.root.buffers.len() {
            let buffer = &source.root.buffers[i];
            let meshopt: Option<meshopt::Fallback> =
                source.read_extension(buffer, &meshopt::NAMES, format_args!("buffer {i}"))?;
            if meshopt.is_some_and(|m| m.fallback) {
                // A fallback buffer has no data: a placeholder for bytes compressed in a separate buffer.
                source.buffers.push(Vec::new());
                continue;
            }
            let uri = buffer.uri.as_ref().filter(|uri| !uri.is_empty());
            let bytes = match (uri, chunk) {
                (Some(uri), _) => source.uri(uri)?,
                (None, Some(chunk)) if i == 0 => chunk.to_vec(),
                _ => return Err(source.malformed(format!("buffer {i} has no data"))),
            };
            if bytes.len() < length(buffer.byte_length) {
                let problem =
                    format!("buffer {i} should have {} bytes, has {}", buffer.byte_length.0, bytes.len());
                return Err(source.malformed(problem));
            }
            source.buffers.push(bytes);
        }
        Ok(source)
    }

    /// Makes a `SceneError::Malformed` for the file.
    pub fn malformed(&self, problem: impl Into<String>) -> SceneError {
        SceneError::Malformed { file: self.file.clone(), problem: problem.into() }
    }

    /// Reads the bytes of a URI: a data URI or a file beside the scene's file.
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
        match beside::read(self.files, &self.dir, uri) {
            Ok(found) => {
                if let Some(place) = found.elsewhere {
                    self.note(format!("{uri}, read as {place}: no file is where the scene's file says"));
                }
                Ok(found.bytes)
            }
            Err(_) if beside::is_on_network(uri) => {
                Err(self.malformed(format!("{uri} is on the network: download it and pack it into a .glb")))
            }
            Err(source) => Err(SceneError::Beside {
                file: self.file.clone(),
                path: self.dir.join(beside::name(uri)).display().to_string(),
                source,
            }),
        }
    }

    /// Adds a note for the user.
    fn note(&self, note: String) {
        self.notes.lock().unwrap_or_else(PoisonError::into_inner).push(note);
    }

    /// Returns the notes added so far.
    pub fn notes(&self) -> Vec<String> {
        self.notes.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Total bytes of all buffers: a bound for counts without data.
    pub fn size(&self) -> usize {
        self.buffers.iter().map(Vec::len).sum()
    }

    /// Returns the decompressed bytes of a buffer view, and the stride in bytes if stated.
    pub fn view(&self, index: usize) -> Result<(&[u8], Option<usize>), SceneError> {
        let bad = |problem: &str| self.malformed(format!("buffer view {index} {problem}"));
        let view = self.root.buffer_views.get(index);
        let view = view.ok_or_else(|| self.malformed(format!("there is no buffer view {index}")))?;
        let outside = || bad("lies outside its buffer");
        let packed: Option<Meshopt> =
            self.read_extension(view, &meshopt::NAMES, format_args!("buffer view {index}"))?;
        let Some(packed) = packed else {
            let (buffer, from, len) =
                (view.buffer.value(), offset(view.byte_offset), length(view.byte_length));
            let bytes = self.slice(buffer, from, len).ok_or_else(outside)?;
            // Browsers read stride 0 as absent.
            let stride = view.byte_stride.map(|stride| stride.0).filter(|stride| *stride > 0);
            return Ok((bytes, stride));
        };
        let cell = &self.unpacked[index];
        if cell.get().is_none() {
            let bytes =
                self.slice(packed.buffer, packed.byte_offset, packed.byte_length).ok_or_else(outside)?;
            let bytes = meshopt::decode(&packed, bytes)
                .map_err(|problem| bad(&format!("(compressed by meshopt) {problem}")))?;
            cell.get_or_init(|| bytes);
        }
        let stride = if packed.mode == "ATTRIBUTES" { Some(packed.byte_stride) } else { None };
        Ok((cell.get().map_or(&[], Vec::as_slice), stride))
    }

    /// Reads the first extension of `names` present on `of`; `what` names the object in errors.
    pub fn read_extension<T: DeserializeOwned>(
        &self,
        of: &impl Extensible,
        names: &[&str],
        what: impl Display,
    ) -> Result<Option<T>, SceneError> {
        let read = names.iter().map(|name| of.extension(name));
        let found = read.collect::<Result<Vec<_>, _>>();
        let found = found.map_err(|problem| self.malformed(format!("{what} {problem}")))?;
        Ok(found.into_iter().flatten().next())
    }

    fn slice(&self, buffer: usize, offset: usize, len: usize) -> Option<&[u8]> {
        self.buffers.get(buffer)?.get(offset..offset.checked_add(len)?)
    }
}

/// Converts a count or length to `usize`, saturating: no buffer has `usize::MAX` bytes.
pub(super) fn length(size: USize64) -> usize {
    usize::try_from(size.0).unwrap_or(usize::MAX)
}

/// Converts a byte offset to `usize`; 0 if absent.
pub(super) fn offset(size: Option<USize64>) -> usize {
    size.map_or(0, length)
}
