//! Glossy transfer from distant light (Lehtinen et al. 2007, 5.2 and 6.4): at points of glossy surfaces, a matrix takes the
//! environment's [coefficients](rebounce_shared::harmonics) to those of the radiance that arrives there, after occlusion and
//! all bounces. The BRDF is applied when a picture is drawn.
//!
//! * here: the whole computation;
//! * `glossy_points` – points of glossy surfaces, and the points that those interpolate;
//! * `sky_irradiance` – what the scene's surfaces get from each function of the environment, through the operator;
//! * `matrix` – a point's matrix, by rays;
//! * `adaptive` – which points get a matrix of their own;
//! * `principal_components` – compression.
//!
//! **Below the horizon** of a point nothing arrives, and harmonics of an edge ring. So the hemisphere is mirrored at the
//! point's tangent plane: radiance is the same on both sides of it. Reflected rays are above, and lobes near the horizon see
//! what is there.

mod adaptive;
mod glossy_points;
mod matrix;
mod principal_components;
mod sky_irradiance;

pub use super::gloss_settings::{GlossReport, GlossSettings};
use crate::geometry::Surfaces;
use crate::job::watch::{Stopped, Watch};
use crate::sampling::Points;
use glossy_points::GlossyPoints;
use matrix::MatrixGather;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::rbn::gloss::Gloss;
use sky_irradiance::SkyIrradiance;

/// Computes the glossy transfer of a file; empty without glossy surfaces, or where no light comes from the sky. `points` are
/// those of the file.
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
    if !file.sources.has_sky {
        return Ok(Default::default());
    }
    let glossy = GlossyPoints::find(surfaces, points, file, settings);
    if glossy.points.is_empty() {
        return Ok(Default::default());
    }
    let irradiance = SkyIrradiance::new(file);
    let gather = MatrixGather::new(surfaces, points, irradiance, settings);
    let found = adaptive::matrices(&gather, file, &glossy, settings, watch)?;
    let mut report = GlossReport {
        points: glossy.points.len() as u64,
        matrices: found.matrices.len() as u64,
        rays: found.rays,
        compression_error: 0.0,
    };
    let (gloss, error) = principal_components::compressed(&glossy.points, &found, settings);
    report.compression_error = error;
    Ok((gloss, report))
}
