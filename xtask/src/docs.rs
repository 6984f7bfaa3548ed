//! `cargo xtask docs`: checks the documentation. Relative links lead to files and headings that are there, prose keeps to
//! 100 columns, and every decision is in the index. In comments of the code no text is indented like code without a fence:
//! it would be compiled as an example.

use crate::{process, sources};
use anyhow::{Context, Result, bail};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Maximum length of a line of prose, characters.
const COLUMNS: usize = 100;
/// Folders without documentation of this repository.
const SKIPPED: [&str; 5] = ["target", "node_modules", ".git", "pkg", "dist"];

/// Checks all Markdown files.
///
/// # Errors
/// If a file cannot be read, or breaks a rule.
pub fn run() -> Result<()> {
    let root = process::root();
    let mut files = Vec::new();
    list(&root, &mut files)?;
    let mut faults = Vec::new();
    for file in &files {
        let text = std::fs::read_to_string(file).with_context(|| file.display().to_string())?;
        let name = file.strip_prefix(&root).unwrap_or(file).display().to_string();
        faults.extend(wide(&text).map(|line| format!("{name}:{line}: over {COLUMNS} columns")));
        faults.extend(dead_links(file, &text).into_iter().map(|link| format!("{name}: dead link {link}")));
    }
    faults.extend(unlisted(&root.join("docs/decisions"))?);
    for file in sources::all_files()? {
        let text = std::fs::read_to_string(&file).with_context(|| file.display().to_string())?;
        let name = file.strip_prefix(&root).unwrap_or(&file).display().to_string();
        let fault =
            |line| format!("{name}:{line}: an indented block is an example to rustdoc: write ```text");
        faults.extend(indented(&text).into_iter().map(fault));
    }
    if !faults.is_empty() {
        bail!("documentation:\n  {}", faults.join("\n  "));
    }
    println!("{} pages of documentation", files.len());
    Ok(())
}

fn list(folder: &Path, files: &mut Vec<PathBuf>) -> Result<()> {
    let entries = std::fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    let mut paths: Vec<PathBuf> = entries.map(|entry| Ok(entry?.path())).collect::<Result<_>>()?;
    paths.sort();
    for path in paths {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let is_link = path.symlink_metadata().is_ok_and(|file| file.is_symlink());
        if path.is_dir() && !is_link && !SKIPPED.contains(&name.as_str()) && !name.starts_with("target") {
            list(&path, files)?;
        } else if name.ends_with(".md") {
            files.push(path);
        }
    }
    Ok(())
}

/// Lines of doc comments with indented blocks: four spaces or more after an empty line, outside of fences.
fn indented(text: &str) -> Vec<usize> {
    let comment = |line: &str| {
        let line = line.trim_start();
        let content = line.strip_prefix("//!").or_else(|| line.strip_prefix("///"));
        content.unwrap_or("code").to_owned()
    };
    let comments = text.lines().map(comment).collect::<Vec<_>>().join("\n");
    let lines: Vec<_> = prose(&comments).collect();
    let is_block = |pair: &&[(usize, &str)]| pair[0].1.trim().is_empty() && pair[1].1.starts_with("     ");
    lines.windows(2).filter(is_block).map(|pair| pair[1].0).collect()
}

/// Lines of prose, without code blocks, of a text.
fn prose(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut is_code = false;
    text.lines().enumerate().filter_map(move |(i, line)| {
        let is_fence = line.trim_start().starts_with("```");
        is_code ^= is_fence;
        (!is_code && !is_fence).then_some((i + 1, line))
    })
}

/// Numbers of prose lines that are too long. A table's row, and a line of a single word, cannot be
/// broken.
fn wide(text: &str) -> impl Iterator<Item = usize> {
    let is_whole = |line: &str| {
        let line = line.trim_start_matches([' ', '*', '-']);
        line.starts_with('|') || line.starts_with("![") || line.starts_with('<') || !line.contains(' ')
    };
    prose(text).filter(move |(_, line)| columns(line) > COLUMNS && !is_whole(line)).map(|(i, _)| i)
}

