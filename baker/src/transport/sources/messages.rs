//! Results of receivers as bytes, little-endian: messages between processes.

use super::sky::Openings;
use crate::job::bytes::{Reader, lengths, put};
use crate::job::parts::PartResult;
use glam::Vec3;
use rebounce_shared::link::SourceLink;

/// A receiver's result.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Receiver {
    pub links: Vec<SourceLink>,
    /// Represented irradiance by source: the parents' prediction plus the links. Empty on the last level.
    pub value: Vec<f32>,
    /// Sum of `value` over the bins of the sky.
    pub sky: f32,
    /// Visibility of each group by channel; NaN where nothing of it is on the receiver's side. Empty on the last level.
    pub visibility: Vec<Vec3>,
    /// What is seen of the sky; `None` on the last level and without a sky.
    pub openings: Option<Box<Openings>>,
    pub rays: u64,
}

/// Results of a chunk of receivers.
#[derive(Clone, Debug, PartialEq)]
pub struct SourceChunk(pub Vec<Receiver>);

impl PartResult for SourceChunk {
    fn encode(&self, out: &mut Vec<u8>) {
        let found = &self.0;
        put(out, &[found.len() as u64]);
        put(out, &found.iter().map(|receiver| receiver.rays).collect::<Vec<u64>>());
        put(out, &found.iter().map(|receiver| receiver.sky).collect::<Vec<f32>>());
        put(out, &lengths(found.iter().map(|receiver| &receiver.links)));
        put(out, &lengths(found.iter().map(|receiver| &receiver.value)));
        put(out, &lengths(found.iter().map(|receiver| &receiver.visibility)));
        put(out, &found.iter().map(|receiver| u8::from(receiver.openings.is_some())).collect::<Vec<u8>>());
        for receiver in found {
            put(out, &receiver.links);
            put(out, &receiver.value);
            put(out, &receiver.visibility);
            receiver.openings.iter().for_each(|openings| put(out, &openings[..]));
        }
    }

    fn decode(from: &mut Reader) -> Option<Self> {
        let count = from.one::<u64>()? as usize;
        let (rays, sky) = (from.take::<u64>(count)?, from.take::<f32>(count)?);
        let (links, values) = (from.take::<u32>(count)?, from.take::<u32>(count)?);
        let visibilities = from.take::<u32>(count)?;
        let has_openings = from.take::<u8>(count)?;
        let mut found = Vec::with_capacity(count);
        for i in 0..count {
            found.push(Receiver {
                links: from.take(links[i] as usize)?,
                value: from.take(values[i] as usize)?,
                visibility: from.take(visibilities[i] as usize)?,
                openings: match has_openings[i] {
                    0 => None,
                    _ => Some(Box::new(from.one::<Openings>()?)),
                },
                sky: sky[i],
                rays: rays[i],
            });
        }
        Some(Self(found))
    }

    /// Links and number of rays are for process 0. All processes need what children read, and the first link as a flag for
    /// non-empty links.
    fn split(&self) -> [Self; 2] {
        let first =
            |row: &Receiver| Receiver { links: row.links.clone(), rays: row.rays, ..Receiver::default() };
        let all = |row: &Receiver| Receiver {
            links: row.links.first().copied().into_iter().collect(),
            rays: 0,
            ..row.clone()
        };
        [Self(self.0.iter().map(first).collect()), Self(self.0.iter().map(all).collect())]
    }

    fn join([first, mut all]: [Self; 2]) -> Option<Self> {
        (first.0.len() == all.0.len()).then_some(())?;
        for (row, first) in all.0.iter_mut().zip(first.0) {
            (row.links, row.rays) = (first.links, first.rays);
        }
        Some(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rebounce_shared::environment::bins::BINS;

    fn chunk() -> SourceChunk {
        let seen = Receiver {
            links: vec![SourceLink::pack(3, 7), SourceLink::pack(9, -2)],
            value: vec![0.5, 0.25],
            visibility: vec![Vec3::new(0.25, 0.5, 1.0)],
            sky: 0.75,
            openings: Some(Box::new([9; BINS])),
            rays: 11,
        };
        SourceChunk(vec![seen, Receiver::default()])
    }

    #[test]
    fn receivers_come_back_as_they_were() {
        let mut bytes = Vec::new();
        chunk().encode(&mut bytes);
        assert_eq!(SourceChunk::decode(&mut Reader(&bytes)), Some(chunk()));
        assert_eq!(SourceChunk::decode(&mut Reader(&bytes[..bytes.len() - 1])), None);
    }

    #[test]
    fn halves_join_to_the_whole() {
        assert_eq!(SourceChunk::join(chunk().split()), Some(chunk()));
        let [first, _] = chunk().split();
        assert_eq!(SourceChunk::join([first, SourceChunk(Vec::new())]), None);
    }
}
