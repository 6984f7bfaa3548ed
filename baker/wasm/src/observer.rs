//! Progress and previews of a bake, on their way to the page.

use super::host::with_host;
use rebounce::bake::{Observer, Preview, Progress};

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

    fn wants_points(&self) -> bool {
        self.wants_previews
    }

    fn preview(&self, preview: Preview) {
        // A preview that does not fit the format is no loss: the file itself reports the error.
        if let Ok(bytes) = preview.file.to_bytes() {
            with_host(|host| host.preview(js_sys::Uint8Array::from(&bytes[..])));
        }
    }
}
