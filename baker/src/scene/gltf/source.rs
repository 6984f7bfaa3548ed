//! The bytes of a glTF file: the GLB container, buffers, data URIs and files beside it.

use super::schema::{BufferView, Root};
use crate::scene::SceneError;
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// A parsed glTF file with the bytes of its buffers.
pub(super) struct Source {
    /// What errors call the file.
    pub file: String,
    dir: PathBuf,
    pub root: Root,
    buffers: Vec<Vec<u8>>,
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
        let mut source = Self { file, dir, root, buffers: Vec::new() };
        for i in 0..source.root.buffers.len() {
            let buffer = &source.root.buffers[i];
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
        read(&name).or_else(|e| read(uri).map_err(|_| e)).map_err(|source| SceneError::Read {
            path: self.dir.join(name.as_ref()).display().to_string(),
            source,
        })
    }

    /// A buffer view and its bytes.
    pub fn view(&self, index: usize) -> Result<(&BufferView, &[u8]), SceneError> {
        let view = self
            .root
            .buffer_views
            .get(index)
            .ok_or_else(|| self.malformed(format!("there is no buffer view {index}")))?;
        let bytes = self
            .buffers
            .get(view.buffer)
            .and_then(|b| b.get(view.byte_offset..view.byte_offset.checked_add(view.byte_length)?))
            .ok_or_else(|| self.malformed(format!("buffer view {index} lies outside its buffer")))?;
        Ok((view, bytes))
    }
}

/// JSON and binary chunk of a GLB file.
fn split_glb(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), String> {
    let word = |at: usize| -> Option<u32> {
        Some(u32::from_le_bytes(bytes.get(at..at.checked_add(4)?)?.try_into().ok()?))
    };
    match word(4) {
        Some(2) => {}
        Some(version) => return Err(format!("it is GLB version {version}")),
        None => return Err("it ends within its header".into()),
    }
    let mut at = 12usize;
    let (mut json, mut chunk) = (None, None);
    while let (Some(len), Some(kind)) = (word(at), word(at.saturating_add(4))) {
        let body = at
            .checked_add(8)
            .and_then(|start| bytes.get(start..start.checked_add(len as usize)?))
            .ok_or("a chunk ends after the file does; the file is cut short")?;
        match kind {
            0x4e4f_534a if json.is_none() => json = Some(body),
            0x004e_4942 if chunk.is_none() => chunk = Some(body),
            _ => {}
        }
        at += 8 + len as usize;
    }
    Ok((json.ok_or("it has no JSON chunk")?, chunk))
}

/// Replaces %XX by the byte; anything else stays.
fn percent_decoded(text: &str) -> Cow<'_, [u8]> {
    if !text.contains('%') {
        return Cow::Borrowed(text.as_bytes());
    }
    let bytes = text.as_bytes();
    let digit = |b: Option<&u8>| b.and_then(|&b| (b as char).to_digit(16));
    let mut out = Vec::with_capacity(bytes.len());
    let mut i = 0;
    while i < bytes.len() {
        match (bytes[i], digit(bytes.get(i + 1)), digit(bytes.get(i + 2))) {
            (b'%', Some(high), Some(low)) => {
                out.push((high * 16 + low) as u8);
                i += 3;
            }
            (byte, ..) => {
                out.push(byte);
                i += 1;
            }
        }
    }
    Cow::Owned(out)
}

/// Base64 (RFC 4648, both alphabets, padding optional, white space ignored).
fn base64_decoded(text: &[u8]) -> Option<Vec<u8>> {
    let mut out = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut count) = (0u32, 0);
    for &byte in text {
        let value = match byte {
            b'A'..=b'Z' => byte - b'A',
            b'a'..=b'z' => byte - b'a' + 26,
            b'0'..=b'9' => byte - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            b'=' | b' ' | b'\n' | b'\r' | b'\t' => continue,
            _ => return None,
        };
        bits = bits << 6 | value as u32;
        count += 6;
        if count >= 8 {
            count -= 8;
            out.push((bits >> count) as u8);
        }
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_and_percent_follow_their_rfcs() {
        assert_eq!(base64_decoded(b"Zm9vYmE="), Some(b"fooba".to_vec()));
        assert_eq!(base64_decoded(b"Zm9v YmFy"), Some(b"foobar".to_vec()));
        assert_eq!(base64_decoded(b"Zm*v"), None);
        assert_eq!(percent_decoded("a%20b%2").as_ref(), b"a b%2");
    }

    #[test]
    fn a_cut_glb_is_an_error_at_every_length() {
        let mut glb = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
        let json = b"{\"asset\":{\"version\":\"2.0\"}}  ";
        glb.extend((json.len() as u32).to_le_bytes());
        glb.extend(b"JSON");
        glb.extend(json);
        assert!(split_glb(&glb).is_ok());
        for len in 4..glb.len() {
            assert!(split_glb(&glb[..len]).is_err(), "cut to {len}");
        }
    }
}
