//! What senders give to probes: rows of coefficients, from rays.

use super::caster::{Caster, SurfaceHit};
use super::grid::Grid;
use super::harmonics::{self, COUNT};
use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::basis::Lookup;
use rebounce_shared::environment::bins;
use rebounce_shared::octahedral;
use rebounce_shared::rbn::bulk::{Cut, Point};
use rebounce_shared::rbn::groups::Groups;
use rebounce_shared::rbn::meta::Material;
use rebounce_shared::rbn::sources::Sources;

/// Texels along a side of a probe's map of planes (octahedral).
pub const PLANES: usize = 16;
/// Rays along a side of a texel of planes.
const FINER: usize = 2;
/// Rays along a side of a probe's map.
const SIDE: usize = PLANES * FINER;
/// Rays of a probe.
pub const RAYS: usize = SIDE * SIDE;
/// Bit of an entry's sender that marks a source: the sky or an emissive surface.
pub const SOURCE: u32 = 1 << 31;
/// Support radius of a sender's function over its distance, at most: the harmonics see no finer detail.
const WIDTH: f32 = 0.3;
/// A probe of which more rays meet backs of surfaces is within something solid.
const INSIDE: f32 = 0.25;
/// Distance to the nearest surface at which a probe is moved, in spacings.
const CROWDED: f32 = 0.1;
/// How far probes are moved, in spacings.
const MOVES: [f32; 3] = [0.15, 0.3, 0.45];
/// Rays that look at whether a probe is well placed.
const GLANCES: usize = 4;
/// Plane of a ray that meets nothing.
const OPEN: [f32; 4] = [0.0, 0.0, 0.0, 1e30];

/// What of a file the rows are made from, kept on the CPU until they are there.
pub struct Input {
    /// Texture coordinates by vertex.
    pub uvs: Vec<[f32; 2]>,
    points: Vec<Point>,
    cuts: Vec<Cut>,
    lookup: Lookup,
    /// Support radius by level of senders.
    supports: Vec<f32>,
    materials: Vec<Material>,
    sources: Sources,
    group_of: Vec<Option<u32>>,
    reconstruction: Groups,
}

/// An entry of a row: what a unit of a sender's light gives to a probe's radiance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Entry {
    /// The sending point; with [`SOURCE`], the source.
    pub sender: u32,
    /// By coefficient.
    pub coefficients: [f32; COUNT],
}

/// The rows of a grid.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rows {
    /// First entry of each probe, and the end of the last.
    pub offsets: Vec<u32>,
    /// Entries, by sender within a row.
    pub entries: Vec<Entry>,
    /// By probe: how it was moved, local space; and 1, or 0 for a probe within something solid.
    pub moved: Vec<[f32; 4]>,
    /// By probe and texel, rows of [`PLANES`]: unit normal towards the probe, and distance of the plane from it.
    pub planes: Vec<[f32; 4]>,
}

/// The rays of a probe.
pub struct Rays {
    /// Where the probe is.
    pub place: Vec3,
    /// Whether it is in free space.
    pub is_free: bool,
    /// By ray; none for a probe within something solid.
    pub hits: Vec<Option<SurfaceHit>>,
}

/// What a surface does where a ray meets it: from [`super::hits`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HitSurface {
    /// Reflectance, linear RGB.
    pub albedo: Vec3,
    /// Share of the material's emission.
    pub emission: Vec3,
    /// Whether the surface is there: not cut away.
    pub is_solid: bool,
}

impl Input {
    /// Copies what is needed of a file.
    pub fn of(scene: &BakedScene) -> Self {
        let levels = scene.meta.levels.iter().take(scene.meta.sender_levels as usize);
        Self {
            uvs: scene.vertices.iter().map(|vertex| vertex.uv).collect(),
            points: scene.points[..scene.sender_count()].to_vec(),
            cuts: scene.cuts.clone(),
            lookup: scene.relations.lookup.clone(),
            supports: levels.map(|level| level.support_radius).collect(),
            materials: scene.meta.materials.clone(),
            group_of: scene.sources.group_of_materials(),
            sources: scene.sources.clone(),
            reconstruction: scene.groups.clone(),
        }
    }

