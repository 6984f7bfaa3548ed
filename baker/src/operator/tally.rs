//! What a receiver gets, summed by sender while its rays come in.

use glam::{Vec3, Vec3A};
use rebounce_shared::link::{Link, VectorRgb};

/// What a receiver gets from a sender.
pub trait Amount: Copy + Default {
    /// `self += scale * other`.
    fn add_scaled(&mut self, scale: f32, other: &Self);
    /// The square of how much it is, root mean square over the channels.
    fn magnitude_squared(&self) -> f32;
}

/// Vector irradiance per channel, aligned for the inner loops.
#[derive(Clone, Copy, Debug, Default)]
pub struct Vectors(pub [Vec3A; 3]);

impl Vectors {
    /// As a link, and what of it the link holds.
    pub fn pack(&self) -> (Link, Self) {
        let link = Link::pack_vectors(0, &VectorRgb { rgb: self.0.map(Vec3::from) });
        (link, Self(link.vectors().rgb.map(Vec3A::from)))
    }
}

impl Amount for Vectors {
    #[inline]
    fn add_scaled(&mut self, scale: f32, other: &Self) {
        for c in 0..3 {
            self.0[c] += other.0[c] * scale;
        }
    }

    #[inline]
    fn magnitude_squared(&self) -> f32 {
        self.0.iter().map(|v| v.length_squared()).sum::<f32>() / 3.0
    }
}

/// Irradiance per channel along the receiver's normal.
#[derive(Clone, Copy, Debug, Default)]
pub struct Irradiance(pub Vec3A);

impl Irradiance {
    /// How a receiver with this unit normal makes links of it: along the normal. Gives the link, and what of
    /// the irradiance it holds.
    pub fn packing(normal: Vec3) -> impl Fn(&Self) -> (Link, Self) {
        // A link's direction is rounded, and the receiver reads the part along its normal.
        let direction = Link::pack(0, normal, Vec3::ONE).direction();
        let along = direction.dot(normal);
        move |irradiance| {
            let link = Link::pack(0, direction, Vec3::from(irradiance.0) / along);
            (link, Self(Vec3A::from(link.magnitude()) * along))
        }
    }
}

impl Amount for Irradiance {
    #[inline]
    fn add_scaled(&mut self, scale: f32, other: &Self) {
        self.0 += other.0 * scale;
    }

    #[inline]
    fn magnitude_squared(&self) -> f32 {
        self.0.length_squared() / 3.0
    }
}

/// A receiver's irradiance per channel from senders, ascending.
pub type IrradianceRow = Vec<(u32, Vec3)>;

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

    /// Adds a share of the amount to each of these senders.
    #[inline]
    pub fn share(&mut self, shares: &[(u32, f32)], amount: &A) {
        for &(sender, share) in shares {
            self.add(sender as usize, share, amount);
        }
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

impl Tally<Vectors> {
    /// The irradiance from each sender on a surface with this unit normal. What is not over
    /// `least` is carried over to the next sender, as in [`super::choose`].
    pub fn irradiance_row(&self, normal: Vec3, least: f32) -> IrradianceRow {
        let normal = Vec3A::from(normal);
        let mut carried = Vec3::ZERO;
        let mut row = Vec::new();
        for sender in self.touched() {
            let sum = &self.sums[sender as usize].0;
            carried += Vec3::new(sum[0].dot(normal), sum[1].dot(normal), sum[2].dot(normal));
            if carried.max_element() > least {
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
    fn a_packed_irradiance_tells_exactly_what_it_holds() {
        for i in 0..2000 {
            let mut s = Stream::new(3, i);
            let normal = s.sphere();
            let mut channel = || (s.unit() - 0.5) * 10f32.powf(-6.0 * s.unit());
            let irradiance = Vec3::new(channel(), channel(), channel());
            let (link, held) = Irradiance::packing(normal)(&Irradiance(irradiance.into()));
            let read = link.vectors().irradiance(normal);
            let largest = irradiance.abs().max_element();
            assert!((read - Vec3::from(held.0)).abs().max_element() < 1e-6 * largest, "{read} {held:?}");
            assert!((read - irradiance).abs().max_element() < 0.005 * largest, "{read} {irradiance}");
        }
    }
}
