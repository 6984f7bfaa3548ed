//! `cargo xtask names`: names that the field has no use for, and types that are defined twice.
//!
//! docs/glossary.md has the names to use. Code under `#[cfg(test)]` is free.

use crate::sources::{self, CRATES, is_test};
use anyhow::{Result, bail};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use syn::visit::{self, Visit};

/// Names of types, functions, constants and modules that were replaced by the field's.
const REPLACED: [&str; 38] = [
    "Body",
    "BLIND",
    "FOUND",
    "Journal",
    "Laid",
    "LoadedScene",
    "Look",
    "Meeting",
    "Meetings",
    "Mixes",
    "Outbox",
    "Piece",
    "Pieces",
    "Place",
    "Run",
    "SAID",
    "Seat",
    "Shares",
    "StillLights",
    "Tally",
    "Team",
    "Vantage",
    "Walker",
    "WideBvh",
    "among",
    "blind",
    "body",
    "choose_pooled",
    "find_all",
    "firsts",
    "laid",
    "plain",
    "speaks_now",
    "still",
    "tally",
    "together",
    "vantage",
    "wide",
];
/// Checks the names of all crates.
///
/// # Errors
/// If a replaced name is back, a type is defined twice in a crate, or a file cannot be read.
pub fn run() -> Result<()> {
    let mut faults = Vec::new();
    for name in CRATES {
        let names = names(&sources::of(name))?;
        faults.extend(replaced(&names).into_iter().map(|fault| format!("{name}: {fault}")));
        faults.extend(doubled(&names).into_iter().map(|fault| format!("{name}: {fault}")));
    }
    if !faults.is_empty() {
        bail!("names (docs/glossary.md has those to use):\n  {}", faults.join("\n  "));
    }
    Ok(())
}

/// What a crate defines.
#[derive(Default)]
struct Names {
    /// Types and traits, and the files that define them.
    types: BTreeMap<String, BTreeSet<PathBuf>>,
    /// All items and modules, and a file of each.
    all: BTreeMap<String, BTreeSet<PathBuf>>,
}

/// Names of a crate's items outside of tests.
fn names(source: &Path) -> Result<Names> {
    let mut names = Names::default();
    for (file, parsed) in sources::parsed(source)? {
        Items { names: &mut names, file: &file }.visit_file(&parsed);
    }
    Ok(names)
}

/// Collects the items of one file.
struct Items<'a> {
    names: &'a mut Names,
    file: &'a Path,
}

impl Items<'_> {
    fn add(&mut self, name: &syn::Ident, is_type: bool) {
        let name = name.to_string();
        if is_type {
            self.names.types.entry(name.clone()).or_default().insert(self.file.to_owned());
        }
        self.names.all.entry(name).or_default().insert(self.file.to_owned());
    }
}

impl<'ast> Visit<'ast> for Items<'_> {
    fn visit_item(&mut self, item: &'ast syn::Item) {
        match item {
            syn::Item::Mod(item) if is_test(&item.attrs) => return,
            syn::Item::Mod(item) => self.add(&item.ident, false),
            syn::Item::Struct(item) => self.add(&item.ident, true),
            syn::Item::Enum(item) => self.add(&item.ident, true),
            syn::Item::Trait(item) => self.add(&item.ident, true),
            syn::Item::Type(item) => self.add(&item.ident, true),
            syn::Item::Union(item) => self.add(&item.ident, true),
            syn::Item::Const(item) => self.add(&item.ident, false),
            syn::Item::Static(item) => self.add(&item.ident, false),
            syn::Item::Fn(item) => self.add(&item.sig.ident, false),
            _ => {}
        }
        visit::visit_item(self, item);
    }

    fn visit_impl_item_fn(&mut self, item: &'ast syn::ImplItemFn) {
        self.add(&item.sig.ident, false);
    }

    fn visit_trait_item_fn(&mut self, item: &'ast syn::TraitItemFn) {
        self.add(&item.sig.ident, false);
    }
}

/// Replaced names that are in use.
fn replaced(names: &Names) -> Vec<String> {
    let files = |name: &&str| names.all.get(*name).map(|files| (name.to_string(), files));
    REPLACED
        .iter()
        .filter_map(files)
        .flat_map(|(name, files)| files.iter().map(move |file| (name.clone(), file)))
        .map(|(name, file)| format!("`{name}` was replaced ({})", file.display()))
        .collect()
}

/// Types that several files define.
fn doubled(names: &Names) -> Vec<String> {
    let several = names.types.iter().filter(|(_, files)| files.len() > 1);
    several
        .map(|(name, files)| {
            let files: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
            format!("`{name}` is defined in {}", files.join(" and "))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replaced_and_doubled_names_are_found() {
        let folder = tempfile::tempdir().unwrap();
        for (name, code) in [
            ("a.rs", "mod together {} struct Kind; impl Kind { fn find_all(&self) {} }"),
            ("b.rs", "#[cfg(test)] mod tests { struct Walker; } fn f() { enum Kind {} }"),
        ] {
            std::fs::write(folder.path().join(name), code).unwrap();
        }
        let names = names(folder.path()).unwrap();
        let found = replaced(&names);
        assert!(
            found.len() == 2 && found[0].contains("find_all") && found[1].contains("together"),
            "{found:?}"
        );
        let found = doubled(&names);
        assert!(found.len() == 1 && found[0].starts_with("`Kind`"), "{found:?}");
    }
}
