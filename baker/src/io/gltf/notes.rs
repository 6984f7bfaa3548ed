//! Notes about a file, with similar notes grouped.

use std::collections::{BTreeMap, BTreeSet};

/// Notes from reading a file.
#[derive(Debug, Default)]
pub(super) struct Told {
    /// Parts of the file that are left out.
    pub left_out: Vec<String>,
    /// Parts of the file that are read differently from the file's text or are likely mistakes.
    pub notes: Vec<String>,
}

/// Maximum number of similar notes on lines of their own.
const FEW: usize = 3;

/// Removes duplicate notes, in the order of first appearance. Notes with equal text after the last colon become a
/// single line with the first names and a count, if more than `FEW`.
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
