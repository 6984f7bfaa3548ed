//! Hit cache: for every small tile of the surfaces the basis functions that cover it, and the light they send per unit, so that
//! shading a gather ray costs one lookup of 32 bytes instead of an evaluation of the basis and of textures.
//!
//! A tile is half a support radius across, over which weights change little. Entries are means over four samples of the tile.
//! Hits are shaded one by one where a mean would be wrong: on tiles that a clip plane crosses, closer than a tile's width, and
//! on primitives with too many tiles.

mod layout;
mod weights;

pub use weights::PackedWeights;

use crate::basis::Leveled;
use crate::geometry::{Primitive, Primitives, SurfaceCoordinates, SurfaceSample};
use crate::processor;
use crate::random::{mix, unit};
use crate::watch::{Stopped, Watch};
use glam::{IVec3, Vec2, Vec3, Vec3A};
use layout::TileLayout;
use rayon::prelude::*;
use rebounce_shared::octahedral;
use smallvec::{SmallVec, smallvec};
use std::collections::HashMap;

/// Width of a tile over the smallest radius of the functions that cover its primitive.
const WIDTH: f32 = 0.5;
/// Hits nearer than this many of the smallest tiles' widths are looked at one by one: in a corner the one tile beside it
/// fills half of what is seen.
const NEAR: f32 = 1.0;
/// Primitives of more tiles have none: of a plain around a house few tiles are ever hit.
const MOST: u32 = 1 << 21;
/// HitCache of all primitives together, for each function and each primitive: further primitives have none. Where functions are everywhere,
/// a dozen tiles lie in the middle of each; where only some of a plain's places have any, most tiles are for nothing.
const MOST_TOGETHER: [usize; 2] = [48, 4];
/// Cuts may go through this much of a tile along its edges: a cut along a wall ends what is cut a hair before the wall.
const EDGE: f32 = 0.05;
/// Small primitives that share a tile lie in one of the cells that are so much of a tile wide.
const SHARED: f32 = 0.7;
/// And face the same of the cells of directions, so many to each half of the octahedral map.
const FACING: f32 = 4.0;
/// What a transparent place counts like, at least.
const LEAST_OPACITY: f32 = 1e-3;
/// Places along each axis that tell how wide a large primitive's tiles are.
const PROBES: u32 = 6;
/// Primitives or tiles that one thread works out at a time; primitives share none beyond.
const TOGETHER: usize = 1 << 12;

/// Whether a primitive is smaller than a cell, where tiles are so wide.
fn is_small(primitive: &Primitive, width: f32) -> bool {
    primitive.normal != Vec3::ZERO && primitive.sides[0].max(primitive.sides[1]) < SHARED * width
}

/// How a primitive is laid with tiles of its own; `first` is not known yet.
fn lay(primitives: &dyn Primitives, number: u32, primitive: &Primitive, functions: &Leveled) -> TileLayout {
    let longest = primitive.sides[0].max(primitive.sides[1]);
    let mut radius = functions.finest_radius();
    if longest > WIDTH * radius {
        // It may be out of the finest functions' reach.
        let probes = ((longest / radius) as u32).clamp(1, PROBES);
        let probed = TileLayout { first: 0, columns: probes as u16, rows: probes as u16 };
        let found = (0..probed.count()).filter_map(|tile| {
            let at = probed.at(probed.column_row(tile)?, Vec2::splat(0.5));
            let spot = primitives.spot(SurfaceCoordinates { primitive: number, at, is_back: false }, 0.0);
            functions.radius_at(spot.position, spot.normal)
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

/// Small primitives that share a tile.
struct Group {
    /// The first of them, whose tile it is.
    primitive: u32,
    primitives: u32,
    /// Some of them.
    some: SmallVec<[u32; 4]>,
    /// Least and greatest corner of their middles.
    low: Vec3,
    high: Vec3,
}

impl Group {
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
            // Of many, not only the first ones.
            let place = self.primitives.trailing_zeros() as usize % self.some.len();
            self.some[place] = number;
        }
    }

    /// What is between is in all of these.
    fn corners(&self) -> impl Iterator<Item = Vec3> {
        let side = |i: u32, axis: usize| if i >> axis & 1 == 0 { self.low[axis] } else { self.high[axis] };
        (0..8).map(move |i| Vec3::new(side(i, 0), side(i, 1), side(i, 2)))
    }
}

/// What primitives that share a tile have in common.
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

/// How all primitives are laid with tiles.
pub struct Layout {
    laid: Vec<TileLayout>,
    /// Ascending; some have no tiles left.
    groups: Vec<Group>,
    /// Primitives that have tiles of their own, ascending.
    owners: Vec<u32>,
    /// HitCache of all.
    count: u32,
}

impl Layout {
    /// Lays tiles on all primitives; small ones that are neighbours, look alike and face one way share one. `points` is how many
    /// functions there may be. `watch` is only asked.
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
        // First, how many tiles each primitive adds, and after it, whose tiles those are that add none.
        let mut leads = vec![0u32; primitives.count()];
        let chunks = laid.par_chunks_mut(TOGETHER).zip(leads.par_chunks_mut(TOGETHER)).enumerate();
        let groups = chunks.map(|(chunk, (laid, leads))| {
            watch.step(0)?;
            let mut groups: Vec<Group> = Vec::new();
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
                    groups.push(Group::new(number, &primitive));
                }
                *laid = lay(primitives, number, &primitive, functions);
                laid.first = laid.count() * (1 + primitive.has_back as u32);
            }
            groups.retain(|group| group.primitives > 1);
            Ok(groups)
        });
        let groups = groups.collect::<Result<Vec<Vec<Group>>, Stopped>>()?;
        // Then, where they begin.
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

/// Four places of a tile, this far from its edges.
fn inside(edge: f32) -> [Vec2; 4] {
    let far = 1.0 - edge;
    [Vec2::splat(edge), Vec2::new(far, edge), Vec2::new(edge, far), Vec2::splat(far)]
}

/// Works out tiles.
struct Maker<'a> {
    primitives: &'a dyn Primitives,
    functions: &'a Leveled,
    duals: &'a [Vec3A],
    seed: u64,
    /// The functions that cover one place.
    weights: Vec<(u32, f32)>,
    /// All that cover some place of a tile: what they weigh, and the light that they get.
    together: Vec<(u32, f32, f32)>,
    /// What a cut that goes through a tile has on both sides.
    edges: Vec<Vec3>,
}

