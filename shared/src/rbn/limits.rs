//! Limits of the format: what a reader refuses.

/// Levels of a file, at most: a pixel or a point without a function on a level asks the next coarser one.
pub const MAX_LEVELS: usize = 32;
/// Links of one row, at most: one invocation of a shader adds them up.
pub const MAX_ROW: usize = 1 << 18;
/// Triangles, those of each copy counted, at most: a small file must not keep a GPU busy for minutes.
pub const MAX_TRIANGLES: u64 = 1 << 30;
/// Copies at most: those of draw calls that follow each other and have the same ones count once.
pub const MAX_COPIES: u64 = 1 << 22;
/// Materials at most: a pixel keeps its material's number in 16 bits.
pub const MAX_MATERIALS: usize = 0xffff;
/// Numbers of a file are smaller than this, so that their squares and sums stay finite.
pub const LARGEST: f32 = 1e15;
/// Largest `META` section, bytes.
pub const MAX_BYTES: usize = 16 << 20;

/// Whether a number is smaller than [`LARGEST`].
pub(crate) fn sane(x: f32) -> bool {
    x.abs() < LARGEST
}

/// Whether all of them are.
pub(crate) fn all_sane(numbers: &[f32]) -> bool {
    numbers.iter().all(|x| sane(*x))
}
