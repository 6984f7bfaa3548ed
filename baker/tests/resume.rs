//! A stopped and resumed bake gives the same file as an uninterrupted bake, to the byte.

use rebounce::bake::{
    BakeError, BakeSettings, Baker, Checkpoint, CheckpointError, Identity, Observer, Preset, bake,
};
use rebounce::job::checkpoint::Storage;
use rebounce::random::Stream;
use rebounce::scene::Scene;
use std::io::{self, Write};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use xxhash_rust::xxh32::xxh32;

/// Requests cancellation after `limit` checks.
struct StopAfter {
    asked: AtomicUsize,
    limit: usize,
}

impl StopAfter {
    fn new(limit: usize) -> Self {
        Self { asked: AtomicUsize::new(0), limit }
    }
}

impl Observer for StopAfter {
    fn is_stopped(&self) -> bool {
        self.asked.fetch_add(1, Ordering::Relaxed) >= self.limit
    }
}

fn small() -> BakeSettings {
    let mut settings = BakeSettings::new(Preset::Draft);
    (settings.place.levels, settings.place.functions) = (4, 700);
    settings.operator.rays = vec![128, 64];
    settings.operator.later_levels = 2;
    settings
}

fn whole(scene: &Scene, settings: &BakeSettings) -> Vec<u8> {
    bake(scene, settings, &()).unwrap().0.to_bytes().unwrap()
}

fn resumed(
    scene: &Scene,
    settings: &BakeSettings,
    path: &Path,
    observer: &dyn Observer,
) -> Result<Vec<u8>, BakeError> {
    let checkpoint = Checkpoint::resume(path, &Identity::new(scene, settings))?;
    Ok(Baker::new(settings)
        .observer(observer)
        .checkpoint(Some(&checkpoint))
        .bake(scene)?
        .unwrap()
        .0
        .to_bytes()?)
}

fn with_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}

/// End offsets of the records of a checkpoint.
fn ends(bytes: &[u8]) -> Vec<usize> {
    let mut ends = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        at += 12 + u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        ends.push(at);
    }
    assert_eq!(at, bytes.len(), "whole records");
    ends
}

#[test]
fn stopped_at_any_time_and_resumed_it_is_the_same_file() {
    for name in ["builtin:cornell-box", "builtin:two-rooms-door"] {
        let (scene, settings) = (rebounce::io::load(name).unwrap(), small());
        let expected = whole(&scene, &settings);
        let threads: &[usize] = if name.contains("box") { &[1, 2] } else { &[2] };
        for &threads in threads {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("a.partial");
            let mut records = 0;
            // Stops at various shares of the remaining work.
            for share in [0.1, 0.3, 0.5, 0.7, 0.9, 0.2, 0.4, 0.6, 0.8, 0.95, 0.99, 0.995, 0.998] {
                let copy = folder.path().join("copy.partial");
                if records > 0 {
                    std::fs::copy(&path, &copy).unwrap();
                }
                let to_the_end = StopAfter::new(usize::MAX);
                let bytes = with_threads(threads, || resumed(&scene, &settings, &copy, &to_the_end));
                assert!(
                    bytes.unwrap() == expected,
                    "{name}, {threads} threads, gone on with {records} records"
                );
                let left = to_the_end.asked.into_inner();
                let observer = StopAfter::new((share * left as f64) as usize);
                let stopped = with_threads(threads, || resumed(&scene, &settings, &path, &observer));
                assert!(matches!(stopped, Err(BakeError::Stopped)), "{name}: {share} of {left}");
                let now = ends(&std::fs::read(&path).unwrap()).len();
                assert!(now >= records, "what is kept only grows");
                records = now;
            }
            assert!(records > 10, "{name}: {records}");
            let bytes = with_threads(threads, || resumed(&scene, &settings, &path, &()));
            assert!(bytes.unwrap() == expected, "{name}, {threads} threads");
        }
    }
}

