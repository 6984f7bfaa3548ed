//! `cargo xtask layers`: checks the dependencies between modules.
//!
//! Two rules. The top-level modules of the baker ([`BAKER`]) and of the viewer ([`VIEWER`]) are ordered: a module may
//! use only earlier modules. Within every folder of every crate, the dependencies between modules are acyclic. Code
//! under `#[cfg(test)]` is exempt. A path through a re-export of `lib.rs` counts as what it stands for.

use crate::sources::{self, CRATES, is_test};
use anyhow::{Result, bail};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use syn::visit::{self, Visit};

/// The baker's modules in layers: a module may use modules of earlier lines alone. Verification of a bake
/// (`verify`) stands beside `transport`, so that an error there cannot hide itself.
const BAKER: [&[&str]; 14] = [
    &["random"],
    &["morton", "processor", "weld", "job"],
    &["lanes"],
    &["scene"],
    &["demo"],
    &["io"],
    &["geometry"],
    &["light"],
    &["sampling"],
    &["basis"],
    &["transport", "verify"],
    &["bake", "export"],
    &["prelude"],
    &["lib"],
];
/// The viewer's modules in layers. The device knows no scene, a scene no pass, and controls draw nothing.
const VIEWER: [&[&str]; 9] = [
    &["error", "shaders"],
    &["gpu"],
    &["scene"],
    &["probes"],
    &["controls"],
    &["passes"],
    &["renderer"],
    &["wasm"],
    &["lib"],
];
/// A module's path within its crate: `geometry`, `mesh`, `blas`.
type Module = Vec<String>;
/// Dependencies (user, used), each with a file as example.
type Arrows = BTreeMap<(Module, Module), PathBuf>;

/// Checks both rules.
///
/// # Errors
/// If a dependency points backwards, modules form a cycle, or a file cannot be read.
pub fn run() -> Result<()> {
    let mut faults = Vec::new();
    for name in CRATES {
        let source = sources::of(name);
        let arrows = arrows(&source)?;
        faults.extend(circles(&arrows).into_iter().map(|circle| format!("{name}: {circle}")));
        let order: &[&[&str]] = match name {
            "baker" => &BAKER,
            "viewer" => &VIEWER,
            _ => &[],
        };
        if !order.is_empty() {
            faults.extend(backward(&arrows, order));
        }
        println!("{name}: {} arrows between modules", arrows.len());
    }
    if !faults.is_empty() {
        bail!("modules use each other against the order:\n  {}", faults.join("\n  "));
    }
    Ok(())
}

/// Dependencies between the modules of a crate, outside of tests.
fn arrows(source: &Path) -> Result<Arrows> {
    let files = sources::parsed(source)?;
    let modules: BTreeSet<Module> = files.iter().map(|(file, _)| module(source, file)).collect();
    let short = re_exports(source, &files);
    let mut arrows = Arrows::new();
    for (file, parsed) in &files {
        let own = module(source, file);
        let mut uses = Uses { own: own.clone(), found: BTreeSet::new() };
        uses.visit_file(parsed);
        for mut path in uses.found {
            if let Some(whole) = path.first().and_then(|first| short.get(first)) {
                path.splice(..1, whole.iter().cloned());
            }
            // The longest prefix of the path that names a module; the rest of the path is inside the module.
            let used = (1..=path.len()).rev().map(|n| path[..n].to_vec()).find(|part| modules.contains(part));
            if let Some(used) = used.filter(|used| *used != own) {
                arrows.entry((own.clone(), used)).or_insert_with(|| file.clone());
            }
        }
    }
    Ok(arrows)
}

/// Re-exports of `lib.rs`: their names at the crate's root, and what they stand for.
fn re_exports(source: &Path, files: &[(PathBuf, syn::File)]) -> BTreeMap<String, Module> {
    let mut found = BTreeMap::new();
    let root = files.iter().find(|(file, _)| *file == source.join("lib.rs"));
    for item in root.iter().flat_map(|(_, parsed)| &parsed.items) {
        if let syn::Item::Use(item) = item {
            list_names(&[], &item.tree, &mut found);
        }
    }
    found
}

