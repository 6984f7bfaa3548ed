//! Work split between the members of a job: the thread pool computes, the calling thread exchanges results.
//!
//! Members exchange results a few times per second, so that the checkpoint of member 0 contains the finished work of
//! all members, and a last time when the last member is done.

use super::{Communicator, CommunicatorError, Received, run_blocking};
use crate::job::watch::{Stopped, Watch};
use std::sync::Mutex;
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};
use std::time::{Duration, Instant};

/// Period of exchanges between members.
const PERIOD: Duration = Duration::from_millis(250);
/// Period at which a waiting pool thread looks for work.
const LOOK_EVERY: Duration = Duration::from_millis(2);

/// Bytes sent during one piece of work.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Bytes from the other members to member 0.
    pub to_first: u64,
    /// Bytes to all members, summed over the senders: the bytes received by one member, including its own.
    pub to_all: u64,
}

impl Traffic {
    /// Adds the bytes of another piece of work.
    pub fn add(&mut self, more: Self) {
        self.to_first += more.to_first;
        self.to_all += more.to_all;
    }
}

/// Buffer of results to send, filled by any thread.
#[derive(Default)]
pub struct SendBuffer {
    letters: Mutex<[Vec<u8>; 2]>,
}

impl SendBuffer {
    /// Appends to the message to member 0, and to the message to all members.
    pub fn post(&self, write: impl FnOnce(&mut Vec<u8>, &mut Vec<u8>)) {
        if let Ok(mut letters) = self.letters.lock() {
            let [to_first, to_all] = &mut *letters;
            write(to_first, to_all);
        }
    }

    /// Takes the messages to member 0 and to all members; the latter begins with whether the sender is done.
    fn letters(&self, is_done: bool) -> [Vec<u8>; 2] {
        let taken = self.letters.lock().map(|mut letters| std::mem::take(&mut *letters));
        let [to_first, posted] = taken.unwrap_or_default();
        let mut to_all = vec![u8::from(is_done)];
        to_all.extend(posted);
        [to_first, to_all]
    }
}

/// Runs this member's part of the work on the pool, and sends the results posted by `work` to the job: during the work
/// if the communicator blocks, otherwise after the work. Calls `arrive` for the messages of the other members: rank,
/// message to member 0 (empty on other members), message to all members. Returns when all members are done.
///
/// # Errors
/// [`CommunicatorError`], of `work`, of `arrive`, or of the exchange.
pub async fn share<T: Send>(
    communicator: &dyn Communicator,
    watch: &dyn Watch,
    work: impl FnOnce(Option<&SendBuffer>) -> Result<T, Stopped> + Send,
    arrive: impl FnMut(usize, &[u8], &[u8]) -> Result<(), CommunicatorError>,
) -> Result<(T, Traffic), CommunicatorError> {
    if communicator.size() == 1 {
        return Ok((work(None)?, Traffic::default()));
    }
    let mut mail = Mail { rank: communicator.rank(), traffic: Traffic::default(), arrive };
    if communicator.is_blocking() {
        let done = share_meanwhile(communicator, watch, work, &mut mail)?;
        return Ok((done, mail.traffic));
    }
    let outbox = SendBuffer::default();
    let done = work(Some(&outbox))?;
    let [to_first, to_all] = outbox.letters(true);
    mail.open(communicator.exchange(&to_first, &to_all, watch).await?)?;
    Ok((done, mail.traffic))
}

/// Messages of the other members on their way to whoever wants them.
struct Mail<F> {
    /// This member.
    rank: usize,
    traffic: Traffic,
    arrive: F,
}

impl<F: FnMut(usize, &[u8], &[u8]) -> Result<(), CommunicatorError>> Mail<F> {
    /// Hands on the messages of an exchange; returns whether all members are done.
    fn open(&mut self, received: Received) -> Result<bool, CommunicatorError> {
        let mut all_done = true;
        for (member, letter) in received.to_all.iter().enumerate() {
            let (is_done, for_all) = letter.split_first().ok_or(CommunicatorError::Garbled(member))?;
            let for_first = received.to_first.get(member).map_or(&[][..], |letter| letter);
            all_done &= *is_done != 0;
            self.traffic.to_all += letter.len() as u64;
            if member != self.rank {
                self.traffic.to_first += for_first.len() as u64;
                (self.arrive)(member, for_first, for_all)?;
            }
        }
        Ok(all_done)
    }
}

/// Computes on the pool while this thread exchanges messages, blocking.
fn share_meanwhile<T: Send>(
    communicator: &dyn Communicator,
    watch: &dyn Watch,
    work: impl FnOnce(Option<&SendBuffer>) -> Result<T, Stopped> + Send,
    mail: &mut Mail<impl FnMut(usize, &[u8], &[u8]) -> Result<(), CommunicatorError>>,
) -> Result<T, CommunicatorError> {
    let outbox = SendBuffer::default();
    let (told, end) = sync_channel(1);
    rayon::in_place_scope(|scope| {
        let posted = &outbox;
        scope.spawn(move |_| {
            // The receiver is gone if the exchange has failed.
            let _ = told.send(work(Some(posted)));
        });
        let mut result = None;
        loop {
            if result.is_none() {
                result = wait(&end, PERIOD)?.transpose()?;
            }
            // Taken after the end of `work` is known: later, nothing more is posted.
            let [to_first, to_all] = outbox.letters(result.is_some());
            let exchange = communicator.exchange(&to_first, &to_all, watch);
            let received = run_blocking(exchange).ok_or(CommunicatorError::WouldBlock)??;
            if mail.open(received)?
                && let Some(done) = result.take()
            {
                return Ok(done);
            }
        }
    })
}

