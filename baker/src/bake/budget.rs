//! Limits on file size and memory: fewer functions if the size is known before the bake, fewer links if a finished file
//! is too large.

use super::{BakeSettings, Preset, assemble};
use crate::geometry::mesh::MOST_PRIMITIVES;
use crate::scene::{Scene, Texture};
use glam::Vec3;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::link::{LaterLink, Link, Sent};
use rebounce_shared::rbn::codec::links;
use rebounce_shared::rbn::{LinkMatrix, RbnError, container};

/// Reason for an impossible budget.
#[derive(Debug, thiserror::Error)]
pub enum BudgetError {
    /// Geometry and textures exceed the file size.
    #[error("{wanted} bytes are too few: {largest}; give at least --max-bytes {least}, or make that smaller")]
    Bytes {
        /// The limit.
        wanted: u64,
        /// Bytes needed by the smallest bake.
        least: u64,
        /// Description of the largest part.
        largest: String,
    },
    /// The scene exceeds the memory.
    #[error(
        "{wanted} bytes of memory are too few: {largest}; give at least --max-memory {least}, or simplify that"
    )]
    Memory {
        /// The limit.
        wanted: u64,
        /// Bytes needed by the smallest bake.
        least: u64,
        /// Description of the largest part.
        largest: String,
    },
    /// No preset promises an error this small.
    #[error("no preset is made for an error under {best}: give at least --target-error {best}")]
    Error {
        /// Smallest promised error.
        best: f64,
    },
    /// The file cannot be written.
    #[error(transparent)]
    Format(#[from] RbnError),
}

/// Limits on the cost of a bake; `None`: unlimited.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Budget {
    /// Bytes of the file.
    pub bytes: Option<u64>,
    /// Approximate bytes of memory.
    pub memory: Option<u64>,
    /// Whether a path tracer measures the bake's error in the same process memory ([`super::judge`]).
    pub is_judged: bool,
}

/// Bytes of a file per function of the finest level, including coarser functions and links: from 55 (a kitchen) to 80
/// (Sponza), format 6.
const BYTES_A_FUNCTION: f64 = 80.0;
/// Minimum number of functions on the finest level; with fewer, bounced light has no detail.
const LEAST_FUNCTIONS: usize = 2_000;
/// Bytes of memory: fixed, per triangle, per texel, per function of the finest level; above the measured values
/// (docs/decisions/0079-cost-of-a-bake-and-a-frame.md). Triangles need the peak memory while the scene file is read.
const MEMORY: [f64; 4] = [60e6, 400.0, 8.0, 2_900.0];
/// Additional bytes per instance of a model, and per triangle of an instance: ray hits on instances are precomputed,
/// too.
const COPIED: [f64; 2] = [500.0, 20.0];
/// Additional bytes per triangle for measuring the error: the file's triangles beside the scene's, with a separate BVH.
/// Measured: 70 to 170 with 60 thousand triangles, 230 with 260 thousand, 210 with a million.
const JUDGED: f64 = 240.0;

/// Returns the coarsest preset that promises this error or less.
///
/// # Errors
/// [`BudgetError::Error`] if no preset does.
pub fn preset_for(error: f64) -> Result<Preset, BudgetError> {
    let presets = [Preset::Draft, Preset::Standard, Preset::Fine];
    let fitting = presets.into_iter().find(|preset| preset.promised_error() <= error);
    fitting.ok_or(BudgetError::Error { best: Preset::Fine.promised_error() })
}

/// Lowers the number of functions to the number expected to fit the budget; returns the new number if lower.
///
/// # Errors
/// [`BudgetError`] if the scene without functions is over the budget; names the largest part.
pub fn plan(
    scene: &Scene,
    settings: &mut BakeSettings,
    budget: &Budget,
) -> Result<Option<usize>, BudgetError> {
    let mut functions = settings.place.functions;
    if let Some(wanted) = budget.bytes {
        let empty = assemble::without_light(scene).to_bytes()?;
        let alone = empty.len() as f64;
        let affordable = (wanted as f64 - alone) / BYTES_A_FUNCTION;
        if affordable < LEAST_FUNCTIONS as f64 {
            let least = (alone + BYTES_A_FUNCTION * LEAST_FUNCTIONS as f64).ceil() as u64;
            return Err(BudgetError::Bytes { wanted, least, largest: largest_section(scene, &empty)? });
        }
        functions = functions.min(affordable as usize);
    }
    if let Some(wanted) = budget.memory {
        let [triangles, textures] = memory_of_scene(scene, budget.is_judged);
        let alone = MEMORY[0] + triangles + textures;
        let affordable = (wanted as f64 - alone) / MEMORY[3];
        if affordable < LEAST_FUNCTIONS as f64 {
            let least = (alone + MEMORY[3] * LEAST_FUNCTIONS as f64).ceil() as u64;
            return Err(BudgetError::Memory { wanted, least, largest: largest_in_memory(scene) });
        }
        functions = functions.min(affordable as usize);
    }
    let fewer = functions < settings.place.functions;
    settings.place.functions = functions;
    Ok(fewer.then_some(functions))
}