/// Adds the names that a `use` brings, with their whole paths.
fn list_names(before: &[String], tree: &syn::UseTree, found: &mut BTreeMap<String, Module>) {
    let whole = |ident: &syn::Ident| [before, &[ident.to_string()]].concat();
    match tree {
        syn::UseTree::Path(path) => list_names(&whole(&path.ident), &path.tree, found),
        syn::UseTree::Name(name) => drop(found.insert(name.ident.to_string(), whole(&name.ident))),
        syn::UseTree::Rename(name) => drop(found.insert(name.rename.to_string(), whole(&name.ident))),
        syn::UseTree::Group(group) => group.items.iter().for_each(|tree| list_names(before, tree, found)),
        syn::UseTree::Glob(_) => {}
    }
}

/// Module path of a source file.
fn module(source: &Path, file: &Path) -> Module {
    let within = file.strip_prefix(source).unwrap_or(file).with_extension("");
    let mut module: Module = within.iter().map(|part| part.to_string_lossy().into_owned()).collect();
    if module.last().is_some_and(|last| last == "mod") {
        module.pop();
    }
    module
}

/// Collector of the paths used by a file, as modules of the crate.
struct Uses {
    own: Module,
    found: BTreeSet<Module>,
}

impl Uses {
    /// Adds a path, given from its first segment.
    fn take(&mut self, path: &[String]) {
        let Some(first) = path.first() else { return };
        let mut full = match first.as_str() {
            "crate" => Vec::new(),
            "self" | "super" => self.own.clone(),
            _ => return,
        };
        let ups = path.iter().take_while(|part| *part == "super").count();
        full.truncate(full.len().saturating_sub(ups));
        full.extend(path.iter().skip(ups.max(1)).cloned());
        self.found.insert(full);
    }

    fn take_tree(&mut self, before: &mut Vec<String>, tree: &syn::UseTree) {
        match tree {
            syn::UseTree::Path(path) => {
                before.push(path.ident.to_string());
                self.take_tree(before, &path.tree);
                before.pop();
            }
            syn::UseTree::Name(syn::UseName { ident })
            | syn::UseTree::Rename(syn::UseRename { ident, .. }) => {
                before.push(ident.to_string());
                self.take(before);
                before.pop();
            }
            syn::UseTree::Glob(_) => self.take(before),
            syn::UseTree::Group(group) => {
                group.items.iter().for_each(|tree| self.take_tree(before, tree));
            }
        }
    }
}

impl<'ast> Visit<'ast> for Uses {
    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        if !is_test(&item.attrs) {
            visit::visit_item_mod(self, item);
        }
    }

    fn visit_item_fn(&mut self, item: &'ast syn::ItemFn) {
        if !is_test(&item.attrs) {
            visit::visit_item_fn(self, item);
        }
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        // A re-export of a module's own parts is no dependency.
        if !is_test(&item.attrs) {
            self.take_tree(&mut Vec::new(), &item.tree);
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let parts: Vec<String> = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
        self.take(&parts);
        visit::visit_path(self, path);
    }
}

/// Cycles between modules of one folder, with the files of the cycle's dependencies.
fn circles(arrows: &Arrows) -> Vec<String> {
    // Dependencies between siblings, at the first difference of the two paths.
    let mut beside: BTreeMap<Module, BTreeMap<String, BTreeMap<String, &PathBuf>>> = BTreeMap::new();
    for ((from, to), file) in arrows {
        let common = from.iter().zip(to).take_while(|(a, b)| a == b).count();
        if let (Some(a), Some(b)) = (from.get(common), to.get(common)) {
            let folder = beside.entry(from[..common].to_vec()).or_default();
            folder.entry(a.clone()).or_default().entry(b.clone()).or_insert(file);
        }
    }
    let mut found = Vec::new();
    for (folder, graph) in &beside {
        let mut seen = BTreeSet::new();
        for start in graph.keys() {
            let way = circle_from(graph, start);
            let members: BTreeSet<String> = way.iter().cloned().collect();
            if !way.is_empty() && seen.insert(members) {
                let named = |k: usize| {
                    let (a, b) = (&way[k], &way[(k + 1) % way.len()]);
                    format!("{a} → {b} ({})", graph[a][b].display())
                };
                let named: Vec<String> = (0..way.len()).map(named).collect();
                found.push(format!("circle in {}: {}", folder.join("::"), named.join(", ")));
            }
        }
    }
    found
}

