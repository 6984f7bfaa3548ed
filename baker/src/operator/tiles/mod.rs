//! What rays find, worked out beforehand: the functions that cover a hit, and how much light they get, for every small
//! tile of the surfaces.
//!
//! Many rays hit what few places are: half a function's radius across, a tile is so small that the functions'
//! weights hardly change over it, and each is hit by dozens of rays. So what a hit costs is one look at 32 bytes, not at a
//! dozen functions and some texels. The means over tiles are those over rays: rays do not know about tiles.

mod laid;
mod shares;

pub use shares::Shares;

use crate::basis::Leveled;
use crate::random::{mix, unit};
use crate::surface::{Piece, Pieces, Place, Spot};
use crate::watch::{Stopped, Watch};
use glam::{Vec2, Vec3, Vec3A};
use laid::Laid;
use rayon::prelude::*;
use smallvec::SmallVec;

/// Width of a tile over the smallest radius of the functions that cover its piece.
const WIDTH: f32 = 0.5;
/// Hits nearer than this many of the smallest tiles' widths are looked at one by one: in a corner the one tile beside it
/// fills half of what is seen.
const NEAR: f32 = 1.0;
/// Pieces of more tiles have none: of a plain around a house few tiles are ever hit.
const MOST: u32 = 1 << 21;
/// Tiles of all pieces together, for each function and each piece: further pieces have none. Where functions are everywhere,
/// a dozen tiles lie in the middle of each; where only some of a plain's places have any, most tiles are for nothing.
const MOST_TOGETHER: [usize; 2] = [48, 4];
/// Cuts may go through this much of a tile along its edges: a cut along a wall ends what is cut a hair before the wall.
const EDGE: f32 = 0.05;
/// Cosine of the angle between pieces that share a tile, at least.
const ALIKE: f32 = 0.95;
/// What a transparent place counts like, at least.
const LEAST_OPACITY: f32 = 1e-3;
/// Places along each axis that tell how wide a large piece's tiles are.
const PROBES: u32 = 6;
/// Pieces or tiles that one thread works out at a time; pieces share none beyond.
const TOGETHER: usize = 1 << 12;

/// The tiles that gathers read.
pub struct SenderTiles {
    /// For the senders.
    pub senders: Tiles,
    /// For the functions that later bounces travel between.
    pub coarse: Tiles,
}

/// Whether a piece is so small that tiles of this width are too large for it alone.
fn is_small(piece: &Piece, width: f32) -> bool {
    2.0 * piece.sides[0].max(piece.sides[1]) < width
}

/// How a piece is laid with tiles of its own; `first` is not known yet.
fn lay(pieces: &dyn Pieces, number: u32, piece: &Piece, functions: &Leveled) -> Laid {
    let longest = piece.sides[0].max(piece.sides[1]);
    let mut radius = functions.finest_radius();
    if longest > WIDTH * radius {
        // It may be out of the finest functions' reach.
        let probes = ((longest / radius) as u32).clamp(1, PROBES);
        let probed = Laid { first: 0, columns: probes as u16, rows: probes as u16 };
        let found = (0..probed.count()).filter_map(|tile| {
            let at = probed.at(probed.column_row(tile)?, Vec2::splat(0.5));
            let spot = pieces.spot(Place { piece: number, at, is_back: false }, 0.0);
            functions.radius_at(spot.position, spot.normal)
        });
        radius = found.reduce(f32::min).unwrap_or(functions.coarsest_radius());
    }
    let [columns, rows] =
        piece.sides.map(|side| (side / (WIDTH * radius)).ceil().clamp(1.0, u16::MAX as f32) as u16);
    if columns as u32 * rows as u32 > MOST {
        return Laid::default();
    }
    Laid { first: 0, columns, rows }
}

/// Pieces that share tiles, or one that has its own.
#[derive(Clone, Copy)]
struct Owner {
    piece: u32,
    /// Further ones are those of the next numbers.
    pieces: u32,
    first: u32,
}

/// Lays tiles on all pieces; small ones that are neighbours, look alike and face one way share one. How many tiles there
/// are, and whose; `points` is how many functions there may be.
fn lay_all(
    pieces: &dyn Pieces,
    functions: &Leveled,
    points: usize,
    watch: &dyn Watch,
) -> Result<(Vec<Laid>, Vec<Owner>, u32), Stopped> {
    let width = WIDTH * functions.finest_radius();
    let mut laid = vec![Laid::default(); pieces.count()];
    // First, how many tiles each piece adds.
    laid.par_chunks_mut(TOGETHER).enumerate().try_for_each(|(chunk, laid)| {
        watch.step(0)?;
        let mut open: Option<Piece> = None;
        for (laid, number) in laid.iter_mut().zip((chunk * TOGETHER) as u32..) {
            let piece = pieces.piece(number);
            let shares = |first: &Piece| {
                piece.kind == first.kind
                    && piece.has_back == first.has_back
                    && piece.middle.distance(first.middle) < 0.3 * width
                    && piece.normal.dot(first.normal) > ALIKE
            };
            let is_small = is_small(&piece, width);
            if is_small && open.as_ref().is_some_and(shares) {
                *laid = Laid { first: 0, columns: 1, rows: 1 };
                continue;
            }
            *laid = lay(pieces, number, &piece, functions);
            laid.first = laid.count() * (1 + piece.has_back as u32);
            open = is_small.then_some(piece);
        }
        Ok(())
    })?;
    // Then, where they begin.
    let mut owners: Vec<Owner> = Vec::new();
    let most = MOST_TOGETHER[0] * points + MOST_TOGETHER[1] * pieces.count();
    let most = most.min(u32::MAX as usize) as u32;
    let mut count = 0u32;
    let mut is_full = false;
    for (piece, laid) in (0..).zip(&mut laid) {
        let more = laid.first;
        if more == 0 && laid.columns != 0 && !is_full {
            if let Some(owner) = owners.last_mut() {
                owner.pieces += 1;
                laid.first = owner.first;
            }
            continue;
        }
        is_full = count.checked_add(more).is_none_or(|count| count > most);
        if is_full || more == 0 {
            *laid = Laid::default();
            continue;
        }
        laid.first = count;
        owners.push(Owner { piece, pieces: 1, first: count });
        count += more;
    }
    Ok((laid, owners, count))
}