/// Length of a line, characters, without the targets of links.
fn columns(line: &str) -> usize {
    let mut parts = line.split("](");
    let first = parts.next().unwrap_or_default();
    let rest = parts.map(|part| part.split_once(')').map_or(part, |(_, rest)| rest).chars().count() + 1);
    first.chars().count() + rest.sum::<usize>()
}

/// Targets of relative links, without those to the network.
fn links(text: &str) -> Vec<String> {
    let mut links = Vec::new();
    for (_, line) in prose(text) {
        for (at, _) in line.match_indices("](") {
            let rest = &line[at + 2..];
            let end = rest.find([')', ' ']).unwrap_or(rest.len());
            let link = &rest[..end];
            if !link.contains("://") && !link.starts_with("mailto:") && !link.is_empty() {
                links.push(link.to_owned());
            }
        }
    }
    links
}

/// Links of a file that lead nowhere.
fn dead_links(file: &Path, text: &str) -> Vec<String> {
    let folder = file.parent().unwrap_or(file);
    let is_dead = |link: &String| {
        let (path, heading) = link.split_once('#').unwrap_or((link, ""));
        let target = if path.is_empty() { file.to_owned() } else { folder.join(path) };
        if !target.exists() {
            return true;
        }
        let is_page = target.extension().is_some_and(|extension| extension == "md");
        let page = std::fs::read_to_string(&target).unwrap_or_default();
        !heading.is_empty() && is_page && !anchors(&page).contains(heading)
    };
    links(text).into_iter().filter(is_dead).collect()
}

/// Anchors of the headings of a page, as GitHub makes them.
fn anchors(page: &str) -> BTreeSet<String> {
    let heading = |line: &str| {
        let title = line.trim_start_matches('#').trim().to_lowercase();
        let kept = title.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
        kept.map(|c| if c == ' ' { '-' } else { c }).collect()
    };
    prose(page).filter(|(_, line)| line.starts_with('#')).map(|(_, line)| heading(line)).collect()
}

/// Decisions that the index does not link.
fn unlisted(folder: &Path) -> Result<Vec<String>> {
    let index = std::fs::read_to_string(folder.join("README.md")).context("docs/decisions/README.md")?;
    let listed: BTreeSet<String> = links(&index).into_iter().collect();
    let mut files = Vec::new();
    list(folder, &mut files)?;
    let names = files.iter().filter_map(|file| Some(file.file_name()?.to_string_lossy().into_owned()));
    let missing = names.filter(|name| name != "README.md" && !listed.contains(name));
    Ok(missing.map(|name| format!("docs/decisions/README.md does not list {name}")).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_prose_is_found_and_what_cannot_be_broken_is_not() {
        let long = "word ".repeat(30);
        let text =
            format!("short\n{long}\n```\n{long}\n```\n| {long} |\n![{long}](a.png)\n{}", "x".repeat(150));
        assert_eq!(wide(&text).collect::<Vec<_>>(), [2]);
    }

    #[test]
    fn indented_blocks_of_comments_are_found_and_fenced_ones_and_lists_are_not() {
        let text = "/// A.\n///\n///     a = b\n/// ```text\n///\n///     a\n/// ```\n/// - c\n///     d\n";
        assert_eq!(indented(text), [3]);
    }

    #[test]
    fn links_are_those_to_files() {
        let text = "[a](b.md#c) ![d](e.png) [f](https://example.com) `[g](h)`\n```\n[i](j)\n```\n";
        assert_eq!(links(text), ["b.md#c", "e.png", "h"]);
        let page = "# One: two, three\n## `four` (Eq. 6)\n";
        assert!(anchors(page).contains("one-two-three") && anchors(page).contains("four-eq-6"));
    }
}