#[test]
fn what_is_kept_is_not_done_again() {
    struct Rays(Mutex<f64>);
    impl Observer for Rays {
        fn progress(&self, progress: &rebounce::bake::Progress) {
            *self.0.lock().unwrap() += progress.rays_per_second.unwrap_or(0.0);
        }
    }
    let (scene, settings) = (rebounce::io::load("builtin:cornell-box").unwrap(), small());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.partial");
    let (first, second) = (Rays(Mutex::default()), Rays(Mutex::default()));
    let once = resumed(&scene, &settings, &path, &first).unwrap();
    let length = path.metadata().unwrap().len();
    assert!(resumed(&scene, &settings, &path, &second).unwrap() == once);
    assert!(*first.0.lock().unwrap() > 0.0);
    assert_eq!(*second.0.lock().unwrap(), 0.0, "no ray was cast for links again");
    assert_eq!(path.metadata().unwrap().len(), length, "nothing was added");
}

#[test]
fn torn_and_damaged_tails_are_cut_off() {
    let (scene, settings) = (rebounce::io::load("builtin:cornell-box").unwrap(), small());
    let expected = whole(&scene, &settings);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.partial");
    resumed(&scene, &settings, &path, &()).unwrap();
    let full = std::fs::read(&path).unwrap();
    let ends = ends(&full);
    // Every record boundary is a resume point: checked by the number of records found; a few are baked to the end.
    let identity = Identity::new(&scene, &settings);
    for (records, &end) in ends.iter().enumerate() {
        for torn in [end, (end + 1).min(full.len()), (end + 13).min(full.len())] {
            std::fs::write(&path, &full[..torn]).unwrap();
            let found = Checkpoint::resume(&path, &identity).unwrap().records_found();
            let whole = ends.iter().filter(|end| **end <= torn).count() - 1;
            assert_eq!(found, whole, "cut at {torn}, record {records}");
        }
    }
    let mut stream = Stream::new(5, 5);
    for k in 0..16 {
        let at = (stream.unit() * full.len() as f32) as usize;
        let mut bytes = full.clone();
        match k % 2 {
            0 => bytes.truncate(at),
            _ => bytes[at.max(ends[0])] ^= 1 << (k / 2),
        }
        std::fs::write(&path, &bytes).unwrap();
        assert!(resumed(&scene, &settings, &path, &()).unwrap() == expected, "at {at} of {}", full.len());
    }
    // Killed within the first record, before its checksum.
    for at in [0, 5, 12, ends[0] - 1] {
        std::fs::write(&path, &full[..at]).unwrap();
        assert_eq!(Checkpoint::resume(&path, &identity).unwrap().records_found(), 0);
    }
}

/// Invalid and extreme numbers.
const ODD: [u32; 10] =
    [0, 1, 2, 255, 0x7fff_ffff, u32::MAX, 0x7f80_0000, 0x7fc0_0000, 0xff00_0000, 0x0000_0001];

#[test]
fn records_that_lie_under_fitting_checksums_end_in_a_file_or_a_sentence() {
    let (scene, settings) = (rebounce::io::load("builtin:cornell-box").unwrap(), small());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.partial");
    resumed(&scene, &settings, &path, &()).unwrap();
    let full = std::fs::read(&path).unwrap();
    let ends = ends(&full);
    let salt = u32::from_le_bytes(full[8..12].try_into().unwrap());
    let (mut baked, mut refused) = (0, 0);
    for seed in 0..30 {
        let mut stream = Stream::new(seed, 9);
        let mut below = |n: usize| stream.bits() as usize % n;
        let mut bytes = full.clone();
        // Only a few records hold points; point records have the most readers.
        let record = if below(2) == 0 { 1 + below(6) } else { 1 + below(ends.len() - 1) };
        let (start, end) = (ends[record - 1], ends[record]);
        for _ in 0..1 + below(4) {
            let at = start + 12 + 4 * below((end - start - 12) / 4);
            let odd =
                if below(3) == 0 { stream_word(&bytes, start, end, below(1 << 20)) } else { ODD[below(10)] };
            bytes[at..at + 4].copy_from_slice(&odd.to_le_bytes());
        }
        let hashed = [&bytes[start + 4..start + 8], &bytes[start + 12..end]].concat();
        bytes[start + 8..start + 12].copy_from_slice(&xxh32(&hashed, salt).to_le_bytes());
        std::fs::write(&path, &bytes).unwrap();
        match resumed(&scene, &settings, &path, &()) {
            Ok(_) => baked += 1,
            Err(error) => {
                refused += 1;
                assert!(error.to_string().len() > 10, "{error}");
            }
        }
    }
    assert!(baked > 10, "{baked} baked, {refused} refused");
}