/// Returns the approximate bytes of memory of a bake, above the measured values, where the preset's number of functions is
/// not lowered.
pub fn memory(scene: &Scene, settings: &BakeSettings) -> u64 {
    let of_scene: f64 = memory_of_scene(scene, false).into_iter().sum();
    (MEMORY[0] + of_scene + MEMORY[3] * settings.place.functions as f64) as u64
}

/// Describes the part of a scene that takes most of a bake's memory.
pub fn largest_in_memory(scene: &Scene) -> String {
    let [triangles, textures] = memory_of_scene(scene, false);
    largest_texture(scene).filter(|_| textures > triangles).unwrap_or_else(|| largest_material(scene))
}

/// Returns the bytes of memory for triangles and for textures.
fn memory_of_scene(scene: &Scene, is_judged: bool) -> [f64; 2] {
    let copied = scene.triangles_placed().min(MOST_PRIMITIVES).saturating_sub(scene.triangles.len() as u64);
    let of_one = MEMORY[1] + if is_judged { JUDGED } else { 0.0 };
    let triangles = of_one * scene.triangles.len() as f64
        + COPIED[0] * scene.instances() as f64
        + COPIED[1] * copied as f64;
    [triangles, MEMORY[2] * scene.textures.iter().map(texels).sum::<u64>() as f64]
}

/// Describes the largest part of a file without light.
fn largest_section(scene: &Scene, file: &[u8]) -> Result<String, RbnError> {
    let sections = container::read(file)?;
    let bytes = |names: &[&[u8; 4]]| -> usize {
        sections.iter().filter(|s| names.contains(&&s.name)).map(|s| s.len).sum()
    };
    let (textures, geometry) = (bytes(&[b"TEXD"]), bytes(&[b"VERT", b"INDX", b"INST", b"COPY"]));
    let texture = scene.textures.iter().max_by_key(|texture| texture.bytes.len());
    Ok(match texture {
        Some(texture) if textures > geometry => format!(
            "textures take {textures}, the largest {:?} {} ({} x {})",
            texture.meta.name,
            texture.bytes.len(),
            texture.meta.width,
            texture.meta.height
        ),
        _ => format!("geometry takes {geometry}; {}", largest_material(scene)),
    })
}

/// Returns the number of texels decoded for the bake.
fn texels(texture: &Texture) -> u64 {
    texture.texels.as_ref().map_or(0, |texels| texels.width as u64 * texels.height as u64)
}

/// Describes the texture with the most texels.
fn largest_texture(scene: &Scene) -> Option<String> {
    let largest = scene.textures.iter().max_by_key(|texture| texels(texture))?;
    let meta = &largest.meta;
    let count = scene.textures.len();
    Some(format!("the largest of {count} textures is {:?}, {} x {}", meta.name, meta.width, meta.height))
}

/// Describes the material with the most triangles.
fn largest_material(scene: &Scene) -> String {
    let mut counts = vec![0usize; scene.materials.len()];
    scene.triangle_material.iter().for_each(|material| counts[*material as usize] += 1);
    let (material, count) = counts.iter().enumerate().max_by_key(|(_, count)| **count).unwrap_or((0, &0));
    let name = scene.materials.get(material).map_or("", |material| &material.name);
    format!("{count} of {} triangles are of material {name:?}", scene.triangles.len())
}

/// Link counts of a thinned file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thinned {
    /// Links before thinning.
    pub before: usize,
    /// Links after thinning.
    pub after: usize,
}

