//! Error of baked light against ground truth: compares the bounced light of a path tracer with the bounced light of the
//! baked file, in one view under the view's lamps, with [`compare`].

use crate::geometry::SceneSurfaces;
use crate::geometry::mesh::TriangleSurfaces;
use crate::geometry::{Ray, Surfaces};
use crate::io::picture::{Only, Picture};
use crate::light::illumination::Illumination;
use crate::scene::{Scene, SceneError, emissive_groups};
use crate::verify::compare::uncertainty::{Answer, ErrorEstimate};
use crate::verify::compare::{CompareError, Comparison, compare};
use crate::verify::expose::Exposure;
use crate::verify::path_trace::{Settings, path_trace};
use crate::verify::render::render;
use glam::{DVec3, Vec3};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::light::Light;
use rebounce_shared::lighting::with_emission;
use rebounce_shared::mix::mixed;
use rebounce_shared::shot::Shot;

/// Approximate number of pixels of a picture. With fewer, wider pixels, errors at edges go unseen.
const PIXELS: f32 = 57_600.0;
/// Samples per pixel of the file's picture.
const SAMPLES: u32 = 64;
/// Initial samples per pixel of each of the two ground-truth pictures, whose noise cancels out.
const TRUE_SAMPLES: u32 = 25;
/// Maximum number of doublings of the ground-truth samples: up to thirty-two times the initial time.
const DOUBLINGS: u32 = 5;
/// Half width of a confidence interval, relative to the target, below which sampling ends: one view cannot determine a
/// file's error more precisely.
const NARROW: f64 = 0.1;

/// Reason for a failed measurement.
#[derive(Debug, thiserror::Error)]
pub enum JudgeError {
    /// The pictures cannot be compared.
    #[error("the bounced light of this view cannot be measured: {0}")]
    Compare(#[from] CompareError),
    /// The baked file's surfaces cannot be built.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

/// Error of a file's light in a view, against ground truth.
#[derive(Clone, Debug)]
pub struct Verdict {
    /// Error figures.
    pub comparison: Comparison,
    /// Surfaces with the largest error; `None` without error.
    pub worst: Option<Worst>,
}

/// The material with the largest part of an error.
#[derive(Clone, Debug, PartialEq)]
pub struct Worst {
    /// Material index and name; the name may be empty.
    pub material: (usize, String),
    /// Share of the squared error; may be over 1 if noise makes other shares negative.
    pub share: f64,
    /// Position of the material's largest pixel error, world space.
    pub place: [f64; 3],
}

/// Returns whether an error is within a target. If noise leaves the answer open, the middle of a narrow interval
/// decides.
pub fn is_within(error: &ErrorEstimate, target: f64) -> Answer {
    let width = error.at_most.zip(error.at_least).map_or(0.0, |(high, low)| high - low);
    match (error.is_within(target), error.value) {
        (Answer::TooNoisy, Some(value)) if width <= 2.0 * NARROW * target => {
            if value <= target {
                Answer::Within
            } else {
                Answer::Over
            }
        }
        (answer, _) => answer,
    }
}

/// Ground truth of one view.
pub struct Judge<'a> {
    scene: &'a Scene,
    shot: &'a Shot,
    /// The lights of the shot, with its emission and its mix.
    lights: Vec<Light>,
    size: [u32; 2],
    truth: [Picture; 2],
    bounces: Option<u32>,
    /// Samples per pixel of each ground-truth picture.
    samples: u32,
    /// Number of doublings of the ground-truth samples so far.
    doubled: u32,
    /// Surface at the centre of each pixel: material index and position, local space.
    seen: Vec<Option<(u32, Vec3)>>,
}

impl<'a> Judge<'a> {
    /// Path-traces two pictures of the view's light after `bounces` bounces; `None`: all bounces. The result is
    /// independent of the thread count. `row_done` is called after each of the [`Self::rows`], from any thread.
    ///
    /// # Errors
    /// [`JudgeError::Compare`] if the view has no bounced light.
    pub fn new(
        scene: &'a Scene,
        shot: &'a Shot,
        bounces: Option<u32>,
        row_done: impl Fn() + Sync,
    ) -> Result<Self, JudgeError> {
        Self::sized(scene, shot, bounces, (Self::size(shot, PIXELS), TRUE_SAMPLES), row_done)
    }

