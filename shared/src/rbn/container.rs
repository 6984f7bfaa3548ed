//! Container of the file: a header, a section table, and sections with checksums.
//!
//! Numbers are little-endian.
//!
//! ```text
//! header, 32 bytes   0  8 bytes  magic "REBOUNCE"
//!                    8  u32      version
//!                   12  u32      number of sections
//!                   16  u64      length of the whole file in bytes
//!                   24  u32      XXH32 of the section table
//!                   28  u32      XXH32 of the first 28 bytes
//! table, 32 bytes    0  4 bytes  name
//! a section          4  u32      XXH32 of the section's bytes
//!                    8  u64      offset from the file's start, a multiple of 256
//!                   16  u64      length in bytes
//!                   24  u64      zero
//! ```
//!
//! The first 24 bytes of the header, the rows of the table and the writer's name at the begin of section META are
//! common to every format version: a reader of any version can name the writer of a file.

use super::RbnError;

/// XXH32, seed 0: needs no table, and is much faster in a browser than a CRC, which took a tenth of loading.
fn checksum(bytes: &[u8]) -> u32 {
    // Chunked: a browser runs a wasm function at full speed only from a later call on.
    #[inline(never)]
    fn update(hash: &mut xxhash_rust::xxh32::Xxh32, bytes: &[u8]) {
        hash.update(bytes);
    }
    let mut hash = xxhash_rust::xxh32::Xxh32::new(0);
    bytes.chunks(1 << 16).for_each(|part| update(&mut hash, part));
    hash.digest()
}

/// First eight bytes of a file.
pub const MAGIC: [u8; 8] = *b"REBOUNCE";
/// Current format version; the reader supports versions from [`WITHOUT_COPIES`] up. A file is written in the least
/// version that supports its features. Without the feature `radiosity` files with [groups](super::groups) are too new,
/// and [fixed solutions](super::light_groups) are not read.
pub const VERSION: u32 = if cfg!(feature = "radiosity") { 13 } else { ONE_GROUP };
/// Last version without a [rig](crate::rig).
pub const WITHOUT_RIG: u32 = 12;
/// Last version without diffuse transfer.
pub const WITHOUT_TRANSFER: u32 = 11;
/// Last version without [reconstruction groups](super::groups).
pub const ONE_GROUP: u32 = 10;
/// Last version whose lights are all [punctual](crate::light::LightKind::is_punctual). Parents in files from this
/// version on have [linear weights](crate::basis::ParentWeights::LeastSquares).
pub const PUNCTUAL_LIGHTS: u32 = 9;
/// Last version with [Shepard's weights](crate::basis::ParentWeights::Shepard) of parents.
pub const SHEPARD_WEIGHTS: u32 = 8;
/// Version of files with instanced triangles, without material [extras](super::extras).
pub const WITHOUT_EXTRAS: u32 = 7;
/// Version of files without instanced triangles and without extras.
pub const WITHOUT_COPIES: u32 = 6;
/// Sections that files have from a version on.
pub const SINCE: &[([u8; 4], u32)] = &[
    (*b"COPY", WITHOUT_EXTRAS),
    (*b"INST", WITHOUT_EXTRAS),
    (*b"MATX", SHEPARD_WEIGHTS),
    #[cfg(feature = "radiosity")]
    (*b"LGRP", ONE_GROUP),
    #[cfg(feature = "radiosity")]
    (*b"RGRP", WITHOUT_TRANSFER),
    #[cfg(feature = "radiosity")]
    (*b"MGRP", WITHOUT_TRANSFER),
    #[cfg(feature = "radiosity")]
    (*b"PGRP", WITHOUT_TRANSFER),
    #[cfg(feature = "radiosity")]
    (*b"REFL", WITHOUT_TRANSFER),
    #[cfg(feature = "radiosity")]
    (*b"DTLY", WITHOUT_RIG),
    #[cfg(feature = "radiosity")]
    (*b"RIGL", VERSION),
];
/// Alignment of sections, bytes: the strictest buffer-offset alignment of WebGPU.
pub const ALIGNMENT: usize = 256;
const HEADER: usize = 32;
const ROW: usize = 32;
const MAX_SECTIONS: usize = 64;

/// A section's name and place in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Section {
    /// Four ASCII letters.
    pub name: [u8; 4],
    /// XXH32 of the bytes.
    pub checksum: u32,
    /// Offset in bytes from the file's start.
    pub offset: usize,
    /// Length in bytes.
    pub len: usize,
}

