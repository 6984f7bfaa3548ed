//! Bounced light around a walking figure, by several ways, against path tracing, as a table of Markdown:
//!
//! `walking [--poses N] [--bins N] [--elements N] [--functions N] [--preset NAME] [--step SECONDS]`.
//!
//! `--step` prints the RMS change of the light within this time of the walk, of antiradiance and of path tracing with the same
//! random numbers: a ratio over 1 is popping.
//!
//! An empty room lit by one lamp, with an operator baked without the figure. Irradiance at random patches of the room, of
//! antiradiance the mean of near patches, as points of a file have it:
//!
//! * `operator`: the baked operator, direct light with the figure's shadow;
//! * `antiradiance`: room and figure by antiradiance;
//! * `difference`: the operator's light, and the difference of two antiradiance solutions, with the figure and without;
//! * `in the page`: an operator baked with the figure at rest, and the difference of antiradiance with the figure where it is and
//!   at rest;
//! * `first bounces`: the operator's light, and what the figure changes of one transport of that light, by antiradiance; what
//!   that changes in turn goes through the operator.
//!
//! Light on the figure itself, in a second table: by the operator, which has that of the figure at rest, by antiradiance, by the
//! operator's light with the difference of antiradiance now and at rest, and by both, as the page has it ([`beside`]).

mod compared;
mod means;

use anyhow::{Context, Result};
use compared::{Compared, compared, traced};
use glam::{DVec3, Vec3};
use means::{area_point, at, means, smooth};
use rayon::prelude::*;
use rebounce::bake::{BakeSettings, Preset, bake};
use rebounce::demo::walker;
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::io::LoadOptions;
use rebounce::light::direct::at_footprint;
use rebounce::scene::Scene;
use rebounce::transport::antiradiance::direct::of_patch;
use rebounce::transport::antiradiance::near::AreaPoint;
use rebounce::transport::antiradiance::{Pool, patches_of};
use rebounce_shared::antiradiance::leaving::Leaving;
use rebounce_shared::antiradiance::sweep::{Sweep, SweepScene};
use rebounce_shared::antiradiance::{AntiradianceSolver, MovingElements, Patch, SolverSettings, beside};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::light::LightSource;
use rebounce_shared::lighting::Lighting;
use rebounce_shared::random::Stream;
use rebounce_shared::relight;
use std::f32::consts::FRAC_1_PI;

/// Columns of the table.
const WAYS: [&str; 5] = ["operator", "antiradiance", "difference", "in the page", "first bounces"];
/// Those of the table of light on the figure.
const FIGURE_WAYS: [&str; 4] = ["operator", "antiradiance", "difference from rest", "in the page"];
/// Patches where the light is compared.
const PLACES: usize = 400;
/// Patches nearer to the figure than this are compared apart, metres.
const NEAR: f32 = 1.0;
/// Sweeps of the light that the figure changes.
const SWEEPS: u32 = 6;

/// The room with the figure at rest.
struct AtRest {
    baked: BakedScene,
    /// Patches of the figure.
    figure: Vec<Patch>,
    /// By point with direct light, the patch of the figure that it is nearest to, if it is the figure's.
    patch_of: Vec<Option<usize>>,
    /// Points of the room of the finest level, and their numbers.
    points: Vec<AreaPoint>,
    numbers: Vec<usize>,
    /// Those of the figure.
    figure_points: Vec<AreaPoint>,
    figure_numbers: Vec<usize>,
}

/// Light of a pose.
struct Row {
    patches: usize,
    /// By way: error and bias of all places of the room, and of those near the figure.
    room: Vec<[f32; 4]>,
    /// By way: error and bias on the figure.
    figure: Vec<[f32; 2]>,
}

/// Light that is shown where the operator has the figure at rest.
struct InPage {
    /// At the patches of the room.
    room: Vec<Vec3>,
    /// At those of the figure, by the operator and by antiradiance, of the figure at rest in the present direct light.
    figure: [Vec<Vec3>; 2],
}

/// An empty room with its operator.
struct Room {
    scene: Scene,
    baked: BakedScene,
    patches: Vec<Patch>,
    points: Vec<AreaPoint>,
    settings: SolverSettings,
    at_rest: AtRest,
}

