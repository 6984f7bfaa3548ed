//! Hit cache: stores for every small tile of the surfaces the basis functions that cover the tile
//! and the light sent to each function per unit of irradiance. Shading a gather ray then costs a
//! single lookup of 32 bytes instead of an evaluation of the basis and of textures.
//!
//! A tile is half a support radius wide; weights change little within a tile. Entries are means
//! over four samples of the tile. Hits are shaded individually where a mean would be wrong: on
//! tiles that a clip plane crosses, at distances below a tile's width, and on primitives with too
//! many tiles.

mod layout;
mod weights;

pub use weights::PackedWeights;

use crate::basis::Leveled;
use crate::geometry::{Primitive, Primitives, SurfaceCoordinates, SurfaceSample};
use crate::job::watch::{Stopped, Watch};
use crate::processor;
use crate::random::{mix, unit};
use glam::{IVec3, Vec2, Vec3, Vec3A};
use layout::TileLayout;
use rayon::prelude::*;
use rebounce_shared::octahedral;
use smallvec::{SmallVec, smallvec};
use std::collections::HashMap;

/// Ratio of a tile's width to the smallest radius of the functions that cover the primitive.
const WIDTH: f32 = 0.5;
/// Least hit distance for cached shading, in widths of the smallest tiles. Nearer hits are shaded
/// individually: in a corner a single tile of the adjacent wall fills half the view.
const NEAR: f32 = 1.0;
/// Greatest number of tiles of a primitive. A primitive with more tiles has no cache: of a plain
/// around a house few tiles are ever hit.
const MOST: u32 = 1 << 21;
/// Tile budget of the scene, per function and per primitive; primitives beyond the budget have no
/// cache. In a scene with functions everywhere, each support holds a dozen tiles on average. On a
/// plain with functions in few places, tiles without functions are useless.
const MOST_TOGETHER: [usize; 2] = [48, 4];
/// Margin of a tile at its edges, as a share of the tile's width, that clip planes may cross: the
/// clip plane of a wall ends supports slightly before the wall.
const EDGE: f32 = 0.05;
/// Width of the position cells that group small primitives into a shared tile, in tile widths.
const SHARED: f32 = 0.7;
/// Resolution of the normal cells that group small primitives: cells per half of the octahedral
/// map.
const FACING: f32 = 4.0;
/// Least opacity weight of a transparent sample.
const LEAST_OPACITY: f32 = 1e-3;
/// Samples along each axis of a large primitive that determine the primitive's tile width.
const PROBES: u32 = 6;
/// Primitives or tiles per parallel work unit; primitives of different units share no tile.
const TOGETHER: usize = 1 << 12;

/// Whether a primitive is smaller than a cell, for tiles of this width.
fn is_small(primitive: &Primitive, width: f32) -> bool {
    primitive.normal != Vec3::ZERO && primitive.sides[0].max(primitive.sides[1]) < SHARED * width
}

/// Returns the layout of a primitive's own tiles; `first` is filled in later.
fn lay(primitives: &dyn Primitives, number: u32, primitive: &Primitive, functions: &Leveled) -> TileLayout {
    let longest = primitive.sides[0].max(primitive.sides[1]);
    let mut radius = functions.finest_radius();
    if longest > WIDTH * radius {
        // The primitive may be outside the supports of the finest functions.
        let probes = ((longest / radius) as u32).clamp(1, PROBES);
        let probed = TileLayout { first: 0, columns: probes as u16, rows: probes as u16 };
        let found = (0..probed.count()).filter_map(|tile| {
            let at = probed.at(probed.column_row(tile)?, Vec2::splat(0.5));
            let spot = primitives.spot(SurfaceCoordinates { primitive: number, at, is_back: false }, 0.0);
            functions.radius_at(spot.position, spot.normal, spot.group)
        });
        radius = found.reduce(f32::min).unwrap_or(functions.coarsest_radius());
    }
    let [columns, rows] =
        primitive.sides.map(|side| (side / (WIDTH * radius)).ceil().clamp(1.0, u16::MAX as f32) as u16);
    if columns as u32 * rows as u32 > MOST {
        return TileLayout::default();
    }
    TileLayout { first: 0, columns, rows }
}

