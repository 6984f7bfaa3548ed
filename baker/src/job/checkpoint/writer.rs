//! Writer thread of a checkpoint, so that computing threads do not wait for the disk.

use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Maximum time between writing data and forcing the data to disk.
const SYNC_EVERY: Duration = Duration::from_secs(5);
/// Maximum number of queued records.
const QUEUE: usize = 256;

/// Destination of records.
pub trait Storage: Write + Send {
    /// Forces the written data to disk.
    ///
    /// # Errors
    /// Error of the operating system.
    fn sync(&mut self) -> io::Result<()>;

    /// Truncates the storage to `length` bytes.
    ///
    /// # Errors
    /// Error of the operating system.
    fn cut(&mut self, length: u64) -> io::Result<()>;
}

impl Storage for File {
    fn sync(&mut self) -> io::Result<()> {
        self.sync_data()
    }

    fn cut(&mut self, length: u64) -> io::Result<()> {
        self.set_len(length)?;
        self.seek(SeekFrom::Start(length)).map(|_| ())
    }
}

enum Message {
    Append(Vec<u8>),
    Flush(SyncSender<()>),
}

#[derive(Default)]
struct Fate {
    failed: AtomicBool,
    error: Mutex<Option<io::Error>>,
}

/// Writes records in order. When dropped, writes all queued records to disk and ends.
pub struct Writer {
    queue: Option<SyncSender<Message>>,
    thread: Option<JoinHandle<()>>,
    fate: Arc<Fate>,
}

impl Writer {
    /// Appends to a storage of `length` bytes.
    pub fn new(storage: Box<dyn Storage>, length: u64) -> Self {
        let (queue, messages) = sync_channel(QUEUE);
        let fate = Arc::new(Fate::default());
        let of_thread = fate.clone();
        let thread = std::thread::spawn(move || write_all(storage, length, &messages, &of_thread));
        Self { queue: Some(queue), thread: Some(thread), fate }
    }

    /// Queues a record.
    pub fn append(&self, record: Vec<u8>) {
        if let Some(queue) = &self.queue {
            // Fails only after a write error; [`Self::flush`] returns the error.
            let _ = queue.send(Message::Append(record));
        }
    }

    /// Returns whether writing has failed.
    pub fn has_failed(&self) -> bool {
        self.fate.failed.load(Ordering::Relaxed)
    }

    /// Waits until all records are on disk.
    ///
    /// # Errors
    /// The write error.
    pub fn flush(&self) -> io::Result<()> {
        let (told, done) = sync_channel(1);
        if let Some(queue) = &self.queue
            && queue.send(Message::Flush(told)).is_ok()
        {
            // Fails after a write error.
            let _ = done.recv();
        }
        if !self.has_failed() {
            return Ok(());
        }
        let error = self.fate.error.lock().ok().and_then(|mut error| error.take());
        Err(error.unwrap_or_else(|| io::Error::other("writing failed before")))
    }
}

impl Drop for Writer {
    fn drop(&mut self) {
        self.queue = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn write_all(mut storage: Box<dyn Storage>, mut length: u64, messages: &Receiver<Message>, fate: &Fate) {
    let (mut synced, mut is_dirty) = (Instant::now(), false);
    let mut work = || -> io::Result<()> {
        loop {
            let wait = SYNC_EVERY.saturating_sub(synced.elapsed());
            let told = match messages.recv_timeout(wait) {
                Ok(Message::Append(record)) => {
                    storage.write_all(&record)?;
                    length += record.len() as u64;
                    is_dirty = true;
                    None
                }
                Ok(Message::Flush(told)) => Some(told),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => return if is_dirty { storage.sync() } else { Ok(()) },
            };
            if told.is_some() || synced.elapsed() >= SYNC_EVERY {
                if is_dirty {
                    storage.sync()?;
                }
                (synced, is_dirty) = (Instant::now(), false);
            }
            if let Some(told) = told {
                let _ = told.send(());
            }
        }
    };
    if let Err(error) = work() {
        // Removes a partly written record; if truncating fails, resuming removes the record.
        let _ = storage.cut(length);
        if let Ok(mut place) = fate.error.lock() {
            *place = Some(error);
        }
        fate.failed.store(true, Ordering::Relaxed);
    }
}
