//! Reads SHOT.json.

use super::Files;
use super::files::Disk;
use rebounce_shared::camera::Camera;
use rebounce_shared::light::{self, LightKind};
use rebounce_shared::mix;
use rebounce_shared::motion::NodeMotion;
use rebounce_shared::shot::Shot;
use serde_json::Value;
use std::io::{Error, ErrorKind};
use std::path::{Path, PathBuf};

/// Largest width or height of a picture.
pub const MAX_SIZE: u32 = 16_384;

/// Reason for an unusable shot.
#[derive(Debug, thiserror::Error)]
pub enum ShotError {
    /// The file could not be read.
    #[error("cannot read {path}: {source}; check the path")]
    Read {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The file is not a shot.
    #[error("{path} is not a shot: {problem}; see docs/guide/shot.md for the format")]
    Invalid {
        /// The file.
        path: PathBuf,
        /// Description of the problem.
        problem: String,
    },
}

/// Reads a shot and checks its numbers.
///
/// # Errors
/// [`ShotError`].
pub fn read(path: &Path) -> Result<Shot, ShotError> {
    read_from(&Disk, path)
}

/// As [`read`], from any source of files.
///
/// # Errors
/// [`ShotError`].
pub fn read_from(files: &dyn Files, path: &Path) -> Result<Shot, ShotError> {
    let utf8 = |bytes| String::from_utf8(bytes).map_err(|error| Error::new(ErrorKind::InvalidData, error));
    let text = files.read(path).and_then(utf8);
    let text = text.map_err(|source| ShotError::Read { path: path.to_owned(), source })?;
    parse(&text).map_err(|problem| ShotError::Invalid { path: path.to_owned(), problem })
}

/// Reads a shot from its text and checks its numbers.
///
/// # Errors
/// Description of the problem.
pub fn parse(text: &str) -> Result<Shot, String> {
    // Some editors write a byte-order mark.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut shot: Shot = serde_json::from_str(text).map_err(|e| e.to_string())?;
    let members: Value = serde_json::from_str(text).map_err(|e| e.to_string())?;
    check_members(&members)?;
    shot.moves = moves(&members["move"])?;
    check(&shot)?;
    let name = |light: &Value| light[NAME].as_str().unwrap_or_default().to_owned();
    shot.light_names = members["lights"].as_array().into_iter().flatten().map(name).collect();
    Ok(shot)
}

/// Known members of a shot, of its camera, and of lights by type.
const SHOT: &[&str] =
    &["scene", "size", "camera", "emission", "gloss", "animation", "time", "lights", "mix", "move"];
const CAMERA: &[&str] = &["position", "target", "up", "yfov_deg"];
const LIGHTS: [(&str, &[&str]); light::MEMBERS.len()] = light::MEMBERS;
/// Name of a light; of an emissive light, the name of its group.
const NAME: &str = "name";

/// Rejects unknown members: a misspelt name would silently drop the value.
fn check_members(shot: &Value) -> Result<(), String> {
    let check = |value: &Value, what: &str, known: &[&str]| {
        let members = value.as_object().into_iter().flatten();
        match members.map(|(name, _)| name).find(|name| !known.contains(&name.as_str())) {
            Some(name) => Err(format!("{what} has no {name:?}; there can be {}", known.join(", "))),
            None => Ok(()),
        }
    };
    check(shot, "it", SHOT)?;
    check(&shot["camera"], "its camera", CAMERA)?;
    for (i, light) in shot["lights"].as_array().into_iter().flatten().enumerate() {
        let known = LIGHTS.iter().find(|(kind, _)| light["type"] == **kind);
        check(light, &format!("light {i}"), known.map_or(&[], |(_, known)| known))?;
        if light.get(NAME).is_some_and(|name| !name.is_string()) {
            return Err(format!("light {i}: its name is a text"));
        }
    }
    Ok(())
}

/// Reads the motions of nodes by their names.
fn moves(members: &Value) -> Result<Vec<(String, NodeMotion)>, String> {
    let all = match members {
        Value::Null => return Ok(Vec::new()),
        members => members.as_object().ok_or("move is an object of nodes by their names")?,
    };
    let motion = |(name, value): (&String, &Value)| {
        let mut out = NodeMotion::default();
        for (member, value) in value.as_object().into_iter().flatten() {
            let numbers: Vec<f64> =
                value.as_array().into_iter().flatten().chain([value]).filter_map(Value::as_f64).collect();
            match (member.as_str(), &numbers[..]) {
                ("translation", &[x, y, z]) => out.translation = [x, y, z],
                ("rotation", &[x, y, z, w]) => out.rotation = [x, y, z, w],
                ("rotation_y_deg", &[degrees]) => out.rotation_y_deg = degrees,
                _ => return Err(format!("move of {name:?} has no such {member:?}; {MOTION}")),
            }
        }
        let is_sound = value.is_object() && out.is_usable();
        is_sound.then(|| (name.clone(), out)).ok_or_else(|| format!("move of {name:?}: {MOTION}"))
    };
    all.iter().map(motion).collect()
}

/// What a motion may be.
const MOTION: &str = "there can be translation (three finite numbers), rotation_y_deg (degrees) and rotation (a quaternion x, y, z, w)";

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
    if shot.camera.up.iter().all(|&x| x == 0.0) {
        return Err("the camera's up has no direction".into());
    }
    if !(*yfov_deg > 0.0 && *yfov_deg < 180.0) {
        return Err("yfov_deg must lie between 0 and 180".into());
    }
    if !(0.0..1e18).contains(&shot.emission) {
        return Err("emission is a factor, 0 or more".into());
    }
    if shot.time.is_some_and(|time| !(0.0..1e9).contains(&time)) {
        return Err("time is in seconds, 0 or more".into());
    }
    let environments = shot.lights.iter().filter(|light| light.kind() == LightKind::Environment);
    if environments.count() > 1 {
        return Err("there is more than one environment".into());
    }
    for (i, light) in shot.lights.iter().enumerate() {
        if !light.is_usable() {
            return Err(format!("light {i} has a number that is not finite, or far too large"));
        }
        if let Some(problem) = light.problem() {
            return Err(format!("light {i}: {problem}"));
        }
    }
    mix::problem(&shot.mix).map_or(Ok(()), Err)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rebounce_shared::light::Light;

