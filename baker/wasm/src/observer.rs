//! Progress and previews of a bake, on their way to the page.

use super::worker::Host;
use rebounce::bake::{Observer, Preview, Progress};
use std::cell::RefCell;

thread_local! {
    /// What this worker reports to: an observer is `Sync`, JavaScript's objects are not.
    static HOST: RefCell<Option<Host>> = const { RefCell::new(None) };
}

/// Sets what this worker reports to.
pub fn set_host(host: Host) {
    HOST.with_borrow_mut(|place| *place = Some(host));
}

/// Calls `tell` with what this worker reports to.
pub fn with_host(tell: impl FnOnce(&Host)) {
    HOST.with_borrow(|host| host.as_ref().map(tell));
}

/// Reports to the page.
pub struct PageObserver {
    /// Whether the page shows previews.
    pub wants_previews: bool,
}

impl Observer for PageObserver {
    fn progress(&self, progress: &Progress) {
        with_host(|host| host.progress(progress.stage.label(), progress.fraction(), progress.seconds_left));
    }

    fn wants_previews(&self) -> bool {
        self.wants_previews
    }

    fn wants_direct_light(&self) -> bool {
        self.wants_previews
    }

    fn preview(&self, preview: Preview) {
        // A preview that does not fit the format is no loss: the file itself reports the error.
        if let Ok(bytes) = preview.file.to_bytes() {
            with_host(|host| host.preview(js_sys::Uint8Array::from(&bytes[..])));
        }
    }
}
