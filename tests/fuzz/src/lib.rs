//! Code shared by the fuzz targets: a bound on memory, files reassembled with valid checksums, and mutators that keep
//! a file's outer format, so that damage reaches the code behind the container.

pub mod contents;
pub mod glb;
pub mod partial;
pub mod rbn;

use cap::Cap;
use std::alloc::System;

#[global_allocator]
static MEMORY: Cap<System> = Cap::new(System, usize::MAX);

/// Memory limit of reading an input, bytes, in addition to four times the input size.
pub const MEMORY_FREE: usize = 64 << 20;

/// Runs `work`; aborts the process if memory exceeds the limit for `input` bytes plus `more` bytes.
pub fn bounded<T>(input: usize, more: usize, work: impl FnOnce() -> T) -> T {
    let most = MEMORY.allocated() + 4 * input + MEMORY_FREE + more;
    MEMORY.set_limit(most).expect("what is allocated is under the limit");
    let done = work();
    MEMORY.set_limit(usize::MAX).expect("no limit is above what is allocated");
    done
}

/// Random numbers from a seed (SplitMix64).
pub struct Random(u64);

impl Random {
    /// Creates the generator for a seed.
    pub fn new(seed: u32) -> Self {
        Self(seed as u64)
    }

    /// Returns a number below `n`.
    pub fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let x = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) as usize) % n.max(1)
    }
}

/// Applies libFuzzer's own mutation to a part of an input, up to `most` bytes long.
pub fn mutated(part: &[u8], most: usize) -> Vec<u8> {
    let mut bytes = part.to_vec();
    bytes.truncate(most);
    let len = bytes.len();
    bytes.resize(most.max(1), 0);
    let size = libfuzzer_sys::fuzzer_mutate(&mut bytes, len, most.max(1));
    bytes.truncate(size);
    bytes
}

/// Copies a new input into libFuzzer's buffer; `None` for an input over `max_size`.
pub fn put(input: &[u8], data: &mut [u8], max_size: usize) -> Option<usize> {
    data.get_mut(..input.len().min(max_size + 1))?.get_mut(..input.len())?.copy_from_slice(input);
    (input.len() <= max_size).then_some(input.len())
}
