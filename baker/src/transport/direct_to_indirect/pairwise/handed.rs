//! Links that a receiver hands down to its children.

use bytemuck::{Pod, Zeroable};

/// A link of a receiver, as the receiver's children take it over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct HandedLink {
    /// Index of the sender.
    pub sender: u32,
    /// Share of the transport between receiver and sender that the link stands for, 0 to 1.
    pub share: f32,
    /// Irradiance of the receiver per unit irradiance at the sender.
    pub amount: f32,
    /// The same without visibility.
    pub open: f32,
    /// 1 for a link that is refined at the receiver: rays find its coefficient at the children. 0 for a smooth link, which
    /// changes at the children as the kernel without visibility does.
    pub is_refined: u32,
}

/// Whether links from elsewhere are valid: senders ascend and are in range, numbers are finite.
pub fn fits(links: &[HandedLink], senders: usize) -> bool {
    links.windows(2).all(|pair| pair[0].sender < pair[1].sender)
        && links.last().is_none_or(|last| (last.sender as usize) < senders)
        && links.iter().all(|link| link.share.is_finite() && link.amount.is_finite() && link.open.is_finite())
}
