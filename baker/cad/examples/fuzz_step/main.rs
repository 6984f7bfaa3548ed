//! Reads damaged copies of STEP files: each must be read or refused, without panic, in bounded time and memory.
//!
//! `fuzz_step FIRST COUNT SEED FOLDER FILE...` reads copies FIRST to FIRST + COUNT - 1 of the files and prints what came of them:
//! a line a kind of result with its count, the longest time and the most memory. Copies at fault are written into FOLDER. The
//! number of the copy in hand is in FOLDER/at-FIRST: where the program ends by a fault that cannot be caught, it was that one.
//! `fuzz_step --write N SEED FOLDER FILE...` writes copy N. `cargo xtask fuzz-step` runs it.

mod damage;

use cap::Cap;
use cpu_time::ThreadTime;
use rebounce_cad::cast::CastFace;
use rebounce_cad::step::{self, StepError};
use std::collections::BTreeMap;
use std::io::{Seek, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

#[global_allocator]
static MEMORY: Cap<std::alloc::System> = Cap::new(std::alloc::System, usize::MAX);

/// Memory limit for reading a copy, bytes.
const MOST_MEMORY: usize = 256 << 20;
/// Limit of processor time: this, and as much again for every megabyte.
const MOST_TIME: Duration = Duration::from_secs(1);
/// Seconds after which a copy that is not done ends the program.
const HANGS: u64 = 120;
/// Whether there was a panic, also one that the reader caught: in a web page it could not.
static HAS_PANICKED: AtomicBool = AtomicBool::new(false);
/// Every copy of so many is prepared for rays too, where it is read.
const CAST: u64 = 16;

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [first, count, seed, folder, files @ ..] = args.as_slice() else {
        return Err("fuzz_step FIRST COUNT SEED FOLDER FILE...".into());
    };
    let texts = files.iter().map(std::fs::read).collect::<Result<Vec<_>, _>>()?;
    let folder = Path::new(folder);
    if first == "--write" {
        let index = count.parse()?;
        let copy = damage::copy(&texts, seed.parse()?, index);
        std::fs::write(folder.join(format!("{index}.step")), copy)?;
        return Ok(());
    }
    read_all([first.parse()?, count.parse()?, seed.parse()?], folder, &texts)
}

/// Reads the copies and prints the results.
fn read_all([first, count, seed]: [u64; 3], folder: &Path, texts: &[Vec<u8>]) -> Result<(), Failure> {
    std::panic::set_hook(Box::new(|_| HAS_PANICKED.store(true, Ordering::Relaxed)));
    let mut counts = BTreeMap::<String, u64>::new();
    let mut slowest = (Duration::ZERO, first);
    let mut largest = (0, first);
    let mut at = std::fs::File::create(folder.join(format!("at-{first}")))?;
    let current = Arc::new(AtomicU64::new(first));
    watch(Arc::clone(&current));
    let mut peak = MEMORY.allocated();
    for index in first..first + count {
        current.store(index, Ordering::Relaxed);
        at.rewind()?;
        writeln!(at, "{index:20}")?;
        let copy = damage::copy(texts, seed, index);
        let before = MEMORY.allocated();
        // A limit below what is in use is refused, and there is none.
        MEMORY.set_limit(before + MOST_MEMORY).map_err(|_| "memory is in use already")?;
        let began = ThreadTime::now();
        let result = std::panic::catch_unwind(|| read(&copy, index));
        let time = began.elapsed();
        MEMORY.set_limit(usize::MAX).map_err(|_| "memory is in use already")?;
        if MEMORY.max_allocated() > peak {
            peak = MEMORY.max_allocated();
            largest = (peak - before, index);
        }
        slowest = slowest.max((time, index));
        let mut kind = result.unwrap_or_default();
        if HAS_PANICKED.swap(false, Ordering::Relaxed) {
            kind = format!("fault: panic ({kind})");
        }
        if time > MOST_TIME + MOST_TIME.mul_f64(copy.len() as f64 / 1e6) {
            kind = format!("fault: slow ({kind})");
        }
        if kind.starts_with("fault") {
            println!("at {index} {kind}");
            std::fs::write(folder.join(format!("{index}.step")), &copy)?;
        }
        *counts.entry(kind).or_default() += 1;
    }
    for (kind, count) in counts {
        println!("count {count} {kind}");
    }
    println!("slowest {} {}", slowest.0.as_micros(), slowest.1);
    println!("largest {} {}", largest.0, largest.1);
    Ok(())
}

/// Ends the program if the number stays the same for long.
fn watch(current: Arc<AtomicU64>) {
    std::thread::spawn(move || {
        let mut last = (u64::MAX, 0);
        loop {
            std::thread::sleep(Duration::from_secs(1));
            let now = current.load(Ordering::Relaxed);
            last = if now == last.0 { (now, last.1 + 1) } else { (now, 0) };
            if last.1 > HANGS {
                std::process::abort();
            }
        }
    });
}

/// The kind of result.
fn read(copy: &[u8], index: u64) -> String {
    let error = match step::read(copy) {
        Ok(assembly) => {
            let mut faces = assembly.parts.iter().flat_map(|part| &part.faces);
            if index.is_multiple_of(CAST) {
                for (face, _) in faces.clone() {
                    // Loops that bound nothing are no fault.
                    let _ = CastFace::new(face);
                }
            }
            let has_notes = !assembly.notes.is_empty();
            if assembly.notes.iter().any(String::is_empty) {
                return "fault: a note without text".into();
            }
            return match (faces.next().is_some(), has_notes) {
                (true, false) => "read",
                (true, true) => "read with notes",
                (false, _) => "read without faces",
            }
            .into();
        }
        Err(error) => error,
    };
    if error.to_string().is_empty() {
        return "fault: an error without text".into();
    }
    let kind = match error {
        StepError::Syntax(_) => "syntax",
        StepError::Cycle(_) => "cycle",
        StepError::TooDeep(_) => "too deep",
        StepError::TooLarge => "too large",
        StepError::Empty => "empty",
    };
    format!("refused: {kind}")
}
