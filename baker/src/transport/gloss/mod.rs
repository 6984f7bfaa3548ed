//! Glossy transfer: the [coefficients](rebounce_shared::harmonics) of the radiance that arrives at points of glossy surfaces,
//! after occlusion and all bounces. The BRDF is applied when a picture is drawn.
//!
//! Bounced light comes by [links](Transfer::Links) from the scene's surfaces, or by [matrices](Transfer::Matrices) from the
//! environment's coefficients (Lehtinen et al. 2007, 5.2 and 6.4). In both the points have the coefficients of visibility:
//! pictures read the environment itself where it is seen.
//!
//! * here: the whole computation;
//! * `glossy_points` – points of glossy surfaces, and the points that those interpolate;
//! * `rays` – the rays of a point;
//! * `links` – links to a point; `merge` – fewer links in a row;
//! * `sky_irradiance` – what the scene's surfaces get from each function of the environment, through the operator;
//! * `matrix` – a point's matrix, by rays;
//! * `neighbour` – metals that are seen in metals, by one more gather;
//! * `adaptive` – which points get a matrix of their own.
//!
//! **Below the horizon** of a point nothing arrives, and harmonics of an edge ring. So the hemisphere is mirrored at the
//! point's tangent plane: radiance is the same on both sides of it. Reflected rays are above, and lobes near the horizon see
//! what is there.

mod adaptive;
mod glossy_points;
mod links;
mod matrix;
mod merge;
mod neighbour;
mod rays;
mod sky_irradiance;

pub use super::gloss_settings::{GlossReport, GlossSettings, Transfer};
use crate::geometry::Surfaces;
use crate::job::watch::{Stopped, Watch};
use crate::sampling::Points;
use crate::transport::environment::principal_components::{Clustered, compressed};
use adaptive::Matrices;
use glossy_points::GlossyPoints;
use links::LinkGather;
use matrix::MatrixGather;
use rays::PointRays;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::harmonics::COUNT;
use rebounce_shared::rbn::gloss::{Gloss, GlossLayout, NO_MATRIX};
use sky_irradiance::SkyIrradiance;

/// Computes the glossy transfer of a file; empty without glossy surfaces, and of matrices where no light comes from the sky.
/// `points` are those of the file.
///
/// # Errors
/// [`Stopped`].
pub fn glossy_transfer<S: Surfaces + ?Sized>(
    surfaces: &S,
    points: &Points,
    file: &BakedScene,
    settings: &GlossSettings,
    watch: &dyn Watch,
) -> Result<(Gloss, GlossReport), Stopped> {
    let by_links = settings.transfer == Transfer::Links;
    if !(file.sources.has_sky || by_links) {
        return Ok(Default::default());
    }
    let glossy = GlossyPoints::find(surfaces, points, file, settings);
    if glossy.points.is_empty() {
        return Ok(Default::default());
    }
    let settings = &GlossSettings { has_direct: settings.has_direct && !by_links, ..settings.clone() };
    let rays = PointRays::new(surfaces, points, settings.directions);
    let mut report = GlossReport { points: glossy.points.len() as u64, ..GlossReport::default() };
    let mut gloss = if file.sources.has_sky {
        let irradiance = (!by_links).then(|| SkyIrradiance::new(file));
        let gather = MatrixGather::new(&rays, irradiance, settings);
        let found = adaptive::matrices(&gather, file, &glossy, settings, watch)?;
        (report.matrices, report.rays) = (found.matrices.len() as u64, found.rays);
        let (gloss, error) = packed(&glossy.points, &found, settings);
        report.compression_error = error;
        gloss
    } else {
        // No environment is seen.
        let clusters = vec![NO_MATRIX; glossy.points.len()];
        Gloss { points: glossy.points.clone(), clusters, ..Gloss::default() }
    };
    gloss.layout.roughness = [settings.metals, settings.dielectrics];
    if by_links {
        let gather = LinkGather::new(&rays, file, settings);
        let found = gather.rows(file, &glossy, settings, watch)?;
        report.linked_points = found.links.iter().filter(|row| !row.is_empty()).count() as u64;
        report.links = found.links.links.len() as u64;
        report.rays += found.rays;
        gloss.links = found.links;
        gloss.layout.emission = gather.emission();
    }
    Ok((gloss, report))
}

/// Compresses matrices of some of the `points`; returns the error beside: the root mean square of what is lost relative to
/// that of the matrices.
fn packed(points: &[u32], found: &Matrices, settings: &GlossSettings) -> (Gloss, f64) {
    let all: Vec<&[f32]> = found.matrices.iter().map(|matrix| &**matrix).collect();
    let Some(first) = all.first() else { return Default::default() };
    let Clustered { clusters, scales, weights, vectors, error } = compressed(&all, settings.components);
    let mut by_point = vec![NO_MATRIX; points.len()];
    for (point, cluster) in found.points.iter().zip(clusters) {
        if let Ok(place) = points.binary_search(point) {
            by_point[place] = cluster;
        }
    }
    let layout = GlossLayout {
        has_direct: settings.has_direct,
        channels: (first.len() / (COUNT * COUNT)) as u32,
        scales,
        ..GlossLayout::default()
    };
    let points = points.to_vec();
    (Gloss { layout, points, clusters: by_point, weights, vectors, ..Gloss::default() }, error)
}
