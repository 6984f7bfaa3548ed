//! Storage of the finished parts of a computation, so that a later run resumes.

/// Storage for the results of parts, including parts of an earlier run. Loaded bytes equal the stored bytes.
pub trait PartialResults: Sync {
    /// Takes the bytes of a part: `kind` is the kind of computation, `key` the part's number among the parts of the kind.
    /// `None` if not stored, or taken before.
    fn take(&self, kind: u32, key: u64) -> Option<Vec<u8>>;

    /// Stores the bytes of a part.
    fn keep(&self, kind: u32, key: u64, bytes: &[u8]);
}

/// Stores nothing.
impl PartialResults for () {
    fn take(&self, _kind: u32, _key: u64) -> Option<Vec<u8>> {
        None
    }

    fn keep(&self, _kind: u32, _key: u64, _bytes: &[u8]) {}
}
