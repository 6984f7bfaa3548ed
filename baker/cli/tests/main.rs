//! Tests of the command as a child process.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common {
    pub mod program;
}

mod export;
mod faults;
mod first_steps;
mod kill;
mod radiosity;
mod solve;
mod target;