/// Returns the result of the work if available within `time`. A pool thread helps with the work while waiting.
fn wait<T>(
    end: &Receiver<Result<T, Stopped>>,
    time: Duration,
) -> Result<Option<Result<T, Stopped>>, Stopped> {
    let began = Instant::now();
    loop {
        match end.try_recv() {
            Ok(result) => return Ok(Some(result)),
            // The work panicked; the pool resumes the panic when the scope ends.
            Err(TryRecvError::Disconnected) => return Err(Stopped),
            Err(TryRecvError::Empty) => {}
        }
        let left = time.saturating_sub(began.elapsed());
        if left.is_zero() {
            return Ok(None);
        }
        match rayon::yield_now() {
            Some(rayon::Yield::Executed) => {}
            // Other pool threads have the work, and may leave tasks to help with.
            Some(rayon::Yield::Idle) => std::thread::sleep(left.min(LOOK_EVERY)),
            None => {
                if let Ok(result) = end.recv_timeout(left) {
                    return Ok(Some(result));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::communicator::Exchange;
    use std::sync::{Arc, Barrier};

    /// Two members on two threads: messages are exchanged through a table, between two barriers.
    struct Pair {
        rank: usize,
        meet: Arc<Barrier>,
        table: Arc<Mutex<[[Vec<u8>; 2]; 2]>>,
    }

    impl Communicator for Pair {
        fn rank(&self) -> usize {
            self.rank
        }

        fn size(&self) -> usize {
            2
        }

        fn exchange<'a>(&'a self, to_first: &'a [u8], to_all: &'a [u8], _: &'a dyn Watch) -> Exchange<'a> {
            self.table.lock().unwrap()[self.rank] = [to_first.to_vec(), to_all.to_vec()];
            self.meet.wait();
            let table = self.table.lock().unwrap().clone();
            self.meet.wait();
            let take = |k: usize| table.iter().map(|letters| letters[k].clone()).collect();
            let to_first = if self.rank == 0 { take(0) } else { Vec::new() };
            Box::pin(std::future::ready(Ok(Received { to_first, to_all: take(1) })))
        }
    }

    #[test]
    fn all_that_is_posted_arrives_and_the_slower_one_is_waited_for() {
        let (meet, table) = (Arc::new(Barrier::new(2)), Arc::default());
        let members = [0, 1].map(|rank| Pair { rank, meet: meet.clone(), table: Arc::clone(&table) });
        let heard = members.map(|member| {
            std::thread::spawn(move || {
                let rank = member.rank as u8;
                let mut heard = [Vec::new(), Vec::new()];
                let work = |outbox: Option<&SendBuffer>| {
                    for k in 0..3 {
                        std::thread::sleep(Duration::from_millis(200 * u64::from(rank)));
                        outbox.unwrap().post(|first, all| {
                            first.push(10 * rank + k);
                            all.push(100 + 10 * rank + k);
                        });
                    }
                    Ok(rank)
                };
                let arrive = |_: usize, first: &[u8], all: &[u8]| {
                    heard[0].extend_from_slice(first);
                    heard[1].extend_from_slice(all);
                    Ok(())
                };
                let (done, traffic) = run_blocking(share(&member, &(), work, arrive)).unwrap().unwrap();
                assert_eq!(done, rank);
                (heard, traffic.to_first)
            })
        });
        let [first, second] = heard.map(|thread| thread.join().unwrap());
        assert_eq!(first, ([vec![10, 11, 12], vec![110, 111, 112]], 3));
        assert_eq!(second, ([vec![], vec![100, 101, 102]], 0));
    }

    /// One of two members, beside another that sends nothing and is never done.
    struct BesideIdle;

    impl Communicator for BesideIdle {
        fn rank(&self) -> usize {
            0
        }

        fn size(&self) -> usize {
            2
        }

        fn exchange<'a>(&'a self, to_first: &'a [u8], to_all: &'a [u8], _: &'a dyn Watch) -> Exchange<'a> {
            Box::pin(std::future::ready(Ok(Received {
                to_first: vec![to_first.to_vec(), Vec::new()],
                to_all: vec![to_all.to_vec(), vec![0]],
            })))
        }
    }

    #[test]
    fn work_that_stops_ends_it_for_this_member() {
        // On a busy pool the work starts late, and exchanges come before its end.
        let found =
            run_blocking(share(&BesideIdle, &(), |_| Err::<(), _>(Stopped), |_, _, _| Ok(()))).unwrap();
        assert_eq!(found, Err(CommunicatorError::Stopped(Stopped)));
    }
}
