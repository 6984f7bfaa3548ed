//! The options of `rebounce bake` as data, from the same table as the help: for callers that are programs.

use crate::bake::BakeArgs;
use clap::{ArgAction, Args, Command, ValueHint};
use serde::Serialize;

/// An option.
#[derive(Clone, Debug, Serialize)]
pub struct OptionEntry {
    /// Name, without the dashes: `max-bytes`.
    pub name: String,
    /// What it does; its first sentences are those of the short help.
    pub help: String,
    /// What its value is called in the help: `BYTES`; empty if the option has no value.
    pub value: String,
    /// Permitted values, if there are few.
    pub choices: Vec<String>,
    /// Whether the value is a path.
    pub is_path: bool,
    /// Whether the option may be given several times.
    pub is_repeated: bool,
    /// Separator of several values of one option, as in `16,64`.
    pub separator: Option<char>,
}

/// Returns the options, in the order of the help.
pub fn options() -> Vec<OptionEntry> {
    let mut command = BakeArgs::augment_args(Command::new("bake"));
    command.build();
    let options = command.get_arguments().filter(|arg| arg.get_long().is_some() && arg.get_id() != "help");
    options.map(entry).collect()
}

fn entry(arg: &clap::Arg) -> OptionEntry {
    let help = arg.get_long_help().or(arg.get_help()).map(ToString::to_string).unwrap_or_default();
    let has_value = arg.get_action().takes_values();
    let value = arg.get_value_names().and_then(|names| names.first()).map(ToString::to_string);
    OptionEntry {
        name: arg.get_long().unwrap_or_default().to_owned(),
        help,
        value: value.filter(|_| has_value).unwrap_or_default(),
        choices: match has_value {
            true => arg.get_possible_values().iter().map(|value| value.get_name().to_owned()).collect(),
            false => Vec::new(),
        },
        is_path: matches!(arg.get_value_hint(), ValueHint::AnyPath | ValueHint::FilePath),
        is_repeated: matches!(arg.get_action(), ArgAction::Append) && arg.get_value_delimiter().is_none(),
        separator: arg.get_value_delimiter(),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]
mod tests {
    use super::*;

    #[test]
    fn the_table_has_flags_choices_paths_lists_and_every_option_its_help() {
        let options = options();
        let of = |name: &str| options.iter().find(|option| option.name == name).unwrap();
        assert_eq!(of("preset").choices, ["draft", "standard", "fine"]);
        assert_eq!((of("no-sources").value.as_str(), of("max-bytes").value.as_str()), ("", "BYTES"));
        assert_eq!((of("still").value.as_str(), of("time").value.as_str()), ("", "SECONDS"));
        assert!(of("environment").is_path && of("shot").is_path && !of("preset").is_path);
        assert!(of("viewpoint").is_repeated && !of("rays").is_repeated);
        assert_eq!(of("rays").separator, Some(','));
        assert!(options.iter().all(|option| option.help.len() > 10), "{options:?}");
    }
}
