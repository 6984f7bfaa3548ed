//! Bakes a scene whose triangles are all split into n x n and prints what it took, as one line of JSON:
//! `cargo run --release --example tessellated -- SCENE N [draft|standard|fine [placing]]`; with `placing` it only places
//! the points and prints how much processor time each level took.
//!
//! The light is the same whatever n is, so a bake's time should be, too. `cargo xtask bench-scale` runs it.

use anyhow::{Context, Result, bail};
use rebounce::bake::{BakeSettings, Observer, Preset, Progress, Stage, bake, peak_memory_bytes};
use split::split;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

#[path = "../../../baker/tests/common/split.rs"]
mod split;

/// Notes when each level of points began, and ends the bake after the last.
#[derive(Default)]
struct Placing {
    began: Mutex<Vec<(Option<usize>, f64)>>,
    is_over: AtomicBool,
}

impl Observer for Placing {
    fn progress(&self, progress: &Progress) {
        let is_over = !matches!(progress.stage, Stage::Bvh | Stage::Points);
        self.is_over.store(is_over, Ordering::Relaxed);
        let Ok(mut began) = self.began.lock() else { return };
        if progress.stage != Stage::Bvh && began.last().is_none_or(|last| last.0 != progress.level) {
            began.push((progress.level, progress.processor_seconds));
        }
    }

    fn is_stopped(&self) -> bool {
        self.is_over.load(Ordering::Relaxed)
    }
}

fn main() -> Result<()> {
    let mut args = std::env::args().skip(1);
    let name = args.next().context("which scene? tessellated SCENE N [PRESET]")?;
    let n: u32 = args.next().context("split by how much?")?.parse()?;
    let preset = match args.next().as_deref() {
        None | Some("standard") => Preset::Standard,
        Some("draft") => Preset::Draft,
        Some("fine") => Preset::Fine,
        Some(other) => bail!("there is no preset {other}"),
    };
    let mut scene = rebounce::io::load(&name)?;
    if n > 1 {
        split(&mut scene, n);
    }
    if args.next().is_some_and(|word| word == "placing") {
        let placing = Placing::default();
        if bake(&scene, &BakeSettings::new(preset), &placing).is_ok() {
            bail!("the bake was not stopped after placing points");
        }
        let began = placing.began.into_inner().map_err(|_| anyhow::anyhow!("a thread panicked"))?;
        let levels: Vec<f64> = began.windows(2).map(|pair| pair[1].1 - pair[0].1).collect();
        println!(
            "{}",
            serde_json::json!({ "triangles": scene.triangles.len(), "processor_seconds_of_levels": levels })
        );
        return Ok(());
    }
    let (baked, report) = bake(&scene, &BakeSettings::new(preset), &())?;
    let stages = report.seconds.iter().map(|(stage, seconds)| (stage.clone(), (*seconds).into()));
    let line = serde_json::json!({
        "triangles": scene.triangles.len(),
        "ray_triangles": report.ray_triangles,
        "seconds": report.seconds.iter().map(|stage| stage.1).sum::<f64>(),
        "stages": stages.collect::<serde_json::Map<_, _>>(),
        "peak_bytes": peak_memory_bytes(),
        "functions": baked.points.len(),
        "links": baked.link_count(),
    });
    println!("{line}");
    Ok(())
}