/// A word of a record: an index replaces another index.
fn stream_word(bytes: &[u8], start: usize, end: usize, k: usize) -> u32 {
    let at = start + 12 + 4 * (k % ((end - start - 12) / 4));
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap())
}

#[test]
fn checkpoints_of_other_bakes_are_refused_and_left_as_they_are() {
    let (scene, settings) = (rebounce::io::load("builtin:cornell-box").unwrap(), small());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.partial");
    let _ = resumed(&scene, &settings, &path, &StopAfter::new(300));
    let before = std::fs::read(&path).unwrap();
    let mut other = small();
    other.operator.rays = vec![99];
    let refused = Checkpoint::resume(&path, &Identity::new(&scene, &other)).err().unwrap().to_string();
    assert!(refused.contains("rays [128, 64], not [99]") && refused.contains("a.partial"), "{refused}");
    let library = rebounce::io::load("builtin:library").unwrap();
    let refused = Checkpoint::resume(&path, &Identity::new(&library, &settings)).err().unwrap().to_string();
    assert!(refused.contains("scene cornell-box") && refused.contains("not library"), "{refused}");
    assert!(std::fs::read(&path).unwrap() == before);
    std::fs::write(&path, "a letter").unwrap();
    let refused = Checkpoint::resume(&path, &Identity::new(&scene, &settings)).err().unwrap();
    assert!(matches!(refused, CheckpointError::Foreign(_)), "{refused}");
    assert_eq!(std::fs::read(&path).unwrap(), b"a letter");
    // Without resume, the checkpoint is replaced.
    Checkpoint::create(&path, &Identity::new(&scene, &settings)).unwrap().flush().unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), before[..ends(&before)[0]]);
}

#[test]
fn two_bakes_do_not_write_one_checkpoint() {
    let scene = rebounce::io::load("builtin:cornell-box").unwrap();
    let identity = Identity::new(&scene, &small());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.partial");
    let first = Checkpoint::create(&path, &identity).unwrap();
    for second in [Checkpoint::create(&path, &identity), Checkpoint::resume(&path, &identity)] {
        assert!(matches!(second.err().unwrap(), CheckpointError::Busy(_)));
    }
    drop(first);
    Checkpoint::resume(&path, &identity).unwrap();
}

/// A disk with a capacity of `room` bytes.
struct SmallDisk {
    bytes: Arc<Mutex<Vec<u8>>>,
    room: usize,
}

impl Write for SmallDisk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut held = self.bytes.lock().unwrap();
        let fits = bytes.len().min(self.room - held.len());
        if fits == 0 {
            return Err(io::ErrorKind::StorageFull.into());
        }
        held.extend_from_slice(&bytes[..fits]);
        Ok(fits)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Storage for SmallDisk {
    fn sync(&mut self) -> io::Result<()> {
        Ok(())
    }

    fn cut(&mut self, length: u64) -> io::Result<()> {
        self.bytes.lock().unwrap().truncate(length as usize);
        Ok(())
    }
}

#[test]
fn a_full_disk_ends_the_bake_and_keeps_whole_records() {
    let (scene, settings) = (rebounce::io::load("builtin:cornell-box").unwrap(), small());
    let expected = whole(&scene, &settings);
    let identity = Identity::new(&scene, &settings);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.partial");
    for room in [2_000, 60_000, 200_000] {
        let bytes = Arc::new(Mutex::new(Vec::new()));
        let disk = SmallDisk { bytes: bytes.clone(), room };
        let checkpoint = Checkpoint::on(Box::new(disk), &path, &identity);
        let error = Baker::new(&settings).checkpoint(Some(&checkpoint)).bake(&scene).unwrap_err();
        assert!(matches!(error, BakeError::Checkpoint(CheckpointError::Io { .. })), "{error}");
        assert!(error.to_string().contains("a.partial") && error.to_string().contains("--resume"), "{error}");
        drop(checkpoint);
        let kept = bytes.lock().unwrap().clone();
        assert!(!ends(&kept).is_empty() && kept.len() <= room);
        std::fs::write(&path, kept).unwrap();
        assert!(resumed(&scene, &settings, &path, &()).unwrap() == expected, "room for {room}");
    }
}