/// Group of small primitives that share a tile.
struct TileGroup {
    /// Number of the first primitive of the group, which owns the tile.
    primitive: u32,
    primitives: u32,
    /// Sampled primitives of the group.
    some: SmallVec<[u32; 4]>,
    /// Bounds of the primitives' centres.
    low: Vec3,
    high: Vec3,
}

impl TileGroup {
    fn new(number: u32, primitive: &Primitive) -> Self {
        let some = smallvec![number];
        Self { primitive: number, primitives: 1, some, low: primitive.middle, high: primitive.middle }
    }

    fn add(&mut self, number: u32, primitive: &Primitive) {
        self.primitives += 1;
        (self.low, self.high) = (self.low.min(primitive.middle), self.high.max(primitive.middle));
        if self.some.len() < self.some.inline_size() {
            self.some.push(number);
        } else if self.primitives.is_power_of_two() {
            // Samples later primitives too, not only the first.
            let place = self.primitives.trailing_zeros() as usize % self.some.len();
            self.some[place] = number;
        }
    }

    /// Corners of the bounds of the primitives' centres.
    fn corners(&self) -> impl Iterator<Item = Vec3> {
        let side = |i: u32, axis: usize| if i >> axis & 1 == 0 { self.low[axis] } else { self.high[axis] };
        (0..8).map(move |i| Vec3::new(side(i, 0), side(i, 1), side(i, 2)))
    }
}

/// Key of a group: primitives with equal keys share a tile.
#[derive(PartialEq, Eq, Hash)]
struct Alike {
    cell: IVec3,
    facing: (i32, i32),
    kind: u32,
    has_back: bool,
}

impl Alike {
    fn new(primitive: &Primitive, width: f32) -> Self {
        let facing = (octahedral::encode(primitive.normal) * FACING).round().as_ivec2();
        Self {
            cell: (primitive.middle / (SHARED * width)).floor().as_ivec3(),
            facing: (facing.x, facing.y),
            kind: primitive.kind,
            has_back: primitive.has_back,
        }
    }
}

/// Tile layouts of all primitives.
pub struct Layout {
    laid: Vec<TileLayout>,
    /// In ascending order of the first primitive; the tile of a group may be missing for lack of
    /// budget.
    groups: Vec<TileGroup>,
    /// Primitives that own tiles, ascending.
    owners: Vec<u32>,
    /// Total number of tiles.
    count: u32,
}

impl Layout {
    /// Lays tiles on all primitives. Adjacent small primitives of equal material and similar normal
    /// share a tile. `points` is the number of functions, for the tile budget. `watch` is only
    /// polled for a stop.
    ///
    /// # Errors
    /// [`Stopped`].
    pub fn new(
        primitives: &dyn Primitives,
        functions: &Leveled,
        points: usize,
        watch: &dyn Watch,
    ) -> Result<Self, Stopped> {
        let width = WIDTH * functions.finest_radius();
        let mut laid = vec![TileLayout::default(); primitives.count()];
        // First pass: number of tiles that each primitive adds (in `first`), and owner of the tiles
        // of each primitive.
        let mut leads = vec![0u32; primitives.count()];
        let chunks = laid.par_chunks_mut(TOGETHER).zip(leads.par_chunks_mut(TOGETHER)).enumerate();
        let groups = chunks.map(|(chunk, (laid, leads))| {
            watch.step(0)?;
            let mut groups: Vec<TileGroup> = Vec::new();
            let mut known: HashMap<Alike, usize> = HashMap::new();
            for ((laid, lead), number) in laid.iter_mut().zip(leads).zip((chunk * TOGETHER) as u32..) {
                let primitive = primitives.primitive(number);
                *lead = number;
                if is_small(&primitive, width) {
                    let group = *known.entry(Alike::new(&primitive, width)).or_insert(groups.len());
                    if let Some(group) = groups.get_mut(group) {
                        group.add(number, &primitive);
                        *lead = group.primitive;
                        *laid = TileLayout { first: 0, columns: 1, rows: 1 };
                        continue;
                    }
                    groups.push(TileGroup::new(number, &primitive));
                }
                *laid = lay(primitives, number, &primitive, functions);
                laid.first = laid.count() * (1 + primitive.has_back as u32);
            }
            groups.retain(|group| group.primitives > 1);
            Ok(groups)
        });
        let groups = groups.collect::<Result<Vec<Vec<TileGroup>>, Stopped>>()?;
        // Second pass: first tile of each primitive.
        let mut owners = Vec::new();
        let most = MOST_TOGETHER[0] * points + MOST_TOGETHER[1] * primitives.count();
        let most = most.min(u32::MAX as usize) as u32;
        let mut count = 0u32;
        for (primitive, lead) in (0u32..).zip(leads) {
            if lead != primitive {
                laid[primitive as usize] = laid[lead as usize];
                continue;
            }
            let laid = &mut laid[primitive as usize];
            let more = laid.first;
            if more == 0 || count.checked_add(more).is_none_or(|count| count > most) {
                *laid = TileLayout::default();
                continue;
            }
            laid.first = count;
            owners.push(primitive);
            count += more;
        }
        Ok(Self { laid, groups: groups.into_iter().flatten().collect(), owners, count })
    }

