//! Reads SHOT.json.

use rebounce_shared::camera::Camera;
use rebounce_shared::light::Light;
use rebounce_shared::shot::Shot;
use std::path::{Path, PathBuf};

/// Largest width or height of a picture.
pub const MAX_SIZE: u32 = 16_384;

/// Why a shot cannot be taken.
#[derive(Debug, thiserror::Error)]
pub enum ShotError {
    /// The file could not be read.
    #[error("cannot read {path}: {source}; check the path")]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file is not a shot.
    #[error("{path} is not a shot: {problem}; see docs/SHOT.md for the format")]
    Invalid {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        problem: String,
    },
}

/// Reads a shot and checks its numbers.
///
/// # Errors
/// [`ShotError`].
pub fn read(path: &Path) -> Result<Shot, ShotError> {
    let text =
        std::fs::read_to_string(path).map_err(|source| ShotError::Read { path: path.to_owned(), source })?;
    parse(&text).map_err(|problem| ShotError::Invalid { path: path.to_owned(), problem })
}

/// Reads a shot from its text and checks its numbers.
///
/// # Errors
/// What is wrong, in words.
pub fn parse(text: &str) -> Result<Shot, String> {
    let shot: Shot = serde_json::from_str(text).map_err(|e| e.to_string())?;
    check(&shot)?;
    Ok(shot)
}

fn check(shot: &Shot) -> Result<(), String> {
    if shot.size.iter().any(|&s| s == 0 || s > MAX_SIZE) {
        return Err(format!("size must lie between 1 and {MAX_SIZE}"));
    }
    let Camera { position, target, yfov_deg, .. } = &shot.camera;
    if !shot.camera.is_usable() {
        return Err("the camera has a number that is not finite, or far too large".into());
    }
    if position == target {
        return Err("the camera's position and target are the same".into());
    }
    if !(*yfov_deg > 0.0 && *yfov_deg < 180.0) {
        return Err("yfov_deg must lie between 0 and 180".into());
    }
    for (i, light) in shot.lights.iter().enumerate() {
        let direction = match light {
            Light::Point { .. } => None,
            Light::Spot { direction, outer_cone_deg, .. } => {
                if !(*outer_cone_deg > 0.0 && *outer_cone_deg <= 90.0) {
                    return Err(format!("light {i}: outer_cone_deg is a half angle between 0 and 90"));
                }
                Some(direction)
            }
            Light::Directional { direction, .. } => Some(direction),
        };
        if !light.is_usable() {
            return Err(format!("light {i} has a number that is not finite, or far too large"));
        }
        if direction.is_some_and(|d| d.iter().all(|&x| x == 0.0)) {
            return Err(format!("light {i} has no direction"));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(json: &str) -> Result<(), String> {
        check(&serde_json::from_str(json).unwrap())
    }

    #[test]
    fn impossible_shots_are_refused_in_words() {
        let camera = r#""camera":{"position":[0,0,1],"target":[0,0,0]}"#;
        assert_eq!(parse(&format!("{{{camera}}}")), Ok(()));
        for (json, word) in [
            (format!(r#"{{{camera},"size":[0,5]}}"#), "size"),
            (r#"{"camera":{"position":[0,0,0],"target":[0,0,0]}}"#.into(), "same"),
            (r#"{"camera":{"position":[0,0,1],"target":[0,0,0],"yfov_deg":180}}"#.into(), "yfov_deg"),
            (
                format!(
                    r#"{{{camera},"lights":[{{"type":"spot","position":[0,0,0],"direction":[0,0,1],"outer_cone_deg":120,"intensity":1}}]}}"#
                ),
                "half angle",
            ),
            (
                format!(
                    r#"{{{camera},"lights":[{{"type":"directional","direction":[0,0,0],"intensity":1}}]}}"#
                ),
                "direction",
            ),
        ] {
            assert!(parse(&json).unwrap_err().contains(word), "{json}");
        }
    }
}