    fn sized(
        scene: &'a Scene,
        shot: &'a Shot,
        bounces: Option<u32>,
        (size, samples): ([u32; 2], u32),
        row_done: impl Fn() + Sync,
    ) -> Result<Self, JudgeError> {
        let surfaces = SceneSurfaces::from_scene(scene);
        let seen = seen(&surfaces, scene, shot, size);
        let black = Picture { width: size[0], height: size[1], pixels: Vec::new() };
        let truth = [black.clone(), black];
        let groups = emissive_groups(scene).len();
        let lights = mixed(&with_emission(&shot.lights, groups, shot.emission), &shot.mix);
        let mut judge = Self { scene, shot, lights, size, truth, bounces, samples, doubled: 0, seen };
        judge.truth = [1, 2].map(|seed| judge.traced(&surfaces, seed, samples, &row_done));
        // The two pictures differ by their noise if the view has light.
        while let Err(error) = compare(&judge.truth[0], &judge.truth[1], None) {
            if !matches!(error, CompareError::TooNoisy) || !judge.can_sample_on() {
                return Err(error.into());
            }
            judge.sample_on(&row_done);
        }
        Ok(judge)
    }

    /// Path-traces a ground-truth picture.
    fn traced(
        &self,
        surfaces: &SceneSurfaces,
        seed: u64,
        samples: u32,
        row_done: impl Fn() + Sync,
    ) -> Picture {
        let exposure = Exposure { size: self.size, samples, seed };
        // The first bounce is always included.
        let settings = Settings {
            only: Only::Indirect,
            bounces: self.bounces.map(|bounces| bounces.max(1)),
            gloss: false,
        };
        let origin = self.scene.origin;
        let groups = emissive_groups(self.scene);
        let environment = self.scene.environment.as_ref();
        let illumination = Illumination::of_scene(surfaces, &self.lights, origin, &groups, environment);
        path_trace(surfaces, origin, &self.shot.camera, &illumination, exposure, settings, row_done)
    }

    /// Returns the shot of the ground truth.
    pub fn shot(&self) -> &Shot {
        self.shot
    }

    /// Returns the samples per pixel of each ground-truth picture.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Returns whether the ground truth may be sampled further.
    fn can_sample_on(&self) -> bool {
        self.doubled < DOUBLINGS
    }

    /// Doubles the ground-truth samples, with new seeds. `row_done` as for [`Self::new`].
    fn sample_on(&mut self, row_done: impl Fn() + Sync) {
        let surfaces = SceneSurfaces::from_scene(self.scene);
        for picture in 0..2 {
            // Seeds 1 and 2 are the initial pictures, seed 3 is the file's picture.
            let seed = u64::from(4 + 2 * self.doubled) + picture as u64;
            let more = self.traced(&surfaces, seed, self.samples(), &row_done);
            self.truth[picture] = self.truth[picture].mean(&more);
        }
        self.samples *= 2;
        self.doubled += 1;
    }

    /// Returns width and height of the pictures, pixels.
    fn size(shot: &Shot, pixels: f32) -> [u32; 2] {
        let size = shot.size.map(|side| side.max(1) as f32);
        let scale = (pixels / (size[0] * size[1])).sqrt();
        size.map(|side| (side * scale).round().max(1.0) as u32)
    }

    /// Returns the number of rows traced by [`Self::new`] (more in views with hardly any light), and by each doubling.
    pub fn rows(shot: &Shot) -> u32 {
        2 * Self::size(shot, PIXELS)[1]
    }

    /// Renders the picture of a baked file of the scene.
    ///
    /// # Errors
    /// [`JudgeError::Scene`].
    pub fn picture(&self, baked: &BakedScene) -> Result<Picture, JudgeError> {
        let camera = &self.shot.camera;
        let surfaces = TriangleSurfaces::from_baked(baked)?;
        let exposure = Exposure { size: self.size, samples: SAMPLES, seed: 3 };
        Ok(render(baked, &surfaces, camera, &self.lights, exposure, Only::Indirect, || ()))
    }

    /// Compares a file's picture with the ground truth at the current number of samples.
    ///
    /// # Errors
    /// [`JudgeError::Compare`].
    pub fn verdict(&self, picture: &Picture) -> Result<Verdict, JudgeError> {
        let [a, b] = &self.truth;
        let comparison = compare(picture, a, Some(b))?;
        Ok(Verdict { comparison, worst: self.worst(picture) })
    }

    /// Returns whether a file's picture is within a target. Doubles the ground-truth samples until the answer is clear
    /// or the limit is reached. Before each doubling, calls `sampling_on` with the current estimate; `sampling_on`
    /// returns the callback for finished rows.
    ///
    /// # Errors
    /// [`JudgeError::Compare`].
    pub fn answer<R: Fn() + Sync>(
        &mut self,
        picture: &Picture,
        target: f64,
        sampling_on: impl Fn(&Self, &ErrorEstimate) -> R,
    ) -> Result<(Answer, Verdict), JudgeError> {
        loop {
            let verdict = self.verdict(picture)?;
            let answer = is_within(&verdict.comparison.error, target);
            if answer != Answer::TooNoisy || !self.can_sample_on() {
                return Ok((answer, verdict));
            }
            let row_done = sampling_on(self, &verdict.comparison.error);
            self.sample_on(row_done);
        }
    }

