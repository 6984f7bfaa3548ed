//! Rays of a packet find the hits of single rays.

use super::*;
use crate::geometry::bvh8::{BEYOND, Node, SlabRay, SlabTest, WIDTH};
use crate::geometry::mesh::blas::LocalRay;
use crate::geometry::mesh::packet::{MOST, Packet};
use crate::geometry::mesh::packet_traversal::{Firsts, NearestTogether};
use crate::geometry::mesh::triangle::{ShearedRays, TriangleHit, TriangleHits};
use crate::lanes::tests::with_each;
use crate::lanes::{F32x8, LaneKernel};

/// Returns bundles of rays, narrow and wide; some rays are along an axis or in an axis plane, pass through shared
/// corners, or end early.
fn bundles(seed: u64, corners: &[Triangle]) -> Vec<(Ray, u32)> {
    let mut stream = Stream::new(seed, 1);
    let mut rays = Vec::new();
    while rays.len() < 1_000 {
        let from = stream.sphere() * 0.95 * stream.unit();
        let towards = stream.sphere();
        let (apart, wide) = (0.3 * stream.unit().powi(3), stream.unit().powi(3));
        let kind = stream.bits() % 6;
        for _ in 0..1 + stream.bits() % 150 {
            let mut origin = from + apart * stream.sphere() * stream.unit();
            let mut direction = (towards + wide * stream.sphere()).normalize_or(Vec3::X);
            match kind {
                0 => direction = [Vec3::X, -Vec3::Y, Vec3::new(-0.0, 0.0, 1.0)][stream.bits() as usize % 3],
                1 => direction = (direction * Vec3::new(0.0, 1.0, 1.0)).normalize_or(Vec3::Y),
                2 => {
                    origin = (from * 12.0).round() / 12.0;
                    let corner = corners[stream.bits() as usize % corners.len()].positions[0];
                    direction = (corner - origin).normalize_or(Vec3::Z);
                }
                _ => {}
            }
            let max_distance = if kind == 3 { stream.unit() } else { f32::INFINITY };
            rays.push((Ray { origin, direction, max_distance, spread: 0.0 }, stream.bits() as u32));
        }
    }
    rays
}

/// Opaque, half transparent and two-sided triangles.
fn mixed() -> (Vec<Triangle>, Vec<Material>) {
    let mut triangles = scrap(1);
    triangles.iter_mut().enumerate().for_each(|(i, t)| t.material = i as u32 % 3);
    // Some triangles are duplicated with another material.
    let again: Vec<Triangle> = triangles.iter().step_by(5).cloned().collect();
    triangles.extend(again.into_iter().map(|t| Triangle { material: (t.material + 1) % 3, ..t }));
    let half = Material { base_color: [0.5, 0.5, 0.5, 0.4], alpha: Alpha::Blend, ..white() };
    (triangles, vec![white(), half, Material { double_sided: true, ..white() }])
}

/// Returns the cells of the rays' directions.
fn cells(rays: &[(Ray, u32)]) -> Vec<u16> {
    let of_some = |some: &[(Ray, u32)]| {
        let axis =
            |axis: usize| std::array::from_fn(|i| some.get(i).map_or(1.0, |ray| ray.0.direction[axis]));
        crate::transport::direct_to_indirect::ray_sort::cells(&[axis(0), axis(1), axis(2)])
    };
    rays.chunks(8).flat_map(of_some).take(rays.len()).collect()
}

pub(super) fn find_the_same(surfaces: &TriangleSurfaces, corners: &[Triangle]) {
    let primitives = surfaces.primitives().unwrap();
    let (mut found, mut ended, mut rays_cast) = (Vec::new(), 0, 0);
    for seed in 0..60 {
        let mut rays = bundles(seed, corners);
        // Some rays end exactly at the hit, or just before.
        for (i, (ray, seed)) in rays.iter_mut().enumerate().filter(|(i, _)| i % 7 < 2) {
            if let Some((_, distance)) = primitives.find(ray, *seed) {
                ray.max_distance = if i % 7 == 0 { distance } else { distance.next_down() };
            }
        }
        // Unsorted, in the order of a gather, and every third ray.
        let mut order = Vec::new();
        crate::transport::direct_to_indirect::ray_sort::sort(&cells(&rays), &mut order);
        let as_they_come: Vec<u32> = (0..rays.len() as u32).collect();
        let thirds: Vec<u32> = as_they_come.iter().copied().step_by(3).collect();
        for numbers in [&order, &as_they_come, &thirds, &as_they_come[..1].to_vec(), &Vec::new()] {
            primitives.intersect_packet(&rays, numbers, &mut found);
            assert_eq!(found.len(), numbers.len());
            for (number, together) in numbers.iter().zip(&found) {
                let (ray, seed) = &rays[*number as usize];
                let alone = primitives.find(ray, *seed);
                let bits = |found: Option<(SurfaceCoordinates, f32)>| {
                    found.map(|(p, d)| (p.primitive, p.is_back, [p.at.x, p.at.y, d].map(f32::to_bits)))
                };
                assert_eq!(bits(*together), bits(alone), "{ray:?}");
                ended += alone.is_some() as usize;
                rays_cast += 1;
            }
        }
    }
    assert!(ended > rays_cast / 4, "{ended} of {rays_cast}");
}

