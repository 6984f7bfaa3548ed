//! Times `S e` by the number of threads that share a row: `lanes FILE.rbn`.

use rebounce_shared::baked::BakedScene;
use rebounce_viewer::gpu::Gpu;
use rebounce_viewer::materials::material_layout;
use rebounce_viewer::relight::{Relight, RelightPipelines};
use rebounce_viewer::shadow::ShadowPipelines;
use rebounce_viewer::upload::Upload;
use std::error::Error;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1).ok_or("which file?")?;
    let scene = BakedScene::from_bytes(&std::fs::read(file)?)?;
    let gpu = Gpu::headless()?;
    let shadows = ShadowPipelines::new(&gpu, &material_layout(&gpu));
    let pipelines = RelightPipelines::new(&gpu, &shadows.layout);
    let upload = Upload::new(&gpu, &scene)?;
    let mut relight = Relight::new(&gpu, &pipelines, &upload, &upload.points, &scene);
    println!("{}: {} rows, {} links", gpu.adapter, scene.links.len(), scene.links.links.len());
    for lanes in [1, 2, 4, 8, 16, 32, 64] {
        relight.set_lanes(&gpu, &pipelines, lanes);
        let mut best = f64::INFINITY;
        for _ in 0..10 {
            let start = Instant::now();
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            relight.encode(&mut encoder, &pipelines, None, None);
            gpu.queue.submit([encoder.finish()]);
            gpu.device.poll(wgpu::PollType::wait_indefinitely())?;
            best = best.min(start.elapsed().as_secs_f64() * 1e3);
        }
        println!("{lanes:3} threads a row: {best:.2} ms, pull and push included");
    }
    Ok(())
}
