//! Identity of a job: the inputs of the result.

use serde::{Deserialize, Serialize};

/// All inputs of a result, by name: the program, the scene's contents, the settings. Jobs with equal identities
/// have equal results, to the byte.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    parts: Vec<(String, String)>,
}

impl Identity {
    /// Makes an identity of named inputs.
    pub fn of(parts: Vec<(String, String)>) -> Self {
        Self { parts }
    }

    /// Returns the identity as stored in a file.
    pub fn to_json(&self) -> Vec<u8> {
        serde_json::to_vec(self).unwrap_or_default()
    }

    /// Describes how `self`, found in a file, differs from the requested identity: "functions 3000, not 2000"; `None`
    /// if equal.
    pub fn difference(&self, asked: &Self) -> Option<String> {
        let value = |of: &Self, name: &str| {
            of.parts.iter().find(|part| part.0 == name).map_or("unknown".to_owned(), |part| part.1.clone())
        };
        let names = asked.parts.iter().map(|part| &part.0);
        let differ = names.filter(|name| value(self, name) != value(asked, name));
        let said: Vec<String> =
            differ.map(|name| format!("{name} {}, not {}", value(self, name), value(asked, name))).collect();
        match said.is_empty() {
            true => (self != asked).then(|| "its form is another".to_owned()),
            false => Some(said.join("; ")),
        }
    }
}