fn main() -> Result<()> {
    let (mut poses, mut bins, mut elements, mut functions) = (10, 128, 6_000, 6_000);
    let (mut preset, mut step) = (Preset::Draft, None);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let value = arguments.next().with_context(|| format!("{argument} needs a value"))?;
        let count = || value.parse::<usize>().with_context(|| value.clone());
        match argument.as_str() {
            "--poses" => poses = count()?,
            "--bins" => bins = count()?,
            "--elements" => elements = count()?,
            "--functions" => functions = count()?,
            "--preset" => {
                preset = match value.as_str() {
                    "draft" => Preset::Draft,
                    "standard" => Preset::Standard,
                    "fine" => Preset::Fine,
                    _ => anyhow::bail!("there is no preset {value}"),
                };
            }
            "--step" => step = Some(value.parse::<f64>().with_context(|| value.clone())?),
            _ => anyhow::bail!("there are --poses, --bins, --elements, --functions, --preset and --step"),
        }
    }
    let mut bake_settings = BakeSettings::new(preset);
    bake_settings.place.functions = functions;
    let room = Room::new(bins, elements, &bake_settings.normalised())?;
    if let Some(step) = step {
        return room.changes(poses, step);
    }
    println!(
        "Relative RMS of the irradiance at {PLACES} patches of the room, and the bias; the same of those within\n\
         {NEAR} m of the figure.\n"
    );
    println!("| seconds | patches | {} |\n|---|---|{}", WAYS.join(" | "), "---|".repeat(WAYS.len()));
    let mut means = vec![[0.0; 4]; WAYS.len()];
    let mut on_figure = Vec::new();
    for pose in 0..poses {
        let time = walker::SECONDS * (pose as f64 + 0.5) / poses as f64;
        let Row { patches, room: found, figure } = room.row(time)?;
        let cells: Vec<String> = found.iter().map(cell).collect();
        println!("| {time:.2} | {patches} | {} |", cells.join(" | "));
        for (sum, own) in means.iter_mut().flatten().zip(found.iter().flatten()) {
            *sum += own / poses as f32;
        }
        on_figure.push((time, figure));
    }
    let cells: Vec<String> = means.iter().map(cell).collect();
    println!("| mean | | {} |", cells.join(" | "));
    println!("\nOn the figure:\n");
    println!("| seconds | {} |\n|---|{}", FIGURE_WAYS.join(" | "), "---|".repeat(FIGURE_WAYS.len()));
    let mut means = vec![[0.0; 2]; FIGURE_WAYS.len()];
    let pair = |[error, bias]: &[f32; 2]| format!("{error:.3}, {bias:+.3}");
    for (time, found) in &on_figure {
        println!("| {time:.2} | {} |", found.iter().map(pair).collect::<Vec<_>>().join(" | "));
        for (sum, own) in means.iter_mut().flatten().zip(found.iter().flatten()) {
            *sum += own / poses as f32;
        }
    }
    println!("| mean | {} |", means.iter().map(pair).collect::<Vec<_>>().join(" | "));
    Ok(())
}

impl Room {
    fn new(bins: usize, elements: usize, bake_settings: &BakeSettings) -> Result<Self> {
        let mut scene = rebounce::io::load("builtin:cornell-box")?;
        // Two triangles a quad: the two blocks are last.
        let walls = scene.triangle_material.len() - 20;
        scene.triangle_material.truncate(walls);
        scene.triangles.truncate(walls);
        if !scene.corner_colors.is_empty() {
            scene.corner_colors.truncate(walls);
        }
        let (baked, _) = bake(&scene, bake_settings, &())?;
        let points = baked.display().map(|i| area_point(&baked, i)).collect();
        let patches = patches_of(&scene, elements, false);
        let settings = SolverSettings { bins, ..SolverSettings::default() };
        let (whole, figure) = with_figure(&scene, None)?;
        let at_rest = AtRest::new(&whole, figure, bake_settings)?;
        Ok(Self { scene, baked, patches, points, settings, at_rest })
    }

