//! Results of the parts of the operator as bytes, little-endian: for checkpoints, and for messages between processes.

use super::bounces::Columns;
use super::gather::Gathered;
use super::gather_context::GatherCost;
use super::pairwise::handed::HandedLink;
use crate::job::bytes::{Reader, lengths, put};
use crate::job::parts::PartResult;
use glam::Vec3;
use rebounce_shared::link::Link;

/// Results of a chunk of receivers.
#[derive(Clone, Debug, PartialEq)]
pub struct GatheredChunk(pub Vec<Gathered>);

impl PartResult for GatheredChunk {
    fn encode(&self, out: &mut Vec<u8>) {
        let found = &self.0;
        put(out, &[found.len() as u64]);
        put(out, &found.iter().map(|g| g.cost.rays).collect::<Vec<u64>>());
        put(out, &found.iter().map(|g| [g.cost.seen, g.cost.lost]).collect::<Vec<_>>());
        put(out, &lengths(found.iter().map(|g| &g.links)));
        put(out, &lengths(found.iter().map(|g| &g.value)));
        put(out, &lengths(found.iter().map(|g| &g.handed)));
        for gathered in found {
            put(out, &gathered.links);
            put(out, &gathered.value);
            put(out, &gathered.handed);
        }
    }

    fn decode(from: &mut Reader) -> Option<Self> {
        let count = from.one::<u64>()? as usize;
        let rays = from.take::<u64>(count)?;
        let light = from.take::<[f64; 2]>(count)?;
        let [links, values, handed] = [from.take::<u32>(count)?, from.take(count)?, from.take(count)?];
        let mut found = Vec::with_capacity(count);
        for (k, (rays, [seen, lost])) in rays.into_iter().zip(light).enumerate() {
            let links: Vec<Link> = from.take(links[k] as usize)?;
            let value: Vec<Link> = from.take(values[k] as usize)?;
            let handed: Vec<HandedLink> = from.take(handed[k] as usize)?;
            found.push(Gathered { links, value, handed, cost: GatherCost { rays, seen, lost } });
        }
        Some(Self(found))
    }

    /// Links and cost are for process 0. All processes need the values, what is handed to children, and the first link as
    /// a flag for non-empty links.
    fn split(&self) -> [Self; 2] {
        let first =
            |row: &Gathered| Gathered { links: row.links.clone(), cost: row.cost, ..Gathered::default() };
        let all = |row: &Gathered| Gathered {
            links: row.links.first().copied().into_iter().collect(),
            value: row.value.clone(),
            handed: row.handed.clone(),
            cost: GatherCost::default(),
        };
        [Self(self.0.iter().map(first).collect()), Self(self.0.iter().map(all).collect())]
    }

    fn join([mut first, all]: [Self; 2]) -> Option<Self> {
        (first.0.len() == all.0.len()).then_some(())?;
        first.0.iter_mut().zip(all.0).for_each(|(row, all)| {
            (row.value, row.handed) = (all.value, all.handed);
        });
        Some(first)
    }
}

impl PartResult for Columns {
    fn encode(&self, out: &mut Vec<u8>) {
        put(out, &[self.rows.len() as u64]);
        put(out, &[self.bounces]);
        put(out, &lengths(self.rows.iter()));
        for row in &self.rows {
            put(out, &row.iter().map(|entry| entry.0).collect::<Vec<u32>>());
            put(out, &row.iter().map(|entry| entry.1).collect::<Vec<Vec3>>());
        }
    }

    fn decode(from: &mut Reader) -> Option<Self> {
        let count = from.one::<u64>()? as usize;
        let bounces = from.one()?;
        let mut rows = Vec::new();
        for length in from.take::<u32>(count)? {
            let senders = from.take::<u32>(length as usize)?;
            rows.push(senders.into_iter().zip(from.take::<Vec3>(length as usize)?).collect());
        }
        Some(Self { bounces, rows })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bytes(found: &impl PartResult) -> Vec<u8> {
        let mut bytes = Vec::new();
        found.encode(&mut bytes);
        bytes
    }

    fn chunk() -> GatheredChunk {
        GatheredChunk(vec![
            Gathered::default(),
            Gathered {
                links: vec![Link::pack(3, 0.5), Link::pack(4, 0.25)],
                value: vec![Link::pack(3, 0.5), Link::pack(9, -0.1)],
                handed: vec![HandedLink { sender: 3, share: 0.5, amount: 0.25, open: 0.5, is_refined: 1 }],
                cost: GatherCost { rays: 512, seen: 0.7, lost: 1e-9 },
            },
        ])
    }

    fn columns() -> Columns {
        Columns { bounces: 9, rows: vec![vec![], vec![(1, Vec3::new(0.1, 0.2, 0.3))]] }
    }

    #[test]
    fn results_come_back_as_they_were_and_no_beginning_is_taken_for_one() {
        let (whole, later) = (bytes(&chunk()), bytes(&columns()));
        assert_eq!(GatheredChunk::decode(&mut Reader(&whole)), Some(chunk()));
        assert_eq!(Columns::decode(&mut Reader(&later)), Some(columns()));
        for end in 0..whole.len() {
            assert_eq!(GatheredChunk::decode(&mut Reader(&whole[..end])), None);
        }
        for end in 0..later.len() {
            assert_eq!(Columns::decode(&mut Reader(&later[..end])), None);
        }
    }

    #[test]
    fn halves_join_to_the_whole() {
        assert_eq!(GatheredChunk::join(chunk().split()), Some(chunk()));
        let [first, _] = chunk().split();
        assert_eq!(GatheredChunk::join([first, GatheredChunk(Vec::new())]), None);
    }
}