    /// Returns the material with the largest squared error, and the position of the material's largest pixel error.
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

/// Returns material index and position at the centre of each pixel; `None` without a hit, or if the surfaces have no
/// [primitives](Surfaces::primitives).
fn seen(
    surfaces: &SceneSurfaces,
    scene: &Scene,
    shot: &Shot,
    [width, height]: [u32; 2],
) -> Vec<Option<(u32, Vec3)>> {
    let frame = shot.camera.frame(scene.origin);
    let at = |pixel: u32| {
        let primitives = surfaces.primitives()?;
        let [x, y] = [pixel % width, pixel / width].map(|at| at as f32 + 0.5);
        let direction = frame.direction(x, y, width, height);
        let ray = Ray { origin: frame.eye, direction, max_distance: f32::INFINITY, spread: 0.0 };
        let (place, distance) = primitives.find_seen(&ray, pixel)?;
        Some((primitives.primitive(place.primitive).kind, frame.eye + direction * distance))
    };
    (0..width * height).map(at).collect()
}

/// One material's part of an error.
#[derive(Clone, Copy, Debug, Default)]
struct Blame {
    error: f64,
    largest: f64,
    /// Position of the largest pixel error, local space.
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
    use rebounce_shared::colour::unpack_rgb9e5;
    use rebounce_shared::light::INTENSITY;
    use rebounce_shared::mix::Channel;

    fn small(functions: usize) -> BakeSettings {
        let mut settings = BakeSettings::new(Preset::Draft);
        (settings.place.levels, settings.place.functions) = (4, functions);
        settings.operator.rays = vec![512];
        settings
    }

    #[test]
    #[ignore = "takes much processor time: docs/dev/testing.md"]
    fn more_functions_are_nearer_to_the_truth_and_a_turned_off_wall_is_blamed() {
        let scene = crate::io::load("builtin:cornell-box").unwrap();
        let (camera, lights) = (scene.cameras[0].clone(), scene.lights.clone());
        let shot = Shot::new([64, 64], camera, lights);
        let judge = Judge::new(&scene, &shot, None, || ()).unwrap();
        let error = |file: &BakedScene| judge.verdict(&judge.picture(file).unwrap()).unwrap();
        let (coarse, _) = bake(&scene, &small(300), &()).unwrap();
        let (fine, _) = bake(&scene, &small(8_000), &()).unwrap();
        let (coarse, good) = (error(&coarse), error(&fine));
        assert!(good.comparison.error.figure() < 0.08, "{good:?}");
        assert!(
            coarse.comparison.error.figure() > 1.5 * good.comparison.error.figure(),
            "{coarse:?}, {good:?}"
        );
        // Removes the links of the red wall's points, found by tint.
        let mut broken = fine.clone();
        let rows: Vec<Vec<_>> = (broken.links.iter().zip(&broken.points))
            .map(|(row, point)| {
                let tint = unpack_rgb9e5(point.tint);
                if tint.x > 2.0 * tint.y { Vec::new() } else { row.to_vec() }
            })
            .collect();
        broken.links = rebounce_shared::rbn::LinkMatrix::from_rows(&rows);
        let broken = error(&broken);
        let worst = broken.worst.unwrap();
        assert!(worst.material.1 == "red" && worst.share > 0.5, "{worst:?}");
        assert!(broken.comparison.error.figure() > 2.0 * good.comparison.error.figure());
    }

