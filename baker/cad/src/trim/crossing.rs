//! Crossings of pieces.

use super::piece::MonotoneEdge;

/// Intervals looked at for a pair before the rest is left: two curves that nearly coincide would need millions.
const MOST_INTERVALS: usize = 4096;

/// The u at which the difference of two pieces changes sign inside their common range, and some at which it comes close to 0.
///
/// Interval bisection. On an interval the slope of a piece lies between those at the ends (a segment's is constant, an arc's
/// monotonic), so that the derivative of the difference is enclosed: without a 0 in it there is at most one crossing, found by
/// bisection; without a 0 in the mean value form of the difference there is none. A crossing that stays undecided is one of two
/// pieces closer together than `tolerance`.
pub(super) fn crossings(a: &MonotoneEdge, b: &MonotoneEdge, tolerance: f64, found: &mut Vec<f64>) {
    let range = (a.u[0].max(b.u[0]), a.u[1].min(b.u[1]));
    if range.0 >= range.1 || a.is_on_curve_of(b) {
        return;
    }
    // Ends of the range are ends of a piece, where slabs end anyway.
    let mut find = |u: f64| {
        if range.0 < u && u < range.1 {
            found.push(u);
        }
    };
    let difference = |u: f64| a.v_at(u) - b.v_at(u);
    let mut open = vec![range];
    let mut intervals = 0;
    while let Some((low, high)) = open.pop() {
        intervals += 1;
        let middle = 0.5 * (low + high);
        let ends = [difference(low), difference(high)];
        if middle <= low || middle >= high || intervals > MOST_INTERVALS {
            if ends[0] * ends[1] <= 0.0 {
                find(middle);
            }
            continue;
        }
        // Both pieces are monotonic: the difference lies between those of their extremes.
        let [a_low, a_high] = sorted(a.v_at(low), a.v_at(high));
        let [b_low, b_high] = sorted(b.v_at(low), b.v_at(high));
        if a_low > b_high || b_low > a_high {
            continue;
        }
        let [a_flat, a_steep] = sorted(a.slope_at(low), a.slope_at(high));
        let [b_flat, b_steep] = sorted(b.slope_at(low), b.slope_at(high));
        let (least, greatest) = (a_flat - b_steep, a_steep - b_flat);
        if least > 0.0 || greatest < 0.0 {
            if ends[0] == 0.0 {
                find(low);
            } else if ends[1] == 0.0 {
                find(high);
            } else if ends[0] * ends[1] < 0.0 {
                find(bisected(difference, low, high, ends[0]));
            }
            continue;
        }
        let steepest =
            if (least + greatest).is_finite() { greatest.abs().max(least.abs()) } else { f64::INFINITY };
        let reach = 0.5 * (high - low) * steepest;
        let at_middle = difference(middle).abs();
        if at_middle > reach || at_middle + reach <= tolerance {
            continue;
        }
        open.push((low, middle));
        open.push((middle, high));
    }
}

fn sorted(a: f64, b: f64) -> [f64; 2] {
    [a.min(b), a.max(b)]
}

fn bisected(difference: impl Fn(f64) -> f64, mut low: f64, mut high: f64, at_low: f64) -> f64 {
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return middle;
        }
        if difference(middle) * at_low > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
}
