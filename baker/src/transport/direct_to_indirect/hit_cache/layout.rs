//! Layout of a primitive's tiles: a grid along two sides of the triangle, and the tile at given
//! surface coordinates.

use glam::Vec2;

/// Tile grid of a primitive: a parallelogram of rows and columns without the half beyond the third
/// side. The rows of the triangle's upper half are rotated by 180° and placed next to the rows of
/// the lower half.
#[derive(Clone, Copy, Debug, Default)]
pub struct TileLayout {
    /// Number of the first tile; tiles of the back follow tiles of the front.
    pub first: u32,
    /// Number of columns; 0 for a primitive without tiles, whose hits are shaded individually.
    pub columns: u16,
    pub rows: u16,
}

impl TileLayout {
    /// Number of tiles per pair of rows.
    fn width(self) -> u32 {
        let (columns, rows) = (self.columns as u32, self.rows as u32);
        if rows == 1 { columns } else { columns + columns.div_ceil(rows.max(1)) + 1 }
    }

    /// Number of tiles of a side (front or back).
    pub fn count(self) -> u32 {
        (self.rows as u32).div_ceil(2) * self.width()
    }

    /// Number of tiles of a row that are at least partly inside the third side.
    fn length(self, row: u32) -> u32 {
        (self.columns as u32 * (self.rows as u32 - row)).div_ceil(self.rows as u32)
    }

    /// Returns the number of the tile at `at`, within its side.
    #[inline]
    pub fn number(self, at: Vec2) -> u32 {
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

    /// Column and row of a tile; `None` for a tile outside the triangle.
    pub fn column_row(self, number: u32) -> Option<(u32, u32)> {
        let (row, k) = (number / self.width(), number % self.width());
        if k < self.length(row) {
            return Some((k, row));
        }
        let (other, k) = (self.rows as u32 - 1 - row, self.width() - 1 - k);
        (other != row && k < self.length(other)).then_some((k, other))
    }

    /// Returns surface coordinates at the fraction `within` (0 to 1 along each axis) of a tile. A
    /// position beyond the third side is moved towards the tile's first corner, onto the third
    /// side.
    pub fn at(self, (column, row): (u32, u32), within: Vec2) -> Vec2 {
        let size = Vec2::new(self.columns as f32, self.rows as f32);
        let corner = Vec2::new(column as f32, row as f32) / size;
        let offset = within / size;
        let room = (1.0 - corner.element_sum()).max(0.0);
        corner + offset * (room / offset.element_sum().max(f32::MIN_POSITIVE)).min(1.0)
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
            let laid = TileLayout { first: 0, columns, rows };
            let mut owners = std::collections::HashSet::new();
            for number in 0..laid.count() {
                let Some(tile) = laid.column_row(number) else { continue };
                assert!(owners.insert(tile), "{columns} x {rows}: {tile:?} is there twice");
                for _ in 0..10 {
                    let at = laid.at(tile, stream.square() * 0.998 + 0.001);
                    assert!(at.min_element() >= 0.0 && at.element_sum() <= 1.0 + 1e-6, "{at}");
                    let found = laid.number(at);
                    // Rounding may move a position on the third side into the adjacent tile.
                    assert!(
                        found == number || at.element_sum() > 0.9999,
                        "{columns} x {rows}: {tile:?}, {at}"
                    );
                    assert!(laid.column_row(found).is_some());
                }
            }
            // All tiles with the first corner inside the third side.
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
}