    #[test]
    fn a_view_is_measured_with_its_emission_and_its_mix() {
        let mut scene = crate::io::load("builtin:cornell-box").unwrap();
        let green = scene.materials.iter().position(|material| material.name == "green").unwrap();
        scene.materials[green].emission = [0.5, 1.0, 0.5];
        let (file, _) = bake(&scene, &small(300), &()).unwrap();
        let lamp = scene.lights[0].clone();
        let shot = |lights: &[Light]| Shot::new([24, 16], scene.cameras[0].clone(), lights.to_vec());
        let channel = |stops, mute| Channel { stops, mute, ..Channel::default() };
        let shine = |intensity| Light::Emissive { group: 0, intensity, color: [1.0; 3] };
        let twice = lamp.with(INTENSITY.at, &[2.0 * lamp.intensity()]);
        // A shot with emission and mix, and the lights that it comes to.
        let pairs = [
            (Shot { emission: 0.5, ..shot(std::slice::from_ref(&lamp)) }, shot(&[lamp.clone(), shine(0.5)])),
            (
                Shot { mix: vec![channel(1.0, false)], ..shot(std::slice::from_ref(&lamp)) },
                shot(&[twice, shine(1.0)]),
            ),
            (
                Shot { mix: vec![channel(0.0, true)], ..shot(std::slice::from_ref(&lamp)) },
                shot(&[shine(1.0)]),
            ),
        ];
        let seen = pairs.map(|(given, meant)| {
            let [given, meant] = [&given, &meant].map(|shot| {
                let judge = Judge::sized(&scene, shot, None, (shot.size, 4), || ()).unwrap();
                [judge.truth[0].pixels.clone(), judge.picture(&file).unwrap().pixels]
            });
            let sum = |pixels: &[Vec3]| pixels.iter().map(|p| p.element_sum()).sum::<f32>();
            for (given, meant) in given.iter().zip(&meant) {
                let [given, meant] = [given, meant].map(|pixels| sum(pixels));
                assert!((given / meant - 1.0).abs() < 0.02, "{given}, not {meant}");
            }
            [sum(&given[0]), sum(&given[1])]
        });
        let [half, twice, without] = seen;
        for ((half, twice), without) in half.into_iter().zip(twice).zip(without) {
            assert!(without < 0.9 * half && half < 0.9 * twice, "{without}, {half}, {twice}");
        }
    }

    #[test]
    fn what_noise_hides_is_sampled_on_for_and_never_taken_for_nothing() {
        // A white room with a door, lit by dozens of bounces.
        let mut scene = crate::io::load("builtin:two-rooms-door").unwrap();
        for material in &mut scene.materials {
            material.base_color = [0.95, 0.95, 0.95, 1.0];
        }
        let (camera, lights) = (scene.cameras[0].clone(), scene.lights.clone());
        let shot = Shot::new([32, 18], camera, lights);
        let (file, _) = bake(&scene, &small(1_000), &()).unwrap();
        let judge = || Judge::sized(&scene, &shot, None, (shot.size, 1), || ()).unwrap();
        let picture = judge().picture(&file).unwrap();
        let first = judge().verdict(&picture).unwrap().comparison.error;
        assert!(first.at_most > Some(0.0), "{first:?}");
        // A target decided by one sample, and a target that stays undecided at any number of samples.
        for (target, doublings) in [(first.figure() + first.at_most.unwrap(), 0..=0), (1e-6, 0..=DOUBLINGS)] {
            let mut judge = judge();
            let heard = std::cell::RefCell::new(Vec::new());
            let told = judge.answer(&picture, target, |judge, error| {
                heard.borrow_mut().push((judge.samples(), *error));
                || ()
            });
            let (answer, verdict) = told.unwrap();
            let heard = heard.into_inner();
            println!("{target}: {answer:?}, {heard:?}, {:?}", verdict.comparison);
            assert!(doublings.contains(&(heard.len() as u32)));
            assert!(heard.iter().zip(0..).all(|((samples, _), i)| *samples == 1 << i));
            assert_eq!(judge.samples(), 1 << heard.len());
            assert!(heard.iter().all(|(_, error)| error.value != Some(0.0) && error.at_most > Some(0.0)));
            assert!(verdict.comparison.error.at_most > Some(0.0));
            assert_eq!(answer == Answer::Within, doublings == (0..=0));
        }
    }

    #[test]
    fn of_an_interval_that_is_narrow_beside_the_target_the_middle_decides() {
        let about = |value: f64, reach: f64| ErrorEstimate {
            value: Some(value),
            at_least: Some(value - reach),
            at_most: Some(value + reach),
        };
        assert_eq!(is_within(&about(0.098, 0.005), 0.1), Answer::Within);
        assert_eq!(is_within(&about(0.102, 0.005), 0.1), Answer::Over);
        assert_eq!(is_within(&about(0.098, 0.02), 0.1), Answer::TooNoisy);
        assert_eq!(is_within(&about(0.05, 0.02), 0.1), Answer::Within);
        let hidden = ErrorEstimate { value: None, at_least: Some(0.0), at_most: Some(0.15) };
        assert_eq!((is_within(&hidden, 0.1), is_within(&hidden, 0.2)), (Answer::TooNoisy, Answer::Within));
    }

    #[test]
    fn a_view_without_bounced_light_is_no_measure() {
        let scene = crate::io::load("builtin:cornell-box").unwrap();
        let camera = scene.cameras[0].clone();
        let shot = Shot::new([16, 16], camera, Vec::new());
        let rows = std::sync::atomic::AtomicU32::new(0);
        let judge = Judge::new(&scene, &shot, None, || {
            rows.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        });
        assert!(matches!(judge.err(), Some(JudgeError::Compare(_))));
        assert_eq!(rows.into_inner(), Judge::rows(&shot));
    }
}
