//! The receivers of a level as parts that processes and workers share.

use super::messages::{Receiver, SourceChunk};
use crate::job::parts::Parts;
use crate::random::mix;
use std::ops::Range;

/// Receivers per part.
const CHUNK: usize = 64;

/// Receivers of a level, in chunks.
pub struct SourceLevel<'a> {
    /// The receivers.
    pub range: Range<usize>,
    /// Whether it is the finest level, whose values no other receiver reads.
    pub is_last: bool,
    /// Gathers for some receivers.
    pub gather: &'a (dyn Fn(Range<usize>) -> Vec<Receiver> + Sync),
    /// Whether a message has as many values as there are sources.
    pub fits: &'a (dyn Fn(&Receiver) -> bool + Sync),
}

impl SourceLevel<'_> {
    /// Receivers of a chunk.
    fn receivers(&self, part: usize) -> Range<usize> {
        let first = self.range.start + part * CHUNK;
        first..self.range.end.min(first + CHUNK)
    }
}

impl Parts for SourceLevel<'_> {
    type Found = SourceChunk;
    const KIND: u32 = 5;

    fn count(&self) -> usize {
        self.range.len().div_ceil(CHUNK)
    }

    fn key(&self, part: usize) -> u64 {
        self.receivers(part).start as u64
    }

    fn compute(&self, part: usize) -> SourceChunk {
        SourceChunk((self.gather)(self.receivers(part)))
    }

    fn fits(&self, part: usize, found: &SourceChunk) -> bool {
        found.0.len() == self.receivers(part).len() && found.0.iter().all(self.fits)
    }

    fn units(&self, part: usize, _found: &SourceChunk) -> u64 {
        self.receivers(part).len() as u64
    }

    fn is_shared(&self) -> bool {
        !self.is_last
    }

    fn order(&self, part: usize) -> u64 {
        mix(self.key(part))
    }
}
