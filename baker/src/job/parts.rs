//! A computation in independent parts: each part is read from the partial_results, computed by this process, or received from
//! another process.

use super::Job;
use super::bytes::{Reader, put};
use super::communicator::CommunicatorError;
use super::communicator::share::{SendBuffer, Traffic, share};
use super::watch::{Stopped, Watch};
use rayon::prelude::*;

/// Result of a part, as bytes.
pub trait PartResult: Clone + Send {
    /// Appends the whole result.
    fn encode(&self, out: &mut Vec<u8>);

    /// Reads a result; `None` for malformed bytes.
    fn decode(from: &mut Reader) -> Option<Self>;

    /// Splits the result into what process 0 alone needs, and what all processes need; [`Self::join`] is the inverse.
    /// Called for [shared](Parts::is_shared) parts. By default both halves are the whole.
    fn split(&self) -> [Self; 2] {
        [self.clone(), self.clone()]
    }

    /// Joins the two halves of a result; `None` if the halves do not match.
    fn join([first, _]: [Self; 2]) -> Option<Self> {
        Some(first)
    }
}

/// A computation in independent parts.
pub trait Parts: Sync {
    /// Result of a part.
    type Found: PartResult;
    /// Kind of the computation in the partial_results.
    const KIND: u32;

    /// Number of parts.
    fn count(&self) -> usize;

    /// Returns a part's key in the partial_results.
    fn key(&self, part: usize) -> u64;

    /// Computes a part.
    fn compute(&self, part: usize) -> Self::Found;

    /// Whether a result of unknown origin is valid for the part.
    fn fits(&self, part: usize, found: &Self::Found) -> bool;

    /// Units of work of a part's result, for the progress.
    fn units(&self, part: usize, found: &Self::Found) -> u64;

    /// Whether all processes need a half of every result; process 0 alone needs the rest.
    fn is_shared(&self) -> bool {
        false
    }

    /// Returns a part's place in the order of work, ascending: any order is right.
    fn order(&self, part: usize) -> u64 {
        part as u64
    }
}

/// Results by part, where known, and the bytes sent.
pub type Computed<T> = (Vec<Option<T>>, Traffic);

/// Computes all parts with all processes of the job. Process 0 returns the results of all parts; another process those of
/// the parts that it computed and, for shared parts, the shared halves of the rest. Also returns the bytes sent. Parts in
/// process 0's partial results are read from the journal; the remaining parts are dealt to the processes in turn, so that costly
/// parts are spread evenly.
///
/// # Errors
/// [`CommunicatorError`]; finished parts are in the partial_results.
pub async fn compute_parts<P: Parts>(
    parts: &P,
    job: &Job<'_>,
    watch: &dyn Watch,
) -> Result<Computed<P::Found>, CommunicatorError> {
    let (partial_results, communicator) = (job.partial_results, job.communicator);
    let mut traffic = Traffic::default();
    let mut found: Vec<Option<P::Found>> = Vec::with_capacity(parts.count());
    for part in 0..parts.count() {
        let stored = partial_results.take(P::KIND, parts.key(part)).and_then(|bytes| whole(&bytes));
        let stored = stored.filter(|stored| parts.fits(part, stored));
        if let Some(stored) = &stored {
            watch.skip(parts.units(part, stored))?;
        }
        found.push(stored);
    }
    let mut is_known: Vec<bool> = found.iter().map(Option::is_some).collect();
    if communicator.size() > 1 {
        traffic.to_all += announce(parts, &mut found, &mut is_known, job, watch).await?;
    }
    let left = (0..parts.count()).filter(|part| !is_known[*part]);
    let mut mine: Vec<usize> = left.skip(communicator.rank()).step_by(communicator.size()).collect();
    mine.sort_by_key(|part| parts.order(*part));
    // Where results arrive only at the end, the others are taken to be as far as this process.
    let members_alike = if communicator.is_blocking() { 1 } else { communicator.size() as u64 };
    let work = |outbox: Option<&SendBuffer>| {
        let compute = |&part: &usize| {
            watch.step(0)?;
            let computed = parts.compute(part);
            partial_results.keep(P::KIND, parts.key(part), &bytes(&computed));
            if let Some(outbox) = outbox {
                outbox.post(|to_first, to_all| post(parts, part, &computed, to_first, to_all));
            }
            watch.step(members_alike * parts.units(part, &computed))?;
            Ok((part, computed))
        };
        mine.par_iter().map(compute).collect::<Result<Vec<_>, Stopped>>()
    };
    let arrive = |member: usize, for_first: &[u8], for_all: &[u8]| {
        let received = receive(parts, for_first, for_all).ok_or(CommunicatorError::Garbled(member))?;
        for (part, result) in received {
            if communicator.rank() == 0 {
                // Only process 0 has whole results.
                if !parts.fits(part, &result) {
                    return Err(CommunicatorError::Garbled(member));
                }
                partial_results.keep(P::KIND, parts.key(part), &bytes(&result));
            }
            watch.step(if members_alike == 1 { parts.units(part, &result) } else { 0 })?;
            *found.get_mut(part).ok_or(CommunicatorError::Garbled(member))? = Some(result);
        }
        Ok(())
    };
    let (own, sent) = share(communicator, watch, work, arrive).await?;
    traffic.add(sent);
    for (part, result) in own {
        found[part] = Some(result);
    }
    let is_complete = found.iter().all(Option::is_some);
    if !is_complete && (communicator.rank() == 0 || parts.is_shared()) {
        return Err(CommunicatorError::Garbled(0));
    }
    Ok((found, traffic))
}

