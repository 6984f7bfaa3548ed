//! Loading a damaged scene returns a scene or an error with the file's name: no panic, in bounded time and memory.

use cap::Cap;
use cpu_time::ProcessTime;
use rebounce::random::Stream;
use std::panic::catch_unwind;
use std::time::Duration;

#[global_allocator]
static MEMORY: Cap<std::alloc::System> = Cap::new(std::alloc::System, usize::MAX);

/// Damaged copies per file.
const COPIES: u64 = 500;
/// Memory limit for loading a file of 15 kB, bytes.
const MOST_MEMORY: usize = 64 << 20;
/// Limit of processor time, independent of the machine's load: a thousand times the usual time.
const MOST_TIME: Duration = Duration::from_secs(3);
/// Critical numbers in broken files.
const ODD: [&str; 16] = [
    "-1",
    "0",
    "1",
    "2",
    "3",
    "7",
    "255",
    "5121",
    "5126",
    "65536",
    "1073741824",
    "4294967295",
    "4294967296",
    "18446744073709551615",
    "1e38",
    "1e308",
];

/// The JSON of a GLB file, and the remaining bytes.
fn parts(glb: &[u8]) -> (Vec<u8>, Vec<u8>) {
    let len = u32::from_le_bytes([glb[12], glb[13], glb[14], glb[15]]) as usize;
    (glb[20..20 + len].to_vec(), glb[20 + len..].to_vec())
}

fn whole(json: &[u8], rest: &[u8]) -> Vec<u8> {
    let mut out = b"glTF\x02\0\0\0".to_vec();
    out.extend((20 + json.len() as u32 + rest.len() as u32).to_le_bytes());
    out.extend((json.len() as u32).to_le_bytes());
    out.extend(b"JSON");
    out.extend(json);
    out.extend(rest);
    out
}

/// Start and end of the numbers in a JSON text, including digits in names.
fn numbers(json: &[u8]) -> Vec<(usize, usize)> {
    let mut out: Vec<(usize, usize)> = Vec::new();
    for (at, byte) in json.iter().enumerate() {
        if byte.is_ascii_digit() {
            match out.last_mut() {
                Some((_, end)) if *end == at => *end = at + 1,
                _ => out.push((at, at + 1)),
            }
        }
    }
    out
}

fn damaged(glb: &[u8], stream: &mut Stream) -> Vec<u8> {
    let below = |stream: &mut Stream, n: usize| stream.bits() as usize % n.max(1);
    let (mut json, mut rest) = parts(glb);
    for _ in 0..1 + below(stream, 3) {
        match below(stream, 7) {
            0 => {
                let at = below(stream, json.len());
                json[at] ^= 1 << below(stream, 8);
            }
            1 | 2 => {
                let numbers = numbers(&json);
                let (from, to) = numbers[below(stream, numbers.len())];
                json.splice(from..to, ODD[below(stream, ODD.len())].bytes());
            }
            // One number replaces another: swapped indices, wrong counts.
            3 => {
                let numbers = numbers(&json);
                let [(from, to), (a, b)] = [0; 2].map(|_| numbers[below(stream, numbers.len())]);
                let other = json[a..b].to_vec();
                json.splice(from..to, other);
            }
            4 if rest.len() > 8 => {
                let at = 8 + below(stream, rest.len() - 8);
                rest[at] ^= 1 << below(stream, 8);
            }
            5 if rest.len() > 16 => {
                let [a, b] = [0; 2].map(|_| 8 + 2 * below(stream, (rest.len() - 10) / 2));
                rest.swap(a, b);
                rest.swap(a + 1, b + 1);
            }
            _ => rest.truncate(below(stream, rest.len())),
        }
    }
    let mut out = whole(&json, &rest);
    if below(stream, 8) == 0 {
        out.truncate(below(stream, out.len()));
    }
    out
}

#[test]
fn damaged_files_end_in_a_scene_or_in_a_sentence() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/gltf");
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|f| f.unwrap().path()).collect();
    files.retain(|f| f.extension().is_some_and(|e| e == "glb"));
    files.sort();
    assert!(files.len() > 10);
    let work = tempfile::tempdir().unwrap();
    let (mut scenes, mut errors) = (0, 0);
    for file in &files {
        let name = file.file_name().unwrap().to_str().unwrap();
        let glb = std::fs::read(file).unwrap();
        let (json, rest) = parts(&glb);
        assert_eq!(whole(&json, &rest), glb, "{name}");
        for seed in 0..COPIES {
            let copy = work.path().join(format!("{seed}-{name}"));
            std::fs::write(&copy, damaged(&glb, &mut Stream::new(seed, 0))).unwrap();
            let (start, before) = (ProcessTime::now(), MEMORY.allocated());
            let loaded = catch_unwind(|| rebounce::io::load(copy.to_str().unwrap()));
            let loaded = loaded.unwrap_or_else(|_| panic!("{name}, seed {seed}: a panic"));
            assert!(start.elapsed() < MOST_TIME, "{name}, seed {seed}: {:?}", start.elapsed());
            match loaded {
                Ok(scene) => {
                    scenes += 1;
                    assert!(scene.positions.iter().all(|p| p.is_finite()), "{name}, seed {seed}");
                    let count = scene.positions.len() as u32;
                    assert!(scene.triangles.iter().flatten().all(|i| *i < count), "{name}, seed {seed}");
                }
                Err(error) => {
                    errors += 1;
                    let error = error.to_string();
                    assert!(error.contains(name), "{name}, seed {seed}: {error}");
                }
            }
            std::fs::remove_file(&copy).unwrap();
            let most = MEMORY.max_allocated().saturating_sub(before);
            assert!(most < MOST_MEMORY, "{name}, seed {seed}: {} MiB", most >> 20);
        }
    }
    // Neither harmless nor always fatal: the damage reaches the code after the JSON parser.
    assert!(scenes > errors / 10 && errors > scenes / 10, "{scenes} scenes, {errors} errors");
}
