//! Mutator of .glb files: damage to numbers and words of the JSON and to the binary chunk, in a valid container.

use crate::{Random, mutated, put};

/// Typical hostile numbers of broken files.
const ODD: [&str; 18] = [
    "-1",
    "0",
    "1",
    "2",
    "3",
    "4",
    "5",
    "7",
    "255",
    "5121",
    "5123",
    "5126",
    "65536",
    "1073741824",
    "4294967296",
    "18446744073709551615",
    "1e38",
    "1e308",
];

/// Splits a file into JSON and binary chunk.
fn parts(file: &[u8]) -> Option<(&[u8], &[u8])> {
    let word = |at: usize| Some(u32::from_le_bytes(file.get(at..at + 4)?.try_into().ok()?) as usize);
    let json = file.get(20..20usize.checked_add(word(12)?)?)?;
    let binary = file.get(20 + json.len() + 8..).unwrap_or_default();
    file.starts_with(b"glTF").then_some((json, binary))
}

fn whole(json: &[u8], binary: &[u8]) -> Vec<u8> {
    let mut out = b"glTF\x02\0\0\0".to_vec();
    out.extend((28 + json.len() as u32 + binary.len() as u32).to_le_bytes());
    out.extend((json.len() as u32).to_le_bytes());
    out.extend(b"JSON");
    out.extend(json);
    out.extend((binary.len() as u32).to_le_bytes());
    out.extend(b"BIN\0");
    out.extend(binary);
    out
}

/// Returns begin and end of the runs of bytes accepted by `is`.
fn runs(json: &[u8], is: impl Fn(u8) -> bool) -> Vec<(usize, usize)> {
    let mut out: Vec<(usize, usize)> = Vec::new();
    for (at, _) in json.iter().enumerate().filter(|(_, byte)| is(**byte)) {
        match out.last_mut() {
            Some((_, end)) if *end == at => *end = at + 1,
            _ => out.push((at, at + 1)),
        }
    }
    out
}

/// Damages the JSON or the binary chunk, or, seldom, the entire file.
pub fn mutate(data: &mut [u8], size: usize, max_size: usize, seed: u32) -> usize {
    let mut random = Random::new(seed);
    let file = data[..size].to_vec();
    let new = parts(&file).filter(|_| random.below(16) > 0).map(|(json, binary)| {
        let mut json = json.to_vec();
        let runs = match random.below(2) {
            0 => runs(&json, |b| b.is_ascii_digit()),
            _ => runs(&json, |b| b.is_ascii_alphanumeric() || b == b'_'),
        };
        let mut any = || runs.get(random.below(runs.len())).copied().unwrap_or((0, 0));
        let ((from, to), (a, b)) = (any(), any());
        match random.below(8) {
            0 | 1 => drop(json.splice(from..to, ODD[random.below(ODD.len())].bytes())),
            2 | 3 => {
                let other = json[a..b].to_vec();
                drop(json.splice(from..to, other));
            }
            // Duplicates a part of the text.
            4 => {
                let part = json[from.min(a)..to.max(b)].to_vec();
                let at = random.below(json.len() + 1);
                drop(json.splice(at..at, part));
            }
            5 => json = mutated(&json, json.len() + 64),
            _ => return whole(&json, &mutated(binary, binary.len() + 64)),
        }
        whole(&json, binary)
    });
    match new.and_then(|new| put(&new, data, max_size)) {
        Some(size) => size,
        None => libfuzzer_sys::fuzzer_mutate(data, size, max_size),
    }
}
