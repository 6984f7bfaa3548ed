//! A solver of one's own: links for a single bounce, by brute force at the finest points.
//!
//! `cargo run --release --example one_bounce [OUTPUT.rbn]`

use rayon::prelude::*;
use rebounce::basis::{Leveled, sender_evaluator};
use rebounce::geometry::{Ray, Surfaces};
use rebounce::job::Job;
use rebounce::job::communicator::CommunicatorError;
use rebounce::job::stage::Stage;
use rebounce::prelude::*;
use rebounce::random::Stream;
use rebounce::shared::link::Link;
use rebounce::transport::direct_to_indirect::tint::{duals, tints};
use rebounce::transport::{Operator, Partial, Problem, Solver};
use std::collections::BTreeMap;
use std::error::Error;

/// Gathers with cosine-distributed rays at each point of the finest level; coarser points have no links.
struct OneBounce {
    /// Rays per point.
    rays: u32,
}

impl<S: Surfaces> Solver<S> for OneBounce {
    type Solution = Operator;

    async fn solve(
        &self,
        problem: &Problem<'_, S>,
        job: &Job<'_>,
        _partial: &mut Partial<'_, Operator>,
    ) -> Result<Operator, CommunicatorError> {
        let Problem { surfaces, points, settings, .. } = problem;
        let watch = job.reporter.begin(Stage::Transport, None);
        let tints = tints(*surfaces, points, settings.seed);
        let duals = duals(&tints);
        let levels = (0..settings.sender_levels).map(|level| sender_evaluator(points, level));
        let senders = Leveled::new(levels.collect());
        let finest = points.levels.last().map_or(0..0, |level| level.range());
        let row = |i: usize| {
            watch.step(1)?;
            let (point, mut stream) = (&points.points[i], Stream::new(settings.seed, i as u64));
            let origin = point.position + point.geometric_normal * surfaces.epsilon_at(point.position);
            let (mut row, mut functions) = (BTreeMap::new(), Vec::new());
            for _ in 0..self.rays {
                let direction = stream.cosine_hemisphere(point.normal);
                let ray = Ray { origin, direction, max_distance: f32::INFINITY, spread: 0.0 };
                let hit = surfaces.cast(&ray, stream.bits() as u32);
                if let Some(hit) = hit.filter(|hit| hit.faces(direction)) {
                    senders.interpolate(hit.position, hit.normal, hit.group, &mut functions);
                    for (sender, weight) in &functions {
                        // A link carries light in the tint of its sender.
                        let amount = weight * hit.albedo.dot(duals[*sender as usize].into());
                        *row.entry(*sender).or_insert(0.0) += amount / self.rays as f32;
                    }
                }
            }
            Ok(row.into_iter().map(|(sender, amount)| Link::pack(sender, amount)).collect())
        };
        let mut links = vec![Vec::new(); finest.start];
        links.par_extend(
            finest.clone().into_par_iter().map(row).collect::<Result<Vec<_>, CommunicatorError>>()?,
        );
        let (receivers, rays) = (finest.len() as u64, finest.len() as u64 * u64::from(self.rays));
        Ok(Operator { links, tints, receivers, rays, bounces: 1, ..Operator::default() })
    }
}

/// Mean bounced irradiance of the finest points, with the scene's own lamps.
fn mean_bounced(scene: &BakedScene) -> Result<f32, Box<dyn Error>> {
    let surfaces = rebounce::geometry::mesh::TriangleSurfaces::from_baked(scene)?;
    let relit = rebounce::verify::render::Relit::new(scene, &surfaces, &scene.meta.lights, false);
    let points = &scene.points[scene.display()];
    let light =
        points.iter().map(|point| relit.interpolated(point.position(), point.normal(), 0).element_sum());
    Ok(light.sum::<f32>() / (3 * points.len()) as f32)
}

/// Bakes a room with both solvers, and compares their light.
pub fn run(output: Option<&str>) -> Result<(), Box<dyn Error>> {
    let scene = load("builtin:cornell-box")?;
    let mut settings = BakeSettings::new(Preset::Draft);
    (settings.place.levels, settings.place.functions) = (3, 3_000);
    settings.operator.bounces = Some(1);
    let (baked, report) =
        Baker::new(&settings).bake_with(&scene, &OneBounce { rays: 256 })?.ok_or("no file")?;
    let (adaptive, adaptive_report) = bake(&scene, &settings, &())?;
    let [ours, theirs] = [mean_bounced(&baked)?, mean_bounced(&adaptive)?];
    println!("links   one bounce {}, direct to indirect {}", report.links, adaptive_report.links);
    println!("light   one bounce {ours:.4}, direct to indirect {theirs:.4}");
    if (ours / theirs - 1.0).abs() > 0.02 {
        return Err("both solvers should give the same light".into());
    }
    if let Some(output) = output {
        save(output, &baked)?;
        println!("saved   {output}; `rebounce view {output}` shows it");
    }
    Ok(())
}

#[allow(dead_code, reason = "tests call `run`")]
fn main() -> Result<(), Box<dyn Error>> {
    run(std::env::args().nth(1).as_deref())
}