    /// Number of tiles.
    pub fn count(&self) -> u32 {
        self.count
    }
}

/// Four sample positions of a tile, at distance `edge` from the tile's edges.
fn inside(edge: f32) -> [Vec2; 4] {
    let far = 1.0 - edge;
    [Vec2::splat(edge), Vec2::new(far, edge), Vec2::new(edge, far), Vec2::splat(far)]
}

/// Computes tiles.
struct Maker<'a> {
    primitives: &'a dyn Primitives,
    functions: &'a Leveled,
    duals: &'a [Vec3A],
    seed: u64,
    /// Functions that cover a sample, with normalised weights.
    weights: Vec<(u32, f32)>,
    /// Functions that cover any sample of the tile: function, weight, and light sent to the
    /// function.
    together: Vec<(u32, f32, f32)>,
    /// Positions that a clip plane must not separate.
    edges: Vec<Vec3>,
}

impl Maker<'_> {
    /// Computes a tile of a primitive, or of the group whose first primitive is `owner`.
    fn tile(
        &mut self,
        owner: u32,
        alike: Option<&TileGroup>,
        laid: TileLayout,
        number: u32,
    ) -> PackedWeights {
        let primitive = self.primitives.primitive(owner);
        let (count, local) = (laid.count(), number - laid.first);
        let Some(tile) = laid.column_row(local % count) else { return PackedWeights::NOTHING };
        let is_back = local >= count;
        let middle = |primitive: u32| SurfaceCoordinates { primitive, at: Vec2::splat(1.0 / 3.0), is_back };
        let within = |at: Vec2| SurfaceCoordinates { primitive: owner, at: laid.at(tile, at), is_back };
        let is_tiny = alike.is_none()
            && 2.0 * primitive.sides[0].max(primitive.sides[1]) < WIDTH * self.functions.finest_radius();
        let places: SmallVec<[SurfaceCoordinates; 4]> = match alike {
            Some(alike) => alike.some.iter().map(|primitive| middle(*primitive)).collect(),
            None if is_tiny => smallvec![middle(owner)],
            None => inside(0.25).map(within).into(),
        };
        let area = primitive.sides[0] * primitive.sides[1] * alike.map_or(1, |alike| alike.primitives) as f32
            / (laid.columns as f32 * laid.rows as f32 * places.len() as f32);
        self.together.clear();
        let mut total = 0.0;
        for place in places {
            let SurfaceSample { position, normal, albedo: here, opacity, group } =
                self.primitives.spot(place, area);
            // Stochastic rays may hit between samples of zero opacity.
            let counts = opacity.max(LEAST_OPACITY);
            self.functions.interpolate(position, normal, group, &mut self.weights);
            total += if self.weights.is_empty() { 0.0 } else { counts };
            for &(function, weight) in &self.weights {
                let weight = counts * weight;
                let light = weight * Vec3A::from(here).dot(self.duals[function as usize]);
                match self.together.iter_mut().find(|entry| entry.0 == function) {
                    Some(entry) => (entry.1, entry.2) = (entry.1 + weight, entry.2 + light),
                    None => self.together.push((function, weight, light)),
                }
            }
        }
        if total == 0.0 {
            // Functions may still cover other hits on the primitive.
            return PackedWeights::UNKNOWN;
        }
        let has_cuts = self.together.iter().any(|entry| self.functions.has_cuts(entry.0));
        if has_cuts && !is_tiny {
            self.edges.clear();
            match alike {
                Some(alike) => self.edges.extend(alike.corners()),
                None => {
                    self.edges.extend(inside(EDGE).map(|at| self.primitives.spot(within(at), 0.0).position));
                }
            }
            if self.together.iter().any(|entry| self.functions.is_cut_between(entry.0, &self.edges)) {
                return PackedWeights::UNKNOWN;
            }
        }
        for (_, weight, light) in &mut self.together {
            (*weight, *light) = (*weight / total, *light / *weight);
        }
        PackedWeights::of(&self.together, unit(mix(self.seed ^ number as u64)))
    }
}

