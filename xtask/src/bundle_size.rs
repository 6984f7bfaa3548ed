//! Sizes of the package's wasm and JavaScript after gzip, held to limits.

use crate::web::{self, Purpose, is_of_baker, is_of_radiosity, is_of_three};
use anyhow::{Result, bail};
use flate2::{Compression, write::GzEncoder};
use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;

/// The module that pages import.
const ENTRY: &str = "rebounce-viewer.js";
/// Limit of what a page loads to show a file, after gzip, bytes: the entry, what it imports, and the wasm file.
const FIRST_LOAD: usize = 200_000;
/// Limit of the baker, which is fetched when a page bakes, after gzip, bytes.
const BAKER: usize = 1_110_000;
/// Limit of the baker that reads STEP files, which is fetched when a page bakes one, after gzip, bytes.
const BAKER_STEP: usize = 1_310_000;
/// Limit of the renderer of all files, after gzip, bytes.
const RADIOSITY: usize = 330_000;
/// Limit of the program for three.js, after gzip, bytes.
const THREE: usize = 250_000;
/// Limit of a module that is loaded when first wanted, with what only it imports, after gzip, bytes.
const ON_DEMAND: usize = 20_000;

/// Prints sizes, raw and after gzip, and checks them against the limits, as far as the modules are to be published.
///
/// # Errors
/// If code is over its limit.
pub fn check(files: &BTreeMap<String, Vec<u8>>, purpose: Purpose) -> Result<()> {
    let first = imported(files, ENTRY);
    let is_first = |name: &str| {
        let is_later = is_of_baker(name) || is_of_three(name) || is_of_radiosity(name);
        first.contains(name) || (name.ends_with(".wasm") && !is_later)
    };
    println!("{:34} {:>9} {:>9}", "bytes", "raw", "gzip");
    let mut sum = 0;
    let mut over = Vec::new();
    for wanted in [true, false] {
        for (name, bytes) in files.iter().filter(|(name, _)| web::is_code(name) && is_first(name) == wanted) {
            let size = gzip(bytes)?;
            println!("{name:34} {:9} {size:9}{}", bytes.len(), if wanted { "" } else { "  on demand" });
            if wanted {
                sum += size;
                continue;
            }
            let limit = match name.ends_with(".wasm") {
                true if is_of_three(name) => THREE,
                true if is_of_radiosity(name) => RADIOSITY,
                true if name.starts_with(web::BAKER_STEP) => BAKER_STEP,
                true => BAKER,
                false => ON_DEMAND,
            };
            if size > limit {
                over.push(format!("{name} is {size} bytes, more than the {limit} allowed"));
            }
        }
        if wanted {
            println!("{:34} {:9} {sum:9}", "loaded to show a file", "");
        }
    }
    if sum > FIRST_LOAD {
        over.push(format!(
            "what a page loads to show a file is {sum} bytes, more than the {FIRST_LOAD} allowed"
        ));
    }
    if purpose == Purpose::Publish && !over.is_empty() {
        bail!("after gzip, {}", over.join("; "));
    }
    Ok(())
}

fn gzip(bytes: &[u8]) -> Result<usize> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes)?;
    Ok(encoder.finish()?.len())
}

/// The module and all modules that it imports, directly or not; without those of `import()`.
fn imported(files: &BTreeMap<String, Vec<u8>>, entry: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut left = vec![entry.to_owned()];
    while let Some(name) = left.pop() {
        let text = files.get(&name).map(|bytes| String::from_utf8_lossy(bytes)).unwrap_or_default();
        let names = ["from\"./", "import\"./"].into_iter().flat_map(|before| text.split(before).skip(1));
        left.extend(names.filter_map(|rest| Some(rest.split_once('"')?.0.to_owned())));
        left.retain(|other| other != &name && !found.contains(other));
        found.insert(name);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn files() -> BTreeMap<String, Vec<u8>> {
        let file = |name: &str, text: &str| (name.to_owned(), text.as_bytes().to_vec());
        BTreeMap::from([
            file(ENTRY, r#"import{a}from"./b.js";import"./c.js";const d=()=>import("./d.js");"#),
            file("b.js", r#"export{a}from"./c.js";"#),
            file("c.js", r#"import"./b.js";"#),
            file("d.js", ""),
        ])
    }

    #[test]
    fn what_is_imported_counts_and_what_is_fetched_later_does_not() {
        let first: Vec<String> = imported(&files(), ENTRY).into_iter().collect();
        assert_eq!(first, ["b.js", "c.js", ENTRY]);
    }

    #[test]
    fn code_over_a_limit_is_refused_by_name() {
        // Bytes that gzip cannot shorten: a linear congruential generator's.
        let mut state = 1u64;
        let mut noise = |count: usize| -> Vec<u8> {
            let mut next = || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                (state >> 56) as u8
            };
            (0..count).map(|_| next()).collect()
        };
        let mut all = files();
        check(&all, Purpose::Publish).unwrap();
        all.insert("d.js".to_owned(), noise(2 * ON_DEMAND));
        assert!(check(&all, Purpose::Publish).unwrap_err().to_string().contains("d.js"));
        let mut all = files();
        all.insert("a.wasm".to_owned(), noise(2 * FIRST_LOAD));
        assert!(check(&all, Purpose::Publish).unwrap_err().to_string().contains("to show a file"));
    }
}