impl Section {
    /// Name as text; unprintable bytes are escaped.
    pub fn name(&self) -> String {
        let digit = |half: u8| char::from(b"0123456789abcdef"[usize::from(half)]);
        let mut name = String::new();
        for byte in self.name {
            if matches!(byte, b' '..=b'~') {
                name.push(char::from(byte));
            } else {
                name += "\\x";
                name.push(digit(byte >> 4));
                name.push(digit(byte & 15));
            }
        }
        name
    }
}

/// Lays out a file of this version from named sections, in order.
pub fn write(version: u32, sections: &[([u8; 4], &[u8])]) -> Vec<u8> {
    let mut offset = align(HEADER + ROW * sections.len());
    let mut table = Vec::with_capacity(ROW * sections.len());
    let mut end = offset;
    for (name, bytes) in sections {
        table.extend_from_slice(name);
        table.extend_from_slice(&checksum(bytes).to_le_bytes());
        table.extend_from_slice(&(offset as u64).to_le_bytes());
        table.extend_from_slice(&(bytes.len() as u64).to_le_bytes());
        table.extend_from_slice(&0u64.to_le_bytes());
        end = offset + bytes.len();
        offset = align(end);
    }
    let mut file = Vec::with_capacity(end);
    file.extend_from_slice(&MAGIC);
    file.extend_from_slice(&version.to_le_bytes());
    file.extend_from_slice(&(sections.len() as u32).to_le_bytes());
    file.extend_from_slice(&(end as u64).to_le_bytes());
    file.extend_from_slice(&checksum(&table).to_le_bytes());
    file.extend_from_slice(&checksum(&file).to_le_bytes());
    file.extend_from_slice(&table);
    for (_, bytes) in sections {
        file.resize(align(file.len()), 0);
        file.extend_from_slice(bytes);
    }
    file
}

/// Returns the version in the header; `None` without the magic bytes.
pub fn version(file: &[u8]) -> Option<u32> {
    let (magic, rest) = file.split_first_chunk()?;
    let (version, _) = rest.split_first_chunk()?;
    (*magic == MAGIC).then_some(u32::from_le_bytes(*version))
}

/// Reads the header and the table and checks every checksum.
///
/// # Errors
/// [`RbnError`] for a truncated or damaged file or an unsupported version.
pub fn read(file: &[u8]) -> Result<Vec<Section>, RbnError> {
    if file.len() < MAGIC.len() || file[..8] != MAGIC {
        return Err(RbnError::NotRbn);
    }
    if file.len() < HEADER {
        return Err(RbnError::Truncated { expected: HEADER as u64, found: file.len() as u64 });
    }
    let u32_at = |at: usize| u32::from_le_bytes([file[at], file[at + 1], file[at + 2], file[at + 3]]);
    let u64_at = |at: usize| u32_at(at) as u64 | (u32_at(at + 4) as u64) << 32;
    let damaged = |section: &str| RbnError::Checksum { section: section.to_owned() };
    // First, since checksums of an unknown version may differ in definition.
    let found = u32_at(8);
    let writer = || writer(file).unwrap_or_else(|| "another Rebounce".to_owned());
    if found > VERSION {
        return Err(RbnError::NewerVersion { writer: writer(), found, supported: VERSION });
    }
    if found < WITHOUT_COPIES {
        return Err(RbnError::OlderVersion { writer: writer(), found, supported: VERSION });
    }
    if u32_at(28) != checksum(&file[..28]) {
        return Err(damaged("header"));
    }
    let expected = u64_at(16);
    if (file.len() as u64) < expected {
        return Err(RbnError::Truncated { expected, found: file.len() as u64 });
    }
    if (file.len() as u64) > expected {
        return Err(RbnError::invalid(
            "header",
            format!("{} bytes follow the file's end", file.len() as u64 - expected),
        ));
    }
    let count = u32_at(12) as usize;
    if count > MAX_SECTIONS || HEADER + ROW * count > file.len() {
        return Err(RbnError::invalid("header", format!("{count} sections")));
    }
    if u32_at(24) != checksum(&file[HEADER..HEADER + ROW * count]) {
        return Err(damaged("table"));
    }
    let mut sections = Vec::with_capacity(count);
    for i in 0..count {
        let at = HEADER + ROW * i;
        let name = [file[at], file[at + 1], file[at + 2], file[at + 3]];
        let (offset, len) = (u64_at(at + 8), u64_at(at + 16));
        let fits = offset % ALIGNMENT as u64 == 0
            && offset.checked_add(len).is_some_and(|end| end <= file.len() as u64);
        let section = Section { name, checksum: u32_at(at + 4), offset: offset as usize, len: len as usize };
        if !fits {
            return Err(RbnError::invalid(&section.name(), "it lies outside the file"));
        }
        if sections.iter().any(|before: &Section| before.name == name) {
            return Err(RbnError::invalid(&section.name(), "it is there twice"));
        }
        if checksum(&file[section.offset..section.offset + section.len]) != section.checksum {
            return Err(damaged(&section.name()));
        }
        sections.push(section);
    }
    // Padding between sections is zero, so that a flipped bit anywhere is found.
    let mut end = HEADER + ROW * count;
    for section in &sections {
        if section.offset < end || file[end..section.offset].iter().any(|&b| b != 0) {
            return Err(damaged("padding"));
        }
        end = section.offset + section.len;
    }
    if end != file.len() {
        return Err(damaged("padding"));
    }
    Ok(sections)
}

