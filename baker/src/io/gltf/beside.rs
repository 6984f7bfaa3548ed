//! Lookup of external files: by URI, and by the malformed URIs that exporters write.

use super::container::percent_decoded;
use crate::io::Files;
use std::path::{Path, PathBuf};

/// Maximum number of shortened paths tried beside the scene's file.
const MOST_FOLDERS: usize = 16;

/// Bytes of a file, and the path if different from the URI.
pub(super) struct FoundFile {
    pub bytes: Vec<u8>,
    pub elsewhere: Option<String>,
}

/// Reads the file of a URI, except a data URI, beside the scene's file in `dir`: as written, percent-decoded, and
/// without `?query` and `#fragment`; then with backslashes as slashes, in any letter case, with ever fewer leading
/// folders, and last the bare name in `dir`. The error is that of the first attempt.
pub(super) fn read(files: &dyn Files, dir: &Path, uri: &str) -> std::io::Result<FoundFile> {
    let mut first = None;
    let mut bytes_of = |path: &Path| {
        let read = files.read(path);
        read.map_err(|error| first.get_or_insert(error).kind()).ok()
    };
    let local = local(uri);
    let plain = local.split(['?', '#']).next().unwrap_or_default();
    let names = [decoded(plain), plain.to_owned()];
    if !is_on_network(uri) {
        // A file name may contain %, ? or #.
        for name in [decoded(local), local.to_owned()].iter().chain(&names) {
            if let Some(bytes) = bytes_of(&dir.join(name)) {
                return Ok(FoundFile { bytes, elsewhere: None });
            }
        }
    }
    for name in names {
        let slashed = name.replace('\\', "/");
        // The full path, then without the first folder, and on, down to the bare name.
        let folders = slashed.matches('/').count();
        let shorter = slashed.match_indices('/').skip(folders.saturating_sub(MOST_FOLDERS));
        let shorter = shorter.map(|(at, _)| &slashed[at + 1..]);
        let whole = (!is_on_network(uri)).then_some(slashed.as_str());
        for name in whole.into_iter().chain(shorter).filter(|name| !name.is_empty() && !name.starts_with('/'))
        {
            let path = in_any_case(files, dir, name).unwrap_or_else(|| dir.join(name));
            if let Some(bytes) = bytes_of(&path) {
                let place = path.strip_prefix(dir).unwrap_or(&path).display().to_string();
                return Ok(FoundFile { bytes, elsewhere: Some(place) });
            }
        }
    }
    Err(first.unwrap_or_else(|| std::io::ErrorKind::NotFound.into()))
}

/// Name of the file in errors.
pub(super) fn name(uri: &str) -> String {
    decoded(local(uri))
}

/// Whether a URI names a network host.
pub(super) fn is_on_network(uri: &str) -> bool {
    uri.contains("://") && local(uri) == uri
}

fn decoded(text: &str) -> String {
    String::from_utf8_lossy(&percent_decoded(text)).into_owned()
}

/// Path of a `file:` URI; returns a URI of a different scheme unchanged.
fn local(uri: &str) -> &str {
    let Some(rest) = strip_prefix_of_any_case(uri, "file:") else {
        return uri;
    };
    let Some(rest) = rest.strip_prefix("//") else {
        return rest;
    };
    // The host is the local machine and ends at the next slash; a drive letter may follow.
    let path = rest.find('/').map_or(rest, |at| &rest[at..]);
    let is_drive = path.as_bytes().get(2) == Some(&b':');
    if is_drive { &path[1..] } else { path }
}

fn strip_prefix_of_any_case<'a>(text: &'a str, prefix: &str) -> Option<&'a str> {
    let head = text.get(..prefix.len())?;
    head.eq_ignore_ascii_case(prefix).then(|| &text[prefix.len()..])
}

/// Finds an existing path below `dir`, ignoring letter case; of several matches, the first by name.
fn in_any_case(files: &dyn Files, dir: &Path, name: &str) -> Option<PathBuf> {
    let mut path = dir.to_path_buf();
    for part in name.split('/').filter(|part| !part.is_empty() && *part != ".") {
        let exact = path.join(part);
        if part == ".." || files.exists(&exact) {
            path = exact;
            continue;
        }
        let alike = |name: &String| name.to_lowercase() == part.to_lowercase();
        path.push(files.names(&path).into_iter().filter(alike).min()?);
    }
    Some(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_found_however_its_name_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let dir = folder.path();
        std::fs::create_dir(dir.join("Maps")).unwrap();
        for name in ["Maps/oak floor.png", "beside.bin", "50%.bin"] {
            std::fs::write(dir.join(name), name).unwrap();
        }
        let absolute = dir.join("beside.bin").display().to_string();
        for (uri, is, elsewhere) in [
            ("Maps/oak%20floor.png", "Maps/oak floor.png", None),
            ("Maps/oak floor.png", "Maps/oak floor.png", None),
            ("beside.bin?v=3#top", "beside.bin", None),
            ("50%.bin", "50%.bin", None),
            ("./beside.bin", "beside.bin", None),
            (&absolute, "beside.bin", None),
            (&format!("file://{absolute}"), "beside.bin", None),
            (&format!("FILE:{absolute}"), "beside.bin", None),
            ("Maps\\oak floor.png", "Maps/oak floor.png", Some("Maps/oak floor.png")),
            (".\\maps\\OAK%20floor.PNG?x", "Maps/oak floor.png", Some("Maps/oak floor.png")),
            ("C:\\work\\Maps\\oak floor.png", "Maps/oak floor.png", Some("Maps/oak floor.png")),
            ("/Home/nobody/maps/oak%20floor.png", "Maps/oak floor.png", Some("Maps/oak floor.png")),
            ("C:\\work\\beside.bin", "beside.bin", Some("beside.bin")),
            ("file:///C:/work/Beside.bin", "beside.bin", Some("beside.bin")),
            ("../elsewhere/beside.bin", "beside.bin", Some("beside.bin")),
            ("https://example.com/a/beside.bin?b=c", "beside.bin", Some("beside.bin")),
        ] {
            let found =
                read(&crate::io::files::Disk, dir, uri).unwrap_or_else(|error| panic!("{uri}: {error}"));
            assert_eq!(
                (found.bytes.as_slice(), found.elsewhere.as_deref()),
                (is.as_bytes(), elsewhere),
                "{uri}"
            );
        }
        for uri in ["oak floor.png", "maps", "", "https://example.com/", "C:\\work\\"] {
            assert!(read(&crate::io::files::Disk, dir, uri).is_err(), "{uri}");
        }
    }
}
