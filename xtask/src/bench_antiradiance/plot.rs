//! Line charts as SVG.

use anyhow::Result;
use plotters::coord::ranged1d::{AsRangedCoord, Ranged, ValueFormatter};
use plotters::prelude::*;
use std::path::Path;

/// A line with its name.
pub struct Line {
    name: String,
    points: Vec<(f64, f64)>,
}

impl Line {
    /// A line through some points.
    pub fn new(name: &str, points: impl Iterator<Item = (f64, f64)>) -> Self {
        Self { name: name.to_owned(), points: points.collect() }
    }
}

/// A chart of some lines.
pub struct Chart<'a> {
    /// What x is.
    pub x: &'a str,
    /// What y is.
    pub y: &'a str,
    /// The lines.
    pub lines: &'a [Line],
    /// Whether x and y are logarithmic.
    pub is_logarithmic: [bool; 2],
}

impl Chart<'_> {
    /// Writes an SVG file.
    ///
    /// # Errors
    /// If it cannot be drawn or written.
    pub fn draw(&self, out: &Path) -> Result<()> {
        let points = || self.lines.iter().flat_map(|line| &line.points);
        let (mut low, mut high) = ([f64::INFINITY; 2], [0.0f64; 2]);
        for (x, y) in points() {
            low = [low[0].min(*x), low[1].min(*y)];
            high = [high[0].max(*x), high[1].max(*y)];
        }
        let range = |axis: usize| match (self.is_logarithmic[axis], axis) {
            (true, 0) => low[0]..high[0],
            (true, _) => 0.5 * low[axis]..2.0 * high[axis],
            (false, _) => 0.0..1.05 * high[axis],
        };
        let (x, y) = (range(0), range(1));
        match self.is_logarithmic {
            [false, false] => self.on(out, x, y),
            [true, false] => self.on(out, x.log_scale().base(2.0), y),
            [false, true] => self.on(out, x, y.log_scale()),
            [true, true] => self.on(out, x.log_scale().base(2.0), y.log_scale()),
        }
    }

    fn on<X, Y>(&self, out: &Path, x: X, y: Y) -> Result<()>
    where
        X: AsRangedCoord<Value = f64>,
        Y: AsRangedCoord<Value = f64>,
        X::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
        Y::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
    {
        let area = SVGBackend::new(out, (640, 380)).into_drawing_area();
        area.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(&area)
            .margin(14)
            .x_label_area_size(42)
            .y_label_area_size(56)
            .build_cartesian_2d(x, y)?;
        let of_y = |y: &f64| if self.is_logarithmic[1] { format!("{y:.0e}") } else { format!("{y:.2}") };
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .x_label_formatter(&|x| format!("{x:.0}"))
            .y_label_formatter(&of_y)
            .x_desc(self.x)
            .y_desc(self.y)
            .draw()?;
        for (k, line) in self.lines.iter().enumerate() {
            let colour = HSLColor(k as f64 / self.lines.len().max(1) as f64, 0.75, 0.42);
            let drawn = chart.draw_series(LineSeries::new(line.points.iter().copied(), &colour))?;
            drawn
                .label(line.name.as_str())
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 14, y)], colour));
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperRight)
            .background_style(WHITE.mix(0.8))
            .label_font(("sans-serif", 12))
            .draw()?;
        area.present()?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn charts_name_their_lines_on_both_scales() {
        let lines = [
            Line::new("maze", [(64.0, 0.3), (128.0, 0.2)].into_iter()),
            Line::new("office", [(64.0, 0.2), (128.0, 0.1)].into_iter()),
        ];
        let folder = tempfile::tempdir().unwrap();
        for is_logarithmic in [[true, false], [false, true], [true, true], [false, false]] {
            let out = folder.path().join("chart.svg");
            Chart { x: "bins", y: "error", lines: &lines, is_logarithmic }.draw(&out).unwrap();
            let svg = std::fs::read_to_string(&out).unwrap();
            assert!(["maze", "office", "bins", "error"].iter().all(|word| svg.contains(word)));
        }
    }
}
