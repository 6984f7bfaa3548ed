//! What noisy references say about an error, and how sure they are of it.
//!
//! An error squared is a ratio, `q = Σ(p − a)·(p − b) / Σ a·b`, of a picture p and two references a and b, whose noise is
//! independent. Its standard error is by *Taylor linearisation of a ratio*: of the residuals `y = (p − a)·(p − b) − q a·b` of
//! all pixels, `SE(q) = √Var(Σ y) / Σ a·b`. The variance is that of a *stratified sample*, whose strata are blocks of pixels:
//! in each block the residuals' own variance, times their number. So it is exact for noise of any distribution, fireflies
//! included, where a block's error is even, and too large by as much as the error differs within blocks.
//!
//! Neighbouring pixels of some renderers share noise. So the variance grows by the *design effect*: that of sums over blocks
//! over that of pixels, in `(p − c + q c)·(a − b)`, c the references' mean, whose expectation is 0 everywhere.
//!
//! An estimate under 0 is noise alone, which is then at least so large. Nothing is clipped, trimmed or left out: it would
//! change what is estimated. An interval of [`SIGMAS`] standard errors to either side holds the truth at least nine times in ten
//! where few pixels have most of the noise, nearly always where it is normal; tests see to it.

use glam::DVec3;

/// Standard errors from an estimate to either end of its interval: for noise whose tails are heavier than normal.
pub const SIGMAS: f64 = 2.5;

/// An error, and where it may lie.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Estimate {
    /// Root mean square of the difference over the reference's root mean square; 0 is perfect. `None`: the references are too
    /// noisy to tell it from 0.
    #[serde(rename = "error")]
    pub value: Option<f64>,
    /// It is hardly less than this. `None`: of one reference nobody knows how noisy it is.
    #[serde(rename = "error_at_least")]
    pub at_least: Option<f64>,
    /// It is hardly more than this; over 0 where there is noise. `None` as above.
    #[serde(rename = "error_at_most")]
    pub at_most: Option<f64>,
}

/// Whether an error is small enough.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// It is.
    Within,
    /// It is not.
    Over,
    /// The interval has both.
    TooNoisy,
}

impl Estimate {
    /// An error with a reference's own noise in it, which nobody knows.
    pub fn with_noise(error: f64) -> Self {
        Self { value: Some(error), at_least: None, at_most: None }
    }

    /// One number to go by, which is not too small: the error, or what it is at most where it is hidden.
    pub fn figure(&self) -> f64 {
        self.value.or(self.at_most).unwrap_or(f64::INFINITY)
    }

    /// Whether the error is at most `most`. Of one reference the error with its noise counts.
    pub fn is_within(&self, most: f64) -> Answer {
        let value = self.figure();
        let (low, high) = (self.at_least.unwrap_or(value), self.at_most.unwrap_or(value));
        match () {
            () if high <= most => Answer::Within,
            () if low > most => Answer::Over,
            () => Answer::TooNoisy,
        }
    }

    /// In words, with so many decimals, or with digits that count where those would all be 0.
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

/// An error with so many decimals; one that would be all zeros, with two digits that count.
pub fn shown(error: f64, decimals: usize) -> String {
    match error != 0.0 && error < 0.5 * 0.1_f64.powi(decimals as i32) {
        true => format!("{error:.1e}"),
        false => format!("{error:.decimals$}"),
    }
}

/// A pixel of a picture and of its two references.
pub type Pixel = [DVec3; 3];

/// How sure two references are of a picture's error. `blocks`: all pixels, each in one block of neighbours. `power` is
/// `Σ a·b`, over 0.
pub fn estimate(blocks: impl Iterator<Item = Vec<Pixel>> + Clone, power: f64) -> Estimate {
    let squares: f64 = blocks.clone().flatten().map(|[p, a, b]| (p - a).dot(p - b)).sum();
    let ratio = squares / power;
    // What is under 0 is noise.
    let known = ratio.max(0.0);
    let (mut variance, mut of_pixels, mut of_blocks) = (0.0, 0.0, 0.0);
    for block in blocks {
        let count = block.len() as f64;
        let (mut sum, mut sum_of_squares, mut swaps) = (0.0, 0.0, 0.0);
        for [p, a, b] in block {
            let residual = (p - a).dot(p - b) - known * a.dot(b);
            sum += residual;
            sum_of_squares += residual * residual;
            // What the references' noise alone says, its sign by chance.
            let mean = 0.5 * (a + b);
            let swap = (p - mean + known * mean).dot(a - b);
            swaps += swap;
            of_pixels += swap * swap;
        }
        of_blocks += swaps * swaps;
        // Of a pixel that is alone in its block the square.
        let spread = sum_of_squares - if count > 1.0 { sum * sum / count } else { 0.0 };
        variance += spread.max(0.0) * count / (count - 1.0).max(1.0);
    }
    let design = if of_pixels > 0.0 { (of_blocks / of_pixels).max(1.0) } else { 1.0 };
    let mut reach = SIGMAS * (variance * design).sqrt() / power;
    if ratio < 0.0 {
        reach = reach.max(-ratio);
    }
    Estimate {
        value: (ratio > reach).then(|| known.sqrt()),
        at_least: Some((known - reach).max(0.0).sqrt()),
        at_most: Some((known + reach).sqrt()),
    }
}

#[cfg(test)]
mod tests;
