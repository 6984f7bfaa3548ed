//! The nearest of many triangles.

use glam::DVec3;

/// Triangles of a leaf.
const FEW: usize = 4;

/// Triangles, to be asked for the nearest to a place: a binary tree of boxes.
#[derive(Debug)]
pub(crate) struct TriangleTree {
    triangles: Vec<[DVec3; 3]>,
    /// Triangles, leaf after leaf.
    order: Vec<u32>,
    nodes: Vec<TreeNode>,
}

/// A box. The first half of its triangles is in the next node, the other half in another one.
#[derive(Debug)]
struct TreeNode {
    low: DVec3,
    high: DVec3,
    /// Range in the order of triangles.
    first: usize,
    end: usize,
    /// Node of the second half; `None` for a leaf.
    second: Option<usize>,
}

/// A place on a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct NearestPlace {
    /// Number of the triangle.
    pub triangle: u32,
    /// Barycentric coordinates of its second and third corner.
    pub barycentric: [f64; 2],
    /// What it was chosen by.
    pub score: f64,
}

impl TriangleTree {
    /// Sorts triangles into boxes.
    pub fn new(triangles: Vec<[DVec3; 3]>) -> Self {
        let order = (0..triangles.len() as u32).collect();
        let mut tree = Self { triangles, order, nodes: Vec::new() };
        if !tree.triangles.is_empty() {
            tree.divide(0, tree.order.len());
        }
        tree
    }

    fn divide(&mut self, first: usize, end: usize) -> usize {
        let Self { triangles, order, nodes } = self;
        let corners = || order[first..end].iter().flat_map(|t| triangles[*t as usize]);
        let low = corners().fold(DVec3::INFINITY, DVec3::min);
        let high = corners().fold(DVec3::NEG_INFINITY, DVec3::max);
        let node = nodes.len();
        nodes.push(TreeNode { low, high, first, end, second: None });
        if end - first > FEW {
            let [x, y, z] = (high - low).to_array();
            let axis = if x >= y.max(z) {
                0
            } else if y >= z {
                1
            } else {
                2
            };
            let middle = |t: &u32| triangles[*t as usize].iter().map(|corner| corner[axis]).sum::<f64>();
            let half = (end - first) / 2;
            order[first..end]
                .select_nth_unstable_by(half, |a, b| middle(a).total_cmp(&middle(b)).then(a.cmp(b)));
            self.divide(first, first + half);
            let second = self.divide(first + half, end);
            self.nodes[node].second = Some(second);
        }
        node
    }

    /// Returns the place of the triangles with the least score under `most`. `score` makes one of a triangle's number and the
    /// distance, not less than the distance; triangles with `None` do not count.
    pub fn nearest(
        &self,
        at: DVec3,
        most: f64,
        score: impl Fn(u32, f64) -> Option<f64>,
    ) -> Option<NearestPlace> {
        let mut best: Option<NearestPlace> = None;
        let mut stack = if self.nodes.is_empty() { Vec::new() } else { vec![0] };
        while let Some(i) = stack.pop() {
            let TreeNode { low, high, first, end, second } = &self.nodes[i];
            let limit = best.map_or(most, |best| best.score);
            if at.distance(at.clamp(*low, *high)) > limit {
                continue;
            }
            if let Some(second) = second {
                stack.extend([*second, i + 1]);
                continue;
            }
            for &triangle in &self.order[*first..*end] {
                let corners = &self.triangles[triangle as usize];
                let barycentric = closest(at, corners);
                let Some(score) = score(triangle, at.distance(place(corners, barycentric))) else { continue };
                // Of equals the first.
                let is_better = |best: NearestPlace| (score, triangle) < (best.score, best.triangle);
                if score <= most && best.is_none_or(is_better) {
                    best = Some(NearestPlace { triangle, barycentric, score });
                }
            }
        }
        best
    }
}

/// The place of a triangle with these barycentric coordinates of its second and third corner.
fn place([a, b, c]: &[DVec3; 3], [v, w]: [f64; 2]) -> DVec3 {
    *a + v * (*b - *a) + w * (*c - *a)
}

/// Barycentric coordinates of the place of a triangle that is closest to another one (Ericson 2005, *Real-Time Collision
/// Detection*, 5.1.5).
fn closest(at: DVec3, &[a, b, c]: &[DVec3; 3]) -> [f64; 2] {
    let (ab, ac) = (b - a, c - a);
    let [d1, d2] = [ab, ac].map(|edge| edge.dot(at - a));
    let [d3, d4] = [ab, ac].map(|edge| edge.dot(at - b));
    let [d5, d6] = [ab, ac].map(|edge| edge.dot(at - c));
    let share = |a: f64, b: f64| if a + b > 0.0 { a / (a + b) } else { 0.0 };
    let (va, vb, vc) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
    if d1 <= 0.0 && d2 <= 0.0 {
        return [0.0, 0.0];
    }
    if d3 >= 0.0 && d4 <= d3 {
        return [1.0, 0.0];
    }
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return [share(d1, -d3), 0.0];
    }
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 1.0];
    }
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return [0.0, share(d2, -d6)];
    }
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let w = share(d4 - d3, d5 - d6);
        return [1.0 - w, w];
    }
    let sum = va + vb + vc;
    if sum > 0.0 { [vb / sum, vc / sum] } else { [0.0, 0.0] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    #[test]
    fn the_nearest_is_that_of_all_places() {
        let mut stream = Stream::new(3, 4);
        let mut place_in_cube = || DVec3::from([0; 3].map(|_| f64::from(stream.unit())));
        let triangles: Vec<[DVec3; 3]> = (0..100)
            .map(|_| {
                let at = place_in_cube();
                [at, at + 0.2 * place_in_cube(), at + 0.2 * place_in_cube()]
            })
            .collect();
        let tree = TriangleTree::new(triangles.clone());
        for _ in 0..200 {
            let at = 1.5 * place_in_cube();
            let found = tree.nearest(at, 10.0, |_, distance| Some(distance)).unwrap();
            // The least of places all over the triangles.
            let grid = |triangle: &[DVec3; 3]| {
                let shares =
                    (0..=20).flat_map(|v| (0..=20 - v).map(move |w| [v, w].map(|x| f64::from(x) / 20.0)));
                shares.map(|share| at.distance(place(triangle, share))).fold(f64::INFINITY, f64::min)
            };
            let least = triangles.iter().map(grid).fold(f64::INFINITY, f64::min);
            assert!(found.score <= least + 1e-9 && found.score > least - 0.02, "{} {least}", found.score);
            let own = place(&triangles[found.triangle as usize], found.barycentric);
            assert!((at.distance(own) - found.score).abs() < 1e-12);
        }
        assert_eq!(tree.nearest(DVec3::splat(9.0), 1.0, |_, distance| Some(distance)), None);
        assert_eq!(tree.nearest(DVec3::ZERO, 9.0, |_, _| None), None);
        assert_eq!(TriangleTree::new(Vec::new()).nearest(DVec3::ZERO, 9.0, |_, d| Some(d)), None);
    }
}
