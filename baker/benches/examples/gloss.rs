//! `gloss [--quick]`: prints the figures of docs/reports/gloss.md. Run by `cargo xtask bench-gloss`.

use anyhow::{Context, Result, bail};
use glam::Vec3;
use rebounce::bake::{BakeReport, BakeSettings, Preset, bake};
use rebounce::basis::Leveled;
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::geometry::{Hit, Ray, Surfaces};
use rebounce::io::picture::{Only, Picture};
use rebounce::light::bsdf::Bsdf;
use rebounce::light::direct;
use rebounce::light::illumination::Illumination;
use rebounce::random::Stream;
use rebounce::scene::Scene;
use rebounce::transport::gloss::{self, GlossSettings};
use rebounce::verify::compare::compare;
use rebounce::verify::compare::uncertainty::ErrorEstimate;
use rebounce::verify::expose::{Exposure, expose};
use rebounce::verify::path_trace;
use rebounce::verify::render::Relit;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::environment::{Environment, daylight, direction_at};
use rebounce_shared::ggx;
use rebounce_shared::gloss::GlossyField;
use rebounce_shared::harmonics::value;
use rebounce_shared::harmonics::zonal::{convolved, factors};
use rebounce_shared::light::Light;
use rebounce_shared::lighting::Lighting;
use rebounce_shared::rbn::{GLOSS_SECTIONS, container};
use std::sync::Arc;

/// Roughness of the metal in the pictures of the first table; those of the second have the middle one.
const ROUGHNESSES: [f32; 3] = [0.2, 0.4, 0.7];
/// Transfers, by the names of the first table.
const TRANSFERS: [(&str, Transfer); 3] = [
    ("bounced light in T, environment through V", Transfer::ThroughVisibility),
    ("all light in T, what harmonics leave out through V", Transfer::WithDirect),
    ("all light in T, harmonics alone", Transfer::HarmonicsAlone),
];
/// Rows of the second table: ε_T and components.
const SIZES: [(f32, u32); 6] = [(0.5, 6), (0.5, 12), (0.5, 24), (0.5, 48), (0.25, 24), (1.0, 24)];
/// Most bytes of a matrix, on average, with its share of the clusters' vectors.
const MOST_BYTES: f64 = 1000.0;

/// What follows from the tables.
const ADVICE: &str = "\
## Which to use

The first transfer, which is the default: it has the least error wherever errors can be told apart,
at roughness 0.7 too, and sections of half the size. Components are what bytes are best spent on up
to 24, the default: packing still loses two fifths of a matrix there, but twice as many cost twice
the bytes for what the intervals hardly tell. ε_T of 0.25 computes more matrices for nothing; 1
computes half of them, and is the choice where bytes or seconds count more than a tenth of the
error.";

#[derive(Clone, Copy, PartialEq)]
enum Transfer {
    ThroughVisibility,
    WithDirect,
    HarmonicsAlone,
}

/// Sizes of the measurement.
struct Size {
    functions: usize,
    side: u32,
    /// Samples a pixel of each of the two path-traced pictures.
    samples: u32,
}

fn main() -> Result<()> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let size = match args.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => Size { functions: 12_000, side: 128, samples: 128 },
        ["--quick"] => Size { functions: 3_000, side: 64, samples: 64 },
        _ => bail!("there is no option but --quick"),
    };
    let scene = rebounce::io::load("builtin:trophy")?;
    let skies = [("daylight", day()), ("studio", studio())];
    let truths = truths(&scene, &skies, &size);
    println!("{}", introduction(&size));
    println!("\n## What the matrices hold\n");
    println!(
        "Error of the metal's pixels, at roughness {}.\n",
        ROUGHNESSES.map(|r| r.to_string()).join(", ")
    );
    let columns: Vec<String> = skies
        .iter()
        .flat_map(|(name, _)| ROUGHNESSES.map(|roughness| format!("{name} {roughness}")))
        .collect();
    println!("| transfer | {} | matrices / points | MB | s |", columns.join(" | "));
    println!("|---|{}---|---|---|", "---|".repeat(columns.len()));
    for (name, transfer) in TRANSFERS {
        let has_direct = transfer != Transfer::ThroughVisibility;
        let bake = Bake::new(&scene, &size, GlossSettings { has_direct, ..by_matrices() })?;
        let mut errors = Vec::new();
        for (sky, truths) in skies.iter().zip(&truths) {
            for (roughness, truth) in ROUGHNESSES.into_iter().zip(truths) {
                errors.push(error(&bake, &scene, &sky.1, (roughness, transfer), truth, &size)?);
            }
        }
        println!(
            "| {name} | {} | {} / {} | {:.2} | {:.1} |",
            errors.join(" | "),
            bake.report.gloss.matrices,
            bake.report.gloss.points,
            bake.bytes as f64 / 1e6,
            bake.seconds
        );
    }
    println!("\n## Threshold and components\n");
    println!("The first transfer, at roughness {}.\n", ROUGHNESSES[1]);
    println!(
        "| ε_T | components | matrices | bytes a matrix | lost by packing | daylight | studio | MB | s |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    let mut most = 0.0f64;
    for (epsilon, components) in SIZES {
        let settings = GlossSettings { epsilon, components, ..by_matrices() };
        let bake = Bake::new(&scene, &size, settings)?;
        let mut errors = Vec::new();
        for (sky, truths) in skies.iter().zip(&truths) {
            let way = (ROUGHNESSES[1], Transfer::ThroughVisibility);
            errors.push(error(&bake, &scene, &sky.1, way, &truths[1], &size)?);
        }
        let figures = &bake.report.gloss;
        let each = bake.bytes as f64 / figures.matrices.max(1) as f64;
        most = most.max(each);
        println!(
            "| {epsilon} | {components} | {} | {each:.0} | {:.1}% | {} | {:.2} | {:.1} |",
            figures.matrices,
            100.0 * figures.compression_error,
            errors.join(" | "),
            bake.bytes as f64 / 1e6,
            bake.seconds
        );
    }
    let than = if most > MOST_BYTES { "**more**" } else { "less" };
    println!(
        "\nBytes are those of the sections in the file, clusters' vectors included: {most:.0} a matrix at"
    );
    println!("most, {than} than {MOST_BYTES:.0}. An uncompressed matrix has 7,600.");
    println!("\n{ADVICE}");
    Ok(())
}

