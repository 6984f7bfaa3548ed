//! Times relighting by the number of lights, with all lights moving, one light moving, or one dark light moving:
//! `lights FILE.rbn`.

use rebounce_shared::baked::BakedScene;
use rebounce_shared::light::Light;
use rebounce_viewer::gpu::Gpu;
use rebounce_viewer::renderer::Renderer;
use rebounce_viewer::scene::GpuScene;
use screen::screen;
use std::error::Error;

#[path = "../tests/common/screen.rs"]
mod screen;

/// Number of frames; the shortest time counts.
const FRAMES: usize = 24;

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1).ok_or("which file?")?;
    let scene = BakedScene::from_bytes(&std::fs::read(file)?)?;
    let direct = scene.direct_count();
    let gpu = Gpu::headless()?;
    let mut renderer = Renderer::new(gpu.clone())?;
    let loaded = pollster::block_on(GpuScene::upload(&gpu, renderer.pipelines().loaders(), scene))?;
    let [low, high] =
        loaded.extent.all.map(|corner| corner.as_dvec3() + glam::DVec3::from(loaded.meta.origin));
    renderer.install(loaded)?;
    println!("{}, {direct} points, milliseconds of relighting", gpu.adapter);
    let target = screen(&gpu, 16, 16);
    let view = target.create_view(&Default::default());
    for count in [1, 4, 16, 32] {
        // Spot lights, one shadow map each, spread through the scene's box; the last one is off.
        let light = |i: usize, step: usize| {
            let share = |x: f64| (x + 0.5) / (count + 1) as f64;
            let place =
                glam::DVec3::new(share(i as f64), 0.8, share((7 * i % count) as f64 + 0.01 * step as f64));
            Light::Spot {
                position: (low + (high - low) * place).to_array(),
                direction: [0.1, -1.0, 0.1],
                intensity: if i < count { 1.0 } else { 0.0 },
                color: [1.0; 3],
                inner_cone_deg: Some(20.0),
                outer_cone_deg: 59.0,
                radius: 0.0,
            }
        };
        let mut time = |moves: &dyn Fn(usize) -> bool| -> Result<f64, Box<dyn Error>> {
            let mut best = f64::INFINITY;
            for frame in 0..FRAMES {
                let step = |i| if moves(i) { frame + 1 } else { 0 };
                renderer.set_lights((0..=count).map(|i| light(i, step(i))).collect())?;
                renderer.draw(&view, target.format(), 16, 16)?;
                gpu.device.poll(wgpu::PollType::wait_indefinitely())?;
                // The first frames build the kept sum.
                let relight =
                    renderer.stats().milliseconds.relight.ok_or("this device cannot time passes")?;
                best = if frame > 9 { best.min(relight) } else { best };
            }
            Ok(best)
        };
        let [all, one, none] = [time(&|_| true)?, time(&|i| i == 0)?, time(&|i| i == count)?];
        println!("{count:3} lights: all move {all:.3}, one moves {one:.3}, none {none:.3}");
    }
    Ok(())
}
