//! Light transport: converts direct light at points to bounced light at points.
//!
//! [`direct_to_indirect`] precomputes a sparse operator (Lehtinen et al. 2008).

pub mod direct_to_indirect;
