//! In place of glossy transfer where it is not compiled.

pub use super::gloss_settings::{GlossReport, GlossSettings, Transfer};
use crate::geometry::Surfaces;
use crate::job::watch::{Stopped, Watch};
use crate::sampling::Points;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::rbn::gloss::Gloss;

/// No glossy transfer.
///
/// # Errors
/// None.
pub fn glossy_transfer<S: Surfaces + ?Sized>(
    _surfaces: &S,
    _points: &Points,
    _file: &BakedScene,
    _settings: &GlossSettings,
    _watch: &dyn Watch,
) -> Result<(Gloss, GlossReport), Stopped> {
    Ok(Default::default())
}
