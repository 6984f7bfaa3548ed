//! Tests of what baker and viewer share, in one program.

mod openness;
mod rules;
mod shown;
mod versions;