/// Shortest cycle through a module; empty without a cycle.
fn circle_from(graph: &BTreeMap<String, BTreeMap<String, &PathBuf>>, start: &String) -> Vec<String> {
    let mut ways = vec![vec![start.clone()]];
    let mut seen = BTreeSet::new();
    while !ways.is_empty() {
        let mut next = Vec::new();
        for way in &ways {
            let Some(onward) = way.last().and_then(|last| graph.get(last)) else { continue };
            for to in onward.keys() {
                if to == start {
                    return way.clone();
                }
                if seen.insert(to.clone()) {
                    next.push([way.as_slice(), std::slice::from_ref(to)].concat());
                }
            }
        }
        ways = next;
    }
    Vec::new()
}

/// Dependencies of a crate's top-level modules against their order.
fn backward(arrows: &Arrows, order: &[&[&str]]) -> Vec<String> {
    let line = |name: &String| order.iter().position(|line| line.contains(&name.as_str()));
    let mut found = BTreeSet::new();
    for ((from, to), file) in arrows {
        let (Some(from), Some(to)) = (from.first(), to.first()) else { continue };
        match (line(from), line(to)) {
            _ if from == to => {}
            (Some(a), Some(b)) if a > b => {}
            (None, _) | (_, None) => {
                found.insert(format!("{from} or {to} has no place in the order: xtask/src/layers.rs"));
            }
            _ => {
                found.insert(format!("{from} may not use {to} ({})", file.display()));
            }
        }
    }
    found.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Dependencies of test modules, given as (file, code).
    fn arrows_of(files: &[(&str, &str)]) -> Arrows {
        let folder = tempfile::tempdir().unwrap();
        for (name, code) in files {
            let file = folder.path().join(name);
            std::fs::create_dir_all(file.parent().unwrap()).unwrap();
            std::fs::write(file, code).unwrap();
        }
        arrows(folder.path()).unwrap()
    }

    #[test]
    fn circles_are_found_and_tests_are_free() {
        let found = circles(&arrows_of(&[
            ("a.rs", "use crate::{b::X, c}; pub struct Y;"),
            ("b/mod.rs", "pub mod d; pub struct X(crate::a::Y);"),
            ("b/d.rs", "use super::X;"),
            ("c.rs", "#[cfg(test)] mod tests { use crate::a::Y; }"),
        ]));
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].contains("a → b") && found[0].contains("b → a"), "{found:?}");
    }

    #[test]
    fn arrows_against_the_order_are_found() {
        let arrows = arrows_of(&[
            ("scene.rs", "fn f() { crate::geometry::cast() }"),
            ("geometry.rs", "use crate::scene::Scene;"),
            ("verify.rs", "use super::transport::T;"),
            ("transport.rs", ""),
        ]);
        let found = backward(&arrows, &BAKER);
        assert_eq!(found.len(), 2, "{found:?}");
        assert!(found[0].starts_with("scene may not use geometry"), "{found:?}");
        assert!(found[1].starts_with("verify may not use transport"), "{found:?}");
    }

    #[test]
    fn a_scene_of_the_viewer_knows_no_pass_by_any_path() {
        let arrows = arrows_of(&[
            ("lib.rs", "pub mod scene; pub mod passes; pub use passes::{settings, shadow as maps};"),
            ("scene/mod.rs", "mod upload;"),
            ("scene/upload.rs", "use crate::maps::Shadows; use super::extent::Extent;"),
            ("scene/extent.rs", ""),
            ("passes/shadow.rs", "use crate::scene::upload::Upload; pub struct Shadows;"),
            ("passes/settings.rs", ""),
            ("renderer.rs", "use crate::settings::Mode;"),
            ("strange.rs", "use crate::scene::upload::Upload;"),
        ]);
        let found = backward(&arrows, &VIEWER);
        assert_eq!(found.len(), 2, "{found:?}");
        assert!(found[0].starts_with("scene may not use passes"), "{found:?}");
        assert!(found[1].starts_with("strange or scene has no place in the order"), "{found:?}");
    }
}
