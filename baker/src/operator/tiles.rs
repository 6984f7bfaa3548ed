//! What rays find, worked out beforehand: the functions that cover a hit, and how much light they get, for every small
//! tile of the surfaces.
//!
//! Many rays hit what few places are: half a function's radius across, a tile is so small that the functions'
//! weights hardly change over it, and each is hit by dozens of rays. So what a hit costs is one look at 32 bytes, not at a
//! dozen functions and some texels. The means over tiles are those over rays: rays do not know about tiles.

use crate::basis::Leveled;
use crate::random::{mix, unit};
use crate::surface::{Piece, Pieces, Place, Spot};
use crate::watch::{Stopped, Watch};
use glam::{Vec2, Vec3A};
use rayon::prelude::*;

/// Width of a tile over the smallest radius of the functions that cover its piece.
const WIDTH: f32 = 0.5;
/// Functions that a tile, or a hit, passes its light to.
const SLOTS: usize = 4;
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
/// What a transparent place counts like, at least.
const LEAST_OPACITY: f32 = 1e-3;
/// Places along each axis that tell how wide a large piece's tiles are.
const PROBES: u32 = 6;
/// Tiles that one thread works out at a time.
const TOGETHER: usize = 1 << 12;

/// No function.
const NONE: u32 = u32::MAX;
/// In place of the first function: hits are to be looked at one by one.
const ASK: u32 = u32::MAX - 1;

/// Light passed to functions: shares of a whole, half a cache line.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub struct Shares {
    functions: [u32; SLOTS],
    amounts: [f32; SLOTS],
}

impl Shares {
    /// No light.
    pub const NOTHING: Self = Self { functions: [NONE; SLOTS], amounts: [0.0; SLOTS] };
    /// What stands in a tile whose hits are to be looked at one by one.
    const ASK: Self = Self { functions: [ASK; SLOTS], amounts: [0.0; SLOTS] };

    /// So much that no function covers.
    pub fn lost(amount: f32) -> Self {
        Self { amounts: [amount, 0.0, 0.0, 0.0], ..Self::NOTHING }
    }

    /// From some functions' weights, which sum to 1, and the light that each of them gets for a whole. Of more than
    /// fit, each is there as often on average as it weighs; `chance`, 0 to 1, decides.
    pub fn of(weights: &[(u32, f32, f32)], chance: f32) -> Self {
        let mut out = Self::NOTHING;
        if weights.len() <= SLOTS {
            for (slot, &(function, weight, light)) in weights.iter().enumerate() {
                (out.functions[slot], out.amounts[slot]) = (function, weight * light);
            }
            return out;
        }
        const EACH: f32 = 1.0 / SLOTS as f32;
        let (mut slot, mut below) = (0, 0.0);
        for (i, &(function, weight, light)) in weights.iter().enumerate() {
            below += weight;
            // The last one takes what rounding leaves.
            while slot < SLOTS && ((slot as f32 + chance) * EACH < below || i + 1 == weights.len()) {
                (out.functions[slot], out.amounts[slot]) = (function, EACH * light);
                slot += 1;
            }
        }
        out
    }

    /// The same light, scaled.
    #[inline]
    pub fn scaled(mut self, factor: f32) -> Self {
        self.amounts.iter_mut().for_each(|amount| *amount *= factor);
        self
    }

    /// All light together.
    #[inline]
    pub fn sum(&self) -> f32 {
        self.amounts.iter().sum()
    }

    /// Whether no function covers what is there.
    #[inline]
    pub fn is_lost(&self) -> bool {
        self.functions[0] == NONE
    }

    /// Calls `visit(function, amount)` for each function that gets light.
    #[inline]
    pub fn each(&self, mut visit: impl FnMut(usize, f32)) {
        for (&function, &amount) in self.functions.iter().zip(&self.amounts) {
            if function != NONE {
                visit(function as usize, amount);
            }
        }
    }
}

/// The tiles of a piece: a parallelogram of rows and columns, of which the half beyond the third side is left out by
/// laying the rows of the upper half, turned around, beside those of the lower half.
#[derive(Clone, Copy, Debug, Default)]
struct Laid {
    /// Where they begin; those of the back follow those of the front.
    first: u32,
    /// None: hits are looked at one by one.
    columns: u16,
    rows: u16,
}

impl Laid {
    /// Tiles from one pair of rows to the next.
    fn width(self) -> u32 {
        let (columns, rows) = (self.columns as u32, self.rows as u32);
        if rows == 1 { columns } else { columns + columns.div_ceil(rows.max(1)) + 1 }
    }

    /// Tiles of a side.
    fn count(self) -> u32 {
        (self.rows as u32).div_ceil(2) * self.width()
    }

