//! Times frames on a device with timestamp queries: `frames FILE.rbn SHOT.json [--size WxH]`.
//!
//! Prints the milliseconds of every pass for frames in which one thing changes: nothing but the camera, the first lamp,
//! the rotation of the sky, its intensity, the strength of the first group of emissive surfaces. The shortest time of a
//! pass counts; *processor* is the time that the frame takes before it is handed to the device.

use anyhow::{Context, Result};
use common::{open, screen::screen, set_shot};
use rebounce::shared::light::{DIRECTION, Light, LightKind, POSITION};
use rebounce_viewer::gpu::Gpu;
use rebounce_viewer::renderer::Renderer;
use std::path::Path;
use std::time::Instant;

mod common;

/// Frames of each kind.
const FRAMES: u32 = 40;

/// A change of the lights from one frame to the next.
struct Change {
    name: &'static str,
    /// The lights of a frame of this number; `None` where the shot has no such light.
    lights: fn(&[Light], u32) -> Option<Vec<Light>>,
}

const CHANGES: [Change; 5] = [
    Change { name: "camera", lights: |lights, _| Some(lights.to_vec()) },
    Change {
        name: "lamp moved",
        lights: |lights, frame| changed(lights, is_placed, |light| moved(light, frame)),
    },
    Change {
        name: "sky turned",
        lights: |lights, frame| {
            changed(lights, is_sky, |light| {
                if let Light::Environment { rotation_deg, .. } = light {
                    *rotation_deg += f64::from(frame);
                }
            })
        },
    },
    Change {
        name: "sky dimmed",
        lights: |lights, frame| changed(lights, is_sky, |light| dimmed(light, frame)),
    },
    Change {
        name: "emission dimmed",
        lights: |lights, frame| {
            changed(lights, |light| light.kind() == LightKind::Emissive, |light| dimmed(light, frame))
        },
    },
];

fn is_sky(light: &Light) -> bool {
    light.kind() == LightKind::Environment
}

fn is_placed(light: &Light) -> bool {
    light.position().is_some() || light.direction().is_some()
}

/// The lights with the first light that `is_meant` changed.
fn changed(
    lights: &[Light],
    is_meant: fn(&Light) -> bool,
    change: impl Fn(&mut Light),
) -> Option<Vec<Light>> {
    let mut lights = lights.to_vec();
    change(lights.iter_mut().find(|light| is_meant(light))?);
    Some(lights)
}

fn moved(light: &mut Light, frame: u32) {
    let step = 1e-3 * f64::from(frame);
    if let Some([x, y, z]) = light.position() {
        *light = light.with(POSITION.at, &[x + step, y, z]);
    } else if let Some([x, y, z]) = light.direction() {
        *light = light.with(DIRECTION.at, &[x + step, y, z]);
    }
}

fn dimmed(light: &mut Light, frame: u32) {
    *light = light.with(rebounce::shared::light::INTENSITY.at, &[1.0 + 1e-3 * f64::from(frame)]);
}

fn main() -> Result<()> {
    let mut files = Vec::new();
    let mut size = [1280, 720];
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        if argument == "--size" {
            let text = arguments.next().context("--size WxH")?;
            let (w, h) = text.split_once('x').context("--size WxH")?;
            size = [w.parse()?, h.parse()?];
        } else {
            files.push(argument);
        }
    }
    let [file, shot] = &files[..] else { anyhow::bail!("frames FILE.rbn SHOT.json [--size WxH]") };
    let gpu = Gpu::headless()?;
    let mut renderer = open(&gpu, Path::new(file))?;
    set_shot(&mut renderer, Path::new(shot))?;
    let start = renderer.lights().to_vec();
    println!("{}, {file}, {} x {}", gpu.adapter, size[0], size[1]);
    println!(
        "| change | processor | shadows | relight | g-buffer | find | gather | blended | composite | sum |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for change in &CHANGES {
        if (change.lights)(&start, 0).is_none() {
            continue;
        }
        let (processor, passes) =
            time(&gpu, &mut renderer, size, |frame| (change.lights)(&start, frame).unwrap_or_default())?;
        let cells: Vec<String> =
            passes.iter().map(|pass| pass.map_or_else(String::new, |ms| format!("{ms:.3}"))).collect();
        let sum: f64 = passes.iter().flatten().sum();
        println!("| {} | {processor:.3} | {} | {sum:.3} |", change.name, cells.join(" | "));
        renderer.set_lights(start.clone())?;
    }
    gpu.check().map_err(Into::into)
}

/// Draws frames with these lights and a camera that moves; returns the least milliseconds of the processor and of every
/// pass that ran in these frames.
fn time(
    gpu: &Gpu,
    renderer: &mut Renderer,
    [width, height]: [u32; 2],
    lights: impl Fn(u32) -> Vec<Light>,
) -> Result<(f64, [Option<f64>; 7])> {
    renderer.set_still_pictures(1);
    let target = screen(gpu, width, height);
    let view = target.create_view(&Default::default());
    let (mut processor, mut best) = (f64::INFINITY, [None; 7]);
    let still = renderer.camera().clone();
    for frame in 0..FRAMES {
        let mut camera = still.clone();
        camera.position[0] += 1e-4 * f64::from(frame);
        renderer.set_camera(camera)?;
        let before = renderer.stats();
        let start = Instant::now();
        renderer.set_lights(lights(frame))?;
        renderer.draw(&view, target.format(), width, height)?;
        let spent = start.elapsed().as_secs_f64() * 1e3;
        gpu.device.poll(wgpu::PollType::wait_indefinitely())?;
        // The first frames draw what the change before left.
        if frame < 4 {
            continue;
        }
        processor = processor.min(spent);
        let after = renderer.stats();
        let times = after.milliseconds;
        let has_shadows = after.shadow_layers > before.shadow_layers;
        let has_relit = after.relights > before.relights;
        let passes = [
            times.shadows.filter(|_| has_shadows),
            times.relight.filter(|_| has_relit),
            times.g_buffer,
            times.find,
            times.gather,
            times.blended,
            times.composite,
        ];
        for (best, pass) in best.iter_mut().zip(passes) {
            *best = match (*best, pass) {
                (Some(a), Some(b)) => Some(f64::min(a, b)),
                (a, b) => a.or(b),
            };
        }
    }
    renderer.set_camera(still)?;
    Ok((processor, best))
}
