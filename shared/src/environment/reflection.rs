//! An environment as surfaces reflect it: without its sun, which is a lamp.

use super::mips::{EnvironmentMips, MIPS_WIDTH};
use super::{Environment, extract_sun};
use crate::harmonics::{Coefficients, project};
use std::sync::{Arc, OnceLock};

/// Most pixels in a row from which coefficients are projected.
const PROJECTED: u32 = 128;

/// Reflected form of an environment, made at the first use.
#[derive(Clone, Debug)]
pub struct Reflection {
    picture: Arc<Environment>,
    parts: OnceLock<(EnvironmentMips, Box<Coefficients>)>,
}

impl Reflection {
    /// Keeps the picture; nothing is computed yet.
    pub fn new(picture: Arc<Environment>) -> Self {
        Self { picture, parts: OnceLock::new() }
    }

    fn parts(&self) -> &(EnvironmentMips, Box<Coefficients>) {
        self.parts.get_or_init(|| {
            let (rest, _) = extract_sun(&self.picture.coarse(2 * MIPS_WIDTH));
            (EnvironmentMips::new(&rest), Box::new(project(&rest.coarse(PROJECTED))))
        })
    }

    /// The picture without its sun, at several widths.
    pub fn mips(&self) -> &EnvironmentMips {
        &self.parts().0
    }

    /// Coefficients of its radiance, environment space.
    pub fn coefficients(&self) -> &Coefficients {
        &self.parts().1
    }
}
