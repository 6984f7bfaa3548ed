//! `rebounce bake --target-error`: compares every bake with a path-traced reference; a finer bake follows if needed.

use crate::picture::{Rows, shot_or_own};
use anyhow::{Context, Result};
use rebounce::bake::aim::is_worth_another;
use rebounce::bake::judge::{Judge, Worst};
use rebounce::scene::{Scene, emissive_groups};
use rebounce::verify::compare::uncertainty::{Answer, ErrorEstimate};
use rebounce_args::escape::escape_controls;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::shot::Shot;

/// Target error, path-traced reference, and measured errors.
pub struct Aim<'a> {
    target: f64,
    judge: Judge<'a>,
    /// Error of each bake; an upper bound if noise hides the error.
    errors: Vec<f64>,
}

/// Decimals of errors.
const DECIMALS: usize = 3;

/// Result of measuring a bake's error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Within the target.
    Met,
    /// Over the target; a finer bake may help.
    Finer,
    /// Over the target, and the last bake.
    Missed,
    /// The last bake; noise hides whether the error is over the target.
    TooNoisy,
}

/// Reason why no finer bake follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopReason {
    /// A finer bake follows.
    No,
    /// The bake is the finest.
    Finest,
    /// A finer bake would exceed the budget.
    Budget,
}

/// Returns the shot for measuring: `given`, or the scene's first camera and lights, shining surfaces among them; `None` if
/// the scene lacks camera or light.
///
/// # Errors
/// If `given` is unusable.
pub fn shot_for(given: Option<Shot>, spec: &str, scene: &Scene) -> Result<Option<Shot>> {
    let is_given = given.is_some();
    match shot_or_own(given, spec, &scene.cameras, &scene.all_lights().0) {
        Ok(mut shot) => {
            let names: Vec<String> = emissive_groups(scene).into_iter().map(|group| group.name).collect();
            shot.resolve_groups(&names).map_err(anyhow::Error::msg).context("--shot")?;
            Ok(Some(shot))
        }
        Err(error) if is_given => Err(error),
        Err(error) => {
            eprintln!("note: {error}; the preset is taken that is made for the error, which is not measured");
            Ok(None)
        }
    }
}

impl<'a> Aim<'a> {
    /// Path traces the reference, and prints a message.
    ///
    /// # Errors
    /// If the shot shows no bounced light.
    pub fn new(target: f64, scene: &'a Scene, shot: &'a Shot, bounces: Option<u32>) -> Result<Self> {
        eprintln!("path tracing the view that --target-error is measured in");
        let rows = Rows::new(Judge::rows(shot));
        let judge = Judge::new(scene, shot, bounces, || rows.done()).context("--target-error")?;
        rows.finish();
        Ok(Self { target, judge, errors: Vec::new() })
    }

    /// Measures a bake, prints the result, and returns the error. Adds samples to the reference while noise hides the
    /// answer.
    ///
    /// # Errors
    /// If the file cannot be measured.
    pub fn measure(
        &mut self,
        baked: &BakedScene,
        name: &str,
        last: StopReason,
    ) -> Result<(ErrorEstimate, Outcome)> {
        let target = self.target;
        let picture = self.judge.picture(baked).context("--target-error")?;
        let sampling_on = |judge: &Judge, error: &ErrorEstimate| {
            let (said, samples) = (error.said(DECIMALS), judge.samples());
            eprintln!(
                "{name}: {said}, which may be over {target}: path tracing goes on, from {samples} samples a pixel to {}",
                2 * samples
            );
            let rows = Rows::new(Judge::rows(judge.shot()));
            move || rows.done()
        };
        let (answer, verdict) = self.judge.answer(&picture, target, sampling_on).context("--target-error")?;
        let error = verdict.comparison.error;
        let said = error.said(DECIMALS);
        self.errors.push(error.figure());
        if answer == Answer::Within {
            eprintln!("{name}: {said}; at most {target} was wanted");
            return Ok((error, Outcome::Met));
        }
        let (is, outcome) = match answer {
            Answer::TooNoisy => ("may be over", Outcome::TooNoisy),
            _ => ("is over", Outcome::Missed),
        };
        if last == StopReason::No && is_worth_another(&self.errors) {
            eprintln!("{name}: {said}, which {is} {target}; a finer bake follows");
            return Ok((error, Outcome::Finer));
        }
        let why = match last {
            StopReason::No => "finer bakes hardly help",
            StopReason::Finest => "this is the finest bake there is",
            StopReason::Budget => "a finer one would be over --max-bytes or --max-memory",
        };
        let worst = match (answer, &verdict.worst) {
            (Answer::Over, Some(worst)) => blamed(worst),
            _ => String::new(),
        };
        eprintln!("warning: {name}: {said}, which {is} --target-error {target}, and {why}{worst}");
        Ok((error, outcome))
    }

    /// Whether the last bake has the smallest error so far.
    pub fn is_best(&self) -> bool {
        let best = self.errors.iter().copied().reduce(f64::min);
        self.errors.last().copied() == best
    }
}

fn blamed(worst: &Worst) -> String {
    let [x, y, z] = worst.place;
    let share = (100.0 * worst.share).min(100.0);
    let name = match &worst.material {
        (number, name) if name.is_empty() => format!("material {number}, which has no name"),
        (_, name) => format!("material {:?}", escape_controls(name)),
    };
    format!("; {share:.0}% of its square is on {name}, most of that around {x:.2}, {y:.2}, {z:.2}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use rebounce_shared::light::Light;

    #[test]
    fn without_camera_or_light_nothing_can_be_measured() {
        let mut scene = rebounce::io::load("builtin:two-rooms").unwrap();
        let shot = |scene: &Scene| shot_for(None, "rooms.glb", scene);
        assert!(shot(&scene).unwrap().is_some());
        scene.lights.clear();
        assert!(shot(&scene).unwrap().is_none());
        // Surfaces that shine are light.
        scene.materials[0].emission = [1.0; 3];
        assert!(matches!(shot(&scene).unwrap().unwrap().lights[..], [Light::Emissive { group: 0, .. }]));
    }

    #[test]
    fn blame_is_in_words() {
        let worst = Worst { material: (3, "cloth".into()), share: 0.414, place: [1.0, 2.5, -0.104] };
        let said = blamed(&worst);
        let unnamed = blamed(&Worst { material: (3, String::new()), ..worst });
        assert!(unnamed.contains("is on material 3, which has no name"), "{unnamed}");
        assert!(
            said.contains("41% of its square is on material \"cloth\"") && said.contains("1.00, 2.50, -0.10")
        );
    }
}
