//! A BVH8 has the triangles of the binary BVH, and traversal finds the triangles.

use super::*;
use crate::lanes::tests::with_each;
use crate::random::Stream;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::triangle::Triangle;

fn scattered(count: u64) -> Vec<Triangle> {
    let corner = |s: &mut Stream| s.sphere() * s.unit();
    let one = |i| {
        let mut s = Stream::new(11, i);
        let (at, size) = (10.0 * corner(&mut s), 0.01 + 0.3 * s.unit());
        let [a, b, c] = [0; 3].map(|_| at + size * corner(&mut s));
        Triangle { v0: a.into(), v1: b.into(), v2: c.into() }
    };
    (0..count).map(one).collect()
}

fn build(triangles: &[Triangle]) -> (Bvh2, Bvh8, Vec<u32>) {
    let binary = build_bvh2_from_tris(triangles, BvhBuildParams::medium_build(), &mut Default::default());
    let (wide, order) = Bvh8::new(&binary);
    (binary, wide, order)
}

/// The box of a node's child.
fn child_box(node: &Node, child: usize) -> Aabb {
    let side = |k: usize| Vec3::from_array(std::array::from_fn(|axis| node.sides[axis][k][child]));
    Aabb::new(side(0).into(), side(1).into())
}

#[test]
fn every_triangle_is_in_one_leaf_and_in_all_boxes_above_it() {
    for count in [1, 2, 8, 9, 100, 5_000] {
        let triangles = scattered(count);
        let (_, wide, order) = build(&triangles);
        let mut places = vec![0; order.len()];
        // A node, and the boxes above it.
        let mut waiting = vec![(0u32, Vec::<Aabb>::new())];
        while let Some((name, above)) = waiting.pop() {
            if name & LEAF == 0 {
                let node = &wide.nodes[name as usize];
                let boxes = (0..WIDTH).map(|child| (child, child_box(node, child)));
                for (child, of) in boxes.filter(|(_, of)| of.valid()) {
                    let mut above = above.clone();
                    above.push(of);
                    waiting.push((node.children[child], above));
                }
                continue;
            }
            for place in super::places(name) {
                places[place] += 1;
                let t = &triangles[order[place] as usize];
                for v in [t.v0, t.v1, t.v2] {
                    let is_inside = |b: &Aabb| (b.min - v).max(v - b.max).max_element() <= 0.0;
                    assert!(above.iter().all(is_inside), "triangle {place} of {count}");
                }
            }
        }
        assert!(places.iter().all(|times| *times == 1));
        let mut sorted = order;
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..count as u32));
    }
}

impl SlabTest for SlabRay {
    /// Box by box.
    fn meet(&self, node: &Node, limit: f32) -> ([f32; WIDTH], u32) {
        let (mut near, mut far) = ([0f32; WIDTH], [limit; WIDTH]);
        for axis in 0..3 {
            let sides = &node.sides[axis];
            let (entry, exit) = (&sides[self.down[axis]], &sides[1 - self.down[axis]]);
            for child in 0..WIDTH {
                let along = |side: f32| (side - self.origin[axis]) * self.inverse[axis];
                let (a, b) = (along(entry[child]), along(exit[child]));
                near[child] = if a > near[child] { a } else { near[child] };
                far[child] = if b < far[child] { b } else { far[child] };
            }
        }
        (near, (0..WIDTH).fold(0, |met, child| met | ((near[child] <= far[child]) as u32) << child))
    }
}

/// Slab test with eight lanes.
#[derive(Clone, Copy)]
struct MeetEight<'a>(&'a Node, &'a SlabRay, f32);

impl LaneKernel for MeetEight<'_> {
    type Output = ([f32; WIDTH], u32);

    #[inline(always)]
    fn run<V: F32x8>(self) -> Self::Output {
        SlabRay8::<V>::new(self.1).meet(self.0, self.2)
    }
}

#[test]
fn eight_boxes_at_once_are_met_as_one_by_one() {
    let (_, wide, _) = build(&scattered(5_000));
    let mut met = 0;
    for i in 0..2_000 {
        let mut s = Stream::new(12, i);
        let mut direction = s.sphere();
        if i % 4 == 0 {
            direction = [Vec3::X, Vec3::NEG_Y, Vec3::Z][i as usize / 4 % 3];
        }
        let limit = if i % 3 == 0 { 4.0 * s.unit() } else { f32::INFINITY };
        let walker = SlabRay::new(9.0 * s.sphere() * s.unit(), direction);
        for node in wide.nodes.iter().step_by(7) {
            let one_by_one = walker.meet(node, limit);
            for at_once in with_each(MeetEight(node, &walker, limit)) {
                assert_eq!(one_by_one, at_once);
            }
            met += one_by_one.1.count_ones();
        }
    }
    assert!(met > 5_000, "{met}");
}

#[test]
fn a_walk_visits_every_box_that_a_ray_meets() {
    let triangles = scattered(3_000);
    let (_, wide, order) = build(&triangles);
    for i in 0..300 {
        let mut s = Stream::new(13, i);
        let (origin, direction) = (9.0 * s.sphere() * s.unit(), s.sphere());
        let mut visited = vec![false; order.len()];
        wide.walk(origin, direction, f32::INFINITY, &mut |place, limit| {
            visited[order[place] as usize] = true;
            ControlFlow::Continue(limit)
        });
        let mut none = vec![false; order.len()];
        let walker = SlabRay::new(origin, direction);
        wide.walk_by(&walker, 0, f32::INFINITY, &mut |place: usize, limit: f32| {
            none[order[place] as usize] = true;
            ControlFlow::Continue(limit)
        });
        assert_eq!(visited, none, "eight boxes at once and box by box");
        // Triangles hit by the ray away from the edges are visited.
        for (t, visited) in triangles.iter().zip(visited) {
            let (a, b, c) = (Vec3::from(t.v0), Vec3::from(t.v1), Vec3::from(t.v2));
            let normal = (b - a).cross(c - a);
            let along = (a - origin).dot(normal) / direction.dot(normal);
            let hit = origin + along * direction;
            let inside = [(a, b), (b, c), (c, a)]
                .map(|(from, to)| (to - from).cross(hit - from).dot(normal) > 1e-3 * normal.length_squared());
            assert!(visited || along < 0.0 || inside.contains(&false), "ray {i}");
        }
    }
}
