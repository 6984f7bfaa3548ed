//! Tests of the command as a child process.

mod common {
    pub mod program;
}

mod faults;
mod first_steps;
mod kill;
mod target;