    fn row(&self, time: f64) -> Result<Row> {
        let (whole, figure) = with_figure(&self.scene, Some(time))?;
        let surfaces = TriangleSurfaces::simplified(&whole);
        let lamps = Lighting::new(&whole.lights, None, whole.origin, 0).lamps;
        let count = self.patches.len();
        let mut patches = self.patches.clone();
        patches.extend(figure);
        let direct: Vec<Vec3> = patches.par_iter().map(|patch| of_patch(&surfaces, &lamps, patch)).collect();
        let seen = self.seen();
        let truth = [0, 1].map(|seed| {
            let path = |i: &usize| traced(&surfaces, &lamps, &patches[*i], seed);
            seen.par_iter().map(path).collect::<Vec<_>>()
        });

        let by_operator = self.operator(&surfaces, &lamps);
        let alone = AntiradianceSolver::new(&self.patches, &self.settings, &Pool);
        let both = AntiradianceSolver::new(&patches, &self.settings, &Pool);
        let without =
            alone.solve(&alone.even_light(direct[..count].to_vec()), &self.settings, &Pool, &mut ()).0;
        let with = both.solve(&both.even_light(direct.clone()), &self.settings, &Pool, &mut ()).0;
        let change: Vec<Vec3> = (0..count).map(|i| with[i] - without[i]).collect();
        let change = self.smooth(&change);
        let difference: Vec<Vec3> = (0..count).map(|i| by_operator[i] + change[i]).collect();
        let in_page = self.in_page((&surfaces, &lamps), &direct, &with[..count]);
        let figure = of_figure(
            (&surfaces, &lamps),
            [&patches[count..], &self.at_rest.figure],
            &with[count..],
            &in_page.figure,
        );
        let with = self.smooth(&with[..count]);
        let first = self.first_bounces(&direct, &by_operator, [&alone, &both]);
        let away = |i: usize| {
            let place = patches[i].position();
            patches[count..]
                .iter()
                .map(|patch| patch.position().distance(place))
                .fold(f32::INFINITY, f32::min)
        };
        let all: Vec<Compared> = seen
            .iter()
            .enumerate()
            .map(|(place, i)| Compared {
                patch: *i,
                area: patches[*i].area(),
                truth: truth.each_ref().map(|t| t[place]),
            })
            .collect();
        let near: Vec<Compared> = all.iter().copied().filter(|place| away(place.patch) < NEAR).collect();
        let columns = [&by_operator, &with, &difference, &in_page.room, &first].map(|found| {
            let [[error, bias], [error_near, bias_near]] =
                [&all, &near].map(|places| compared(places, found));
            [error, bias, error_near, bias_near]
        });
        Ok(Row { patches: patches.len(), room: columns.to_vec(), figure })
    }

    /// The light that the page shows: of the operator, which has the figure at rest, and what antiradiance changes of it. `with` is that
    /// of antiradiance with the figure where it is.
    fn in_page(
        &self,
        (surfaces, lamps): (&TriangleSurfaces, &[LightSource]),
        direct: &[Vec3],
        with: &[Vec3],
    ) -> InPage {
        let AtRest { baked, figure, patch_of, points, numbers, figure_points, figure_numbers } =
            &self.at_rest;
        let count = self.patches.len();
        let lit = baked.points[..baked.direct_count()].par_iter().zip(patch_of);
        let at_points = lit.map(|(point, patch)| match patch {
            Some(patch) => direct[count + patch],
            None => at_footprint(surfaces, lamps, point),
        });
        let values = relight::relight(baked, at_points.collect());
        let of = |numbers: &[usize]| numbers.iter().map(|i| values[*i]).collect::<Vec<Vec3>>();
        let by_operator = at(&self.patches, points, &of(numbers));
        let on_figure = at(figure, figure_points, &of(figure_numbers));
        let patches = [&self.patches[..], figure].concat();
        let resting = AntiradianceSolver::new(&patches, &self.settings, &Pool);
        let rest = resting.solve(&resting.even_light(direct.to_vec()), &self.settings, &Pool, &mut ()).0;
        let change: Vec<Vec3> = (0..count).map(|i| with[i] - rest[i]).collect();
        let change = self.smooth(&change);
        let room = (0..count).map(|i| by_operator[i] + change[i]).collect();
        InPage { room, figure: [on_figure, smooth(figure, &rest[count..])] }
    }

    /// Prints how much the light of poses changes within `step` seconds.
    fn changes(&self, poses: usize, step: f64) -> Result<()> {
        println!(
            "RMS change of the irradiance at {PLACES} patches of the room within {step} s, as a share of its RMS.\n"
        );
        println!("| seconds | antiradiance | path tracing | ratio |\n|---|---|---|---|");
        // As in the page, elements stay and links of the figure are made anew.
        let mut all = self.patches.clone();
        all.extend(with_figure(&self.scene, Some(0.0))?.1);
        let mut elements = MovingElements::new(all, self.patches.len(), self.settings, &Pool);
        for pose in 0..poses {
            let time = (walker::SECONDS - step) * (pose as f64 + 0.5) / poses as f64;
            let [(before, truth), (after, later)] =
                [self.moment(time, &mut elements)?, self.moment(time + step, &mut elements)?];
            let (mut found, mut traced, mut power) = (0.0, 0.0, 0.0);
            for i in 0..before.len() {
                found += (after[i] - before[i]).length_squared();
                // Of two estimates with noise of their own.
                let [one, other] = [0, 1].map(|seed| later[seed][i] - truth[seed][i]);
                traced += one.dot(other);
                power += truth[0][i].dot(truth[1][i]);
            }
            let [found, traced] = [found, traced].map(|sum: f32| (sum.max(0.0) / power).sqrt());
            println!("| {time:.2} | {found:.4} | {traced:.4} | {:.2} |", found / traced);
        }
        Ok(())
    }