impl Maker<'_> {
    /// A tile of a primitive, or of the group that it is the first of.
    fn tile(&mut self, owner: u32, group: Option<&Group>, laid: TileLayout, number: u32) -> PackedWeights {
        let primitive = self.primitives.primitive(owner);
        let (count, local) = (laid.count(), number - laid.first);
        let Some(tile) = laid.column_row(local % count) else { return PackedWeights::NOTHING };
        let is_back = local >= count;
        let middle = |primitive: u32| SurfaceCoordinates { primitive, at: Vec2::splat(1.0 / 3.0), is_back };
        let within = |at: Vec2| SurfaceCoordinates { primitive: owner, at: laid.at(tile, at), is_back };
        let is_tiny = group.is_none()
            && 2.0 * primitive.sides[0].max(primitive.sides[1]) < WIDTH * self.functions.finest_radius();
        let places: SmallVec<[SurfaceCoordinates; 4]> = match group {
            Some(group) => group.some.iter().map(|primitive| middle(*primitive)).collect(),
            None if is_tiny => smallvec![middle(owner)],
            None => inside(0.25).map(within).into(),
        };
        let area = primitive.sides[0] * primitive.sides[1] * group.map_or(1, |group| group.primitives) as f32
            / (laid.columns as f32 * laid.rows as f32 * places.len() as f32);
        self.together.clear();
        let mut total = 0.0;
        for place in places {
            let SurfaceSample { position, normal, albedo: here, opacity } = self.primitives.spot(place, area);
            // Rays may find something between places that stop none.
            let counts = opacity.max(LEAST_OPACITY);
            self.functions.interpolate(position, normal, &mut self.weights);
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
            // What rays find of the primitive may be covered all the same.
            return PackedWeights::UNKNOWN;
        }
        let has_cuts = self.together.iter().any(|entry| self.functions.has_cuts(entry.0));
        if has_cuts && !is_tiny {
            self.edges.clear();
            match group {
                Some(group) => self.edges.extend(group.corners()),
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

/// The tiles of all primitives.
pub struct HitCache {
    /// Hits nearer than this are looked at one by one, scene units.
    near: f32,
    laid: Vec<TileLayout>,
    tiles: Vec<PackedWeights>,
}

impl HitCache {
    /// Works out the tiles of a layout of these primitives for these functions. `duals` say what light gives each of the
    /// functions. A unit of `watch` is a tile.
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
            // The last owner that begins here or before.
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

    /// The number of the tile at a place, to be asked for its [`Self::shares`] on behalf of a ray from so far away, scene
    /// units; `None` on primitives that have none, and where one tile would be all that is seen.
    #[inline]
    pub fn number(&self, place: SurfaceCoordinates, distance: f32) -> Option<u32> {
        if distance < self.near {
            return None;
        }
        let laid = self.laid[place.primitive as usize];
        let back = if place.is_back { laid.count() } else { 0 };
        (laid.columns != 0).then(|| laid.first + back + laid.number(place.at))
    }

    /// Asks for what [`Self::number`] reads of a primitive.
    #[inline]
    pub fn fetch_piece(&self, primitive: u32) {
        processor::fetch(&self.laid, primitive as usize);
    }

    /// Asks for what [`Self::shares`] reads.
    #[inline]
    pub fn fetch_shares(&self, number: u32) {
        processor::fetch(&self.tiles, number as usize);
    }

    /// What a unit of light that hits a tile gives to the functions; `None` where hits are to be looked at one by one.
    #[inline]
    pub fn shares(&self, number: u32) -> Option<PackedWeights> {
        let tile = self.tiles[number as usize];
        (!tile.is_unknown()).then_some(tile)
    }
}