    /// Tiles of a row that are not beyond the third side altogether.
    fn length(self, row: u32) -> u32 {
        (self.columns as u32 * (self.rows as u32 - row)).div_ceil(self.rows as u32)
    }

    /// The number of the tile that holds a place, among those of its side.
    #[inline]
    fn number(self, at: Vec2) -> u32 {
        let (columns, rows) = (self.columns as u32, self.rows as u32);
        if columns * rows == 1 {
            return 0;
        }
        let row = ((at.y * rows as f32) as u32).min(rows - 1);
        let column = ((at.x * columns as f32) as u32).min(self.length(row) - 1);
        let other = rows - 1 - row;
        if row <= other {
            row * self.width() + column
        } else {
            other * self.width() + self.width() - 1 - column
        }
    }

    /// Column and row of a tile; `None` for one that is no part of the piece.
    fn column_row(self, number: u32) -> Option<(u32, u32)> {
        let (row, k) = (number / self.width(), number % self.width());
        if k < self.length(row) {
            return Some((k, row));
        }
        let (other, k) = (self.rows as u32 - 1 - row, self.width() - 1 - k);
        (other != row && k < self.length(other)).then_some((k, other))
    }

    /// A place of a tile, `within` it from 0 to 1 along each axis; beyond the third side the nearest one towards the
    /// tile's first corner.
    fn at(self, (column, row): (u32, u32), within: Vec2) -> Vec2 {
        let size = Vec2::new(self.columns as f32, self.rows as f32);
        let corner = Vec2::new(column as f32, row as f32) / size;
        let offset = within / size;
        let room = (1.0 - corner.element_sum()).max(0.0);
        corner + offset * (room / offset.element_sum().max(f32::MIN_POSITIVE)).min(1.0)
    }
}

/// The tiles that gathers read.
pub struct SenderTiles {
    /// For the senders.
    pub senders: Tiles,
    /// For the functions that later bounces travel between.
    pub coarse: Tiles,
}

/// How a piece is laid with tiles.
fn lay(pieces: &dyn Pieces, piece: u32, functions: &Leveled) -> Laid {
    let Piece { sides, .. } = pieces.piece(piece);
    let longest = sides[0].max(sides[1]);
    let mut radius = functions.finest_radius();
    if longest > WIDTH * radius {
        // It may be out of the finest functions' reach.
        let probes = ((longest / radius) as u32).clamp(1, PROBES);
        let probed = Laid { first: 0, columns: probes as u16, rows: probes as u16 };
        let found = (0..probed.count()).filter_map(|number| {
            let at = probed.at(probed.column_row(number)?, Vec2::splat(0.5));
            let spot = pieces.spot(Place { piece, at, is_back: false }, 0.0);
            functions.radius_at(spot.position, spot.normal)
        });
        radius = found.reduce(f32::min).unwrap_or(functions.coarsest_radius());
    }
    let [columns, rows] =
        sides.map(|side| (side / (WIDTH * radius)).ceil().clamp(1.0, u16::MAX as f32) as u16);
    if columns as u32 * rows as u32 > MOST {
        return Laid::default();
    }
    Laid { first: 0, columns, rows }
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
}

