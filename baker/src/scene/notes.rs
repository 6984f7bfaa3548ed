//! What is said about a file besides its scene, alike notes together.

use std::collections::{BTreeMap, BTreeSet};

/// What is said while a file is read.
#[derive(Debug, Default)]
pub(super) struct Told {
    /// What of the file is not taken over.
    pub left_out: Vec<String>,
    /// What is taken over otherwise than it is written, or is likely not meant.
    pub notes: Vec<String>,
}

/// Alike notes that are said one by one.
const FEW: usize = 3;

/// Notes, each once, in the order of their first appearance. Those with the same end after their last colon are one line
/// with a count and the first of them, if there are more than a few.
pub(super) fn grouped(notes: Vec<String>) -> Vec<String> {
    let mut seen = BTreeSet::new();
    let mut places: BTreeMap<&str, usize> = BTreeMap::new();
    let mut kinds: Vec<(&str, Vec<&str>)> = Vec::new();
    for note in notes.iter().filter(|note| seen.insert(note.as_str())) {
        let (name, what) = note.rsplit_once(": ").unwrap_or(("", note));
        let place = *places.entry(what).or_insert_with(|| {
            kinds.push((what, Vec::new()));
            kinds.len() - 1
        });
        kinds[place].1.push(name);
    }
    let lines = kinds.into_iter().flat_map(|(what, names)| {
        let one = |name: &&str| if name.is_empty() { what.to_owned() } else { format!("{name}: {what}") };
        if names.len() <= FEW {
            return names.iter().map(one).collect();
        }
        let (first, more) = (names[..FEW].join(", "), names.len() - FEW);
        vec![format!("{first} and {more} more ({} in all): {what}", names.len())]
    });
    lines.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ten_alike_are_one_line_with_a_count() {
        let mut notes = Vec::new();
        for i in 0..10 {
            notes.push(format!("mesh {i}: it is odd"));
            notes.push("the file is odd in its own way".to_owned());
            notes.push(format!("lamp {}: it is dark", i % 2));
        }
        assert_eq!(
            grouped(notes),
            [
                "mesh 0, mesh 1, mesh 2 and 7 more (10 in all): it is odd",
                "the file is odd in its own way",
                "lamp 0: it is dark",
                "lamp 1: it is dark",
            ]
        );
    }
}
