//! Damage to a file's bytes, its table and its sections.

use super::{Damaged, Outcome, Random, Sections};
use rebounce_shared::rbn::container;
use std::ops::Range;
use xxhash_rust::xxh32::xxh32;

/// Header and table row, bytes: docs/format/rbn.md.
const HEADER: usize = 32;
const ROW: usize = 32;

fn made(what: String, outcome: Outcome, bytes: Vec<u8>) -> Damaged {
    Damaged { what, outcome, bytes }
}

/// The sections of an undamaged file.
fn sections(file: &[u8]) -> Sections {
    let sections = container::read(file).unwrap_or_default();
    sections.iter().map(|s| (s.name, file[s.offset..s.offset + s.len].to_vec())).collect()
}

/// Writes a file of these sections with valid checksums.
pub fn sealed(sections: &Sections) -> Vec<u8> {
    let parts: Vec<_> = sections.iter().map(|(name, bytes)| (*name, bytes.as_slice())).collect();
    container::write(container::VERSION, &parts)
}

fn text(name: [u8; 4]) -> String {
    name.escape_ascii().to_string()
}

/// Flips up to eight bits.
pub fn flip(file: &[u8], random: &mut Random) -> Damaged {
    let mut bytes = file.to_vec();
    let count = 1 + random.below(8);
    for _ in 0..count {
        let bit = random.below(8 * bytes.len());
        bytes[bit / 8] ^= 1 << (bit % 8);
    }
    made(format!("{count} bits flipped"), Outcome::Error, bytes)
}

/// Ends the file early.
pub fn cut(file: &[u8], random: &mut Random) -> Damaged {
    let len = random.below(file.len());
    made(format!("cut to {len} bytes"), Outcome::Error, file[..len].to_vec())
}

/// Changes bytes within a section and repairs the checksums.
pub fn flip_sealed(file: &[u8], random: &mut Random) -> Damaged {
    let mut sections = sections(file);
    let at = random.below(sections.len());
    let (name, bytes) = &mut sections[at];
    let name = text(*name);
    let count = 1 + random.below(8);
    for _ in 0..count.min(8 * bytes.len()) {
        let bit = random.below(8 * bytes.len());
        bytes[bit / 8] ^= 1 << (bit % 8);
    }
    made(format!("{count} bits of {name} flipped, checksums repaired"), Outcome::Any, sealed(&sections))
}

/// Swaps the contents of two sections, or duplicates a section.
pub fn swap(file: &[u8], random: &mut Random) -> Option<Damaged> {
    let mut sections = sections(file);
    let (a, b) = (random.below(sections.len()), random.below(sections.len()));
    if a == b {
        return None;
    }
    let what = format!("{} and {} swapped, checksums repaired", text(sections[a].0), text(sections[b].0));
    if random.below(2) == 0 {
        let first = sections[a].1.clone();
        sections[a].1 = std::mem::replace(&mut sections[b].1, first);
    } else {
        // Section `b` twice, section `a` missing.
        sections[a] = sections[b].clone();
    }
    Some(made(what, Outcome::Any, sealed(&sections)))
}

/// Truncates, extends, shortens or removes a section, and repairs the checksums.
pub fn resize(file: &[u8], random: &mut Random) -> Option<Damaged> {
    let mut sections = sections(file);
    let at = random.below(sections.len());
    let name = text(sections[at].0);
    let bytes = &mut sections[at].1;
    let what = match random.below(4) {
        0 => {
            bytes.truncate(random.below(bytes.len().max(1)));
            format!("{name} cut to {} bytes, checksums repaired", bytes.len())
        }
        1 => {
            let (more, value) = (1 + random.below(5000), random.bits() as u8);
            bytes.resize(bytes.len() + more, value);
            format!("{more} bytes of {value} added to {name}, checksums repaired")
        }
        2 if !bytes.is_empty() => {
            let Range { start, end } = part(bytes.len(), random);
            bytes.drain(start..end);
            format!("{} bytes taken out of {name}, checksums repaired", end - start)
        }
        _ => {
            sections.remove(at);
            format!("{name} left out, checksums repaired")
        }
    };
    Some(made(what, Outcome::Any, sealed(&sections)))
}

fn part(len: usize, random: &mut Random) -> Range<usize> {
    let start = random.below(len);
    start..start + 1 + random.below(len - start)
}

/// Writes a wrong number into the header, the table or the first bytes of a section, and repairs every checksum that
/// can be repaired.
pub fn lie(file: &[u8], random: &mut Random) -> Damaged {
    let mut bytes = file.to_vec();
    let sections = container::read(file).unwrap_or_default();
    let row = HEADER + ROW * random.below(sections.len());
    // Packed sections begin with counts and lengths.
    let start = sections[random.below(sections.len())].offset;
    let (what, at, width) = random.one(&[
        ("version", 8, 4),
        ("number of sections", 12, 4),
        ("length", 16, 8),
        ("section's offset", row + 8, 8),
        ("section's length", row + 16, 8),
        ("section's first word", start, 4),
        ("section's second word", start + 4, 4),
        ("section's first byte", start, 1),
    ]);
    let mut word = [0; 8];
    word[..width].copy_from_slice(&bytes[at..at + width]);
    let value = random.number(u64::from_le_bytes(word));
    bytes[at..at + width].copy_from_slice(&value.to_le_bytes()[..width]);
    for i in 0..sections.len() {
        let row = HEADER + ROW * i;
        let number = |at: usize| u64::from_le_bytes(std::array::from_fn(|k| bytes[at + k])) as usize;
        let (offset, len) = (number(row + 8), number(row + 16));
        if let Some(contents) = offset.checked_add(len).and_then(|end| bytes.get(offset..end)) {
            let checksum = xxh32(contents, 0);
            bytes[row + 4..row + 8].copy_from_slice(&checksum.to_le_bytes());
        }
    }
    let count = u32::from_le_bytes(std::array::from_fn(|k| bytes[12 + k])) as usize;
    let table = HEADER..HEADER.saturating_add(ROW.saturating_mul(count)).min(bytes.len());
    let checksum = xxh32(&bytes[table], 0);
    bytes[24..28].copy_from_slice(&checksum.to_le_bytes());
    let checksum = xxh32(&bytes[..28], 0);
    bytes[28..32].copy_from_slice(&checksum.to_le_bytes());
    made(format!("{what} at {at} is {value}, checksums repaired"), Outcome::Any, bytes)
}
