//! A device to test with.

use rebounce_viewer::gpu::Gpu;

/// The device, or `None` (said aloud) where there is no adapter.
pub fn gpu() -> Option<Gpu> {
    match Gpu::headless() {
        Ok(gpu) => Some(gpu),
        Err(error) => {
            println!("skipped: no adapter ({error})");
            None
        }
    }
}
