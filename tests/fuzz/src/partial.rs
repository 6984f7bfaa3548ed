//! Mutator of checkpoints: damage within a record, with valid checksums.

use crate::{Random, mutated, put};
use xxhash_rust::xxh32::xxh32;

/// Size of a record's header, bytes.
const HEAD: usize = 12;

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?))
}

/// Returns kinds and contents of the records; ignores checksums.
fn records(file: &[u8]) -> Vec<(u32, &[u8])> {
    let mut records = Vec::new();
    let mut rest = file;
    while let (Some(len), Some(kind)) = (word(rest, 0), word(rest, 4)) {
        let Some(contents) = rest.get(HEAD..HEAD + len as usize) else { break };
        records.push((kind, contents));
        rest = &rest[HEAD + len as usize..];
    }
    records
}

/// Writes a file of these records with valid checksums.
fn whole(records: &[(u32, &[u8])]) -> Vec<u8> {
    let mut out = Vec::new();
    let mut salt = 0;
    for (i, (kind, contents)) in records.iter().enumerate() {
        let checksum = xxh32(&[&kind.to_le_bytes(), *contents].concat(), if i == 0 { 0 } else { salt });
        salt = if i == 0 { checksum } else { salt };
        out.extend((contents.len() as u32).to_le_bytes());
        out.extend(kind.to_le_bytes());
        out.extend(checksum.to_le_bytes());
        out.extend(*contents);
    }
    out
}

/// Damages, removes, repeats or relabels a record, or, seldom, damages the entire file.
pub fn mutate(data: &mut [u8], size: usize, max_size: usize, seed: u32) -> usize {
    let mut random = Random::new(seed);
    let file = data[..size].to_vec();
    let mut records = records(&file);
    let mut new = None;
    if records.len() > 1 && random.below(16) > 0 {
        let k = 1 + random.below(records.len() - 1);
        let changed;
        match random.below(16) {
            0 => drop(records.remove(k)),
            1 => records.insert(1 + random.below(records.len()), records[k]),
            2 => records[k].0 = random.below(6) as u32,
            _ => {
                changed = mutated(records[k].1, records[k].1.len() + 64);
                records[k].1 = &changed;
                new = Some(whole(&records));
            }
        }
        new = new.or_else(|| Some(whole(&records)));
    }
    match new.and_then(|new| put(&new, data, max_size)) {
        Some(size) => size,
        None => libfuzzer_sys::fuzzer_mutate(data, size, max_size),
    }
}
