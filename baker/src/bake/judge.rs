//! How far baked light is from the truth: in one view, under its lamps, the bounced light of a path tracer and of the
//! baked file, as [`compare`] has it.

use crate::path_trace::{Settings, path_trace};
use crate::picture::compare::{CompareError, Comparison, compare};
use crate::picture::expose::Exposure;
use crate::picture::{Only, Picture};
use crate::render::render;
use crate::scene::{Scene, SceneError};
use crate::surface::{Ray, Surfaces};
use crate::triangles::TriangleSurfaces;
use glam::{DVec3, Vec3};
use rebounce_shared::rbn;
use rebounce_shared::shot::Shot;

/// About how many pixels are looked at: of fewer ones each is wider, and what is wrong at edges goes unseen.
const PIXELS: f32 = 57_600.0;
/// Samples of each pixel of the file's picture.
const SAMPLES: u32 = 64;
/// And of each of two pictures of the truth: their noise cancels out.
const TRUE_SAMPLES: u32 = 25;

/// Why baked light cannot be judged.
#[derive(Debug, thiserror::Error)]
pub enum JudgeError {
    /// The pictures cannot be compared.
    #[error("the bounced light of this view cannot be measured: {0}")]
    Compare(#[from] CompareError),
    /// The baked file's surfaces cannot be made.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

/// What a file's light is in a view, beside the truth.
#[derive(Clone, Debug)]
pub struct Verdict {
    /// The figures.
    pub comparison: Comparison,
    /// Where most of the error is; `None` where there is none.
    pub worst: Option<Worst>,
}

/// The surfaces with the largest part of an error.
#[derive(Clone, Debug, PartialEq)]
pub struct Worst {
    /// Their material's number and name; it may have none.
    pub material: (usize, String),
    /// Their part of the error's square; may be over 1 where noise takes from the others.
    pub share: f64,
    /// Where the largest part of that is, world space.
    pub place: [f64; 3],
}

/// The truth of one view.
pub struct Judge<'a> {
    scene: &'a Scene,
    shot: &'a Shot,
    size: [u32; 2],
    truth: [Picture; 2],
    /// What is seen in the middle of each pixel: its material and where it is, local space.
    seen: Vec<Option<(u32, Vec3)>>,
}

impl<'a> Judge<'a> {
    /// Traces the view's light after this many bounces, or all, twice. The same scene and shot give the same pictures at any
    /// thread count. `row_done` is called after each row of the [`Self::rows`], from any thread.
    ///
    /// # Errors
    /// [`JudgeError::Compare`] where no bounced light is seen.
    pub fn new(
        scene: &'a Scene,
        shot: &'a Shot,
        bounces: Option<u32>,
        row_done: impl Fn() + Sync,
    ) -> Result<Self, JudgeError> {
        let surfaces = TriangleSurfaces::from_scene(scene);
        let size = Self::size(shot);
        let truth = [1, 2].map(|seed| {
            let exposure = Exposure { size, samples: TRUE_SAMPLES, seed };
            // The first one is always there.
            let settings = Settings { only: Only::Indirect, bounces: bounces.map(|bounces| bounces.max(1)) };
            path_trace(&surfaces, scene.origin, &shot.camera, &shot.lights, exposure, settings, &row_done)
        });
        // As far from itself as its noise, if there is anything.
        compare(&truth[0], &truth[0], Some(&truth[1]))?;
        let seen = seen(&surfaces, scene, shot, size);
        Ok(Self { scene, shot, size, truth, seen })
    }

    /// Width and height of the pictures, pixels.
    fn size(shot: &Shot) -> [u32; 2] {
        let size = shot.size.map(|side| side.max(1) as f32);
        let scale = (PIXELS / (size[0] * size[1])).sqrt();
        size.map(|side| (side * scale).round().max(1.0) as u32)
    }

    /// Rows that [`Self::new`] traces.
    pub fn rows(shot: &Shot) -> u32 {
        2 * Self::size(shot)[1]
    }

    /// How far a baked file of the scene is from it.
    ///
    /// # Errors
    /// [`JudgeError`].
    pub fn verdict(&self, baked: &rbn::Scene) -> Result<Verdict, JudgeError> {
        let Shot { camera, lights, .. } = self.shot;
        let surfaces = TriangleSurfaces::from_baked(baked)?;
        let exposure = Exposure { size: self.size, samples: SAMPLES, seed: 3 };
        let picture = render(baked, &surfaces, camera, lights, exposure, Only::Indirect, || ());
        let [a, b] = &self.truth;
        let comparison = compare(&picture, a, Some(b))?;
        Ok(Verdict { comparison, worst: self.worst(&picture) })
    }