#[test]
fn together_they_find_what_each_finds_alone() {
    let (triangles, materials) = mixed();
    find_the_same(&surfaces(triangles.clone(), &materials), &triangles);
}

#[test]
fn so_they_do_among_copies_and_in_next_to_nothing() {
    let crowd = super::tlas::crowd();
    let corners = crowd.triangles.clone();
    find_the_same(&TriangleSurfaces::new(crowd), &corners);
    let (triangles, materials) = mixed();
    let one = surfaces(triangles[..1].to_vec(), &materials);
    let none = surfaces(Vec::new(), &[]);
    for surfaces in [one, none] {
        let (rays, mut found) = (bundles(3, &triangles), Vec::new());
        let numbers: Vec<u32> = (0..rays.len() as u32).collect();
        let primitives = surfaces.primitives().unwrap();
        primitives.intersect_packet(&rays, &numbers, &mut found);
        assert!(rays.iter().zip(&found).all(|((ray, seed), found)| *found == primitives.find(ray, *seed)));
    }
}

/// Axes, origins and shears of eight rays, as arguments of [`ShearedRays::new`].
type OfEight = ([usize; 3], [[f32; 8]; 3], [[f32; 8]; 3]);

/// Arguments of [`Corners::meet_together`].
#[derive(Clone, Copy)]
struct MeetTogether<'a>(&'a Corners, &'a OfEight, [f32; 8]);

impl LaneKernel for MeetTogether<'_> {
    type Output = TriangleHits;

    #[inline(always)]
    fn run<V: F32x8>(self) -> TriangleHits {
        let &(axes, origin, shear) = self.1;
        self.0.meet_together(&ShearedRays::<V>::new(axes, origin, shear), self.2, 0xff)
    }
}

#[test]
fn eight_rays_meet_a_triangle_as_one_by_one() {
    let triangles = scrap(2);
    let (mut met, mut unclear) = (0, 0);
    for seed in 0..20 {
        let rays = bundles(seed, &triangles);
        let mut by_class: [Vec<Ray>; Ray::OCTANTS_AND_AXES] = Default::default();
        rays.iter().for_each(|(ray, _)| by_class[Ray::octant_and_axis(ray.direction) as usize].push(*ray));
        for some in by_class.iter().flat_map(|rays| rays.chunks_exact(8)) {
            let sheared: Vec<ShearedRay> =
                some.iter().map(|ray| ShearedRay::new(ray.origin, ray.direction)).collect();
            let lanes = |of: &dyn Fn(&ShearedRay) -> f32| std::array::from_fn(|ray| of(&sheared[ray]));
            // Origin and shear in the order of `axes`, as in a single ray.
            let axes = sheared[0].axes;
            let together: OfEight = (
                axes,
                std::array::from_fn(|i| lanes(&|ray| ray.origin[i])),
                std::array::from_fn(|i| lanes(&|ray| ray.shear[i])),
            );
            let limits: [f32; 8] = std::array::from_fn(|ray| some[ray].max_distance);
            for triangle in triangles.iter().step_by(7) {
                let corners = Corners::new(triangle.positions);
                for meetings in with_each(MeetTogether(&corners, &together, limits)) {
                    for (ray, sheared) in sheared.iter().enumerate() {
                        let alone = corners.meet(sheared, limits[ray]);
                        let may = meetings.met >> ray & 1 != 0;
                        if meetings.unclear >> ray & 1 != 0 {
                            unclear += 1;
                            assert!(may);
                            continue;
                        }
                        let bits = |m: TriangleHit| [m.distance, m.v, m.w].map(f32::to_bits);
                        assert_eq!(may.then(|| bits(meetings.of(ray))), alone.map(bits), "{:?}", some[ray]);
                        met += may as u32;
                    }
                }
            }
        }
    }
    assert!(met > 1_000 && unclear > 100, "{met} met, {unclear} unclear");
}