/// Merges weak links into neighbours in the row until the file is within `bytes`; row sums stay. Returns the link
/// counts if links were removed.
///
/// # Errors
/// [`BudgetError::Bytes`] if the file is too large even with a single link per row.
pub fn fit(file: &mut BakedScene, bytes: u64) -> Result<Option<Thinned>, BudgetError> {
    let whole = file.to_bytes()?.len() as u64;
    if whole <= bytes {
        return Ok(None);
    }
    if file.is_for_environment() {
        let largest = "points and transfer take it: bake with fewer --functions".to_owned();
        return Err(BudgetError::Bytes { wanted: bytes, least: whole, largest });
    }
    let size = |links: &LinkMatrix<Link>, later: &LinkMatrix<LaterLink>| {
        links::encode(&links.offsets, &links.links).len() + links::encode(&later.offsets, &later.links).len()
    };
    let rest = whole - size(&file.links, &file.later) as u64;
    // Sections are aligned.
    let wanted = bytes.saturating_sub(rest + 4 * container::ALIGNMENT as u64);
    let thinned = |least: f32| {
        let links = thin(&file.links, least, Link::amount, f32::abs, Link::pack);
        let later = thin(&file.later, least, LaterLink::colour, Vec3::max_element, LaterLink::pack);
        (links, later)
    };
    // Bisection on a logarithmic scale, between thresholds below and above every link.
    let (mut low, mut high) = (1e-8f32, 4.0f32);
    let mut best = thinned(high);
    let least = size(&best.0, &best.1) as u64;
    if least > wanted {
        let least = rest + least;
        let largest = "points and one link for each of them take the rest".to_owned();
        return Err(BudgetError::Bytes { wanted: bytes, least, largest });
    }
    for _ in 0..14 {
        let middle = (low * high).sqrt();
        let tried = thinned(middle);
        if size(&tried.0, &tried.1) as u64 <= wanted {
            (high, best) = (middle, tried);
        } else {
            low = middle;
        }
    }
    let result = Thinned { before: file.link_count(), after: best.0.links.len() };
    (file.links, file.later) = best;
    Ok(Some(result))
}