    fn parse(json: &str) -> Result<(), String> {
        super::parse(json).map(drop)
    }

    #[test]
    fn what_would_be_passed_over_is_refused_and_all_that_can_be_written_is_known() {
        let shot = r#"{"scene":"a.glb","size":[9,9],"camera":{"position":[0,0,1],"target":[0,0,0],"up":[0,1,0],"yfov_deg":60},"emission":0.5,"gloss":true,"animation":"walk","time":0.5,
            "lights":[{"type":"point","name":"Lamp","position":[0,0,0],"intensity":1,"color":[1,1,1],"radius":0.1},
            {"type":"spot","position":[0,0,0],"direction":[0,0,1],"outer_cone_deg":40,"inner_cone_deg":30,"intensity":1,"color":[1,1,1],"radius":0.1},
            {"type":"directional","direction":[0,0,1],"intensity":1,"color":[1,1,1],"radius_deg":0.27},
            {"type":"rectangle","position":[0,0,0],"direction":[0,0,1],"up":[0,1,0],"width":1,"height":2,"intensity":1,"color":[1,1,1]},
            {"type":"disk","position":[0,0,0],"direction":[0,0,1],"radius":1,"intensity":1,"color":[1,1,1]},
            {"type":"sphere","position":[0,0,0],"radius":1,"intensity":1,"color":[1,1,1]},
            {"type":"environment","file":"sky.hdr","rotation_deg":30,"intensity":1,"color":[1,1,1]},
            {"type":"emissive","name":"screen","group":2,"intensity":1,"color":[1,1,1]}],
            "mix":[{"stops":-1,"mute":true,"solo":true,"color":[1,0,0]},{}],
            "move":{"door":{"translation":[1,0,0],"rotation_y_deg":90},"lid":{"rotation":[1,0,0,0]}}}"#;
        assert_eq!(parse(shot), Ok(()));
        let names = super::parse(shot).unwrap().light_names;
        assert_eq!(names, ["Lamp", "", "", "", "", "", "", "screen"]);
        assert!(parse(&shot.replace("\"Lamp\"", "7")).unwrap_err().contains("name is a text"));
        assert_eq!(parse(&format!("\u{feff}{shot}")), Ok(()));
        // The lists of members must match the types.
        let written = serde_json::to_value(super::parse(shot).unwrap()).unwrap();
        let names = |value: &Value| value.as_object().unwrap().len();
        // Motions are not written.
        assert_eq!((names(&written) + 1, names(&written["camera"])), (SHOT.len(), CAMERA.len()));
        for (light, (kind, known)) in written["lights"].as_array().unwrap().iter().zip(LIGHTS) {
            assert!(light["type"] == kind && names(light) + 1 == known.len(), "{light}");
        }
        let said = parse(&shot.replacen("\"mute\"", "\"muted\"", 1)).unwrap_err();
        assert!(said.contains("muted") && said.contains("`mute`"), "{said}");
        for (right, wrong) in [
            ("\"lights\"", "\"light\""),
            ("\"yfov_deg\"", "\"fov\""),
            ("\"color\"", "\"colour\""),
            ("\"inner_cone_deg\"", "\"inner\""),
        ] {
            let said = parse(&shot.replacen(right, wrong, 1)).unwrap_err();
            assert!(
                said.contains(&format!("has no {wrong}")) && said.contains(right.trim_matches('"')),
                "{said}"
            );
        }
    }

    #[test]
    fn what_lights_with_a_surface_leave_out_is_as_usual() {
        let shot = r#"{"camera":{"position":[0,0,1],"target":[0,0,0]},"lights":[
            {"type":"rectangle","position":[0,0,0],"direction":[0,0,1],"width":1,"height":2,"intensity":3},
            {"type":"environment"},{"type":"emissive","name":"screen"}]}"#;
        let shot = super::parse(shot).unwrap();
        assert_eq!(shot.emission, 1.0);
        let (color, position, direction) = ([1.0; 3], [0.0; 3], [0.0, 0.0, 1.0]);
        let (width, height, intensity) = (1.0, 2.0, 3.0);
        assert_eq!(
            shot.lights,
            [
                Light::Rectangle { position, direction, up: [0.0; 3], width, height, intensity, color },
                Light::Environment { file: None, rotation_deg: 0.0, intensity: 1.0, color },
                Light::Emissive { group: 0, intensity: 1.0, color },
            ]
        );
    }

    #[test]
    fn impossible_shots_are_refused_in_words() {
        let camera = r#""camera":{"position":[0,0,1],"target":[0,0,0]}"#;
        assert_eq!(parse(&format!("{{{camera}}}")), Ok(()));
        for (json, word) in [
            (format!(r#"{{{camera},"size":[0,5]}}"#), "size"),
            (format!(r#"{{{camera},"time":-1}}"#), "time"),
            (r#"{"camera":{"position":[0,0,0],"target":[0,0,0]}}"#.into(), "same"),
            (format!(r#"{{{camera},"move":{{"door":{{"rotation":[0,0,0,0]}}}}}}"#), "door"),
            (format!(r#"{{{camera},"move":{{"door":{{"turn":1}}}}}}"#), "turn"),
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
            (format!(r#"{{{camera},"emission":-1}}"#), "emission is"),
            (format!(r#"{{{camera},"gloss":1}}"#), "boolean"),
            (
                format!(r#"{{{camera},"lights":[{{"type":"environment"}},{{"type":"environment"}}]}}"#),
                "more than one environment",
            ),
            (
                format!(
                    r#"{{{camera},"lights":[{{"type":"sphere","position":[0,0,0],"radius":0,"intensity":1}}]}}"#
                ),
                "radius is above 0",
            ),
            (
                format!(
                    r#"{{{camera},"lights":[{{"type":"disk","position":[0,0,0],"direction":[0,0,1],"intensity":1}}]}}"#
                ),
                "missing field `radius`",
            ),
            (
                r#"{"camera":{"position":[0,0,1],"target":[0,0,0],"up":[0,0,0]}}"#.into(),
                "up has no direction",
            ),
            (
                format!(r#"{{{camera},"lights":[{{"type":"point","position":[0,0,0],"intensity":-1}}]}}"#),
                "negative",
            ),
            (
                format!(
                    r#"{{{camera},"lights":[{{"type":"point","position":[0,0,0],"intensity":1,"radius":-1}}]}}"#
                ),
                "radius is",
            ),
            (
                format!(
                    r#"{{{camera},"lights":[{{"type":"directional","direction":[0,0,1],"intensity":1,"radius_deg":31}}]}}"#
                ),
                "radius_deg lies",
            ),
            (
                format!(
                    r#"{{{camera},"lights":[{{"type":"point","position":[0,0,0],"intensity":1,"color":[255,255,255]}}]}}"#
                ),
                "from 0 to 1",
            ),
            (
                format!(
                    r#"{{{camera},"lights":[{{"type":"spot","position":[0,0,0],"direction":[0,0,1],"inner_cone_deg":50,"outer_cone_deg":40,"intensity":1}}]}}"#
                ),
                "inner_cone_deg",
            ),
        ] {
            assert!(parse(&json).unwrap_err().contains(word), "{json}");
        }
    }
}