impl Maker<'_> {
    fn tile(&mut self, piece: u32, laid: Laid, number: u32) -> Shares {
        let Piece { sides, .. } = self.pieces.piece(piece);
        let (count, local) = (laid.count(), number - laid.first);
        let Some(tile) = laid.column_row(local % count) else { return Shares::NOTHING };
        let spot = |within: Vec2, area: f32| {
            let place = Place { piece, at: laid.at(tile, within), is_back: local >= count };
            self.pieces.spot(place, area)
        };
        let area = sides[0] * sides[1] / (laid.columns as f32 * laid.rows as f32);
        let is_tiny = 2.0 * sides[0].max(sides[1]) < WIDTH * self.functions.finest_radius();
        let all = inside(0.25);
        let places = if is_tiny { &[Vec2::splat(1.0 / 3.0)][..] } else { &all };
        self.together.clear();
        let mut total = 0.0;
        for within in places {
            let Spot { position, normal, albedo: here, opacity } = spot(*within, area / places.len() as f32);
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
            return Shares::ASK;
        }
        if !is_tiny && self.together.iter().any(|entry| self.functions.has_cuts(entry.0)) {
            let corners = inside(EDGE).map(|corner| spot(corner, 0.0).position);
            if self.together.iter().any(|entry| self.functions.is_cut_between(entry.0, &corners)) {
                return Shares::ASK;
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
        let lay = |piece: usize| lay(pieces, piece as u32, functions);
        let mut laid: Vec<Laid> = (0..pieces.count()).into_par_iter().map(lay).collect();
        watch.step(0)?;
        let sides = |piece: usize| 1 + pieces.piece(piece as u32).has_back as u32;
        let most = MOST_TOGETHER[0] * duals.len() + MOST_TOGETHER[1] * pieces.count();
        let most = most.min(ASK as usize) as u32;
        let mut count = 0u32;
        for (piece, laid) in laid.iter_mut().enumerate() {
            let more = laid.count() * sides(piece);
            if count.checked_add(more).is_none_or(|count| count > most) {
                *laid = Laid::default();
            }
            laid.first = count;
            count += laid.count() * sides(piece);
        }
        let mut tiles = vec![Shares::NOTHING; count as usize];
        tiles.par_chunks_mut(TOGETHER).enumerate().try_for_each(|(chunk, tiles)| {
            watch.step(0)?;
            let mut maker =
                Maker { pieces, functions, duals, seed, weights: Vec::new(), together: Vec::new() };
            let first = (chunk * TOGETHER) as u32;
            // The last piece that begins here or before: those without tiles begin where the next one does.
            let mut piece = laid.partition_point(|laid| laid.first <= first) - 1;
            for (tile, number) in tiles.iter_mut().zip(first..) {
                while number >= laid.get(piece + 1).map_or(count, |next| next.first) {
                    piece += 1;
                }
                *tile = maker.tile(piece as u32, laid[piece], number);
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
        (tile.functions[0] != ASK).then_some(tile)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    #[test]
    fn each_place_of_a_triangle_is_in_one_tile_and_each_tile_has_places() {
        let mut stream = Stream::new(3, 0);
        for (columns, rows) in
            [(1, 1), (2, 1), (1, 2), (3, 1), (1, 7), (2, 2), (5, 3), (3, 5), (8, 8), (40, 7), (2, 31)]
        {
            let laid = Laid { first: 0, columns, rows };
            let mut owners = std::collections::HashSet::new();
            for number in 0..laid.count() {
                let Some(tile) = laid.column_row(number) else { continue };
                assert!(owners.insert(tile), "{columns} x {rows}: {tile:?} is there twice");
                for _ in 0..10 {
                    let at = laid.at(tile, stream.square() * 0.998 + 0.001);
                    assert!(at.min_element() >= 0.0 && at.element_sum() <= 1.0 + 1e-6, "{at}");
                    let found = laid.number(at);
                    // A place on the third side may be rounded into the tile beside.
                    assert!(
                        found == number || at.element_sum() > 0.9999,
                        "{columns} x {rows}: {tile:?}, {at}"
                    );
                    assert!(laid.column_row(found).is_some());
                }
            }
            // All that reach below the third side.
            let below = |column: u32, row: u32| {
                column * (rows as u32) + row * (columns as u32) < columns as u32 * rows as u32
            };
            let wanted = (0..columns as u32)
                .flat_map(|c| (0..rows as u32).map(move |r| (c, r)))
                .filter(|(c, r)| below(*c, *r));
            assert_eq!(owners, wanted.collect(), "{columns} x {rows}");
            for corner in [Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::splat(0.5), Vec2::new(0.3, 0.7)] {
                assert!(laid.column_row(laid.number(corner)).is_some(), "{columns} x {rows}: {corner}");
            }
        }
    }

    #[test]
    fn light_goes_to_each_function_by_its_weight_on_average() {
        let weights =
            [(7, 0.05, 2.0), (3, 0.3, 1.0), (9, 0.02, 0.5), (1, 0.4, 1.5), (4, 0.13, 3.0), (8, 0.1, 1.0)];
        let mut sums = [0.0; 10];
        const TIMES: usize = 10_000;
        for k in 0..TIMES {
            let shares = Shares::of(&weights, k as f32 / TIMES as f32);
            assert!(!shares.is_lost());
            let mut total = 0.0;
            shares.each(|function, amount| {
                sums[function] += amount / TIMES as f32;
                total += amount / weights.iter().find(|w| w.0 == function as u32).unwrap().2;
            });
            assert!((total - 1.0).abs() < 1e-6, "{total}");
        }
        for (function, weight, light) in weights {
            let sum = sums[function as usize];
            assert!((sum / (weight * light) - 1.0).abs() < 0.01, "{function}: {sum}, not {}", weight * light);
        }
        // Few are there as they are.
        let shares = Shares::of(&weights[..3], 0.9);
        let mut found = Vec::new();
        shares.each(|function, amount| found.push((function, amount)));
        assert_eq!(found, [(7, 0.05 * 2.0), (3, 0.3), (9, 0.02 * 0.5)]);
    }
}
