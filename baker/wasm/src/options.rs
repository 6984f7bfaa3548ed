//! What a page asks for.

use rebounce::bake::{BakeSettings, BakeSolver, Preset};
use rebounce::io::{GroupOption, LoadOptions};
use serde::Deserialize;

/// Options of a bake, as JSON; all workers of a bake get the same.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct PageOptions {
    /// `draft`, `standard` or `fine`.
    preset: String,
    /// Seed of the random numbers.
    seed: u64,
    /// Functions on the finest level, if not those of the preset.
    functions: Option<usize>,
    /// Whether the file's bounced light is computed by radiosity, and not from links.
    radiosity: bool,
    /// Reconstruction groups: names of nodes and materials, and their densities.
    groups: Vec<(String, f32)>,
    /// Whether previews are shown.
    #[serde(default)]
    pub previews: bool,
}

impl PageOptions {
    /// Reads the options.
    ///
    /// # Errors
    /// A sentence.
    pub fn read(json: &str) -> Result<Self, String> {
        serde_json::from_str(json).map_err(|error| format!("the options of the bake: {error}"))
    }

    /// How the scene is read.
    pub fn load_options(&self) -> LoadOptions {
        let group = |(name, density): &(String, f32)| GroupOption { name: name.clone(), density: *density };
        LoadOptions {
            all_nodes_move: self.radiosity,
            groups: self.groups.iter().map(group).collect(),
            ..LoadOptions::default()
        }
    }

    /// Returns the settings of the bake.
    ///
    /// # Errors
    /// A sentence, for a preset that does not exist.
    pub fn settings(&self) -> Result<BakeSettings, String> {
        let presets = [Preset::Draft, Preset::Standard, Preset::Fine];
        let preset = presets.into_iter().find(|preset| preset.name() == self.preset);
        let preset = preset.ok_or_else(|| {
            format!("there is no preset {:?}: use \"draft\", \"standard\" or \"fine\"", self.preset)
        })?;
        let mut settings = BakeSettings::new(preset);
        if self.radiosity {
            settings.solver = BakeSolver::Radiosity;
        }
        settings.place.seed = self.seed;
        settings.operator.seed = self.seed;
        settings.sources.seed = self.seed;
        if let Some(functions) = self.functions {
            settings.place.functions = functions;
        }
        Ok(settings)
    }
}
