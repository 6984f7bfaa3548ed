//! `cargo xtask plot-jacobian`: draws grids of the unit square on surfaces, coloured by the Jacobian: by natural parameters, and
//! by the virtual mesh (Alonso et al. 2001, Figure 4 c and b).

use crate::{process, report};
use anyhow::{Context, Result, bail, ensure};
use std::fmt::Write;

/// Width and height of a panel, and the height of its caption.
const PANEL: [f64; 2] = [240.0, 170.0];
const CAPTION: f64 = 34.0;
/// The direction of the view: from above, in front and a little from the right.
const VIEW: [[f64; 3]; 3] = [[0.92, 0.39, 0.0], [-0.22, 0.52, 0.825], [0.32, -0.76, 0.565]];
/// Colours of half the mean, the mean and twice the mean.
const COLOURS: [[f64; 3]; 3] = [[49.0, 104.0, 182.0], [240.0, 238.0, 230.0], [196.0, 60.0, 44.0]];

/// A surface with its maps.
#[derive(Debug, Default, PartialEq)]
struct DrawnSurface {
    name: String,
    maps: Vec<DrawnMap>,
}

/// A grid of the unit square on a surface.
#[derive(Debug, Default, PartialEq)]
struct DrawnMap {
    name: String,
    /// How far Jacobians are from their mean at most, in multiples of it.
    deviation: f64,
    cells: Vec<DrawnCell>,
}

/// A cell: its Jacobian in multiples of the mean, and its corners.
#[derive(Debug, PartialEq)]
struct DrawnCell {
    jacobian: f64,
    corners: [[f64; 3]; 4],
}

/// Runs the example `jacobian` of rebounce-cad and draws docs/method/jacobian.svg.
///
/// # Errors
/// If a step fails.
pub fn run() -> Result<()> {
    let surfaces = parse(&report::printed_by("rebounce-cad", "jacobian", &[])?)?;
    let out = process::root().join("docs/method/jacobian.svg");
    std::fs::write(&out, drawing(&surfaces)).with_context(|| out.display().to_string())?;
    println!("wrote {}", out.display());
    Ok(())
}

/// Reads what the example prints.
fn parse(text: &str) -> Result<Vec<DrawnSurface>> {
    let mut surfaces: Vec<DrawnSurface> = Vec::new();
    for line in text.lines() {
        let (word, rest) = line.split_once(' ').with_context(|| format!("a line without number: {line}"))?;
        if word == "surface" {
            surfaces.push(DrawnSurface { name: rest.to_owned(), maps: Vec::new() });
            continue;
        }
        let maps = &mut surfaces.last_mut().context("a map before any surface")?.maps;
        match word {
            "map" => {
                let (name, deviation) = rest.rsplit_once(' ').context("a map without deviation")?;
                let deviation = deviation.parse().context("a deviation")?;
                maps.push(DrawnMap { name: name.to_owned(), deviation, cells: Vec::new() });
            }
            "cell" => {
                let numbers = rest.split(' ').map(str::parse).collect::<Result<Vec<f64>, _>>();
                let numbers = numbers.with_context(|| format!("a cell: {line}"))?;
                ensure!(numbers.len() == 13, "a cell of {} numbers", numbers.len());
                let corner = |i: usize| [0, 1, 2].map(|axis| numbers[1 + 3 * i + axis]);
                let cell = DrawnCell { jacobian: numbers[0], corners: [0, 1, 2, 3].map(corner) };
                maps.last_mut().context("a cell before any map")?.cells.push(cell);
            }
            other => bail!("a line of {other}"),
        }
    }
    Ok(surfaces)
}

/// The picture: a column for each surface, a row for each map, and the scale of colours.
fn drawing(surfaces: &[DrawnSurface]) -> String {
    let rows = surfaces.iter().map(|surface| surface.maps.len()).max().unwrap_or(0);
    let [width, height] = [PANEL[0] * surfaces.len() as f64, (PANEL[1] + CAPTION) * rows as f64 + 44.0];
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
         height=\"{height}\" font-family=\"sans-serif\" font-size=\"12\" text-anchor=\"middle\" \
         stroke-linejoin=\"round\">\n<rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n"
    );
    for (column, surface) in surfaces.iter().enumerate() {
        // Both maps of a surface have one scale.
        let all = surface.maps.iter().flat_map(|map| &map.cells).flat_map(|cell| cell.corners);
        let fit = Fit::new(all.map(seen));
        for (row, map) in surface.maps.iter().enumerate() {
            let corner = [PANEL[0] * column as f64, (PANEL[1] + CAPTION) * row as f64];
            panel(&mut svg, map, &fit, corner);
            let [x, y] = [corner[0] + 0.5 * PANEL[0], corner[1] + PANEL[1] + 14.0];
            let most = percent(map.deviation);
            let _ = writeln!(
                svg,
                "<text x=\"{x}\" y=\"{y}\">{}, {}</text>\n<text x=\"{x}\" y=\"{}\" fill=\"#555\">{most} \
                 from the mean at most</text>",
                surface.name,
                map.name,
                y + 15.0
            );
        }
    }
    scale(&mut svg, 0.5 * width, height - 34.0);
    svg + "</svg>\n"
}

