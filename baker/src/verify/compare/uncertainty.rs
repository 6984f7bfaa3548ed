//! Error of a picture against two noisy references, with a confidence interval.
//!
//! The squared error is a ratio, `q = Σ(p − a)·(p − b) / Σ a·b`, of a picture p and two references
//! a and b with independent noise. The standard error follows by *Taylor linearisation of a ratio*:
//! with the residuals `y = (p − a)·(p − b) − q a·b` of the pixels, `SE(q) = √Var(Σ y) / Σ a·b`. The
//! variance is the variance of a *stratified sample* with blocks of pixels as strata: the variance
//! of the residuals within a block, times the block's number of pixels. The estimate is exact for
//! noise of any distribution, fireflies included, where the error is constant within a block, and
//! too large by the variation of the error within blocks.
//!
//! Neighbouring pixels of some renderers share noise. The variance is therefore multiplied by the
//! *design effect*: the variance of sums over blocks divided by the variance of pixels, of
//! `(p − c + q c)·(a − b)`, where c is the mean of the references and the expectation is 0 everywhere.
//!
//! A negative estimate is pure noise of at least that magnitude. No value is clipped, trimmed or
//! left out: removal would change the estimated quantity. An interval of [`SIGMAS`] standard errors
//! to either side contains the truth in at least nine of ten cases where a few pixels hold most of
//! the noise, and nearly always for normal noise; tests check both.

use glam::DVec3;

/// Half width of an interval in standard errors: for noise with heavier tails than normal.
pub const SIGMAS: f64 = 2.5;

/// Error with its confidence interval.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct ErrorEstimate {
    /// Root mean square of the difference over the reference's root mean square; 0 is perfect.
    /// `None`: the references are too noisy to distinguish the error from 0.
    #[serde(rename = "error")]
    pub value: Option<f64>,
    /// Lower end of the interval. `None` with a single reference of unknown noise.
    #[serde(rename = "error_at_least")]
    pub at_least: Option<f64>,
    /// Upper end of the interval; over 0 where there is noise. `None` with a single reference.
    #[serde(rename = "error_at_most")]
    pub at_most: Option<f64>,
}

/// Comparison of an error with a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// The error is within the limit.
    Within,
    /// The error is over the limit.
    Over,
    /// The limit is inside the interval.
    TooNoisy,
}

impl ErrorEstimate {
    /// Error against a single reference, including the unknown noise of the reference.
    pub fn with_noise(error: f64) -> Self {
        Self { value: Some(error), at_least: None, at_most: None }
    }

    /// Single conservative number: the error, or its upper bound where noise hides the error.
    pub fn figure(&self) -> f64 {
        self.value.or(self.at_most).unwrap_or(f64::INFINITY)
    }

    /// Compares the error with the limit `most`. With a single reference, the error including noise
    /// counts.
    pub fn is_within(&self, most: f64) -> Answer {
        let value = self.figure();
        let (low, high) = (self.at_least.unwrap_or(value), self.at_most.unwrap_or(value));
        match () {
            () if high <= most => Answer::Within,
            () if low > most => Answer::Over,
            () => Answer::TooNoisy,
        }
    }

    /// Text of the error with `decimals` decimals, or with significant digits where the decimals
    /// would be zeros.
    pub fn said(&self, decimals: usize) -> String {
        let shown = |error: f64| shown(error, decimals);
        match (self.value, self.at_least, self.at_most) {
            (Some(error), Some(low), Some(high)) => {
                format!("error {} ({} to {})", shown(error), shown(low), shown(high))
            }
            (Some(error), ..) => format!("error {}", shown(error)),
            (None, ..) => format!("error too noisy to tell, at most {}", shown(self.figure())),
        }
    }
}

/// Formats an error with `decimals` decimals; with two significant digits where the decimals would
/// be zeros.
pub fn shown(error: f64, decimals: usize) -> String {
    match error != 0.0 && error < 0.5 * 0.1_f64.powi(decimals as i32) {
        true => format!("{error:.1e}"),
        false => format!("{error:.decimals$}"),
    }
}

/// A pixel of a picture and of its two references.
pub type Pixel = [DVec3; 3];

/// Estimates the error of a picture and its interval from two references. `blocks` covers the
/// picture, every pixel in exactly one block of neighbours. `power` is `Σ a·b`, over 0.
pub fn estimate(blocks: impl Iterator<Item = Vec<Pixel>> + Clone, power: f64) -> ErrorEstimate {
    let squares: f64 = blocks.clone().flatten().map(|[p, a, b]| (p - a).dot(p - b)).sum();
    let ratio = squares / power;
    // A negative ratio is noise.
    let known = ratio.max(0.0);
    let (mut variance, mut of_pixels, mut of_blocks) = (0.0, 0.0, 0.0);
    for block in blocks {
        let count = block.len() as f64;
        let (mut sum, mut sum_of_squares, mut swaps) = (0.0, 0.0, 0.0);
        for [p, a, b] in block {
            let residual = (p - a).dot(p - b) - known * a.dot(b);
            sum += residual;
            sum_of_squares += residual * residual;
            // Noise of the references alone, with random sign.
            let mean = 0.5 * (a + b);
            let swap = (p - mean + known * mean).dot(a - b);
            swaps += swap;
            of_pixels += swap * swap;
        }
        of_blocks += swaps * swaps;
        // A single pixel in a block contributes its square.
        let spread = sum_of_squares - if count > 1.0 { sum * sum / count } else { 0.0 };
        variance += spread.max(0.0) * count / (count - 1.0).max(1.0);
    }
    let design = if of_pixels > 0.0 { (of_blocks / of_pixels).max(1.0) } else { 1.0 };
    let mut reach = SIGMAS * (variance * design).sqrt() / power;
    if ratio < 0.0 {
        reach = reach.max(-ratio);
    }
    ErrorEstimate {
        value: (ratio > reach).then(|| known.sqrt()),
        at_least: Some((known - reach).max(0.0).sqrt()),
        at_most: Some((known + reach).sqrt()),
    }
}

#[cfg(test)]
mod tests;
