//! Texels without light of their own: filled, so that filtering finds no black beside a surface.

use super::texels::{LightTexture, NO_CHART};
use glam::Vec4;

/// Gives the texels of charts without light, those of hidden places, the mean of lit neighbours of the same chart, until
/// none is left. Charts without any light stay black.
pub fn fill_charts(texture: &mut LightTexture) {
    let mut left: Vec<usize> =
        (0..texture.values.len()).filter(|i| !texture.is_lit[*i] && texture.charts[*i] != NO_CHART).collect();
    loop {
        let found: Vec<(usize, Option<Vec4>)> = left
            .iter()
            .map(|i| {
                let chart = texture.charts[*i];
                let mean = mean(texture, *i, |neighbour| texture.charts[neighbour] == chart);
                (*i, mean.map(|(value, _)| value))
            })
            .collect();
        let before = left.len();
        left.clear();
        for (i, value) in found {
            match value {
                Some(value) => (texture.values[i], texture.is_lit[i]) = (value, true),
                None => left.push(i),
            }
        }
        if left.len() == before || left.is_empty() {
            return;
        }
    }
}

/// Gives texels without a chart the mean of their lit neighbours and a neighbour's chart, `rounds` times: so many texels
/// around every chart. Two charts that are at least 2 × `rounds` apart keep texels of their own.
pub fn dilate(texture: &mut LightTexture, rounds: u32) {
    for _ in 0..rounds {
        let outside = (0..texture.values.len()).filter(|i| texture.charts[*i] == NO_CHART);
        let found: Vec<(usize, Vec4, u64)> = outside
            .filter_map(|i| {
                let (value, chart) = mean(texture, i, |_| true)?;
                Some((i, value, chart))
            })
            .collect();
        for (i, value, chart) in found {
            (texture.values[i], texture.charts[i], texture.is_lit[i]) = (value, chart, true);
        }
    }
}

/// Gives all texels without a chart the mean light of the others, for engines that make mip levels.
pub fn fill_background(texture: &mut LightTexture) {
    let lit = || texture.values.iter().zip(&texture.is_lit).filter(|(_, is_lit)| **is_lit);
    let sum = lit()
        .fold([0.0; 4], |sum: [f64; 4], (value, _)| std::array::from_fn(|c| sum[c] + f64::from(value[c])));
    let count = lit().count().max(1) as f64;
    let mean = Vec4::from(sum.map(|sum| (sum / count) as f32));
    for (value, chart) in texture.values.iter_mut().zip(&texture.charts) {
        if *chart == NO_CHART {
            *value = mean;
        }
    }
}

/// Returns the mean of the lit neighbours of a texel that `is_taken` lets through, and the chart of the first; `None` without
/// any.
fn mean(texture: &LightTexture, texel: usize, is_taken: impl Fn(usize) -> bool) -> Option<(Vec4, u64)> {
    let (width, height) = (texture.width as usize, texture.height as usize);
    let (x, y) = (texel % width, texel / width);
    let (mut sum, mut count, mut chart) = (Vec4::ZERO, 0u32, None);
    for row in y.saturating_sub(1)..(y + 2).min(height) {
        for column in x.saturating_sub(1)..(x + 2).min(width) {
            let neighbour = row * width + column;
            if texture.is_lit[neighbour] && is_taken(neighbour) {
                sum += texture.values[neighbour];
                count += 1;
                chart = chart.or(Some(texture.charts[neighbour]));
            }
        }
    }
    Some((sum / count.max(1) as f32, chart?))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two lit texels of different charts, far apart; one more of chart 1 without light.
    fn texture() -> LightTexture {
        let mut texture = LightTexture {
            width: 16,
            height: 8,
            values: vec![Vec4::ZERO; 128],
            charts: vec![NO_CHART; 128],
            is_lit: vec![false; 128],
        };
        for (x, y, chart, light) in [(3, 3, 1, 2.0), (12, 4, 2, 6.0)] {
            let i = y * 16 + x;
            (texture.values[i], texture.charts[i], texture.is_lit[i]) = (Vec4::splat(light), chart, true);
        }
        texture.charts[3 * 16 + 4] = 1;
        texture
    }

    #[test]
    fn a_chart_is_dilated_by_so_many_texels_and_no_more_and_keeps_its_own() {
        let mut texture = texture();
        fill_charts(&mut texture);
        assert_eq!(texture.values[3 * 16 + 4], Vec4::splat(2.0), "a hidden texel has its chart's light");
        let before = texture.clone();
        dilate(&mut texture, 2);
        let mut grown = 0;
        for (i, chart) in texture.charts.iter().enumerate() {
            let (x, y) = ((i % 16) as i32, (i / 16) as i32);
            let from_first = (x - x.clamp(3, 4)).abs().max((y - 3).abs());
            let from_second = (x - 12).abs().max((y - 4).abs());
            let expected = match (from_first <= 2, from_second <= 2) {
                (true, _) => 1,
                (_, true) => 2,
                _ => NO_CHART,
            };
            assert_eq!(*chart, expected, "{x} {y}");
            let light = [2.0, 6.0].get((expected as usize).wrapping_sub(1)).copied().unwrap_or(0.0);
            assert_eq!(texture.values[i], Vec4::splat(light), "{x} {y}: no light of another chart");
            grown += (expected != NO_CHART) as usize;
            if before.charts[i] != NO_CHART {
                assert_eq!(texture.values[i], before.values[i]);
            }
        }
        assert_eq!(grown, 30 + 25);
        fill_background(&mut texture);
        let mean = (30.0 * 2.0 + 25.0 * 6.0) / 55.0;
        assert!((texture.values[7].x - mean).abs() < 1e-5, "{}", texture.values[7]);
    }

    #[test]
    fn a_chart_without_any_light_stays_black() {
        let mut texture = texture();
        texture.is_lit.fill(false);
        texture.values.fill(Vec4::ZERO);
        fill_charts(&mut texture);
        dilate(&mut texture, 2);
        assert!(texture.values.iter().all(|value| *value == Vec4::ZERO) && !texture.is_lit.contains(&true));
    }
}
