//! Mutator of .rbn files: damage within a section, with valid checksums.

use crate::{Random, mutated, put};
use rebounce_shared::rbn::container;

/// Size of the header and of a table row, bytes.
const ROW: usize = 32;

/// Returns the sections of a file; ignores checksums.
fn sections(file: &[u8]) -> Option<Vec<([u8; 4], &[u8])>> {
    let word = |at: usize| Some(u64::from_le_bytes(file.get(at..at + 8)?.try_into().ok()?));
    let count = (word(8)? >> 32) as usize;
    let section = |i: usize| {
        let at = ROW + ROW * i;
        let name = file.get(at..at + 4)?.try_into().ok()?;
        let (offset, len) = (usize::try_from(word(at + 8)?).ok()?, usize::try_from(word(at + 16)?).ok()?);
        Some((name, file.get(offset..offset.checked_add(len)?)?))
    };
    (0..count.min(64)).map(section).collect()
}

/// Damages a section, swaps the names of two, removes one, or, seldom, damages the entire file.
pub fn mutate(data: &mut [u8], size: usize, max_size: usize, seed: u32) -> usize {
    let mut random = Random::new(seed);
    let file = data[..size].to_vec();
    let damaged = sections(&file).filter(|s| !s.is_empty() && random.below(16) > 0).map(|mut sections| {
        let k = random.below(sections.len());
        match random.below(24) {
            0 => {
                let other = random.below(sections.len());
                let name = sections[k].0;
                sections[k].0 = std::mem::replace(&mut sections[other].0, name);
            }
            1 => drop(sections.remove(k)),
            _ => {
                let changed = mutated(sections[k].1, sections[k].1.len() + 64);
                let with = |i: usize| if i == k { &changed[..] } else { sections[i].1 };
                let all: Vec<_> = (0..sections.len()).map(|i| (sections[i].0, with(i))).collect();
                return container::write(container::VERSION, &all);
            }
        }
        container::write(container::VERSION, &sections)
    });
    match damaged.and_then(|file| put(&file, data, max_size)) {
        Some(size) => size,
        None => libfuzzer_sys::fuzzer_mutate(data, size, max_size),
    }
}
