//! `rebounce bake --target-error`: each bake is held to a path tracer, and a finer one follows where that is needed.

use crate::cli::picture::shot_or_own;
use crate::cli::plain::plain;
use anyhow::{Context, Result};
use rebounce::bake::aim::is_worth_another;
use rebounce::bake::judge::{Judge, Worst};
use rebounce::scene::Scene;
use rebounce::shot;
use rebounce_shared::rbn;
use rebounce_shared::shot::Shot;
use std::path::Path;

/// The error that is wanted, and where it is measured.
pub struct Aim {
    target: f64,
    shot: Shot,
}

/// What is known of the bakes so far.
pub struct Trials<'a> {
    aim: &'a Aim,
    judge: Option<Judge<'a>>,
    scene: &'a Scene,
    errors: Vec<f64>,
}

/// What a bake's error asks for.
pub enum Outcome {
    /// Small enough.
    Met,
    /// Too large, and a finer bake may help.
    Finer,
    /// Too large, and this is the last bake.
    Missed,
}

impl Aim {
    /// Nothing where there is no camera or no light to measure with.
    ///
    /// # Errors
    /// A shot that cannot be read.
    pub fn new(target: f64, shot: Option<&Path>, spec: &str, scene: &Scene) -> Result<Option<Self>> {
        let given = shot.map(shot::read).transpose()?;
        let is_given = given.is_some();
        match shot_or_own(given, spec, &scene.cameras, &scene.lights) {
            Ok(shot) => Ok(Some(Self { target, shot })),
            Err(error) if is_given => Err(error),
            Err(error) => {
                eprintln!(
                    "note: {error}; the preset is taken that is made for the error, which is not measured"
                );
                Ok(None)
            }
        }
    }

    /// No bake so far.
    pub fn trials<'a>(&'a self, scene: &'a Scene) -> Trials<'a> {
        Trials { aim: self, judge: None, scene, errors: Vec::new() }
    }
}

impl Trials<'_> {
    /// Measures a bake, says what it found, and returns the error. `is_last`: no finer one can follow.
    ///
    /// # Errors
    /// If the view cannot be measured.
    pub fn measure(&mut self, baked: &rbn::Scene, name: &str, is_last: bool) -> Result<(f64, Outcome)> {
        let (scene, Aim { target, shot }) = (self.scene, self.aim);
        eprintln!("measuring the error");
        let judge = self.judge.get_or_insert_with(|| Judge::new(scene, shot));
        let verdict = judge.verdict(baked).context("--target-error")?;
        let error = verdict.comparison.error;
        self.errors.push(error);
        if error <= *target {
            eprintln!("{name}: error {error:.3}, at most {target} was wanted");
            return Ok((error, Outcome::Met));
        }
        if !is_last && is_worth_another(&self.errors) {
            eprintln!("{name}: error {error:.3}, over {target}; a finer bake follows");
            return Ok((error, Outcome::Finer));
        }
        let why = if is_last { "this is the finest bake there is" } else { "finer bakes hardly help" };
        let worst = verdict.worst.as_ref().map_or_else(String::new, |worst| blamed(worst));
        eprintln!("warning: {name}: error {error:.3} is over --target-error {target}, and {why}{worst}");
        Ok((error, Outcome::Missed))
    }
}

fn blamed(worst: &Worst) -> String {
    let [x, y, z] = worst.place;
    let share = (100.0 * worst.share).min(100.0);
    let name = plain(&worst.material);
    format!("; {share:.0}% of its square is on material {name:?}, most of that around {x:.2}, {y:.2}, {z:.2}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use rebounce::scene;

    #[test]
    fn without_camera_or_light_nothing_can_be_measured() {
        let mut scene = scene::load("builtin:two-rooms").unwrap();
        let aim = |scene: &Scene, shot| Aim::new(0.1, shot, "rooms.glb", scene);
        assert!(aim(&scene, None).unwrap().is_some());
        scene.lights.clear();
        assert!(aim(&scene, None).unwrap().is_none());
        assert!(aim(&scene, Some(Path::new("no/such.json"))).is_err());
    }

    #[test]
    fn blame_is_in_words() {
        let worst = Worst { material: "cloth".into(), share: 0.414, place: [1.0, 2.5, -0.104] };
        let said = blamed(&worst);
        assert!(
            said.contains("41% of its square is on material \"cloth\"") && said.contains("1.00, 2.50, -0.10")
        );
    }
}