fn introduction(Size { functions, side, samples }: &Size) -> String {
    let GlossSettings { epsilon, components, directions, .. } = GlossSettings::default();
    format!(
        "`builtin:trophy` at preset `draft` with {functions} functions; a picture of {side} x {side} pixels, of\n\
         which only metal counts. Error: RMS difference from two path-traced pictures of {samples} samples a\n\
         pixel, over their RMS, ± 2.5 standard errors of its noise. Metals scatter like chalk in\n\
         transport, as GGX conductors in the reference: part of each error is that. The two environments are\n\
         a clear day, whose sun is a lamp in every picture, and a studio with a softbox and a compact lamp\n\
         of 3° radius. Defaults: ε_T = {epsilon}, {components} components, {directions} directions. MB and s are\n\
         those of the glossy transfer alone, with two threads at `opt-level` 2.\n\n\
         **Harmonics alone** is the transfer of the 2007 report: the lobe as factors of the bands, applied to\n\
         T l. The other two show the environment itself, blurred as wide as the samples of the lobe."
    )
}

/// A baked scene, with the figures of its glossy transfer.
struct Bake {
    file: BakedScene,
    report: BakeReport,
    seconds: f64,
    /// Bytes of the sections.
    bytes: usize,
}

/// Settings of matrices, which the report is of.
fn by_matrices() -> GlossSettings {
    GlossSettings { transfer: gloss::Transfer::Matrices, ..GlossSettings::default() }
}

impl Bake {
    fn new(scene: &Scene, size: &Size, gloss: GlossSettings) -> Result<Self> {
        let mut settings = BakeSettings::new(Preset::Draft);
        settings.place.functions = size.functions;
        settings.gloss = Some(gloss);
        let (file, report) = bake(scene, &settings.normalised(), &())?;
        let bytes = file.to_bytes()?;
        let sections = container::read(&bytes)?;
        let own = sections.iter().filter(|section| GLOSS_SECTIONS.contains(&section.name));
        let bytes = own.map(|section| section.len).sum();
        let seconds = report.seconds.iter().filter(|(stage, _)| stage == GLOSS).map(|(_, s)| s).sum();
        Ok(Self { file, report, seconds, bytes })
    }
}

/// The stage of glossy transfer, as reports name it.
const GLOSS: &str = "gathering glossy transfer";

/// The sun over the scene's left shoulder.
fn day() -> Arc<Environment> {
    Arc::new(daylight::sky(Vec3::new(-0.5, 1.0, 0.7).normalize(), 3.0, Vec3::splat(0.2)).0)
}

/// A dim room with a softbox on one side and a compact lamp on the other.
fn studio() -> Arc<Environment> {
    let (width, height) = (512, 256);
    let lamp = Vec3::new(0.8, 0.7, 0.5).normalize();
    let at = |i: u32| {
        let (u, v) = ((f64::from(i % width) + 0.5) / f64::from(width), f64::from(i / width) + 0.5);
        let direction = direction_at(u, v / f64::from(height));
        let is_softbox = direction.x < -0.5
            && direction.z.abs() < 0.5 * -direction.x
            && (0.2..0.75).contains(&direction.y);
        match () {
            () if direction.dot(lamp) > 3.0f32.to_radians().cos() => Vec3::new(250.0, 230.0, 200.0),
            () if is_softbox => Vec3::splat(5.0),
            () => Vec3::splat(0.12) + Vec3::new(0.05, 0.06, 0.08) * direction.y,
        }
    };
    Arc::new(Environment { width, height, pixels: (0..width * height).map(at).collect() })
}

const SKY: Light = Light::Environment { file: None, rotation_deg: 0.0, intensity: 1.0, color: [1.0; 3] };