/// Rays of a class, for a test of their [`Packet`] against nodes.
#[derive(Clone, Copy)]
struct AgainstNodes<'a>(&'a [Ray], u8, &'a [Node]);

impl LaneKernel for AgainstNodes<'_> {
    type Output = u32;

    /// Compares the packet's hits with those of each ray; returns the number of hits.
    #[inline(always)]
    fn run<V: F32x8>(self) -> u32 {
        let (some, class, nodes) = (self.0, self.1, self.2);
        let mut met = 0;
        let packet = Packet::<V>::new(some.iter(), class);
        for node in nodes.iter().step_by(5) {
            let (nearest, any) = node.meet_any(&packet);
            let met_by = |asked: u64| -> [u64; WIDTH] {
                std::array::from_fn(|child| node.meet_child(child, &packet, asked))
            };
            let mut expected = [0; WIDTH];
            for (i, ray) in some.iter().enumerate() {
                let walker = SlabRay::new(ray.origin, ray.direction);
                let sheared = ShearedRay::new(ray.origin, ray.direction);
                assert_eq!(format!("{:?}", packet.alone(i)), format!("{:?}", (&walker, sheared)));
                let (near, alone) = walker.meet(node, ray.max_distance * BEYOND);
                for child in (0..WIDTH).filter(|child| alone >> child & 1 != 0) {
                    expected[child] |= 1 << i;
                    assert!(any >> child & 1 != 0 && nearest[child] <= near[child], "{ray:?}");
                    met += 1;
                }
            }
            assert_eq!(met_by(u64::MAX), expected);
            const FEW: u64 = 0x9249_2492_4924_9249;
            assert_eq!(met_by(FEW), expected.map(|rays| rays & FEW));
        }
        met
    }
}

#[test]
fn what_one_of_them_meets_all_of_them_may() {
    let (triangles, materials) = mixed();
    let surfaces = surfaces(triangles.clone(), &materials);
    let mut met = 0;
    for seed in 0..20 {
        let rays = bundles(seed, &triangles);
        let mut by_class: [Vec<Ray>; Ray::OCTANTS_AND_AXES] = Default::default();
        rays.iter().for_each(|(ray, _)| by_class[Ray::octant_and_axis(ray.direction) as usize].push(*ray));
        for (class, some) in
            (0..).zip(&by_class).flat_map(|(class, rays)| rays.chunks(MOST).map(move |some| (class, some)))
        {
            let all = with_each(AgainstNodes(some, class, &surfaces.static_blas.bvh.nodes));
            met += all.iter().sum::<u32>();
        }
    }
    assert!(met > 10_000, "{met}");
}

/// [`NearestTogether`] of the rays of a slice.
#[derive(Clone, Copy)]
struct OfSlice<'a> {
    blas: &'a Blas,
    surfaces: &'a [Surface],
    rays: &'a [(Ray, u32)],
    class: u8,
}

impl LaneKernel for OfSlice<'_> {
    type Output = Firsts;

    #[inline(always)]
    fn run<V: F32x8>(self) -> Firsts {
        let Self { blas, surfaces, rays, class } = self;
        NearestTogether { blas, surfaces, rays: rays.iter(), class }.run::<V>()
    }
}

#[test]
fn every_backend_finds_the_same() {
    let (triangles, materials) = mixed();
    let surfaces = surfaces(triangles.clone(), &materials);
    for seed in 0..10 {
        let rays = bundles(seed, &triangles);
        let class = |ray: &(Ray, u32)| Ray::octant_and_axis(ray.0.direction);
        for alike in rays.chunk_by(|a, b| class(a) == class(b)).flat_map(|rays| rays.chunks(MOST)) {
            let (blas, surfaces) = (&surfaces.static_blas, &surfaces.surfaces[..]);
            let of_class = OfSlice { blas, surfaces, rays: alike, class: class(&alike[0]) };
            let [scalar, widest] = with_each(of_class);
            assert_eq!(scalar, widest);
            for ((ray, seed), found) in alike.iter().zip(&widest) {
                let line = LocalRay { origin: ray.origin, direction: ray.direction };
                assert_eq!(*found, blas.nearest(surfaces, &line, ray.max_distance, false, *seed));
            }
        }
    }
}