    /// The material whose pixels have most of the squared error, and where it is largest.
    fn worst(&self, picture: &Picture) -> Option<Worst> {
        let mut by_material = vec![Blame::default(); self.scene.materials.len()];
        let mut whole = 0.0;
        for (pixel, (p, seen)) in picture.pixels.iter().zip(&self.seen).enumerate() {
            let [a, b] = [0, 1].map(|i| self.truth[i].pixels[pixel].as_dvec3());
            let error = (p.as_dvec3() - a).dot(p.as_dvec3() - b);
            whole += error;
            if let Some((material, place)) = seen
                && let Some(blame) = by_material.get_mut(*material as usize)
            {
                blame.add(error, *place);
            }
        }
        let (material, blame) =
            by_material.iter().enumerate().max_by(|a, b| a.1.error.total_cmp(&b.1.error))?;
        let place = DVec3::from(self.scene.origin) + blame.place.as_dvec3();
        (whole > 0.0 && blame.error > 0.0).then(|| Worst {
            material: (material, self.scene.materials[material].name.clone()),
            share: blame.error / whole,
            place: place.to_array(),
        })
    }
}

/// The material and the place in the middle of each pixel; none where the surfaces do not tell their pieces.
fn seen(
    surfaces: &TriangleSurfaces,
    scene: &Scene,
    shot: &Shot,
    [width, height]: [u32; 2],
) -> Vec<Option<(u32, Vec3)>> {
    let frame = shot.camera.frame(scene.origin);
    let at = |pixel: u32| {
        let pieces = surfaces.pieces()?;
        let [x, y] = [pixel % width, pixel / width].map(|at| at as f32 + 0.5);
        let direction = frame.direction(x, y, width, height);
        let ray = Ray { origin: frame.eye, direction, max_distance: f32::INFINITY, spread: 0.0 };
        let (place, distance) = pieces.find_seen(&ray, pixel)?;
        Some((pieces.piece(place.piece).kind, frame.eye + direction * distance))
    };
    (0..width * height).map(at).collect()
}

/// One material's part of an error.
#[derive(Clone, Copy, Debug, Default)]
struct Blame {
    error: f64,
    largest: f64,
    /// Where that is, local space.
    place: Vec3,
}

impl Blame {
    fn add(&mut self, error: f64, place: Vec3) {
        self.error += error;
        if error > self.largest {
            (self.largest, self.place) = (error, place);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::{BakeSettings, Preset, bake};
    use crate::scene;
    use rebounce_shared::colour::unpack_rgb9e5;

    fn small(functions: usize) -> BakeSettings {
        let mut settings = BakeSettings::new(Preset::Draft);
        (settings.place.levels, settings.place.functions) = (4, functions);
        settings.operator.rays = vec![512];
        settings
    }

    #[test]
    fn more_functions_are_nearer_to_the_truth_and_a_turned_off_wall_is_blamed() {
        let scene = scene::load("builtin:cornell-box").unwrap();
        let (camera, lights) = (scene.cameras[0].clone(), scene.lights.clone());
        let shot = Shot { scene: None, size: [64, 64], camera, lights };
        let judge = Judge::new(&scene, &shot, None, || ()).unwrap();
        let error = |file: &rbn::Scene| judge.verdict(file).unwrap();
        let (coarse, _) = bake(&scene, &small(300), &()).unwrap();
        let (fine, _) = bake(&scene, &small(8_000), &()).unwrap();
        let (coarse, good) = (error(&coarse), error(&fine));
        assert!(good.comparison.error < 0.08, "{good:?}");
        assert!(coarse.comparison.error > 1.5 * good.comparison.error, "{coarse:?}, {good:?}");
        // Points of the red wall, by their tint, lose their links.
        let mut broken = fine.clone();
        let rows: Vec<Vec<_>> = (broken.links.iter().zip(&broken.points))
            .map(|(row, point)| {
                let tint = unpack_rgb9e5(point.tint);
                if tint.x > 2.0 * tint.y { Vec::new() } else { row.to_vec() }
            })
            .collect();
        broken.links = rbn::LinkMatrix::from_rows(&rows);
        let broken = error(&broken);
        let worst = broken.worst.unwrap();
        assert!(worst.material.1 == "red" && worst.share > 0.5, "{worst:?}");
        assert!(broken.comparison.error > 2.0 * good.comparison.error);
    }

    #[test]
    fn a_view_without_bounced_light_is_no_measure() {
        let scene = scene::load("builtin:cornell-box").unwrap();
        let camera = scene.cameras[0].clone();
        let shot = Shot { scene: None, size: [16, 16], camera, lights: Vec::new() };
        let rows = std::sync::atomic::AtomicU32::new(0);
        let judge = Judge::new(&scene, &shot, None, || {
            rows.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        });
        assert!(matches!(judge.err(), Some(JudgeError::Compare(_))));
        assert_eq!(rows.into_inner(), Judge::rows(&shot));
    }
}