    /// Finds the place of a probe and casts its rays.
    pub fn rays(&self, caster: &Caster, grid: &Grid, probe: usize) -> Rays {
        let (place, is_free) = self.free_place(caster, grid, probe);
        let cast = |ray: usize| caster.cast(place, direction(ray, SIDE), f32::INFINITY, &self.uvs);
        let hits = if is_free { (0..RAYS).map(cast).collect() } else { Vec::new() };
        Rays { place, is_free, hits }
    }

    /// The probe's place in the grid, or a near one that is not within something solid nor close to a surface.
    fn free_place(&self, caster: &Caster, grid: &Grid, probe: usize) -> (Vec3, bool) {
        let start = grid.place(probe);
        let mut best = (start, f32::NEG_INFINITY);
        let moves = MOVES.iter().flat_map(|far| AXES.map(|axis| axis * *far));
        for offset in std::iter::once(Vec3::ZERO).chain(moves) {
            let place = start + offset * grid.spacing;
            let (mut backs, mut nearest) = (0, f32::INFINITY);
            for glance in 0..GLANCES * GLANCES {
                if let Some(hit) = caster.cast(place, direction(glance, GLANCES), f32::INFINITY, &self.uvs) {
                    backs += u32::from(hit.is_back);
                    nearest = nearest.min(hit.distance);
                }
            }
            let is_inside = backs as f32 > INSIDE * (GLANCES * GLANCES) as f32;
            let room = if is_inside { f32::NEG_INFINITY } else { (nearest / grid.spacing).min(CROWDED) };
            if room > best.1 {
                best = (place, room);
            }
            if room >= CROWDED {
                break;
            }
        }
        (best.0, best.1 > f32::NEG_INFINITY)
    }

    /// Appends a probe to the rows: `shade` tells what a hit's surface does.
    pub fn append(
        &self,
        rows: &mut Rows,
        grid: &Grid,
        probe: usize,
        rays: &Rays,
        shade: impl Fn(usize) -> HitSurface,
    ) {
        if rows.offsets.is_empty() {
            rows.offsets.push(0);
        }
        let moved = rays.place - grid.place(probe);
        rows.moved.push(moved.extend(f32::from(u8::from(rays.is_free))).to_array());
        let mut entries: Vec<(u32, usize, f32)> = Vec::new();
        for (ray, hit) in rays.hits.iter().enumerate() {
            let towards = direction(ray, SIDE);
            let shade = hit.map(|_| shade(ray)).filter(|shade| shade.is_solid);
            match (hit, shade) {
                (Some(hit), Some(shade)) if !hit.is_back => {
                    self.reflected(
                        rays.place + towards * hit.distance,
                        hit,
                        &shade,
                        &mut |sender, amount| {
                            entries.push((sender, ray, amount));
                        },
                    );
                }
                (None, _) if self.sources.has_sky && self.sources.sky_step > 0.0 => {
                    entries.push((SOURCE | bins::bin_of(towards) as u32, ray, 1.0 / self.sources.sky_step));
                }
                _ => {}
            }
        }
        entries.sort_unstable_by_key(|entry| (entry.0, entry.1));
        for part in entries.chunk_by(|a, b| a.0 == b.0) {
            let mut row = Entry { sender: part[0].0, ..Entry::default() };
            for (_, ray, amount) in part {
                let towards = direction(*ray, SIDE);
                let scale = amount * solid_angle(*ray, SIDE);
                for (sum, y) in row.coefficients.iter_mut().zip(harmonics::basis(towards)) {
                    *sum += scale * y;
                }
            }
            rows.entries.push(row);
        }
        rows.offsets.push(rows.entries.len() as u32);
        for texel in 0..PLANES * PLANES {
            rows.planes.push(plane(rays, texel));
        }
    }

    /// Senders of the radiance that a surface sends towards a probe.
    fn reflected(&self, place: Vec3, hit: &SurfaceHit, shade: &HitSurface, entry: &mut dyn FnMut(u32, f32)) {
        // The coarsest level whose functions are small as seen from the probe, or the finest one.
        let width = WIDTH * hit.distance;
        let finest = self.supports.len();
        let level =
            self.supports.iter().position(|support| *support <= width).map_or(finest, |level| level + 1);
        let group = self.reconstruction.of_material(hit.material);
        let of = (self.points.as_slice(), self.cuts.as_slice());
        let covering = self.lookup.covering(level, of, (place, hit.normal), group);
        let total: f32 = covering.iter().map(|(_, weight)| weight).sum();
        for (j, weight) in covering {
            let tint = self.points[j as usize].tint();
            let amount = shade.albedo.dot(tint) / tint.length_squared();
            entry(j, weight / total * amount * std::f32::consts::FRAC_1_PI);
        }
        self.emitted(hit, shade, entry);
    }

