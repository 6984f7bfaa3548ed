//! `damage FOLDER COUNT SEED`: writes COUNT damaged files, `list.json` with a description of the damage, the original
//! file, two files with markup as names, and a file with a greatly overstated texture size. Run by
//! `cargo xtask damage` and by the tests of the page.

use anyhow::{Context, Result};
use rebounce_tests::damage::{Outcome, damage};
use rebounce_tests::small::{everything, named};
use std::path::PathBuf;

/// A name that runs a script in a page that interprets the name as markup.
const NAME: &str = "<img src=x onerror=\"globalThis.markup='run'\">";

fn main() -> Result<()> {
    let mut args = std::env::args().skip(1);
    let mut next = || args.next().context("usage: damage FOLDER COUNT SEED");
    let (folder, count, seed) = (PathBuf::from(next()?), next()?.parse::<u64>()?, next()?.parse::<u64>()?);
    std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    let write = |name: &str, bytes: &[u8]| {
        std::fs::write(folder.join(name), bytes).with_context(|| folder.join(name).display().to_string())
    };
    let scene = everything(300)?;
    let file = scene.to_bytes()?;
    write("whole.rbn", &file)?;
    let mut markup = named(&scene, NAME);
    write("names.rbn", &markup.to_bytes()?)?;
    // The error message of an undecodable texture contains its name.
    markup.texture_bytes.fill(0);
    write("broken-texture.rbn", &markup.to_bytes()?)?;
    // A picture of four pixels with the maximum width in its metadata.
    let mut claims = scene.clone();
    claims.meta.textures.iter_mut().for_each(|texture| texture.width = u32::MAX);
    write("large-claim.rbn", &claims.to_bytes()?)?;
    // Silences panics: contents that cannot be packed are caught and skipped.
    std::panic::set_hook(Box::new(|_| ()));
    let mut list = Vec::new();
    for index in 0..count {
        let made = damage(&file, &scene, seed, index);
        let name = format!("{index:05}.rbn");
        write(&name, &made.bytes)?;
        let refused = made.outcome == Outcome::Error;
        list.push(serde_json::json!({ "name": name, "what": made.what, "refused": refused }));
    }
    write("list.json", &serde_json::to_vec(&list)?)?;
    println!("{count} damaged files of {} bytes, seed {seed}, in {}", file.len(), folder.display());
    Ok(())
}
