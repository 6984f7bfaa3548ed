//! Files that a scene's file refers to: a URI as it is meant to be, and as exporters write it.

use super::container::percent_decoded;
use std::path::{Path, PathBuf};

/// Folders of a name that are tried beside the scene's file.
const MOST_FOLDERS: usize = 16;

/// A file's bytes, and where they were found if not where the URI says.
pub(super) struct Found {
    pub bytes: Vec<u8>,
    pub elsewhere: Option<String>,
}

/// Reads the file behind a URI that is not data, beside the scene's file in `dir`: as written, without percent signs,
/// without `?query` and `#fragment`; then with backslashes as slashes, in any letter case, with ever fewer folders, and
/// at last its bare name in `dir`. The error is the first of them all.
pub(super) fn read(dir: &Path, uri: &str) -> std::io::Result<Found> {
    let mut first = None;
    let mut bytes_of = |path: &Path| {
        let read = std::fs::read(path);
        read.map_err(|error| first.get_or_insert(error).kind()).ok()
    };
    let local = local(uri);
    let plain = local.split(['?', '#']).next().unwrap_or_default();
    let names = [decoded(plain), plain.to_owned()];
    if !is_on_network(uri) {
        // A name may hold %, ? or # as they stand.
        for name in [decoded(local), local.to_owned()].iter().chain(&names) {
            if let Some(bytes) = bytes_of(&dir.join(name)) {
                return Ok(Found { bytes, elsewhere: None });
            }
        }
    }
    for name in names {
        let slashed = name.replace('\\', "/");
        // Whole, then without its first folder, and so on, at last its bare name.
        let folders = slashed.matches('/').count();
        let shorter = slashed.match_indices('/').skip(folders.saturating_sub(MOST_FOLDERS));
        let shorter = shorter.map(|(at, _)| &slashed[at + 1..]);
        let whole = (!is_on_network(uri)).then_some(slashed.as_str());
        for name in whole.into_iter().chain(shorter).filter(|name| !name.is_empty() && !name.starts_with('/'))
        {
            let path = in_any_case(dir, name).unwrap_or_else(|| dir.join(name));
            if let Some(bytes) = bytes_of(&path) {
                let place = path.strip_prefix(dir).unwrap_or(&path).display().to_string();
                return Ok(Found { bytes, elsewhere: Some(place) });
            }
        }
    }
    Err(first.unwrap_or_else(|| std::io::ErrorKind::NotFound.into()))
}

/// What errors call the file.
pub(super) fn name(uri: &str) -> String {
    decoded(local(uri))
}

/// Whether a URI names another machine.
pub(super) fn is_on_network(uri: &str) -> bool {
    uri.contains("://") && local(uri) == uri
}

fn decoded(text: &str) -> String {
    String::from_utf8_lossy(&percent_decoded(text)).into_owned()
}

/// The path of a `file:` URI; other text as it is.
fn local(uri: &str) -> &str {
    let Some(rest) = strip_prefix_of_any_case(uri, "file:") else {
        return uri;
    };
    let Some(rest) = rest.strip_prefix("//") else {
        return rest;
    };
    // A host, which is this machine, ends at the next slash; a drive letter follows it.
    let path = rest.find('/').map_or(rest, |at| &rest[at..]);
    let is_drive = path.as_bytes().get(2) == Some(&b':');
    if is_drive { &path[1..] } else { path }
}

fn strip_prefix_of_any_case<'a>(text: &'a str, prefix: &str) -> Option<&'a str> {
    let head = text.get(..prefix.len())?;
    head.eq_ignore_ascii_case(prefix).then(|| &text[prefix.len()..])
}

/// A path below `dir` that is there when letter case does not count; the first of several in the order of their names.
fn in_any_case(dir: &Path, name: &str) -> Option<PathBuf> {
    let mut path = dir.to_path_buf();
    for part in name.split('/').filter(|part| !part.is_empty() && *part != ".") {
        let exact = path.join(part);
        if part == ".." || exact.exists() {
            path = exact;
            continue;
        }
        let folder = if path.as_os_str().is_empty() { Path::new(".") } else { &path };
        let alike = |entry: std::io::Result<std::fs::DirEntry>| {
            let found = entry.ok()?.file_name();
            (found.to_string_lossy().to_lowercase() == part.to_lowercase()).then_some(found)
        };
        path.push(std::fs::read_dir(folder).ok()?.filter_map(alike).min()?);
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
            let found = read(dir, uri).unwrap_or_else(|error| panic!("{uri}: {error}"));
            assert_eq!(
                (found.bytes.as_slice(), found.elsewhere.as_deref()),
                (is.as_bytes(), elsewhere),
                "{uri}"
            );
        }
        for uri in ["oak floor.png", "maps", "", "https://example.com/", "C:\\work\\"] {
            assert!(read(dir, uri).is_err(), "{uri}");
        }
    }
}
