//! Oracle of links: whether a link is refined, and at which end (Lehtinen et al. 2007, 6.5; in the manner of Gortler et
//! al. 1993).
//!
//! The oracle sees the link's magnitude, and the deviation of the kernel over the children of either end. A link that is
//! weak at the point and at the children stays. Otherwise the end with the greater deviation over its threshold is refined.

/// What the oracle knows of a link, all in the unit of its amount.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Inspection {
    /// Deviation of the kernel over the sender; 0 for a sender without children.
    pub over_sender: f32,
    /// Deviation of the kernel over the receiver's children; 0 for a receiver without children.
    pub over_receiver: f32,
    /// The greatest magnitude of the link: at the receiver, and at its children.
    pub magnitude: f32,
}

/// End of a link that is refined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RefinedEnd {
    /// Links from the sender's children replace the link.
    Sender,
    /// Links to the receiver's children add their differences to it.
    Receiver,
}

/// Thresholds of the oracle on a level of receivers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oracle {
    /// Least magnitude, and least deviation over a sender, of a link that is refined.
    pub epsilon: f32,
    /// Least deviation over a receiver's children.
    pub finer_epsilon: f32,
}

impl Oracle {
    /// The end to refine; `None` for a link that stays.
    pub fn decide(&self, link: &Inspection) -> Option<RefinedEnd> {
        if link.magnitude <= self.epsilon {
            return None;
        }
        let sender = link.over_sender / self.epsilon.max(f32::MIN_POSITIVE);
        let receiver = link.over_receiver / self.finer_epsilon.max(f32::MIN_POSITIVE);
        match sender.max(receiver) > 1.0 {
            false => None,
            true if sender >= receiver => Some(RefinedEnd::Sender),
            true => Some(RefinedEnd::Receiver),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ORACLE: Oracle = Oracle { epsilon: 0.01, finer_epsilon: 0.02 };

    fn decide(over_sender: f32, over_receiver: f32, magnitude: f32) -> Option<RefinedEnd> {
        ORACLE.decide(&Inspection { over_sender, over_receiver, magnitude })
    }

    #[test]
    fn the_end_with_more_deviation_for_its_threshold_is_refined() {
        assert_eq!(decide(0.03, 0.05, 0.1), Some(RefinedEnd::Sender));
        assert_eq!(decide(0.03, 0.07, 0.1), Some(RefinedEnd::Receiver));
        assert_eq!(decide(0.0, 0.03, 0.1), Some(RefinedEnd::Receiver));
    }

    #[test]
    fn weak_links_and_even_ones_stay() {
        assert_eq!(decide(0.03, 0.05, 0.009), None);
        assert_eq!(decide(0.009, 0.019, 0.1), None);
    }

    #[test]
    fn an_epsilon_of_zero_refines_whatever_varies() {
        let oracle = Oracle { epsilon: 0.0, finer_epsilon: 0.0 };
        let link = Inspection { over_sender: 1e-6, over_receiver: 0.0, magnitude: 1e-6 };
        assert_eq!(oracle.decide(&link), Some(RefinedEnd::Sender));
        assert_eq!(oracle.decide(&Inspection { magnitude: 0.5, ..Inspection::default() }), None);
    }
}
