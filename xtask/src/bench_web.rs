//! `cargo xtask bench-web`: frame time of the viewer in a browser against three.js, with equal scene, light and
//! size, alternating on the same machine. The bounced light of each picture is compared with the path-traced
//! reference, if present. Then: frames under a sky, with the sky turned and with the light moved; costs of lookup and
//! splatting, and the difference of their pictures; metals under a sky likewise; a ball in three.js that no bake knows, by our probes and by three's
//! own ways.

use crate::fidelity::given;
use crate::{install, process, report, web};
use anyhow::{Context, Result, bail};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Default shot.
const SHOT: &str = "sponza-dabrovic";

#[derive(Debug, Default, PartialEq)]
struct Options {
    scenes: Option<PathBuf>,
    shot: Option<String>,
}

fn parse(args: &[String]) -> Result<Options> {
    let mut options = Options::default();
    let mut args = args.iter();
    while let Some(name) = args.next() {
        let mut value = || args.next().with_context(|| format!("{name} needs a value"));
        match name.as_str() {
            "--scenes" => options.scenes = Some(value()?.into()),
            "--shot" => options.shot = Some(value()?.clone()),
            other => bail!("there is no option {other}; there are --scenes and --shot"),
        }
    }
    Ok(options)
}

/// Bakes, serves, measures, prints a table of lookup and splatting, a table of the viewers and the line
/// `frame ratio R`.
///
/// # Errors
/// If a step fails, or there is no scene to measure.
pub fn run(args: &[String]) -> Result<()> {
    let options = parse(args)?;
    let scenes = options.scenes.or_else(given).context(
        "which scene? --scenes DIR names a folder with shots/NAME.shot.json, whose \"scene\" is a .glb file that three.js reads too",
    )?;
    let name = options.shot.as_deref().unwrap_or(SHOT);
    let shot = std::path::absolute(scenes.join("shots").join(format!("{name}.shot.json")))?;
    let text = std::fs::read_to_string(&shot).with_context(|| shot.display().to_string())?;
    let scene: Value = serde_json::from_str(&text).with_context(|| shot.display().to_string())?;
    let scene = scene["scene"].as_str().context("the shot names no scene")?;
    let scene = shot.with_file_name("").join(scene);
    let reference = std::path::absolute(scenes.join("references").join(name))?;
    let has_reference = reference.with_file_name(format!("{name}.indirect.a.exr")).exists();

    install::ensure(&install::BROWSER)?;
    web::build(web::Purpose::Publish)?;
    web::packages("web/bench", "three.js")?;
    process::run(process::cargo().args([
        "build",
        "--locked",
        "--release",
        "--package",
        "rebounce-cli",
        "--package",
        "rebounce-tests",
    ]))?;
    let work = process::target().join("bench-web");
    std::fs::create_dir_all(&work).with_context(|| work.display().to_string())?;
    let [baked, out, ways, ball, metal] =
        [&format!("{name}.rbn"), "frames.json", "ways.json", "ball.json", "metal.json"]
            .map(|file| work.join(file));
    let release = |program: &str| process::target().join("release").join(program);
    process::run(Command::new(release("rebounce")).arg("bake").arg(&scene).arg("-o").arg(&baked))?;
    let reference = if has_reference { reference } else { PathBuf::from("-") };
    process::run(web::node().arg("bench/run.mjs").args([
        &release("compare"),
        &scene,
        &baked,
        &shot,
        &reference,
        &out,
    ]))?;
    process::run(web::node().arg("bench/ways.mjs").args([&baked, &shot, &ways]))?;
    process::run(web::node().arg("bench/rooms.mjs").args([&release("rebounce"), &ball]))?;
    let [room, object] =
        ["room", "environment"].map(|purpose| (purpose, work.join(format!("{purpose}.rbn"))));
    for (purpose, file) in [&room, &object] {
        let mut bake = Command::new(release("rebounce"));
        bake.args(["bake", "builtin:trophy", "--preset", "draft", "--for", purpose, "-o"]);
        process::run(bake.arg(file))?;
    }
    process::run(web::node().arg("bench/metal.mjs").args([&room.1, &object.1, &metal]))?;
    let metal = metal_table(&figures(&metal)?)?;
    let tables =
        [ways_table(&figures(&ways)?)?, metal, ball_table(&figures(&ball)?)?, table(&figures(&out)?)?];
    let tables = tables.join("\n\n");
    println!("{tables}");
    let command = format!("cargo xtask bench-web --shot {name}");
    report::write("web", "Frames in a browser", &command, &tables)
}

