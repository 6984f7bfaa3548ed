//! Observers of a bake.

use crate::progress::Display;
use crate::stop::Stop;
use rebounce::bake::{Observer, Preview, Progress};
use rebounce::io::write::write_whole;
use std::path::PathBuf;

/// Observer that forwards stop requests.
pub struct Follower(pub Stop);

impl Observer for Follower {
    fn is_stopped(&self) -> bool {
        self.0.is_asked()
    }
}

/// Observer that shows progress, forwards stop requests and writes previews.
pub struct Watcher {
    pub display: Display,
    pub stop: Stop,
    /// Path of previews, if enabled.
    pub previews: Option<PathBuf>,
}

impl Watcher {
    /// Ends previews after a complete bake is written: previews of the next bake would be coarser. Removes the preview
    /// file.
    pub fn end_previews(&mut self) {
        if let Some(preview) = self.previews.take() {
            // The file may never have been written.
            let _ = std::fs::remove_file(preview);
        }
    }
}

impl Observer for Watcher {
    fn progress(&self, progress: &Progress) {
        // A stopped bake has a separate last line.
        if !self.stop.is_asked() {
            self.display.show(progress);
        }
    }

    fn is_stopped(&self) -> bool {
        self.stop.is_asked()
    }

    fn wants_previews(&self) -> bool {
        self.previews.is_some()
    }

    fn preview(&self, preview: Preview) {
        let Some(path) = &self.previews else { return };
        let written = preview.file.to_bytes().map_err(|error| error.to_string());
        let written = written.and_then(|bytes| write_whole(path, &bytes).map_err(|error| error.to_string()));
        if let Err(error) = written {
            eprintln!("warning: no preview: {error}");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nobody_goes_back_from_a_whole_bake_to_a_preview() {
        let stop = Stop::install(|| ()).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("room.preview.rbn");
        std::fs::write(&path, "a preview").unwrap();
        let mut watcher = Watcher { display: Display::new(true), stop, previews: Some(path.clone()) };
        assert!(watcher.wants_previews());
        watcher.end_previews();
        assert!(!watcher.wants_previews() && !path.exists());
    }
}
