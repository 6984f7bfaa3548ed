//! Triangles for rays: whatever sheet with steps, holes, folds and seams the bytes say, what is left is where the scene
//! was, with as much area, and looks as it looked.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rebounce::geometry::simplify::TOGETHER;

#[path = "../../../baker/tests/common/soup.rs"]
mod soup;

fuzz_target!(|bytes: &[u8]| {
    // All at once, or little by little.
    let together = if bytes.len() % 4 < 2 { TOGETHER } else { 16 };
    soup::keeps_promises(&soup::soup(bytes), together);
});