/// Sends the parts of process 0's partial results to the other processes: the shared halves, or only the numbers. Returns the
/// number of bytes.
async fn announce<P: Parts>(
    parts: &P,
    found: &mut [Option<P::Found>],
    is_known: &mut [bool],
    job: &Job<'_>,
    watch: &dyn Watch,
) -> Result<u64, CommunicatorError> {
    let is_first = job.communicator.rank() == 0;
    let mut told = Vec::new();
    for (part, found) in found.iter().enumerate().filter(|_| is_first) {
        if let Some(found) = found {
            let half = if parts.is_shared() { bytes(&found.split()[1]) } else { Vec::new() };
            frame(&mut told, part, &half);
        }
    }
    let received = job.communicator.exchange(&[], &told, watch).await?;
    let told = received.to_all.first().ok_or(CommunicatorError::Garbled(0))?;
    if !is_first {
        is_known.fill(false);
        for (part, half) in frames(told).ok_or(CommunicatorError::Garbled(0))? {
            *is_known.get_mut(part).ok_or(CommunicatorError::Garbled(0))? = true;
            found[part] = if parts.is_shared() {
                Some(whole(half).ok_or(CommunicatorError::Garbled(0))?)
            } else {
                None
            };
        }
    }
    Ok(told.len() as u64)
}

fn bytes(result: &impl PartResult) -> Vec<u8> {
    let mut bytes = Vec::new();
    result.encode(&mut bytes);
    bytes
}

/// Reads a result that fills `bytes`.
fn whole<R: PartResult>(bytes: &[u8]) -> Option<R> {
    let mut from = Reader(bytes);
    R::decode(&mut from).filter(|_| from.is_empty())
}

/// Appends the bytes of a part, with its number and length.
fn frame(out: &mut Vec<u8>, part: usize, bytes: &[u8]) {
    put(out, &[part as u64, bytes.len() as u64]);
    out.extend_from_slice(bytes);
}

/// Reads all frames; `None` for malformed bytes.
fn frames(bytes: &[u8]) -> Option<Vec<(usize, &[u8])>> {
    let mut from = Reader(bytes);
    let mut frames = Vec::new();
    while !from.is_empty() {
        let [part, length] = from.one::<[u64; 2]>()?.map(|number| number as usize);
        frames.push((part, from.slice(length)?));
    }
    Some(frames)
}

fn post<P: Parts>(parts: &P, part: usize, found: &P::Found, to_first: &mut Vec<u8>, to_all: &mut Vec<u8>) {
    if parts.is_shared() {
        let [first, all] = found.split();
        frame(to_first, part, &bytes(&first));
        frame(to_all, part, &bytes(&all));
    } else {
        frame(to_first, part, &bytes(found));
    }
}

/// Reads the results sent by [`post`]; on processes other than 0 the shared halves. `None` for malformed bytes.
fn receive<P: Parts>(parts: &P, for_first: &[u8], for_all: &[u8]) -> Option<Vec<(usize, P::Found)>> {
    let results = |bytes| -> Option<Vec<(usize, P::Found)>> {
        frames(bytes)?.into_iter().map(|(part, bytes)| Some((part, whole(bytes)?))).collect()
    };
    let (first, all) = (results(for_first)?, results(for_all)?);
    if !parts.is_shared() || first.is_empty() {
        return Some(if first.is_empty() { all } else { first });
    }
    // Both halves were posted in the same order.
    let is_even = first.len() == all.len() && first.iter().zip(&all).all(|(a, b)| a.0 == b.0);
    let pairs = first.into_iter().zip(all);
    is_even.then(|| pairs.map(|((part, a), (_, b))| Some((part, P::Found::join([a, b])?))).collect())?
}