/// Returns the writer of a file of any version: the first string of section META. The rest of the section is not
/// specified for other versions.
fn writer(file: &[u8]) -> Option<String> {
    let row =
        file.get(HEADER..)?.chunks_exact(ROW).take(MAX_SECTIONS).find(|row| row.starts_with(b"META"))?;
    let offset = u64::from_le_bytes(row.get(8..16)?.try_into().ok()?);
    let (len, rest) = file.get(usize::try_from(offset).ok()?..)?.split_first()?;
    // Length bytes from 251 on start a multi-byte length, too long for a name.
    let name = std::str::from_utf8(rest.get(..*len as usize).filter(|_| *len < 251)?).ok()?;
    let is_plain = name.chars().all(|c| c.is_ascii_graphic() || c == ' ');
    (is_plain && name.starts_with("rebounce")).then(|| name.to_owned())
}

fn align(offset: usize) -> usize {
    offset.div_ceil(ALIGNMENT) * ALIGNMENT
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Vec<u8> {
        write(VERSION, &[(*b"AAAA", b"hello"), (*b"BBBB", &[]), (*b"CCCC", &[7; 300])])
    }

    #[test]
    fn round_trip() {
        let file = sample();
        let sections = read(&file).unwrap();
        assert_eq!(&file[sections[0].offset..][..sections[0].len], b"hello");
        assert_eq!(sections[2].len, 300);
        assert_eq!(sections[2].offset % ALIGNMENT, 0);
    }

    #[test]
    fn files_of_other_versions_say_who_wrote_them() {
        let said = |version: u32, meta: &[u8]| {
            let mut file = write(VERSION, &[(*b"META", meta), (*b"BBBB", &[])]);
            file[8..12].copy_from_slice(&version.to_le_bytes());
            read(&file).unwrap_err()
        };
        let newer = said(VERSION + 3, b"\x0erebounce 9.0.0 and more");
        assert_eq!(newer.code(), "newer-version");
        let newer = newer.to_string();
        let (written, supported) =
            (format!("rebounce 9.0.0 in format version {}", VERSION + 3), format!("reads version {VERSION}"));
        for words in [written.as_str(), "this Rebounce is older", &supported, "update"] {
            assert!(newer.contains(words), "{words}: {newer}");
        }
        let older = said(2, b"\x0erebounce 0.0.3...");
        assert_eq!(older.code(), "older-version");
        let older = older.to_string();
        for words in ["by rebounce 0.0.3 in format version 2", "rebounce bake"] {
            assert!(older.contains(words), "{words}: {older}");
        }
        // Other contents are not mistaken for a name.
        for meta in
            [&b""[..], b"\xff", b"\x0erebounce", b"\x0erebounce\x1b[2J  ", b"\x04evil", b"\xfb\x0e\0rebounce"]
        {
            assert!(said(5, meta).to_string().contains("by another Rebounce in format version 5"));
        }
        for len in 0..HEADER + 2 * ROW {
            let mut file = sample();
            file[8] = 5;
            assert!(read(&file[..len]).is_err());
        }
    }

    #[test]
    fn no_section_is_there_twice_and_names_are_printable() {
        let twice = write(VERSION, &[(*b"AAAA", b"hello"), (*b"AAAA", b"other")]);
        assert!(read(&twice).unwrap_err().to_string().contains("section AAAA is invalid: it is there twice"));
        let odd = read(&write(VERSION, &[(*b"A\x1b[\n", b"")])).unwrap();
        assert_eq!(odd[0].name(), "A\\x1b[\\x0a");
    }

    #[test]
    fn every_flipped_bit_is_found() {
        let file = sample();
        for bit in 0..file.len() * 8 {
            let mut bad = file.clone();
            bad[bit / 8] ^= 1 << (bit % 8);
            assert!(read(&bad).is_err(), "bit {bit}");
        }
    }

    #[test]
    fn every_cut_is_found() {
        let file = sample();
        for len in 0..file.len() {
            assert!(read(&file[..len]).is_err(), "cut to {len}");
        }
    }
}