/// Removes weak links. The value of a removed link is carried to the next link of the row; a link is kept if its value
/// plus the carry is over `least`. The remaining carry of a row goes to the last kept link; a row without a kept link
/// keeps its strongest link.
fn thin<L: Sent, V>(
    matrix: &LinkMatrix<L>,
    least: f32,
    value: impl Fn(L) -> V,
    size: impl Fn(V) -> f32,
    pack: impl Fn(u32, V) -> L,
) -> LinkMatrix<L>
where
    V: Copy + Default + std::ops::AddAssign + std::ops::SubAssign,
{
    let mut thinned = LinkMatrix::default();
    for row in matrix.iter() {
        let first = thinned.links.len();
        let mut carried = V::default();
        for &link in row {
            carried += value(link);
            if size(carried) > least {
                let kept = pack(link.sender() as u32, carried);
                thinned.links.push(kept);
                carried -= value(kept);
            }
        }
        let strongest = row.iter().max_by(|a, b| size(value(**a)).total_cmp(&size(value(**b))));
        match (thinned.links[first..].last_mut(), strongest) {
            (Some(last), _) => {
                carried += value(*last);
                *last = pack(last.sender() as u32, carried);
            }
            (None, Some(strongest)) => thinned.links.push(pack(strongest.sender() as u32, carried)),
            (None, None) => {}
        }
        thinned.offsets.push(thinned.links.len() as u32);
    }
    thinned
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::bake;
    use crate::scene::texture::Texels;

    fn small() -> BakeSettings {
        let mut settings = BakeSettings::new(Preset::Draft);
        (settings.place.levels, settings.place.functions) = (4, 2_500);
        settings.operator.rays = vec![256, 128];
        settings
    }

    #[test]
    fn a_file_is_thinned_to_its_budget_and_rows_keep_their_sums() {
        let scene = crate::io::load("builtin:two-rooms-door").unwrap();
        let (whole, _) = bake(&scene, &small(), &()).unwrap();
        let bytes = whole.to_bytes().unwrap().len() as u64;
        let sums = |file: &BakedScene| -> Vec<f32> {
            file.links.iter().map(|row| row.iter().map(|link| link.amount()).sum()).collect()
        };
        let mut same = whole.clone();
        assert_eq!(fit(&mut same, bytes).unwrap(), None);
        assert_eq!(same, whole);
        let mut last = whole.link_count();
        for share in [0.9, 0.75] {
            let mut thinned = whole.clone();
            let wanted = (bytes as f64 * share) as u64;
            let told = fit(&mut thinned, wanted).unwrap().unwrap();
            let found = thinned.to_bytes().unwrap().len() as u64;
            assert!(found <= wanted && found as f64 > 0.95 * wanted as f64, "{found} of {wanted}");
            assert_eq!((told.before, told.after), (whole.link_count(), thinned.link_count()));
            assert!(told.after < last);
            last = told.after;
            // Up to the packing error of the last link: half a step of the mantissa.
            for (row, (sum, wanted)) in thinned.links.iter().zip(sums(&thinned).into_iter().zip(sums(&whole)))
            {
                let last = row.last().map_or(0.0, |link| link.amount().abs());
                assert!((sum - wanted).abs() <= last / 15.0 + 1e-5, "{sum}, not {wanted}");
            }
        }
        let error = fit(&mut whole.clone(), 1000).unwrap_err().to_string();
        assert!(error.contains("--max-bytes"), "{error}");
    }

    #[test]
    fn a_plan_lowers_the_functions_or_names_what_is_too_large() {
        let scene = crate::io::load("builtin:library").unwrap();
        let plan = |bytes, memory| {
            let mut settings = BakeSettings::new(Preset::Standard);
            plan(&scene, &mut settings, &Budget { bytes, memory, ..Budget::default() })
                .map(|fewer| (fewer, settings.place.functions))
        };
        let full = BakeSettings::new(Preset::Standard).place.functions;
        assert_eq!(plan(None, None).unwrap(), (None, full));
        assert_eq!(plan(Some(1 << 30), Some(1 << 33)).unwrap(), (None, full));
        let (fewer, functions) = plan(Some(3_000_000), None).unwrap();
        assert!(fewer == Some(functions) && functions < full);
        let (_, by_memory) = plan(Some(3_000_000), Some(100_000_000)).unwrap();
        assert!(by_memory < functions);
        let error = plan(Some(10_000), None).unwrap_err().to_string();
        assert!(error.contains("triangles are of material") && error.contains("--max-bytes"), "{error}");
        let error = plan(None, Some(1_000)).unwrap_err().to_string();
        assert!(error.contains("--max-memory") && error.contains("triangles are of material"), "{error}");
    }

    #[test]
    fn memory_goes_to_triangles_and_texels() {
        let settings = BakeSettings::new(Preset::Standard);
        let judged_or_not = |scene: &Scene, memory, is_judged| {
            plan(scene, &mut settings.clone(), &Budget { bytes: None, memory: Some(memory), is_judged })
        };
        let plan = |scene: &Scene, memory| judged_or_not(scene, memory, false);
        let mut scene = crate::io::load("builtin:two-rooms").unwrap();
        // Measured memory of a hall of five million triangles: 1.7 GB.
        let some = scene.triangles.clone();
        scene.triangles = some.iter().copied().cycle().take(5_400_000).collect();
        scene.triangle_material = vec![0; scene.triangles.len()];
        assert_eq!(plan(&scene, 4_000_000_000).unwrap(), None);
        assert!(plan(&scene, 1_000_000_000).is_err());
        // A sufficient budget for the bake may be too small for measuring the error.
        assert_eq!(plan(&scene, 2_800_000_000).unwrap(), None);
        assert!(judged_or_not(&scene, 2_800_000_000, true).is_err());
        // A theatre of six million triangles in copies: 0.41 GB.
        let theatre = crate::io::load("builtin:theatre").unwrap();
        assert_eq!(plan(&theatre, 700_000_000).unwrap(), None);
        assert!(plan(&theatre, 300_000_000).unwrap().is_some());
        scene.triangles = some;
        // Only the number of texels matters.
        let mut texels = Texels::new(1, 1, vec![[0; 4]]);
        (texels.width, texels.height) = (16_384, 8_192);
        let meta = rebounce_shared::rbn::meta::Texture {
            name: "sky".into(),
            width: 16_384,
            height: 8_192,
            ..Default::default()
        };
        scene.textures.push(Texture { meta, bytes: [].into(), texels: Some(texels.into()) });
        let error = plan(&scene, 500_000_000).unwrap_err().to_string();
        assert!(error.contains("\"sky\", 16384 x 8192"), "{error}");
    }

    #[test]
    fn the_coarsest_preset_that_promises_an_error_is_taken() {
        assert_eq!(preset_for(0.2).unwrap(), Preset::Draft);
        assert_eq!(preset_for(0.1).unwrap(), Preset::Standard);
        assert_eq!(preset_for(0.06).unwrap(), Preset::Fine);
        assert!(preset_for(0.01).unwrap_err().to_string().contains("0.06"));
    }
}