/// Tiles of all primitives.
pub struct HitCache {
    /// Distance below which hits are shaded individually, scene units.
    near: f32,
    laid: Vec<TileLayout>,
    tiles: Vec<PackedWeights>,
}

impl HitCache {
    /// Computes the tiles of a layout of `primitives` for `functions`. `duals` map light to the
    /// amount in each function's tint. A unit of `watch` is a tile.
    ///
    /// # Errors
    /// [`Stopped`].
    pub fn on(
        layout: Layout,
        primitives: &dyn Primitives,
        functions: &Leveled,
        duals: &[Vec3A],
        seed: u64,
        watch: &dyn Watch,
    ) -> Result<Self, Stopped> {
        let Layout { laid, groups, owners, count } = layout;
        let mut tiles = vec![PackedWeights::NOTHING; count as usize];
        let begins =
            |owner: usize| owners.get(owner).map_or(count, |primitive| laid[*primitive as usize].first);
        tiles.par_chunks_mut(TOGETHER).enumerate().try_for_each(|(chunk, tiles)| {
            let (weights, together, edges) = Default::default();
            let mut maker = Maker { primitives, functions, duals, seed, weights, together, edges };
            let first = (chunk * TOGETHER) as u32;
            // The last owner whose first tile is at or before `first`.
            let mut owner = owners.partition_point(|primitive| laid[*primitive as usize].first <= first) - 1;
            let mut group = groups.partition_point(|group| group.primitive < owners[owner]);
            for (tile, number) in tiles.iter_mut().zip(first..) {
                while begins(owner + 1) <= number {
                    owner += 1;
                }
                let primitive = owners[owner];
                while groups.get(group).is_some_and(|group| group.primitive < primitive) {
                    group += 1;
                }
                let group = groups.get(group).filter(|group| group.primitive == primitive);
                *tile = maker.tile(primitive, group, laid[primitive as usize], number);
            }
            watch.step(tiles.len() as u64)
        })?;
        Ok(Self { near: NEAR * WIDTH * functions.finest_radius(), laid, tiles })
    }

    /// Number of tiles.
    pub fn count(&self) -> usize {
        self.tiles.len()
    }

    /// Returns the tile number at surface coordinates, the argument of [`Self::shares`], for a ray
    /// of length `distance`, scene units; `None` for primitives without tiles and for hits nearer
    /// than a tile's width.
    #[inline]
    pub fn number(&self, place: SurfaceCoordinates, distance: f32) -> Option<u32> {
        if distance < self.near {
            return None;
        }
        let laid = self.laid[place.primitive as usize];
        let back = if place.is_back { laid.count() } else { 0 };
        (laid.columns != 0).then(|| laid.first + back + laid.number(place.at))
    }

    /// Prefetches the layout that [`Self::number`] reads for a primitive.
    #[inline]
    pub fn fetch_piece(&self, primitive: u32) {
        processor::fetch(&self.laid, primitive as usize);
    }

    /// Prefetches the tile that [`Self::shares`] reads.
    #[inline]
    pub fn fetch_shares(&self, number: u32) {
        processor::fetch(&self.tiles, number as usize);
    }

    /// Returns the light sent to each function per unit of light that hits the tile; `None` if hits
    /// must be shaded individually.
    #[inline]
    pub fn shares(&self, number: u32) -> Option<PackedWeights> {
        let tile = self.tiles[number as usize];
        (!tile.is_unknown()).then_some(tile)
    }
}
