//! Wavelet radiosity on exact faces and on triangles, in the columns of Alonso et al. 2001, tables 1 to 3.

use super::coarse;
use anyhow::{Context, Result, ensure};
use glam::{DVec2, Vec3};
use rayon::prelude::*;
use rebounce::geometry::{Ray, SceneSurfaces, Surfaces};
use rebounce::io::picture::{Only, Picture};
use rebounce::light::direct::at_point;
use rebounce::light::illumination::Illumination;
use rebounce::scene::Scene;
use rebounce::transport::wavelet::{Order, ScenePatches, WaveletSettings, WaveletSolution, solve_until};
use rebounce::verify::compare::compare;
use rebounce::verify::expose::Exposure;
use rebounce::verify::path_trace::{Settings, path_trace};
use rebounce_shared::light::LightSource;
use std::ops::ControlFlow;
use std::time::Instant;

/// Pictures, and paths a pixel of each of the two references.
const SIZE: [u32; 2] = [160, 100];
const PATHS: u32 = 1024;
const QUICK_PATHS: u32 = 64;
/// Triangles of the tessellations.
const TRIANGLES: [usize; 3] = [1_000, 10_000, 100_000];
/// No shot begins later than this, seconds: a row that has come to an end there says so.
const TIME_LIMIT: f64 = 300.0;
/// How much farther from the exact surface a patch is looked for if none is near: triangles lie beside it.
const FARTHER: [f32; 3] = [1.0, 16.0, 256.0];

/// The path tracer's pictures of bounced light, and the view.
struct Truth {
    pictures: [Picture; 2],
    exact: SceneSurfaces,
    lights: Vec<LightSource>,
}

/// Prints a table for each scene.
pub fn tables(names: &[&str], is_quick: bool) -> Result<()> {
    println!(
        "At 99% convergence, or what had been shot after {TIME_LIMIT:.0} s. *Error*: bounced light at the\n\
         pixels of the scene's camera against the path tracer's on exact faces: relative RMS without the\n\
         path tracer's noise, and bias. What the camera sees is the exact surface in all rows. *Natural\n\
         parameters*: the square of a face is that of the surface's own parameters, so that the Jacobian is\n\
         not constant.\n"
    );
    for name in names {
        println!("## {name}\n");
        println!(
            "| surfaces | basis | input primitives | final meshes | coefficients | convergence | time, s | memory, MB | shooting surfaces | shots | rays, M | error | bias |"
        );
        println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|");
        let exact = rebounce::io::load(&format!("builtin:{name}"))?;
        let truth = Truth::new(&exact, if is_quick { QUICK_PATHS } else { PATHS });
        for order in [Order::M1, Order::M2, Order::M3] {
            truth.row("exact", &exact, order, ScenePatches::new)?;
        }
        for order in [Order::M1, Order::M2, Order::M3] {
            truth.row("exact, natural parameters", &exact, order, ScenePatches::natural)?;
        }
        for count in TRIANGLES {
            let triangles = coarse::tessellated(&format!("builtin:{name}"), count)?;
            for order in [Order::M1, Order::M2, Order::M3] {
                let surfaces = format!("{} triangles", triangles.triangles.len());
                truth.row(&surfaces, &triangles, order, ScenePatches::new)?;
            }
        }
        println!();
    }
    Ok(())
}

impl Truth {
    fn new(scene: &Scene, paths: u32) -> Self {
        let exact = SceneSurfaces::from_scene(scene);
        let illumination = Illumination::of(&exact, &scene.lights, scene.origin, 1.0);
        let settings = Settings { only: Only::Indirect, ..Settings::default() };
        let traced = |seed| {
            let exposure = Exposure { size: SIZE, samples: paths, seed };
            path_trace(&exact, scene.origin, &scene.cameras[0], &illumination, exposure, settings, || ())
        };
        let pictures = [1, 2].map(traced);
        let lights = scene.lights.iter().map(|light| light.source(scene.origin)).collect();
        Self { pictures, exact, lights }
    }

    /// Solves and prints a row.
    fn row(
        &self,
        surfaces_name: &str,
        scene: &Scene,
        order: Order,
        patches: impl Fn(&Scene, f32) -> Option<ScenePatches>,
    ) -> Result<()> {
        let began = Instant::now();
        let surfaces = SceneSurfaces::simplified(scene);
        let patches = patches(scene, surfaces.epsilon()).context("no faces")?;
        let all = patches.with_emission(&[], &[]);
        let direct = |position: Vec3, normal: Vec3| at_point(&surfaces, &self.lights, position, normal);
        let settings = WaveletSettings { order, ..WaveletSettings::default() };
        let in_time = |_| {
            let is_late = began.elapsed().as_secs_f64() > TIME_LIMIT;
            Ok(if is_late { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
        };
        let solution = solve_until(&all, &surfaces, direct, &settings, in_time)?;
        let seconds = began.elapsed().as_secs_f64();
        let picture = self.picture(scene, &patches, &solution);
        let found = compare(&picture, &self.pictures[0], Some(&self.pictures[1]))?;
        let error = found.error.value.or(found.error.at_most).context("the references are too noisy")?;
        let figures = &solution.figures;
        ensure!(figures.shots > 0, "nothing was shot");
        println!(
            "| {surfaces_name} | {order:?} | {} | {} | {} | {:.1}% | {seconds:.1} | {:.1} | {} | {} | {:.2} | {error:.3} | {:+.3} |",
            patches.faces(),
            figures.leaf_cells,
            figures.coefficients,
            100.0 * figures.convergence.last().copied().unwrap_or(0.0),
            figures.bytes as f64 * 1e-6,
            figures.shooting_patches,
            figures.shots,
            figures.rays as f64 * 1e-6,
            found.bias,
        );
        Ok(())
    }

    /// Bounced light of a solution at the pixels: what the camera sees is the exact surface, in all rows alike.
    fn picture(&self, scene: &Scene, patches: &ScenePatches, solution: &WaveletSolution) -> Picture {
        let frame = scene.cameras[0].frame(scene.origin);
        let [width, height] = SIZE;
        let epsilon = self.exact.epsilon();
        // Samples on a grid of 4 by 4 in each pixel.
        let sample = |pixel: u32, i: u32| {
            let [x, y] = [pixel % width, pixel / width].map(|at| at as f32);
            let (dx, dy) = (0.125 + 0.25 * (i % 4) as f32, 0.125 + 0.25 * (i / 4) as f32);
            let ray = Ray::visibility(frame.eye, frame.direction(x + dx, y + dy, width, height));
            let Some(hit) = self.exact.see(&ray, i) else { return Vec3::ZERO };
            let within = |factor: &f32| patches.locate(hit.position, hit.normal, factor * epsilon);
            let place = FARTHER.iter().find_map(within);
            let light = place
                .map_or(Vec3::ZERO, |at| solution.irradiance(at.patch, at.st.clamp(DVec2::ZERO, DVec2::ONE)));
            hit.albedo * light.max(Vec3::ZERO) / std::f32::consts::PI
        };
        let pixel = |pixel: u32| (0..16).map(|i| sample(pixel, i)).sum::<Vec3>() / 16.0;
        Picture { width, height, pixels: (0..width * height).into_par_iter().map(pixel).collect() }
    }
}
