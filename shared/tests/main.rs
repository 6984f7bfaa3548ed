//! Tests of the shared crate, in one program.

mod openness;
mod rules;
mod shown;
mod versions;
