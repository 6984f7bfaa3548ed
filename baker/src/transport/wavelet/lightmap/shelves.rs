//! Packing of rectangles on shelves: by falling height, from left to right, a new shelf where a row is full ("next-fit
//! decreasing height", Coffman et al. 1980).

use glam::UVec2;

/// Rectangles without overlaps.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Shelves {
    /// Width and height of all.
    pub size: UVec2,
    /// The least corner of each rectangle, in the order given.
    pub corners: Vec<UVec2>,
}

/// Packs rectangles of these sizes about as wide as high.
pub fn pack(sizes: &[UVec2]) -> Shelves {
    let area: u64 = sizes.iter().map(|size| u64::from(size.x) * u64::from(size.y)).sum();
    let widest = sizes.iter().map(|size| size.x).max().unwrap_or(0);
    let width = widest.max((area as f64).sqrt().ceil() as u32);
    let mut order: Vec<usize> = (0..sizes.len()).collect();
    // Equal heights stay in their order: sorting is stable.
    order.sort_by_key(|i| std::cmp::Reverse(sizes[*i].y));
    let mut out = Shelves { size: UVec2::ZERO, corners: vec![UVec2::ZERO; sizes.len()] };
    let (mut at, mut height) = (UVec2::ZERO, 0);
    for i in order {
        if at.x + sizes[i].x > width {
            at = UVec2::new(0, at.y + height);
            height = 0;
        }
        out.corners[i] = at;
        out.size = out.size.max(at + sizes[i]);
        at.x += sizes[i].x;
        height = height.max(sizes[i].y);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rectangles_lie_apart_and_within_the_size() {
        let sizes: Vec<UVec2> = (0..60u32).map(|i| UVec2::new(1 + i * 7 % 13, 1 + i * 5 % 11)).collect();
        let Shelves { size, corners } = pack(&sizes);
        for (i, (corner, own)) in corners.iter().zip(&sizes).enumerate() {
            assert!((corner + own).cmple(size).all());
            for (other, its) in corners.iter().zip(&sizes).take(i) {
                let is_apart = (corner + own).cmple(*other).any() || (other + its).cmple(*corner).any();
                assert!(is_apart, "{corner} {own} meets {other} {its}");
            }
        }
        let area: u32 = sizes.iter().map(|size| size.x * size.y).sum();
        assert!(f64::from(area) > 0.7 * f64::from(size.x * size.y), "{size} for {area}");
        assert_eq!(pack(&[]).size, UVec2::ZERO);
    }
}
