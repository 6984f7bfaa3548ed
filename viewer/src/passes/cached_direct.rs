//! Incremental direct light: the irradiance of unchanged lights at the points is summed once and kept; afterwards
//! only changing lights are evaluated.

use super::shadow::fit::LightRecord;
use crate::scene::relight::CachedEvaluation;

/// Number of unchanged evaluations after which a changed light is added to the sum again.
const CALM: u32 = 8;

/// State of every light: the lights in the kept sum.
#[derive(Debug, Default)]
pub struct CachedDirectLight(Vec<Light>);

#[derive(Clone, Copy, Debug)]
struct Light {
    record: LightRecord,
    kept: bool,
    /// Number of evaluations without a change.
    calm: u32,
}

impl CachedDirectLight {
    /// Notes that the sum is of no use: surfaces or points have moved.
    #[cfg(feature = "radiosity")]
    pub fn forget(&mut self) {
        self.0.iter_mut().for_each(|light| light.record = light.record.of_none());
    }

    /// Returns the work of the next evaluation, which must take place: for these lights, in the same scene and with
    /// the same shadow maps as before. Initially the sum is zero.
    pub fn choose(&mut self, lights: &[LightRecord]) -> CachedEvaluation {
        let before = std::mem::take(&mut self.0);
        // A changed or removed light cannot be subtracted exactly from the sum.
        let changed = |(i, light): (usize, &Light)| light.kept && lights.get(i) != Some(&light.record);
        let keep = !before.iter().enumerate().any(changed);
        let mut choice = CachedEvaluation { keep, ..CachedEvaluation::default() };
        for (i, record) in lights.iter().enumerate() {
            let mut light = match before.get(i) {
                Some(light) if light.record == *record => {
                    Light { calm: light.calm.saturating_add(1), ..*light }
                }
                Some(_) => Light { record: *record, kept: false, calm: 0 },
                None => Light { record: *record, kept: false, calm: CALM },
            };
            light.kept &= keep;
            if !light.kept {
                light.kept = light.calm >= CALM;
                let list = if light.kept { &mut choice.still } else { &mut choice.moving };
                if record.shines() {
                    list.push(i as u32);
                }
            }
            self.0.push(light);
        }
        choice
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::passes::shadow::fit::fit;
    use crate::scene::extent::Extent;
    use glam::Vec3;
    use rebounce_shared::light::Light as Source;

    fn records(intensities: &[f64]) -> Vec<LightRecord> {
        let source = |(i, intensity): (usize, &f64)| {
            let light = Source::Point {
                position: [i as f64, 0.0, 0.0],
                intensity: *intensity,
                color: [1.0; 3],
                radius: 0.0,
            };
            light.source([0.0; 3])
        };
        let sources: Vec<_> = intensities.iter().enumerate().map(source).collect();
        fit(&sources, &Extent { all: [Vec3::ZERO, Vec3::ONE], detail: None }, 0.01, 256).lights
    }

    /// Mirrors the shader, with an intensity for the light of all points.
    fn evaluate(sum: &mut f64, choice: &CachedEvaluation, intensities: &[f64]) -> f64 {
        let total = |list: &[u32]| list.iter().map(|i| intensities[*i as usize]).sum::<f64>();
        *sum = if choice.keep { *sum } else { 0.0 } + total(&choice.still);
        *sum + total(&choice.moving)
    }

    #[test]
    fn whatever_the_lights_do_their_sum_is_that_of_all() {
        let (mut still, mut sum) = (CachedDirectLight::default(), 0.0);
        let mut intensities = vec![1.0; 5];
        let mut seed = 1u32;
        let mut random = |below: u32| {
            seed = seed.wrapping_mul(0x2c92_77b5).wrapping_add(0xac56_4b05);
            (seed >> 16) % below
        };
        let mut evaluated = 0;
        for step in 0..4000 {
            // Long periods with a single changing light; occasionally a change of another light.
            let one = (step / 40) % intensities.len();
            intensities[one] = random(9) as f64;
            match random(30) {
                0 => intensities.push(random(9) as f64),
                1 if intensities.len() > 2 => drop(intensities.remove(random(2) as usize)),
                2 => intensities[0] = random(9) as f64,
                #[cfg(feature = "radiosity")]
                3 => {
                    // What the lights give the points is another amount now.
                    still.forget();
                    sum *= 2.0;
                }
                _ => {}
            }
            let choice = still.choose(&records(&intensities));
            evaluated += choice.count();
            assert_eq!(
                evaluate(&mut sum, &choice, &intensities),
                intensities.iter().sum::<f64>(),
                "step {step}"
            );
        }
        assert!(evaluated > 4000, "{evaluated}");
    }

    #[test]
    fn one_that_moves_is_evaluated_alone_and_belongs_to_the_others_when_it_rests() {
        let mut still = CachedDirectLight::default();
        let mut intensities = vec![1.0; 16];
        let all: Vec<u32> = (0..16).collect();
        let first = still.choose(&records(&intensities));
        assert_eq!(first, CachedEvaluation { keep: true, still: all.clone(), moving: vec![] });
        intensities[3] = 2.0;
        let begins = still.choose(&records(&intensities));
        assert_eq!((begins.keep, begins.count(), &begins.moving[..]), (false, 16, &[3][..]));
        for step in 0..20 {
            intensities[3] = 3.0 + step as f64;
            let choice = still.choose(&records(&intensities));
            assert_eq!(choice, CachedEvaluation { keep: true, still: vec![], moving: vec![3] });
        }
        // A second light changes: all lights once more, then two, until the first light rests.
        for step in 0..CALM {
            intensities[7] = 3.0 + step as f64;
            let expected = if step == 0 { 16 } else { 2 };
            assert_eq!(still.choose(&records(&intensities)).count(), expected, "step {step}");
        }
        intensities[7] = 1.5;
        assert_eq!(
            still.choose(&records(&intensities)),
            CachedEvaluation { keep: true, still: vec![], moving: vec![7] }
        );
    }

    #[test]
    fn a_light_that_is_off_costs_nothing() {
        let mut still = CachedDirectLight::default();
        assert_eq!(still.choose(&records(&[0.0, 1.0, 0.0])).count(), 1);
    }
}
