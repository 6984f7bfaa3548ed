//! Baker.
