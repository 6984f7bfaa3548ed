//! Simplification: for an arbitrary sheet with steps, holes, folds and seams, the result keeps place, area and
//! appearance of the scene.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rebounce::geometry::simplify::TOGETHER;

#[path = "../../../baker/tests/common/soup.rs"]
mod soup;

fuzz_target!(|bytes: &[u8]| {
    // Simplification in one batch or in small batches.
    let together = if bytes.len() % 4 < 2 { TOGETHER } else { 16 };
    soup::keeps_promises(&soup::soup(bytes), together);
});