    /// Light at the patches that are looked at, by antiradiance and by two estimates of path tracing.
    fn moment(&self, time: f64, elements: &mut MovingElements) -> Result<(Vec<Vec3>, [Vec<Vec3>; 2])> {
        let (whole, figure) = with_figure(&self.scene, Some(time))?;
        let surfaces = TriangleSurfaces::simplified(&whole);
        let lamps = Lighting::new(&whole.lights, None, whole.origin, 0).lamps;
        let count = self.patches.len();
        elements.follow(&figure, &Pool);
        let patches = elements.patches();
        let direct = patches.par_iter().map(|patch| of_patch(&surfaces, &lamps, patch)).collect();
        let solver = elements.solver();
        let found = solver.solve(&solver.even_light(direct), &self.settings, &Pool, &mut ()).0;
        let found = self.smooth(&found[..count]);
        let seen = self.seen();
        let truth = [0, 1].map(|seed| {
            let path = |i: &usize| traced(&surfaces, &lamps, &patches[*i], seed);
            seen.par_iter().map(path).collect::<Vec<_>>()
        });
        Ok((seen.iter().map(|i| found[*i]).collect(), truth))
    }

    /// Patches of the room that are looked at, at random: they follow each other as they were halved, and every n-th one is the
    /// same corner of its square.
    fn seen(&self) -> Vec<usize> {
        let mut stream = Stream::new(1, 1);
        (0..PLACES).map(|_| stream.bits() as usize % self.patches.len()).collect()
    }

    /// Irradiance of the room's patches by the operator.
    fn operator(&self, surfaces: &TriangleSurfaces, lamps: &[LightSource]) -> Vec<Vec3> {
        let points = &self.baked.points[..self.baked.direct_count()];
        let direct = points.par_iter().map(|point| at_footprint(surfaces, lamps, point)).collect();
        self.at_patches(&relight::relight(&self.baked, direct))
    }

    /// Values of points at the patches of the room.
    fn at_patches(&self, values: &[Vec3]) -> Vec<Vec3> {
        at(&self.patches, &self.points, &values[self.baked.display()])
    }

    /// Means of the values of near patches of the room, at its patches.
    fn smooth(&self, values: &[Vec3]) -> Vec<Vec3> {
        smooth(&self.patches, values)
    }

    /// Values of patches of the room at the points that direct light is evaluated at.
    fn at_points(&self, values: &[Vec3]) -> Vec<Vec3> {
        let points = self.baked.points[..self.baked.direct_count()].iter();
        means(&self.patches, values, points.map(|point| [point.position(), point.normal()]).collect())
    }

    /// The operator's light, what the figure changes of one transport of it, and the bounces of that change.
    fn first_bounces(
        &self,
        direct: &[Vec3],
        by_operator: &[Vec3],
        [alone, both]: [&AntiradianceSolver<'_>; 2],
    ) -> Vec<Vec3> {
        let count = self.patches.len();
        let given: Vec<Vec3> = (0..count).map(|i| direct[i] + by_operator[i]).collect();
        let [without, with] = [alone, both].map(|solver| transported(solver, &given, &direct[count..]));
        let change: Vec<Vec3> = (0..count).map(|i| with[i] - without[i]).collect();
        let bounced = self.at_patches(&relight::relight(&self.baked, self.at_points(&change)));
        let change = self.smooth(&change);
        (0..count).map(|i| by_operator[i] + change[i] + bounced[i]).collect()
    }
}

impl AtRest {
    fn new(whole: &Scene, figure: Vec<Patch>, settings: &BakeSettings) -> Result<Self> {
        let (baked, _) = bake(whole, settings, &())?;
        // The room is the group without a number; what deforms has one of its own.
        let is_figure = |i: usize| baked.group_of(i) > 0;
        let nearest = |i: usize| {
            let place = baked.points[i].position();
            let distance = |k: &usize| figure[*k].position().distance_squared(place);
            (0..figure.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)))
        };
        let patch_of =
            (0..baked.direct_count()).map(|i| is_figure(i).then(|| nearest(i)).flatten()).collect();
        let (figure_numbers, numbers): (Vec<usize>, Vec<usize>) =
            baked.display().partition(|i| is_figure(*i));
        anyhow::ensure!(numbers.len() < baked.display().len(), "the figure has no points");
        let [points, figure_points] =
            [&numbers, &figure_numbers].map(|of| of.iter().map(|i| area_point(&baked, *i)).collect());
        Ok(Self { baked, figure, patch_of, points, numbers, figure_points, figure_numbers })
    }
}