/// Draws a grid, what is farthest first.
fn panel(svg: &mut String, map: &DrawnMap, fit: &Fit, corner: [f64; 2]) {
    let mut cells: Vec<(f64, f64, [[f64; 3]; 4])> = Vec::new();
    for cell in &map.cells {
        let corners = cell.corners.map(seen);
        cells.push((corners.iter().map(|c| c[2]).sum(), cell.jacobian, corners));
    }
    cells.sort_by(|a, b| a.0.total_cmp(&b.0));
    let _ = writeln!(svg, "<g stroke=\"#333\" stroke-width=\".4\">");
    for (_, jacobian, corners) in cells {
        let [r, g, b] = colour(jacobian);
        let at = corners.map(|c| fit.place(c, corner)).map(|[x, y]| format!("{x:.1} {y:.1}"));
        let _ = writeln!(svg, "<path d=\"M{}z\" fill=\"#{r:02x}{g:02x}{b:02x}\"/>", at.join(" "));
    }
    let _ = writeln!(svg, "</g>");
}

/// Draws what the colours mean.
fn scale(svg: &mut String, middle: f64, top: f64) {
    let steps = 32;
    for step in 0..steps {
        let power = 2.0 * f64::from(step) / f64::from(steps - 1) - 1.0;
        let [r, g, b] = colour(power.exp2());
        let x = middle + 4.0 * f64::from(step - steps / 2);
        let _ = writeln!(
            svg,
            "<rect x=\"{x}\" y=\"{top}\" width=\"4.2\" height=\"10\" fill=\"#{r:02x}{g:02x}{b:02x}\"/>"
        );
    }
    for (x, text) in [(-64.0, "½"), (0.0, "mean Jacobian"), (64.0, "2")] {
        let _ = writeln!(svg, "<text x=\"{}\" y=\"{}\">{text}</text>", middle + x, top + 24.0);
    }
}

/// A place across and along the view: right, up, towards the eye.
fn seen(place: [f64; 3]) -> [f64; 3] {
    VIEW.map(|axis| (0..3).map(|i| axis[i] * place[i]).sum())
}

/// From places across the view to a panel.
struct Fit {
    middle: [f64; 2],
    scale: f64,
}

impl Fit {
    fn new(places: impl Iterator<Item = [f64; 3]>) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for place in places {
            for axis in 0..2 {
                low[axis] = low[axis].min(place[axis]);
                high[axis] = high[axis].max(place[axis]);
            }
        }
        let scale = [0, 1].map(|axis| 0.9 * PANEL[axis] / (high[axis] - low[axis]));
        Self { middle: [0, 1].map(|axis| 0.5 * (low[axis] + high[axis])), scale: scale[0].min(scale[1]) }
    }

    fn place(&self, place: [f64; 3], corner: [f64; 2]) -> [f64; 2] {
        let [x, y] = [0, 1].map(|axis| self.scale * (place[axis] - self.middle[axis]));
        [corner[0] + 0.5 * PANEL[0] + x, corner[1] + 0.5 * PANEL[1] - y]
    }
}

/// The colour of a Jacobian in multiples of the mean: by its logarithm, from a half to twice the mean.
fn colour(jacobian: f64) -> [u8; 3] {
    let power = jacobian.max(1e-9).log2().clamp(-1.0, 1.0);
    let [end, share] = if power < 0.0 { [0.0, -power] } else { [2.0, power] };
    [0, 1, 2].map(|i| (COLOURS[1][i] + share * (COLOURS[end as usize][i] - COLOURS[1][i])).round() as u8)
}

/// A share in percent, with two digits.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent < 1e-4 {
        return "less than 0.0001 %".to_owned();
    }
    let digits = (1.0 - percent.log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{percent:.digits$} %")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grids_are_read_and_drawn() {
        let text = "surface cone\nmap natural parameters 0.71\ncell 2.000 0 0 0 1 0 0 1 1 0 0 1 0\n\
                    map virtual mesh 3e-9\ncell 1.000 0 0 0 1 0 0 1 1 0 0 1 0\n";
        let surfaces = parse(text).unwrap();
        assert_eq!((surfaces.len(), surfaces[0].maps.len()), (1, 2));
        assert_eq!(surfaces[0].maps[0].cells[0].corners[2], [1.0, 1.0, 0.0]);
        let svg = drawing(&surfaces);
        assert!(
            svg.contains("cone, natural parameters</text>") && svg.contains("71 % from the mean"),
            "{svg}"
        );
        assert!(svg.contains("less than 0.0001 %") && svg.contains("#c43c2c") && svg.contains("#f0eee6"));
        assert!(parse("cell 1 2").is_err() && parse("surface a\nmap b c").is_err());
    }

    #[test]
    fn shares_have_two_digits() {
        assert_eq!([1.4, 0.0712, 0.00123].map(percent), ["140 %", "7.1 %", "0.12 %"]);
    }
}
