//! Running a long computation: progress and cancellation ([`watch`]), and the processes of a bake ([`communicator`]).
//! Knows no geometry.

pub mod communicator;
pub mod watch;
