//! Where a ray meets a surface: a short list.

use super::SurfaceHit;
use glam::DVec2;
use std::ops::Deref;

/// At most four meetings: as many as a line has with a torus. A slice, by [`Deref`].
#[derive(Clone, Copy, Debug)]
pub struct SurfaceHits {
    meetings: [SurfaceHit; 4],
    count: usize,
}

impl Default for SurfaceHits {
    fn default() -> Self {
        Self { meetings: [SurfaceHit { distance: 0.0, at: DVec2::ZERO }; 4], count: 0 }
    }
}

impl SurfaceHits {
    /// Leaves none.
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// Adds one; `false` if there is no room.
    pub fn push(&mut self, meeting: SurfaceHit) -> bool {
        let Some(place) = self.meetings.get_mut(self.count) else { return false };
        *place = meeting;
        self.count += 1;
        true
    }
}

impl Deref for SurfaceHits {
    type Target = [SurfaceHit];

    fn deref(&self) -> &[SurfaceHit] {
        &self.meetings[..self.count]
    }
}
