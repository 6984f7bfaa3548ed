//! Planned bakes: settings within the budget.

use crate::bake::BakeArgs;
use crate::error::ArgsError;
use rebounce::bake::budget::{self, Budget, Thinned};
use rebounce::bake::{BakeSettings, aim};
use rebounce::scene::Scene;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::camera::Camera;

/// Plan of a single bake.
pub struct Plan {
    /// Settings within the budget.
    pub settings: BakeSettings,
    /// Number of functions, if lowered by the budget.
    pub fewer: Option<usize>,
}

impl Plan {
    /// Plans a bake with `settings`, or with fewer functions. `is_judged`: the bake is measured.
    ///
    /// # Errors
    /// If the scene by itself exceeds the budget.
    fn new(
        args: &BakeArgs,
        scene: &Scene,
        mut settings: BakeSettings,
        is_judged: bool,
    ) -> Result<Self, ArgsError> {
        let budget = Budget { bytes: args.max_bytes, memory: args.max_memory, is_judged };
        let fewer = budget::plan(scene, &mut settings, &budget)
            .map_err(|source| ArgsError::Budget { scene: args.scene.clone(), source })?;
        Ok(Self { settings, fewer })
    }

    /// Says how the budget lowered the number of functions, if it did.
    pub fn note(&self) -> Option<String> {
        let functions = self.fewer?;
        Some(format!("about {functions} functions on the finest level, to keep within the budget"))
    }

    /// Plans the requested bake, without a target error.
    ///
    /// # Errors
    /// If the bake cannot fit the budget.
    pub fn asked_for(args: &BakeArgs, scene: &Scene, camera: Option<&Camera>) -> Result<Self, ArgsError> {
        Self::new(args, scene, args.settings(args.preset()?, camera), false)
    }

    /// Plans successively finer bakes, tried in order until a bake is within the target.
    ///
    /// # Errors
    /// If the first bake cannot fit the budget.
    pub fn tries(args: &BakeArgs, scene: &Scene, camera: Option<&Camera>) -> Result<Vec<Self>, ArgsError> {
        let mut plans = Vec::new();
        for settings in aim::tries(|preset| args.settings(preset, camera)) {
            let plan = Self::new(args, scene, settings, true)?;
            // Later plans would be lowered to an equal number of functions.
            let is_last = plan.fewer.is_some();
            plans.push(plan);
            if is_last {
                break;
            }
        }
        Ok(plans)
    }
}

/// Removes links until the file is within `--max-bytes`; `note` receives how many.
///
/// # Errors
/// If the file without links is over the budget.
pub fn thin(
    args: &BakeArgs,
    baked: &mut BakedScene,
    note: &mut dyn FnMut(&str),
) -> Result<Option<Thinned>, ArgsError> {
    let Some(bytes) = args.max_bytes else { return Ok(None) };
    let thinned = budget::fit(baked, bytes)
        .map_err(|source| ArgsError::Budget { scene: args.scene.clone(), source })?;
    if let Some(Thinned { before, after }) = thinned {
        note(&format!("{after} of {before} links are left, to keep within the budget"));
    }
    Ok(thinned)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]
mod tests {
    use super::*;
    use clap::Parser;
    use rebounce::bake::Preset;

    #[derive(Parser)]
    struct CommandLine {
        #[command(flatten)]
        args: BakeArgs,
    }

    fn told(words: &[&str]) -> BakeArgs {
        let words = ["bake", "builtin:two-rooms-door"].iter().chain(words);
        CommandLine::try_parse_from(words).unwrap().args
    }

    #[test]
    fn a_target_is_tried_for_with_ever_more_functions_and_within_the_budget() {
        let args = told(&["--target-error", "0.1", "--bounces", "2"]);
        let scene = rebounce::io::load(&args.scene).unwrap();
        let plans = Plan::tries(&args, &scene, None).unwrap();
        assert!(plans.len() > 3 && plans[0].settings.preset == Preset::Draft);
        assert!(plans.iter().all(|plan| plan.settings.operator.bounces == Some(2) && plan.fewer.is_none()));
        let args = told(&["--target-error", "0.1", "--max-bytes", "4M"]);
        let plans = Plan::tries(&args, &scene, None).unwrap();
        // The last plan has the functions that fit the budget.
        assert!(plans.len() == 2 && plans[0].fewer.is_none(), "{}", plans.len());
        assert_eq!(plans[1].fewer, Some(plans[1].settings.place.functions));
        assert!(Plan::asked_for(&told(&["--max-bytes", "1K"]), &scene, None).is_err());
    }
}
