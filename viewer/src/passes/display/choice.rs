//! Choice of the [way](Way) from functions to pixels: the requested way, or the faster of the two. Both ways draw
//! the same picture, so ordinary pictures serve as measurements.

use crate::passes::settings::{Display, Way};

/// Number of measured pictures for each way. The first picture includes creation of resources and is not counted.
const PICTURES: u32 = 4;

/// The choice, with its measurements.
#[derive(Debug)]
pub struct DisplayChoice {
    wanted: Display,
    /// The adapter is a software renderer on the CPU, slow at quads: no measurement.
    software: bool,
    /// Pixels of the measured pictures.
    pixels: u64,
    /// By way: number of measured pictures, and the shortest time.
    measured: [(u32, f64); 2],
}

impl DisplayChoice {
    /// Without measurements; `software`: see the field.
    pub fn new(software: bool) -> Self {
        Self { wanted: Display::Auto, software, pixels: 0, measured: NONE }
    }

    /// The requested display.
    pub fn wanted(&self) -> Display {
        self.wanted
    }

    /// Sets the requested display; returns whether the request changed.
    pub fn set(&mut self, wanted: Display) -> bool {
        std::mem::replace(&mut self.wanted, wanted) != wanted
    }

    /// The way for the next picture of `pixels` pixels. The measurement restarts at twice or half of the measured
    /// pixels.
    pub fn of_size(&mut self, pixels: u64) -> Way {
        if pixels >= 2 * self.pixels || 2 * pixels <= self.pixels {
            (self.pixels, self.measured) = (pixels, NONE);
        }
        self.way()
    }

    /// The way for a picture of any size.
    pub fn way(&self) -> Way {
        match self.wanted {
            Display::Lookup => Way::Lookup,
            Display::Splat => Way::Splat,
            Display::Auto if self.software => Way::Lookup,
            Display::Auto => {
                let [(lookups, lookup), (splats, splat)] = self.measured;
                let splats = if lookups < PICTURES { false } else { splats < PICTURES || splat < lookup };
                if splats { Way::Splat } else { Way::Lookup }
            }
        }
    }

    /// Adds the time of a picture drawn in this way, in any unit.
    pub fn add(&mut self, way: Way, time: f64) {
        let (pictures, least) = &mut self.measured[way as usize];
        if *pictures > 0 {
            *least = least.min(time);
        }
        *pictures = (*pictures + 1).min(PICTURES);
    }
}

const NONE: [(u32, f64); 2] = [(0, f64::INFINITY); 2];

#[cfg(test)]
mod tests {
    use super::*;

    /// Draws pictures past the measurement of both ways; returns their ways.
    fn draw(choice: &mut DisplayChoice, pixels: u64, [lookup, splat]: [f64; 2]) -> Vec<Way> {
        let mut ways = Vec::new();
        for picture in 0..12 {
            let way = choice.of_size(pixels);
            // The first picture of a way is slow, and a later picture now and then.
            let slow = if picture % 4 == 0 { 100.0 } else { 0.0 };
            choice.add(way, slow + if way == Way::Lookup { lookup } else { splat });
            ways.push(way);
        }
        ways
    }

    #[test]
    fn both_are_measured_and_the_faster_is_kept() {
        for (times, kept) in [([2.0, 1.0], Way::Splat), ([1.0, 2.0], Way::Lookup)] {
            let mut choice = DisplayChoice::new(false);
            let ways = draw(&mut choice, 1000, times);
            assert_eq!(ways, [[Way::Lookup; 4], [Way::Splat; 4], [kept; 4]].concat());
            // A slightly larger window changes nothing; a much larger window restarts the measurement.
            assert_eq!(choice.of_size(1900), kept);
            assert_eq!(choice.of_size(2000), Way::Lookup);
            assert_ne!(draw(&mut choice, 2000, [times[1], times[0]]).last(), Some(&kept));
        }
    }

    #[test]
    fn what_is_asked_for_is_done_and_software_looks_up() {
        for software in [false, true] {
            let mut choice = DisplayChoice::new(software);
            for (wanted, way) in [(Display::Splat, Way::Splat), (Display::Lookup, Way::Lookup)] {
                assert!(choice.set(wanted) && !choice.set(wanted));
                assert_eq!(draw(&mut choice, 1000, [1.0, 2.0]), [way; 12]);
                assert_eq!(choice.wanted(), wanted);
            }
        }
        assert_eq!(draw(&mut DisplayChoice::new(true), 1000, [2.0, 1.0]), [Way::Lookup; 12]);
    }
}
