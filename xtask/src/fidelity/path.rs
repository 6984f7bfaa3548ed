//! Temporal stability: change of the bounced light between consecutive pictures of a moving lamp.

use super::measure::{INDIRECT, Tool};
use anyhow::{Context, Result};
use std::path::{Path, PathBuf};

/// Pictures along the way.
const STEPS: usize = 200;
/// Samples per pixel of the path tracer, with identical random numbers in every picture: noise does not move.
const TRUTH_SAMPLES: u32 = 32;

/// Largest change between neighbouring pictures on a lamp's path through the library.
pub struct Steps {
    /// Root mean square change over the root mean square.
    pub whole: f64,
    /// 95th percentile of the change over blocks of 8 by 8 pixels, over the mean.
    pub blocks: f64,
}

impl Tool {
    /// Measures a baked library; path-traced pictures if `baked` is `None`.
    pub fn steps(&self, baked: Option<&Path>) -> Result<Steps> {
        let (mut last, mut next) = (self.file("step.0.exr"), self.file("step.1.exr"));
        let mut largest = Steps { whole: 0.0, blocks: 0.0 };
        for step in 0..STEPS {
            let shot = self.shot_at(step as f64 / (STEPS - 1) as f64)?;
            let view = ["--shot".to_owned(), shot.display().to_string()];
            match baked {
                Some(baked) => self.render(INDIRECT, baked, &view, &next)?,
                None => self.path_traced(INDIRECT, ("builtin:library", &view), 1, TRUTH_SAMPLES, &next)?,
            }
            if step > 0 {
                let change = self.compare(&next, &last, None, &[])?;
                largest.whole = largest.whole.max(change.error());
                largest.blocks = largest.blocks.max(change.p95);
            }
            std::mem::swap(&mut last, &mut next);
        }
        Ok(largest)
    }

    /// The lamp goes along the shelves and turns.
    fn shot_at(&self, t: f64) -> Result<PathBuf> {
        let file = self.file("step.shot.json");
        let shot = serde_json::json!({
            "size": [160, 96],
            "camera": {
                "position": [3.9, 1.6, 3.5], "target": [1.9, 0.9, 0.6], "up": [0, 1, 0], "yfov_deg": 60,
            },
            "lights": [{
                "type": "spot", "position": [0.7 + 3.2 * t, 2.3, 2.9], "direction": [0.5 - t, -1.0, -0.7],
                "outer_cone_deg": 40, "intensity": 60, "color": [1, 1, 1],
            }],
        });
        std::fs::write(&file, shot.to_string()).with_context(|| file.display().to_string())?;
        Ok(file)
    }
}
