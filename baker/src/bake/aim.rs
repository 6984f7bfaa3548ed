//! Sequence of settings to try until a bake's error is within a target.

use super::{BakeSettings, Preset};

/// Functions and ε of the settings after the presets: the number of functions doubles, ε shrinks to three quarters.
const BEYOND: [(usize, f32); 2] = [(500_000, 0.0075), (1_000_000, 0.0056)];
/// Minimum relative decrease of the error for another try. Every preset is tried regardless: from `draft` to
/// `standard`, functions increase and links get no finer.
const LEAST_GAIN: f64 = 0.1;
const PRESETS: usize = 3;

/// Returns the settings from the cheapest to the costliest; `adjust` returns the settings of a preset with the user's
/// options applied.
pub fn tries(adjust: impl Fn(Preset) -> BakeSettings) -> Vec<BakeSettings> {
    let presets = [Preset::Draft, Preset::Standard, Preset::Fine].map(&adjust);
    let beyond = BEYOND.map(|(functions, epsilon)| {
        let mut settings = adjust(Preset::Fine);
        settings.place.functions = functions;
        // The user's ε may be smaller.
        settings.operator.epsilon = settings.operator.epsilon.min(epsilon);
        settings
    });
    presets.into_iter().chain(beyond).collect()
}

/// Returns whether a finer bake is worth a try. `errors`: errors of the tries so far, latest last.
pub fn is_worth_another(errors: &[f64]) -> bool {
    match errors {
        [.., before, last] if errors.len() >= PRESETS => *last < (1.0 - LEAST_GAIN) * before,
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_try_costs_more_and_keeps_what_it_is_told() {
        let told = |preset| {
            let mut settings = BakeSettings::new(preset);
            (settings.operator.bounces, settings.operator.epsilon) = (Some(2), 0.007);
            settings
        };
        let tries = tries(told);
        assert!(tries.len() > 3 && tries.iter().all(|settings| settings.operator.bounces == Some(2)));
        assert!(tries.iter().all(|settings| settings.operator.epsilon <= 0.007));
        let cost = |settings: &BakeSettings| settings.place.functions;
        assert!(tries.windows(2).all(|pair| cost(&pair[0]) < cost(&pair[1])));
    }

    #[test]
    fn tries_end_where_errors_stay() {
        assert!(is_worth_another(&[]) && is_worth_another(&[0.3]) && is_worth_another(&[0.3, 0.31]));
        assert!(is_worth_another(&[0.3, 0.31, 0.2]) && is_worth_another(&[0.3, 0.2, 0.15, 0.1]));
        assert!(!is_worth_another(&[0.3, 0.2, 0.19]) && !is_worth_another(&[0.3, 0.2, 0.1, 0.11]));
    }
}
