//! Tests of the shared crate, in one program.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod openness;
mod rules;
mod shown;
mod versions;
