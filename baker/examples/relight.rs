//! Relights a baked scene on the CPU with a lamp that moves: bounced light without a new bake.
//!
//! `cargo run --release --example relight [FOLDER]` writes a picture per place of the lamp.

use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::io::picture::Only;
use rebounce::prelude::*;
use rebounce::verify::expose::Exposure;
use rebounce::verify::render::render;
use std::error::Error;
use std::path::Path;

/// Bakes a room once, and takes a picture for each of `places` places of its lamp. Returns the mean radiance of each.
pub fn run(folder: Option<&Path>, places: usize, size: [u32; 2]) -> Result<Vec<f32>, Box<dyn Error>> {
    let scene = load("builtin:cornell-box")?;
    let mut settings = BakeSettings::new(Preset::Draft);
    (settings.place.levels, settings.place.functions) = (4, 4_000);
    let (baked, _) = bake(&scene, &settings, &())?;
    let surfaces = TriangleSurfaces::from_baked(&baked)?;
    let camera = baked.meta.cameras.first().ok_or("a baked file has a camera")?;
    let mut means = Vec::new();
    for place in 0..places {
        let mut lights = baked.meta.lights.clone();
        if let Some(Light::Point { position, .. } | Light::Spot { position, .. }) = lights.first_mut() {
            position[0] += 0.5 * (place as f64 / (places - 1).max(1) as f64 - 0.5);
        }
        let exposure = Exposure { size, samples: 16, seed: 1 };
        let picture = render(&baked, &surfaces, camera, &lights, exposure, Only::All, || ());
        let sum: f32 = picture.pixels.iter().map(|pixel| pixel.element_sum()).sum();
        means.push(sum / (3 * picture.pixels.len()) as f32);
        if let Some(folder) = folder {
            let path = folder.join(format!("relit-{place}.png"));
            picture.write(&path, 1.0)?;
            println!("{}: mean radiance {:.4}", path.display(), means[place]);
        }
    }
    Ok(means)
}

#[allow(dead_code, reason = "tests call `run`")]
fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).map_or_else(std::env::temp_dir, Into::into);
    run(Some(&folder), 5, [480, 480]).map(|_| ())
}
