//! What a receiver gets, summed by sender while its rays come in.

use glam::Vec3A;
use rebounce_shared::link::{Link, VectorLink};

/// What a receiver gets from a sender.
pub trait Amount: Copy + Default {
    /// `self += scale * other`.
    fn add_scaled(&mut self, scale: f32, other: &Self);
    /// The square of how much it is.
    fn magnitude_squared(&self) -> f32;
}

/// An amount that links can hold.
pub trait Packed: Amount {
    /// The link.
    type Link: Copy;
    /// As a link, and what of it the link holds.
    fn pack(&self, sender: u32) -> (Self::Link, Self);
}

/// Vector irradiance, aligned for the inner loops.
#[derive(Clone, Copy, Debug, Default)]
pub struct Vector(pub Vec3A);

impl Packed for Vector {
    type Link = VectorLink;

    fn pack(&self, sender: u32) -> (VectorLink, Self) {
        let link = VectorLink::pack(sender, self.0.into());
        (link, Self(link.vector().into()))
    }
}

impl Amount for Vector {
    #[inline]
    fn add_scaled(&mut self, scale: f32, other: &Self) {
        self.0 += other.0 * scale;
    }

    #[inline]
    fn magnitude_squared(&self) -> f32 {
        self.0.length_squared()
    }
}

/// Irradiance along the receiver's normal.
#[derive(Clone, Copy, Debug, Default)]
pub struct Irradiance(pub f32);

impl Packed for Irradiance {
    type Link = Link;

    fn pack(&self, sender: u32) -> (Link, Self) {
        let link = Link::pack(sender, self.0);
        (link, Self(link.amount()))
    }
}

impl Amount for Irradiance {
    #[inline]
    fn add_scaled(&mut self, scale: f32, other: &Self) {
        self.0 += other.0 * scale;
    }

    #[inline]
    fn magnitude_squared(&self) -> f32 {
        self.0 * self.0
    }
}

/// A receiver's irradiance from senders, ascending.
pub type IrradianceRow = Vec<(u32, f32)>;

/// Sums by sender, of which few are not zero.
pub struct Tally<A> {
    sums: Vec<A>,
    /// One bit a sender, so that those touched come in order.
    is_touched: Vec<u64>,
}

impl<A: Amount> Tally<A> {
    /// For this many senders.
    pub fn new(senders: usize) -> Self {
        Self { sums: vec![A::default(); senders], is_touched: vec![0; senders.div_ceil(64)] }
    }

    #[inline]
    fn touch(&mut self, sender: usize) {
        self.is_touched[sender / 64] |= 1 << (sender % 64);
    }

    /// What a sender gave so far.
    #[inline]
    pub fn get(&self, sender: u32) -> &A {
        &self.sums[sender as usize]
    }

    /// Adds to one sender.
    #[inline]
    pub fn add(&mut self, sender: usize, scale: f32, amount: &A) {
        self.touch(sender);
        self.sums[sender].add_scaled(scale, amount);
    }

    /// The senders touched, ascending.
    pub fn touched(&self) -> impl Iterator<Item = u32> + '_ {
        self.touched_with(None)
    }

    /// The senders touched here or there, ascending.
    pub fn touched_with<'a>(&'a self, other: Option<&'a Self>) -> impl Iterator<Item = u32> + 'a {
        self.is_touched.iter().enumerate().flat_map(move |(i, &word)| {
            let mut rest = word | other.map_or(0, |other| other.is_touched[i]);
            let first = 64 * i as u32;
            std::iter::from_fn(move || {
                let bit = (rest != 0).then(|| rest.trailing_zeros())?;
                rest &= rest - 1;
                Some(first + bit)
            })
        })
    }

    /// Back to nothing.
    pub fn clear(&mut self) {
        for (word, sums) in self.is_touched.iter_mut().zip(self.sums.chunks_mut(64)) {
            if std::mem::take(word) != 0 {
                sums.fill(A::default());
            }
        }
    }
}

impl Tally<Irradiance> {
    /// The irradiance from each sender. What is not over `least` is carried over to the next sender, as in
    /// [`super::choose`].
    pub fn row(&self, least: f32) -> IrradianceRow {
        let mut carried = 0.0;
        let mut row: IrradianceRow = Vec::new();
        for sender in self.touched() {
            carried += self.sums[sender as usize].0;
            if carried > least {
                row.push((sender, std::mem::take(&mut carried)));
            }
        }
        match (row.last_mut(), self.touched().next()) {
            (Some((_, last)), _) => *last += carried,
            (None, Some(sender)) => row.push((sender, carried)),
            (None, None) => {}
        }
        row
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    #[test]
    fn what_is_packed_tells_exactly_what_it_holds() {
        for i in 0..2000 {
            let mut s = Stream::new(3, i);
            let size = 10f32.powf(-6.0 * s.unit());
            let (link, held) = Irradiance(-size).pack(7);
            assert_eq!(link.amount(), held.0);
            assert!((held.0 + size).abs() < 0.01 * size);
            let vector = Vec3A::from(s.sphere()) * size;
            let (link, held) = Vector(vector).pack(7);
            assert_eq!(Vec3A::from(link.vector()), held.0);
            assert!((held.0 - vector).length() < 0.02 * size);
        }
    }
}