fn figures(file: &Path) -> Result<Value> {
    let text = std::fs::read(file).with_context(|| file.display().to_string())?;
    serde_json::from_slice(&text).with_context(|| file.display().to_string())
}

/// Table of milliseconds of lookup and splatting by size, and the difference of their pictures.
fn ways_table(results: &Value) -> Result<String> {
    let mut lines = vec![
        "| milliseconds | size | find | gather | a frame with the light moving |".to_owned(),
        "|---|---|---|---|---|".to_owned(),
    ];
    for size in results["sizes"].as_array().context("no size was measured")? {
        for way in ["lookup", "splat"] {
            let number =
                |pass: &str| size[way][pass].as_f64().map_or_else(|| "–".to_owned(), |ms| format!("{ms:.0}"));
            let [find, gather, light] = ["find", "gather", "light"].map(number);
            let [width, height] = [&size["width"], &size["height"]];
            lines.push(format!("| {way} | {width} x {height} | {find} | {gather} | {light} |"));
        }
    }
    let apart = results["apart"].as_f64().context("no pictures were compared")?;
    let adapter = results["adapter"].as_str().context("no adapter")?;
    lines.push(format!("\n{adapter}; the pictures are {:.3}% apart (relative RMS)", 100.0 * apart));
    Ok(lines.join("\n"))
}

/// Table of metals with the environment turned and with a lamp moved.
fn metal_table(results: &Value) -> Result<String> {
    let mut lines = vec![
        "| metals (`builtin:trophy`), 1280 x 720 | sky turned, s | lamp moved, s | ratio |".to_owned(),
        "|---|---|---|---|".to_owned(),
    ];
    for (key, label) in [("room", "bake for rooms"), ("object", "bake for an environment")] {
        let number = |name: &str| results[key][name].as_f64().with_context(|| format!("no {name} of {key}"));
        let (sky, lamp) = (number("sky")? / 1e3, number("lamp")? / 1e3);
        lines.push(format!("| {label} | {sky:.2} | {lamp:.2} | {:.2} |", sky / lamp));
    }
    Ok(lines.join("\n"))
}

/// Table of a ball that no bake knows, in three.js.
fn ball_table(results: &Value) -> Result<String> {
    let mut lines = vec![
        "| a ball in three.js that the bake does not know | error | bias | behind a wall of 5 cm, of the lit side |"
            .to_owned(),
        "|---|---|---|---|".to_owned(),
    ];
    let names = [
        ("ours", "our probes"),
        ("vxgi", "VXGI 256³, two cached bounces"),
        ("probes", "LightProbeGrid, 0.5 m, six more bounces"),
    ];
    for (key, label) in names {
        let number = |name: &str| results[key][name].as_f64().with_context(|| format!("no {name} of {key}"));
        let (error, bias, leak) = (number("error")?, number("bias")?, number("leak")?);
        lines.push(format!("| {label} | {error:.3} | {bias:.3} | {:.1}% |", 100.0 * leak));
    }
    Ok(lines.join("\n"))
}

