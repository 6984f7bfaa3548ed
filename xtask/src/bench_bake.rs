//! `cargo xtask bench-bake`: time of a bake against the time of its rays alone, and the speed-up by a second
//! thread.

use crate::fidelity::given_or;
use crate::{process, report};
use anyhow::{Context, Result, bail, ensure};
use std::process::Stdio;

/// Default scene, in the folder of given scenes, and its replacement without the folder.
const SCENES: [&str; 2] = ["sponza-dabrovic/sponza-dabrovic.glb", "builtin:library"];

#[derive(Debug, PartialEq)]
struct Options {
    scene: Option<String>,
    preset: String,
    rounds: u32,
}

fn parse(args: &[String]) -> Result<Options> {
    let mut options = Options { scene: None, preset: "standard".to_owned(), rounds: 3 };
    let mut args = args.iter();
    while let Some(name) = args.next() {
        let mut value = || args.next().with_context(|| format!("{name} needs a value"));
        match name.as_str() {
            "--scene" => options.scene = Some(value()?.clone()),
            "--preset" => options.preset = value()?.clone(),
            "--rounds" => options.rounds = value()?.parse().context("--rounds needs a number")?,
            other => bail!("there is no option {other}; there are --scene, --preset and --rounds"),
        }
    }
    Ok(options)
}

/// Measures; the last line is `traversal ratio R, two threads S`.
///
/// # Errors
/// If a step fails.
pub fn run(args: &[String]) -> Result<()> {
    let options = parse(args)?;
    let scene = match options.scene {
        // The benchmark runs in the crate's folder.
        Some(scene) if !scene.starts_with("builtin:") => std::path::absolute(scene)?.display().to_string(),
        Some(scene) => scene,
        None => given_or(SCENES[0], SCENES[1]),
    };
    let mut command = process::cargo();
    command.args(["bench", "--locked", "--package", "rebounce-benches", "--bench", "bake", "--"]);
    command.args([&scene, &options.preset, &options.rounds.to_string()]);
    let output = command.stdin(Stdio::null()).stderr(Stdio::inherit()).output();
    let output = output.context("the benchmark could not be started")?;
    let said = String::from_utf8_lossy(&output.stdout);
    println!("{said}");
    ensure!(output.status.success(), "the benchmark failed ({})", output.status);
    let name = scene.rsplit(['/', '\\']).next().unwrap_or(&scene);
    let figures = format!("{name}, preset {}.\n\n```\n{}\n```", options.preset, said.trim());
    report::write("bake", "A bake beside its rays", "cargo xtask bench-bake", &figures)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options() {
        let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        let options = parse(&words("--scene a.glb --preset draft --rounds 5")).unwrap();
        assert_eq!(options, Options { scene: Some("a.glb".into()), preset: "draft".into(), rounds: 5 });
        assert_eq!(parse(&[]).unwrap().preset, "standard");
        assert!(parse(&words("--rounds many")).is_err() && parse(&words("hall")).is_err());
    }
}
