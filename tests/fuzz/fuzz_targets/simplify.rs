//! Triangles for rays: whatever sheet with steps, holes, folds and seams the bytes say, what is left is where the scene
//! was, with as much area.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../../../baker/tests/common/soup.rs"]
mod soup;

fuzz_target!(|bytes: &[u8]| soup::keeps_promises(&soup::soup(bytes)));