    /// Sources of the radiance that an emissive surface sends.
    fn emitted(&self, hit: &SurfaceHit, shade: &HitSurface, entry: &mut dyn FnMut(u32, f32)) {
        let Some(group) = self.group_of.get(hit.material as usize).copied().flatten() else { return };
        let emission = Vec3::from(self.materials[hit.material as usize].emission) * shade.emission;
        let before = self.sources.groups[..group as usize].iter().map(|group| group.senders()).sum::<usize>();
        let (of, first) = (&self.sources.groups[group as usize], self.sources.sky_bins() + before);
        let step = Vec3::from(of.step);
        if of.is_coloured {
            for channel in (0..3).filter(|channel| step[*channel] > 0.0) {
                entry(SOURCE | (first + channel) as u32, emission[channel] / step[channel]);
            }
        } else if step.length_squared() > 0.0 {
            entry(SOURCE | first as u32, emission.dot(step) / step.length_squared());
        }
    }
}

/// The ways in which probes are moved.
const AXES: [Vec3; 6] = [Vec3::Y, Vec3::NEG_Y, Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z];

/// Applies the rows on the CPU: radiance of every probe from the senders' light (irradiance times tint) and the strengths
/// of sources.
pub fn apply(rows: &Rows, sent: &[Vec3], strengths: &[Vec3]) -> Vec<[Vec3; COUNT]> {
    let of = |entry: &Entry| match entry.sender & SOURCE {
        0 => sent[entry.sender as usize],
        _ => strengths.get((entry.sender & !SOURCE) as usize).copied().unwrap_or(Vec3::ZERO),
    };
    let row = |range: &[u32]| {
        let mut out = [Vec3::ZERO; COUNT];
        for entry in &rows.entries[range[0] as usize..range[1] as usize] {
            let light = of(entry);
            out.iter_mut().zip(entry.coefficients).for_each(|(sum, c)| *sum += light * c);
        }
        out
    };
    rows.offsets.windows(2).map(row).collect()
}

/// Direction of cell `cell` of an octahedral map with this side.
fn direction(cell: usize, side: usize) -> Vec3 {
    octahedral::decode(place_in(cell, side))
}

/// The middle of a cell of a map, -1 to 1.
fn place_in(cell: usize, side: usize) -> Vec2 {
    (Vec2::new((cell % side) as f32, (cell / side) as f32) + 0.5) * (2.0 / side as f32) - 1.0
}

/// Solid angle of a cell of an octahedral map, sr: its area over the cube of the distance of the octahedron there.
fn solid_angle(cell: usize, side: usize) -> f32 {
    let p = place_in(cell, side);
    let a = p.abs();
    let (xy, z) = if a.x + a.y > 1.0 {
        (Vec2::new(1.0 - a.y, 1.0 - a.x), a.x + a.y - 1.0)
    } else {
        (a, 1.0 - a.x - a.y)
    };
    let cell = 2.0 / side as f32;
    cell * cell / xy.extend(z).length().powi(3)
}

/// The plane of the nearest surface in a texel of a probe's map.
fn plane(rays: &Rays, texel: usize) -> [f32; 4] {
    if rays.hits.is_empty() {
        return OPEN;
    }
    let (x, y) = (texel % PLANES * FINER, texel / PLANES * FINER);
    let cells = (0..FINER * FINER).map(|k| (y + k / FINER) * SIDE + x + k % FINER);
    let hits = cells.filter_map(|ray| rays.hits[ray].map(|hit| (direction(ray, SIDE) * hit.distance, hit)));
    let nearest = hits.min_by(|a, b| a.1.distance.total_cmp(&b.1.distance));
    nearest.map_or(OPEN, |(offset, hit)| hit.normal.extend(-hit.normal.dot(offset)).to_array())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_of_a_map_cover_the_sphere() {
        for side in [GLANCES, PLANES, SIDE] {
            let sum: f32 = (0..side * side).map(|cell| solid_angle(cell, side)).sum();
            // The middle of a cell stands for the whole.
            assert!(
                (sum / (4.0 * std::f32::consts::PI) - 1.0).abs() < 2.0 / (side * side) as f32,
                "{side}: {sum}"
            );
        }
    }
}
