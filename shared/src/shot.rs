//! SHOT.json: description of a picture of a scene – size, camera and lights, in world space.
//!
//! ```json
//! { "size": [320, 180],
//!   "camera": { "position": [0, 1, 4], "target": [0, 1, 0], "up": [0, 1, 0], "yfov_deg": 60 },
//!   "emission": 1,
//!   "move": { "door": { "translation": [0, 0, 0], "rotation_y_deg": 90 } },
//!   "lights": [ { "type": "spot", "position": [0, 2, 0], "direction": [0, -1, 0],
//!                 "outer_cone_deg": 40, "intensity": 60, "color": [1, 1, 1] } ] }
//! ```

use crate::motion::{Motions, NodeMotion};
use crate::rbn::groups::Groups;
use crate::{camera::Camera, light::Light, mix::Channel};
use serde::{Deserialize, Serialize};

/// Picture to render.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shot {
    /// File of the scene, relative to the shot's file; unused if a baked file is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scene: Option<String>,
    /// Width and height in pixels.
    #[serde(default = "default_size")]
    pub size: [u32; 2],
    /// Camera of the picture.
    pub camera: Camera,
    /// Factor of the emission of all surfaces.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub emission: f64,
    /// Whether metals are GGX conductors whose reflectance is the base colour at every angle; otherwise they are Lambertian.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub gloss: bool,
    /// Name or number of the animation that the scene's file is in, at [`Self::time`]; its first when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub animation: Option<String>,
    /// Seconds from the animation's begin; at rest when neither this nor an animation is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time: Option<f64>,
    /// Lights of the scene; without lights, and without surfaces that shine, the picture is black.
    #[serde(default)]
    pub lights: Vec<Light>,
    /// Channels of the light mixer, by the lights' places; a light without one is as it is.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mix: Vec<Channel>,
    /// Motions of nodes, by their names. In SHOT.json, the object `move`.
    #[serde(skip)]
    pub moves: Vec<(String, NodeMotion)>,
    /// Names of the lights, empty for lights without; may be shorter than `lights`. In SHOT.json, a member of the light.
    #[serde(skip)]
    pub light_names: Vec<String>,
}

impl Shot {
    /// Returns a shot without names, whose surfaces shine as the scene says.
    pub fn new(size: [u32; 2], camera: Camera, lights: Vec<Light>) -> Self {
        let (mix, moves, light_names) = Default::default();
        let (scene, animation, time) = Default::default();
        let (emission, gloss) = (1.0, false);
        Self { scene, size, camera, emission, gloss, animation, time, lights, mix, moves, light_names }
    }

    /// Resolves the names of emissive lights to numbers of groups of shining surfaces, by the names of the scene's
    /// groups. A light without a name keeps its number.
    ///
    /// # Errors
    /// A description of the light that has no group, with the names that there are.
    pub fn resolve_groups(&mut self, group_names: &[String]) -> Result<(), String> {
        for (i, light) in self.lights.iter_mut().enumerate() {
            let Light::Emissive { group, .. } = light else { continue };
            let name = self.light_names.get(i).map_or("", String::as_str);
            let found = match name {
                "" => group_names.get(*group as usize).map(|_| *group),
                name => (0..).zip(group_names).find(|(_, group)| *group == name).map(|(number, _)| number),
            };
            *group = found.ok_or_else(|| {
                let wanted =
                    if name.is_empty() { format!("number {group}") } else { format!("named {name:?}") };
                let there = match group_names {
                    [] => "no surface of the scene shines".to_owned(),
                    names => format!("there can be {}", names.join(", ")),
                };
                format!("light {i}: the scene has no group of shining surfaces {wanted}; {there}")
            })?;
        }
        Ok(())
    }
}

impl Shot {
    /// Whether the shot is of a moment of an animation.
    pub fn is_animated(&self) -> bool {
        self.animation.is_some() || self.time.is_some()
    }

    /// Returns the motions of groups that the shot asks for; `origin` is that of local space.
    ///
    /// # Errors
    /// A description of the node that cannot move, with those that can.
    pub fn motions(&self, groups: &Groups, origin: [f64; 3]) -> Result<Motions, String> {
        let mut nodes = vec![NodeMotion::default(); groups.nodes.len()];
        for (name, motion) in &self.moves {
            let mut named = groups.nodes.iter().zip(&mut nodes).filter(|(node, _)| node.name == *name);
            let Some((_, first)) = named.next() else {
                let names: Vec<&str> = groups.nodes.iter().map(|node| node.name.as_str()).take(32).collect();
                let there = match names[..] {
                    [] => "nothing can: bake with --solver radiosity, or with --group NODE".to_owned(),
                    _ => format!("these can: {}", names.join(", ")),
                };
                return Err(format!("move: no node named {name:?} can move; {there}"));
            };
            *first = *motion;
        }
        Ok(Motions::new(groups, &nodes, origin))
    }
}

fn default_size() -> [u32; 2] {
    [640, 360]
}

fn one() -> f64 {
    1.0
}

fn is_one(factor: &f64) -> bool {
    *factor == 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_are_found_by_name_and_what_there_is_is_listed() {
        let camera =
            Camera { position: [0.0; 3], target: [0.0, 0.0, -1.0], up: [0.0, 1.0, 0.0], yfov_deg: 60.0 };
        let group = |group| Light::Emissive { group, intensity: 1.0, color: [1.0; 3] };
        let named = |names: &[&str], lights: &[Light]| Shot {
            light_names: names.iter().map(|name| (*name).to_owned()).collect(),
            ..Shot::new([1; 2], camera.clone(), lights.to_vec())
        };
        let there = ["lamp", "screen"].map(str::to_owned);
        let mut shot = named(&["screen"], &[group(0), group(1)]);
        shot.resolve_groups(&there).unwrap();
        assert_eq!(shot.lights, [group(1), group(1)]);
        let said = named(&["", "tube"], &[group(0), group(0)]).resolve_groups(&there).unwrap_err();
        assert!(
            said.contains("light 1") && said.contains("\"tube\"") && said.contains("lamp, screen"),
            "{said}"
        );
        let said = named(&[], &[group(2)]).resolve_groups(&there).unwrap_err();
        assert!(said.contains("number 2") && said.contains("lamp, screen"), "{said}");
        let said = named(&[], &[group(0)]).resolve_groups(&[]).unwrap_err();
        assert!(said.contains("no surface of the scene shines"), "{said}");
    }
}
