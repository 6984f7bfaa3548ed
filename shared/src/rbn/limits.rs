//! Limits of the format, enforced by readers.

/// Maximum number of levels: a pixel or a point without a function on a level tries the next coarser level.
pub const MAX_LEVELS: usize = 32;
/// Maximum number of links in a row: one shader invocation adds the row up.
pub const MAX_ROW: usize = 1 << 18;
/// Maximum number of triangles, counted once per copy: a small file must not occupy a GPU for minutes.
pub const MAX_TRIANGLES: u64 = 1 << 30;
/// Maximum number of copies; consecutive draw calls with equal copies count once.
pub const MAX_COPIES: u64 = 1 << 22;
/// Maximum number of materials: a pixel stores its material index in 16 bits.
pub const MAX_MATERIALS: usize = 0xffff;
/// Exclusive bound of numbers in a file; keeps squares and sums finite.
pub const LARGEST: f32 = 1e15;
/// Maximum size of section `META`, bytes.
pub const MAX_BYTES: usize = 16 << 20;

/// Returns true if the magnitude of a number is below [`LARGEST`].
pub(crate) fn sane(x: f32) -> bool {
    x.abs() < LARGEST
}

/// Returns true if every number is [`sane`].
pub(crate) fn all_sane(numbers: &[f32]) -> bool {
    numbers.iter().all(|x| sane(*x))
}