/// Error and bias on the figure by [`FIGURE_WAYS`], of its patches now and at rest. `now` is the light of antiradiance at its patches; `at_rest` is as
/// [`InPage::figure`].
fn of_figure(
    (surfaces, lamps): (&TriangleSurfaces, &[LightSource]),
    [patches, resting]: [&[Patch]; 2],
    now: &[Vec3],
    [by_operator, at_rest]: &[Vec<Vec3>; 2],
) -> Vec<[f32; 2]> {
    let now = smooth(patches, now);
    let mut stream = Stream::new(1, 2);
    let places = (0..PLACES).map(|_| stream.bits() as usize % patches.len()).collect::<Vec<_>>();
    let place = |patch: &usize| Compared {
        patch: *patch,
        area: patches[*patch].area(),
        truth: [0, 1].map(|seed| traced(surfaces, lamps, &patches[*patch], seed)),
    };
    // What is within another limb is dark.
    let is_seen = |place: &Compared| place.truth.iter().all(|light| *light != Vec3::ZERO);
    let places: Vec<Compared> = places.par_iter().map(place).filter(is_seen).collect();
    let all = |light: &dyn Fn(usize) -> Vec3| (0..patches.len()).map(light).collect::<Vec<Vec3>>();
    let difference = all(&|i| (by_operator[i] + now[i] - at_rest[i]).max(Vec3::ZERO));
    let in_page = all(&|i| {
        let departure = beside::departure(&resting[i], &patches[i]);
        beside::shown(by_operator[i], beside::change(now[i], at_rest[i], departure))
    });
    [by_operator, &now, &difference, &in_page].map(|found| compared(&places, found)).to_vec()
}

/// A room with the figure at a time of its walk, or at rest, and the figure's patches in the room's local space.
fn with_figure(scene: &Scene, time: Option<f64>) -> Result<(Scene, Vec<Patch>)> {
    let pose = time.map(|time| rebounce::io::PoseOption { animation: None, time });
    let options = LoadOptions { pose, ..LoadOptions::default() };
    let figure = rebounce::io::load_with("builtin:walker", &options)?;
    let at = DVec3::new(0.5, 0.0, -4.9);
    let shift = (DVec3::from(figure.origin) + at - DVec3::from(scene.origin)).as_vec3();
    let moved = |patch: Patch| Patch { corners: patch.corners.map(|corner| corner + shift), ..patch };
    let patches = patches_of(&figure, 1, false).into_iter().map(moved).collect();
    let mut whole = scene.clone();
    whole.add(figure, at)?;
    Ok((whole, patches))
}

/// Error and bias of all places, and of those near the figure.
fn cell([error, bias, error_near, bias_near]: &[f32; 4]) -> String {
    format!("{error:.3}, {bias:+.3} ({error_near:.3}, {bias_near:+.3})")
}

/// One transport of the light of the first patches, whose irradiance is `given`, by antiradiance. The others reflect what comes
/// to them, and their own direct light.
fn transported(solver: &AntiradianceSolver<'_>, given: &[Vec3], direct: &[Vec3]) -> Vec<Vec3> {
    let AntiradianceSolver { patches, hierarchy, bins, normalisations, .. } = solver;
    let scene = SweepScene { patches, hierarchy, bins, normalisations };
    let sweep = Sweep::new(&scene, &solver.transfers);
    let mut table = vec![Vec3::ZERO; 2 * hierarchy.elements.len() * bins.count()];
    let mut found = vec![Vec3::ZERO; patches.len()];
    for _ in 0..SWEEPS {
        let radiance: Vec<Vec3> = (0..patches.len())
            .map(|i| {
                let light = given.get(i).copied().unwrap_or_else(|| direct[i - given.len()] + found[i]);
                FRAC_1_PI * patches[i].albedo * light
            })
            .collect();
        let leaving = Leaving { matt: &radiance, lobes: &[], bins: bins.count() };
        sweep.run(&scene, &leaving, &mut table, &Pool);
        Sweep::irradiance(&scene, &table, &mut found, &Pool);
    }
    found
}
