//! A device for tests.

use rebounce_viewer::gpu::Gpu;

/// The device, or `None` (with a message) without an adapter.
pub fn gpu() -> Option<Gpu> {
    match Gpu::headless() {
        Ok(gpu) => Some(gpu),
        Err(error) => {
            println!("skipped: no adapter ({error})");
            None
        }
    }
}
