//! `cargo xtask bench-scale`: bake times of a scene with increasing numbers of triangles at equal settings. The
//! time of a bake should grow with the complexity of the light, not with the triangles.

use crate::fidelity::given_or;
use crate::{process, report};
use anyhow::{Context, Result, bail};
use serde_json::Value;
use std::process::{Command, Stdio};

/// Subdivisions of a triangle's edges; the number of triangles grows by the square.
const SPLITS: [u32; 3] = [1, 4, 9];
/// Default scene, in the folder of given scenes.
const SCENE: &str = "sponza-dabrovic/sponza-dabrovic.glb";
/// Replacement without the folder.
const GENERATED: &str = "builtin:apartment";

#[derive(Debug, PartialEq)]
struct Options {
    scene: Option<String>,
    preset: String,
}

fn parse(args: &[String]) -> Result<Options> {
    let mut options = Options { scene: None, preset: "standard".to_owned() };
    let mut args = args.iter();
    while let Some(name) = args.next() {
        let mut value = || args.next().with_context(|| format!("{name} needs a value"));
        match name.as_str() {
            "--scene" => options.scene = Some(value()?.clone()),
            "--preset" => options.preset = value()?.clone(),
            other => bail!("there is no option {other}; there are --scene and --preset"),
        }
    }
    Ok(options)
}

/// Bakes, prints a table and the line `growth R`.
///
/// # Errors
/// If a bake fails.
pub fn run(args: &[String]) -> Result<()> {
    let options = parse(args)?;
    let scene = options.scene.unwrap_or_else(|| given_or(SCENE, GENERATED));
    process::run(process::cargo().args([
        "build",
        "--locked",
        "--release",
        "--package",
        "rebounce-tests",
        "--bin",
        "tessellated",
    ]))?;
    let program = process::target().join("release/tessellated");
    let mut results = Vec::new();
    for split in SPLITS {
        let output = Command::new(&program)
            .args([&scene, &split.to_string(), &options.preset])
            .stderr(Stdio::inherit())
            .output()
            .with_context(|| program.display().to_string())?;
        if !output.status.success() {
            bail!("{} failed on {scene}, split by {split}", program.display());
        }
        results.push(serde_json::from_slice(&output.stdout).context("the figures")?);
    }
    let table = table(&scene, &options.preset, &results)?;
    println!("{table}");
    report::write("scaling", "Scaling with triangles", "cargo xtask bench-scale", &table)
}

fn table(scene: &str, preset: &str, results: &[Value]) -> Result<String> {
    let name = scene.rsplit(['/', '\\']).next().unwrap_or(scene);
    let mut lines = vec![
        format!("| {name}, {preset}: triangles | seconds | peak memory, MB | functions | links |"),
        "|---|---|---|---|---|".to_owned(),
    ];
    let mut seconds = Vec::new();
    for result in results {
        let number = |name: &str| result[name].as_f64().with_context(|| format!("no {name}"));
        seconds.push(number("seconds")?);
        lines.push(format!(
            "| {} | {:.1} | {:.0} | {} | {} |",
            number("triangles")?,
            number("seconds")?,
            number("peak_bytes")? / 1e6,
            number("functions")?,
            number("links")?
        ));
    }
    let (first, last) = (seconds.first().context("no bake")?, seconds.last().context("no bake")?);
    lines.push(format!("\ngrowth {:.2}", last / first));
    Ok(lines.join("\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options() {
        let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        let wanted = Options { scene: Some("a.glb".into()), preset: "standard".into() };
        assert_eq!(parse(&words("--scene a.glb --preset standard")).unwrap(), wanted);
        assert!(parse(&words("--scene")).is_err() && parse(&words("a.glb")).is_err());
    }

    #[test]
    fn the_table_ends_with_the_growth() {
        let result = |triangles: u32, seconds: f64| {
            serde_json::json!({
                "triangles": triangles, "seconds": seconds, "peak_bytes": 2e8, "functions": 7, "links": 9,
            })
        };
        let table = table("a/b.glb", "draft", &[result(10, 20.0), result(810, 25.0)]).unwrap();
        assert!(table.ends_with("growth 1.25") && table.contains("| 810 | 25.0 | 200 | 7 | 9 |"), "{table}");
    }
}
