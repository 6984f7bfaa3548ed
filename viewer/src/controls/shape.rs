//! Shapes of handles in the picture.

/// A shape to draw, canvas pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// Its centre.
    pub centre: [f32; 2],
    /// Radius; half the width of a line.
    pub radius: f32,
    /// Radius of the hole; 0 for none.
    pub hole: f32,
    /// Length of a line; 0 for a disc.
    pub length: f32,
    /// Direction of a line, radians.
    pub angle: f32,
    /// Display RGB and alpha.
    pub color: [f32; 4],
}

/// Radius of a handle, pixels, in a picture of this size.
pub fn radius(size: [u32; 2]) -> f32 {
    (size[1] as f32 / 75.0).clamp(5.0, 18.0)
}