fn with_roughness(scene: &Scene, roughness: f32) -> Scene {
    let mut scene = scene.clone();
    scene.materials.iter_mut().filter(|m| m.metallic > 0.5).for_each(|m| m.roughness = roughness);
    scene
}

/// A picture of the metals of a scene, all else black.
fn of_metals(
    scene: &Scene,
    surfaces: &TriangleSurfaces,
    exposure: Exposure,
    radiance: impl Fn(&Ray, &Hit, &mut Stream) -> Vec3 + Sync,
) -> Picture {
    let of = |ray: &Ray, stream: &mut Stream| {
        let hit = surfaces.see(ray, stream.bits() as u32);
        hit.filter(|hit| hit.gloss.is_metal()).map_or(Vec3::ZERO, |hit| radiance(ray, &hit, stream))
    };
    expose(&scene.cameras[0].frame(scene.origin), exposure, of, || ())
}

/// Two path-traced pictures with noise of their own, by environment and roughness.
fn truths(scene: &Scene, skies: &[(&str, Arc<Environment>)], size: &Size) -> Vec<Vec<[Picture; 2]>> {
    let settings = path_trace::Settings { gloss: true, ..path_trace::Settings::default() };
    let of = |sky: &Arc<Environment>, roughness: f32, seed: u64| {
        let scene = with_roughness(scene, roughness);
        let surfaces = TriangleSurfaces::from_scene(&scene);
        let light = Illumination::of_scene(&surfaces, &[SKY], scene.origin, &[], Some(sky));
        let exposure = Exposure { size: [size.side; 2], samples: size.samples, seed };
        of_metals(&scene, &surfaces, exposure, |ray, _, stream| {
            path_trace::radiance(&surfaces, &light, *ray, settings, stream)
        })
    };
    let of_sky = |(_, sky): &(&str, Arc<Environment>)| {
        ROUGHNESSES.iter().map(|roughness| [1, 2].map(|seed| of(sky, *roughness, seed))).collect()
    };
    skies.iter().map(of_sky).collect()
}

/// Error of a picture, as the tables have it.
fn error(
    bake: &Bake,
    scene: &Scene,
    sky: &Arc<Environment>,
    (roughness, transfer): (f32, Transfer),
    [a, b]: &[Picture; 2],
    size: &Size,
) -> Result<String> {
    let scene = with_roughness(scene, roughness);
    let surfaces = TriangleSurfaces::from_scene(&scene);
    let groups = bake.file.sources.groups.len();
    let lighting = Lighting::new(&[SKY], Some(sky), bake.file.meta.origin, groups);
    let field = GlossyField::new(&bake.file, &lighting, &[]);
    let lamps = lighting.lamps.clone();
    let relit = Relit::lit(&bake.file, &surfaces, lighting, false).with_gloss(&bake.file, &surfaces);
    let basis = Leveled::of_baked(&bake.file);
    let lobe = lobe(roughness);
    let harmonics = |ray: &Ray, hit: &Hit, stream: &mut Stream| {
        let mut weights = Vec::new();
        basis.interpolate(hit.position, hit.normal, hit.group, &mut weights);
        let arriving = field.mean(&weights).unwrap_or_default().map(|c| c.truncate());
        let mirrored = ray.direction - 2.0 * ray.direction.dot(hit.normal) * hit.normal;
        let bsdf = Bsdf::new(hit, -ray.direction, true);
        let single = ggx::single_scattering(roughness, -ray.direction.dot(hit.normal));
        let around = bsdf.albedo * single * value(&convolved(&arriving, &lobe), mirrored).max(Vec3::ZERO);
        let weigh = |irradiance: Vec3, to_light| irradiance * bsdf.reflectance(to_light);
        around + direct::toward_hit_with(&surfaces, &lamps, hit, stream, weigh)
    };
    let exposure = Exposure { size: [size.side; 2], samples: 16, seed: 3 };
    let picture = of_metals(&scene, &surfaces, exposure, |ray, hit, stream| match transfer {
        Transfer::HarmonicsAlone => harmonics(ray, hit, stream),
        _ => relit.radiance(&surfaces, ray, Only::All, stream),
    });
    let comparison = compare(&picture, a, Some(b)).context("a picture of metal")?;
    Ok(cell(&comparison.error))
}

/// An error, and half the width of its interval.
fn cell(error: &ErrorEstimate) -> String {
    match (error.value, error.at_least, error.at_most) {
        (Some(value), Some(low), Some(high)) => format!("{value:.3} ± {:.3}", 0.5 * (high - low)),
        _ => format!("under {:.3}", error.figure()),
    }
}

/// Factors of the bands of the lobe at normal incidence, of total 1, about the mirrored direction.
fn lobe(roughness: f32) -> [f32; 5] {
    let alpha = ggx::alpha(roughness);
    let of = |t: f64| {
        let half = ((1.0 + t) / 2.0).sqrt() as f32;
        let masked = 1.0 + ggx::smith_lambda(alpha, t as f32);
        if t > 0.0 { f64::from(ggx::density(alpha, half) / masked) } else { 0.0 }
    };
    let found = factors(of);
    found.map(|factor| factor / found[0])
}