/// Table of the viewers, and the summary line.
fn table(results: &Value) -> Result<String> {
    let mut lines = vec![
        "| a frame with the light moving, 1280 x 720 | seconds | error | bias |".to_owned(),
        "|---|---|---|---|".to_owned(),
    ];
    let names = [
        ("ours", "rebounce-viewer"),
        ("three", "three.js, no global illumination"),
        ("rebounce", "three.js, our bounced light"),
        ("vxgi", "three.js, VXGI 128³, one cached bounce"),
        ("probes", "three.js, LightProbeGrid of 6 x 3 x 4, one more bounce, baked anew"),
    ];
    for (key, label) in names {
        let result = &results[key];
        let number = |value: &Value, digits: usize| {
            value.as_f64().map_or_else(|| "–".to_owned(), |x| format!("{x:.digits$}"))
        };
        let seconds =
            result["median"].as_f64().map_or_else(|| "–".to_owned(), |ms| format!("{:.2}", ms / 1e3));
        let (error, bias) = (number(&result["error"]["error"], 3), number(&result["error"]["bias"], 3));
        lines.push(format!("| {label} | {seconds} | {error} | {bias} |"));
    }
    let median = |key: &str| results[key]["median"].as_f64().with_context(|| format!("no frame of {key}"));
    if let Some(turn) = results["ours"]["turn"].as_f64() {
        lines.push(format!("\nrebounce-viewer with the camera moving instead: {:.2} s", turn / 1e3));
    }
    let sky = &results["ours"]["sky"];
    if let (Some(turned), Some(moved)) = (sky["sky"].as_f64(), sky["lamp"].as_f64()) {
        lines.push(format!(
            "under a sky: {:.2} s with the sky turned, {:.2} s with the light moved",
            turned / 1e3,
            moved / 1e3
        ));
    }
    if let Some(lit) = results["ours"]["lit"].as_f64() {
        lines.push(format!("first lit frame {:.1} s after navigation", lit / 1e3));
    }
    let still = &results["ours"]["still"];
    let counted = |name: &str| still["counts"][name].as_f64();
    if let (Some(kernels), Some(functions), Some(bytes)) =
        (counted("kernelEvaluationsPerPixel"), counted("functionsLookedAtPerPixel"), still["bytes"].as_f64())
    {
        lines.push(format!(
            "a still picture: {kernels:.1} kernel evaluations a pixel, {functions:.1} functions looked at, {:.0} MB on the GPU",
            bytes / 1e6
        ));
    }
    let ratio = median("rebounce")? / median("three")?;
    lines.push(format!("\nthree.js with our bounced light over three.js alone: {ratio:.2}"));
    lines.push(format!("frame ratio {:.2}", median("ours")? / median("three")?));
    Ok(lines.join("\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options() {
        let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        let wanted = Options { scenes: Some("a/b".into()), shot: Some("hall".into()) };
        assert_eq!(parse(&words("--scenes a/b --shot hall")).unwrap(), wanted);
        assert!(parse(&words("--shot")).is_err() && parse(&words("hall")).is_err());
    }

    #[test]
    fn both_ways_have_a_line_at_each_size() {
        let way = |find: f64| serde_json::json!({ "find": find, "gather": 4.4, "light": 60.0 });
        let mut results = serde_json::json!({
            "sizes": [{ "width": 320, "height": 180, "lookup": way(120.0), "splat": way(7.5) }],
            "apart": 0.00123,
            "adapter": "an adapter",
        });
        let table = ways_table(&results).unwrap();
        assert!(
            table.contains("| lookup | 320 x 180 | 120 | 4 | 60 |\n| splat | 320 x 180 | 8 | 4 | 60 |"),
            "{table}"
        );
        assert!(table.ends_with("an adapter; the pictures are 0.123% apart (relative RMS)"), "{table}");
        // Without GPU timestamps the passes have no times.
        results["sizes"][0]["splat"] = serde_json::json!({ "light": 60.0 });
        assert!(ways_table(&results).unwrap().contains("| splat | 320 x 180 | – | – | 60 |"));
        assert!(ways_table(&serde_json::json!({})).is_err());
    }

    #[test]
    fn a_ball_has_its_error_and_its_leak() {
        let way = serde_json::json!({ "error": 0.0621, "bias": 0.003, "leak": 0.472 });
        let table = ball_table(&serde_json::json!({ "ours": way, "vxgi": way, "probes": way })).unwrap();
        assert!(table.contains("| our probes | 0.062 | 0.003 | 47.2% |"), "{table}");
        assert!(ball_table(&serde_json::json!({ "ours": way })).is_err());
    }

    #[test]
    fn metals_have_the_ratio_of_both_frames() {
        let own = serde_json::json!({ "sky": 1200.0, "lamp": 1000.0 });
        let table = metal_table(&serde_json::json!({ "room": own, "object": own })).unwrap();
        assert!(table.ends_with("| bake for an environment | 1.20 | 1.00 | 1.20 |"), "{table}");
        assert!(metal_table(&serde_json::json!({ "room": own })).is_err());
    }

    #[test]
    fn the_table_ends_with_the_ratio() {
        let results = serde_json::json!({
            "ours": {
                "median": 600.0,
                "error": { "error": 0.07, "bias": -0.01 },
                "sky": { "sky": 450.0, "lamp": 700.0 },
                "still": {
                    "counts": { "kernelEvaluationsPerPixel": 5.25, "functionsLookedAtPerPixel": 17.0 },
                    "bytes": 150_400_000,
                },
            },
            "three": { "median": 400.0 },
            "rebounce": { "median": 500.0 },
            "vxgi": {},
            "probes": {},
        });
        let table = table(&results).unwrap();
        assert!(table.ends_with("frame ratio 1.50"), "{table}");
        assert!(table.contains("three.js with our bounced light over three.js alone: 1.25"), "{table}");
        assert!(table.contains("| 0.60 | 0.070 | -0.010 |"), "{table}");
        assert!(
            table.contains("5.2 kernel evaluations a pixel, 17.0 functions looked at, 150 MB"),
            "{table}"
        );
        assert!(
            table.contains("under a sky: 0.45 s with the sky turned, 0.70 s with the light moved"),
            "{table}"
        );
        assert!(super::table(&serde_json::json!({})).is_err());
    }
}
