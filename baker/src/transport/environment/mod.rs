//! Precomputed radiance transfer from the environment (Sloan, Kautz and Snyder 2002) through the operator.
//!
//! * here: [`keep_for_environment`], a file whose light comes from its environment alone;
//! * `sky_functions` – a file relit by each spherical harmonic;
//! * `diffuse_transfer` – vectors of the points;
//! * `principal_components` – compression, of diffuse and glossy transfer.

mod diffuse_transfer;
pub(super) mod principal_components;
pub(super) mod sky_functions;

pub use diffuse_transfer::{TransferReport, TransferSettings};

use rebounce_shared::baked::BakedScene;
use rebounce_shared::rbn::LinkMatrix;

/// Puts diffuse transfer in the place of a file's links: its points then get the light of the environment, of emissive
/// surfaces and of directional lamps, and that of other lamps without a bounce.
pub fn keep_for_environment(file: &mut BakedScene, settings: &TransferSettings) -> TransferReport {
    let (transfer, report) = diffuse_transfer::of_file(file, settings);
    let rows = file.points.len();
    file.diffuse_transfer = transfer;
    file.links = without_links(rows);
    file.later = without_links(0);
    file.meta.later_levels = 0;
    file.source_links = without_links(rows);
    // Nothing can move: transfer is that of the object as it stands.
    file.reflectance = Vec::new();
    report
}

fn without_links<L>(rows: usize) -> LinkMatrix<L> {
    LinkMatrix { offsets: vec![0; rows + 1], links: Vec::new() }
}