/// Four places of a tile, this far from its edges.
fn inside(edge: f32) -> [Vec2; 4] {
    let far = 1.0 - edge;
    [Vec2::splat(edge), Vec2::new(far, edge), Vec2::new(edge, far), Vec2::splat(far)]
}

/// Works out tiles.
struct Maker<'a> {
    pieces: &'a dyn Pieces,
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
    fn tile(&mut self, owner: Owner, laid: Laid, number: u32) -> Shares {
        let piece = self.pieces.piece(owner.piece);
        let (count, local) = (laid.count(), number - owner.first);
        let Some(tile) = laid.column_row(local % count) else { return Shares::NOTHING };
        let is_back = local >= count;
        let is_small = is_small(&piece, WIDTH * self.functions.finest_radius());
        // Of small pieces the middles of some, else places of the tile.
        let inner = inside(0.25);
        let places: SmallVec<[Place; 4]> = if is_small {
            let count = owner.pieces.min(4);
            let member = |k: u32| owner.piece + (2 * k + 1) * owner.pieces / (2 * count);
            (0..count).map(|k| Place { piece: member(k), at: Vec2::splat(1.0 / 3.0), is_back }).collect()
        } else {
            inner.map(|within| Place { piece: owner.piece, at: laid.at(tile, within), is_back }).into()
        };
        let area = piece.sides[0] * piece.sides[1] * owner.pieces as f32
            / (laid.columns as f32 * laid.rows as f32 * places.len() as f32);
        self.together.clear();
        let mut total = 0.0;
        for place in places {
            let Spot { position, normal, albedo: here, opacity } = self.pieces.spot(place, area);
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
            // What rays find of the piece may be covered all the same.
            return Shares::UNKNOWN;
        }
        let has_cuts = self.together.iter().any(|entry| self.functions.has_cuts(entry.0));
        if has_cuts && (!is_small || owner.pieces > 1) {
            self.edges.clear();
            if is_small {
                let members = owner.piece..owner.piece + owner.pieces;
                self.edges.extend(members.map(|member| self.pieces.piece(member).middle));
            } else {
                let at = |within: Vec2| Place { piece: owner.piece, at: laid.at(tile, within), is_back };
                self.edges.extend(inside(EDGE).map(|corner| self.pieces.spot(at(corner), 0.0).position));
            }
            if self.together.iter().any(|entry| self.functions.is_cut_between(entry.0, &self.edges)) {
                return Shares::UNKNOWN;
            }
        }
        for (_, weight, light) in &mut self.together {
            (*weight, *light) = (*weight / total, *light / *weight);
        }
        Shares::of(&self.together, unit(mix(self.seed ^ number as u64)))
    }
}

/// The tiles of all pieces.
pub struct Tiles {
    /// Hits nearer than this are looked at one by one, scene units.
    near: f32,
    laid: Vec<Laid>,
    tiles: Vec<Shares>,
}

impl Tiles {
    /// Lays tiles on all pieces. `duals` say what light gives each of the functions.
    ///
    /// # Errors
    /// [`Stopped`].
    pub fn new(
        pieces: &dyn Pieces,
        functions: &Leveled,
        duals: &[Vec3A],
        seed: u64,
        watch: &dyn Watch,
    ) -> Result<Self, Stopped> {
        let (laid, owners, count) = lay_all(pieces, functions, duals.len(), watch)?;
        let mut tiles = vec![Shares::NOTHING; count as usize];
        tiles.par_chunks_mut(TOGETHER).enumerate().try_for_each(|(chunk, tiles)| {
            watch.step(0)?;
            let (weights, together, edges) = Default::default();
            let mut maker = Maker { pieces, functions, duals, seed, weights, together, edges };
            let first = (chunk * TOGETHER) as u32;
            // The last owner that begins here or before.
            let mut owner = owners.partition_point(|owner| owner.first <= first) - 1;
            for (tile, number) in tiles.iter_mut().zip(first..) {
                while owners.get(owner + 1).is_some_and(|next| next.first <= number) {
                    owner += 1;
                }
                *tile = maker.tile(owners[owner], laid[owners[owner].piece as usize], number);
            }
            Ok(())
        })?;
        Ok(Self { near: NEAR * WIDTH * functions.finest_radius(), laid, tiles })
    }

    /// Number of tiles.
    pub fn count(&self) -> usize {
        self.tiles.len()
    }

    /// The number of the tile at a place, to be asked for its [`Self::shares`] on behalf of a ray from so far away, scene
    /// units; `None` on pieces that have none, and where one tile would be all that is seen.
    #[inline]
    pub fn number(&self, place: Place, distance: f32) -> Option<u32> {
        if distance < self.near {
            return None;
        }
        let laid = self.laid[place.piece as usize];
        let back = if place.is_back { laid.count() } else { 0 };
        (laid.columns != 0).then(|| laid.first + back + laid.number(place.at))
    }

    /// What a unit of light that hits a tile gives to the functions; `None` where hits are to be looked at one by one.
    #[inline]
    pub fn shares(&self, number: u32) -> Option<Shares> {
        let tile = self.tiles[number as usize];
        (!tile.is_unknown()).then_some(tile)
    }
}
