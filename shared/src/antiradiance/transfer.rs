//! The form factor of a link for one bin.

/// Bits of a bin in [`Transfer::bins`].
pub(super) const BIN_BITS: u32 = 10;

/// Light from one bin of a sender.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Transfer {
    /// Element that it comes from.
    pub sender: u32,
    /// The bin, and above its ten bits the width that it is spread by.
    pub bins: u32,
    /// Incident radiance per exitant intensity, 1 / square scene units.
    pub factor: f32,
}

impl Transfer {
    /// The bin.
    pub fn bin(&self) -> usize {
        (self.bins & ((1 << BIN_BITS) - 1)) as usize
    }

    /// Index of the width in [`Spread`](super::spread::Spread).
    pub fn width(&self) -> usize {
        (self.bins >> BIN_BITS) as usize
    }
}
