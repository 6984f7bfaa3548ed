//! A bake over several processes gives the same file as a single process, to the byte. Threads stand in for
//! processes here, with message exchange as in MPI; `mpi.rs` tests real processes.

use rebounce::bake::{
    BakeError, BakeReport, BakeSettings, Baker, Checkpoint, Identity, Observer, Preset, bake,
};
use rebounce::job::communicator::{Communicator, Exchange, Received};
use rebounce::job::watch::{Stopped, Watch};
use rebounce::scene::Scene;
use std::future::ready;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Barrier, Mutex};

/// Messages to the first member and to all members.
type Letters = [Vec<u8>; 2];

/// Shared state of the job's threads.
struct Table {
    letters: Mutex<Vec<Letters>>,
    meet: Barrier,
    /// A member has stopped.
    is_over: AtomicBool,
}

struct Member {
    rank: usize,
    table: Arc<Table>,
}

fn communicator(size: usize) -> Vec<Member> {
    let letters = Mutex::new(vec![Letters::default(); size]);
    let table = Arc::new(Table { letters, meet: Barrier::new(size), is_over: AtomicBool::new(false) });
    (0..size).map(|rank| Member { rank, table: table.clone() }).collect()
}

impl Communicator for Member {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.table.letters.lock().unwrap().len()
    }

    fn exchange<'a>(&'a self, to_first: &'a [u8], to_all: &'a [u8], watch: &'a dyn Watch) -> Exchange<'a> {
        self.table.letters.lock().unwrap()[self.rank] = [to_first.to_vec(), to_all.to_vec()];
        if watch.step(0).is_err() {
            self.table.is_over.store(true, Ordering::SeqCst);
        }
        self.table.meet.wait();
        let letters = self.table.letters.lock().unwrap().clone();
        // Members stop together: no launcher exists to end the rest.
        let is_over = self.table.is_over.load(Ordering::SeqCst);
        self.table.meet.wait();
        if is_over {
            return Box::pin(ready(Err(Stopped)));
        }
        let kind = |k: usize| letters.iter().map(|letters| letters[k].clone()).collect();
        let to_first = if self.rank == 0 { kind(0) } else { Vec::new() };
        Box::pin(ready(Ok(Received { to_first, to_all: kind(1) })))
    }
}

fn small() -> BakeSettings {
    let mut settings = BakeSettings::new(Preset::Draft);
    (settings.place.levels, settings.place.functions) = (4, 900);
    settings.operator.rays = vec![128, 64];
    settings.operator.later_levels = 2;
    settings
}

/// Requests cancellation after the given number of checks.
struct StopAfter(AtomicUsize, usize);

impl Observer for StopAfter {
    fn is_stopped(&self) -> bool {
        self.0.fetch_add(1, Ordering::Relaxed) >= self.1
    }
}

type Baked = Result<Option<(Vec<u8>, BakeReport)>, BakeError>;

/// Result of each member; the first member has the checkpoint, if present.
fn baked(
    scene: &Scene,
    settings: &BakeSettings,
    size: usize,
    threads: usize,
    kept: Option<&Path>,
) -> Vec<Baked> {
    let one = |member: Member| -> Baked {
        let identity = Identity::new(scene, settings);
        let path = kept.filter(|_| member.rank == 0);
        let checkpoint = path.map(|path| Checkpoint::resume(path, &identity)).transpose()?;
        let baked = Baker::new(settings).checkpoint(checkpoint.as_ref()).communicator(&member).bake(scene)?;
        Ok(baked.map(|(file, report)| (file.to_bytes().unwrap(), report)))
    };
    let run = |member: Member| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| one(member))
    };
    std::thread::scope(|scope| {
        let run = &run;
        let members: Vec<_> =
            communicator(size).into_iter().map(|member| scope.spawn(move || run(member))).collect();
        members.into_iter().map(|member| member.join().unwrap()).collect()
    })
}

fn whole(scene: &Scene, settings: &BakeSettings) -> (Vec<u8>, BakeReport) {
    let (file, report) = bake(scene, settings, &()).unwrap();
    (file.to_bytes().unwrap(), report)
}

#[test]
fn any_number_of_processes_and_threads_makes_the_same_file() {
    let (scene, settings) = (rebounce::io::load("builtin:two-rooms-door").unwrap(), small());
    let (expected, alone) = whole(&scene, &settings);
    assert!(alone.traffic.is_empty());
    for (size, threads) in [(1, 1), (2, 1), (2, 2), (3, 1), (4, 2)] {
        let mut members = baked(&scene, &settings, size, threads, None).into_iter();
        let (bytes, report) = members.next().unwrap().unwrap().unwrap();
        assert!(bytes == expected, "{size} processes of {threads} threads");
        assert_eq!((report.rays, report.links), (alone.rays, alone.links));
        assert_eq!(report.lost_share.to_bits(), alone.lost_share.to_bits());
        assert_eq!(report.processes, size as u64);
        assert!(members.all(|member| member.unwrap().is_none()), "only the first has the file");
        let Some(finest) = report.traffic.last().filter(|_| size > 1) else { continue };
        // Rows of the finest level are read only by their writer; a byte to all members is a completion flag, one
        // per message.
        assert!(finest.to_first > 1000 && finest.to_all < 1000, "{finest:?}");
    }
}

#[test]
fn one_level_that_bounces_among_itself_is_shared_too() {
    let (scene, mut settings) = (rebounce::io::load("builtin:cornell-box").unwrap(), small());
    (settings.place.levels, settings.place.functions) = (1, 400);
    settings.operator.later_levels = 1;
    let expected = whole(&scene, &settings).0;
    let (bytes, _) = baked(&scene, &settings, 3, 1, None).remove(0).unwrap().unwrap();
    assert!(bytes == expected);
}

#[test]
fn what_many_have_kept_any_number_goes_on_with() {
    let (scene, settings) = (rebounce::io::load("builtin:two-rooms-door").unwrap(), small());
    let expected = whole(&scene, &settings).0;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.partial");
    let (bytes, _) = baked(&scene, &settings, 3, 1, Some(&path)).remove(0).unwrap().unwrap();
    assert!(bytes == expected);
    let full = std::fs::read(&path).unwrap();
    for (share, size) in [(0.3, 2), (0.6, 4), (0.8, 1), (0.95, 3), (1.0, 2)] {
        std::fs::write(&path, &full[..(full.len() as f64 * share) as usize]).unwrap();
        let (bytes, report) = baked(&scene, &settings, size, 1, Some(&path)).remove(0).unwrap().unwrap();
        assert!(bytes == expected, "{size} go on after {share}");
        // The checkpoint has no links from sources.
        let kept = report.traffic.iter().filter(|part| part.stage != "gathering sources");
        let sent: u64 = kept.map(|part| part.to_first).sum();
        if share == 1.0 {
            assert_eq!(sent, 0, "nothing is left to be done: nothing is sent to the first");
        }
    }
}

#[test]
fn a_stop_ends_all_and_the_checkpoint_goes_on() {
    let (scene, settings) = (rebounce::io::load("builtin:cornell-box").unwrap(), small());
    let expected = whole(&scene, &settings).0;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.partial");
    let identity = Identity::new(&scene, &settings);
    // Points are placed first, by a single member, so that both members meet in the shared part.
    let checkpoint = Checkpoint::resume(&path, &identity).unwrap();
    assert!(
        Baker::new(&settings)
            .observer(&StopAfter(AtomicUsize::new(0), 400))
            .checkpoint(Some(&checkpoint))
            .bake(&scene)
            .is_err()
    );
    drop(checkpoint);
    let before = path.metadata().unwrap().len();
    let stopped = std::thread::scope(|scope| {
        let ends: Vec<_> = communicator(2)
            .into_iter()
            .map(|member| {
                let (scene, settings, identity, path) = (&scene, &settings, &identity, &path);
                scope.spawn(move || {
                    let checkpoint = (member.rank == 0).then(|| Checkpoint::resume(path, identity).unwrap());
                    let watch = StopOnceItLinks::default();
                    let baker = Baker::new(settings).observer(&watch).checkpoint(checkpoint.as_ref());
                    baker.communicator(&member).bake(scene).map(|_| ())
                })
            })
            .collect();
        ends.into_iter().map(|end| end.join().unwrap()).collect::<Vec<_>>()
    });
    for end in stopped {
        assert!(matches!(end, Err(BakeError::Stopped)), "{end:?}");
    }
    assert!(path.metadata().unwrap().len() >= before, "what is kept only grows");
    let (bytes, _) = baked(&scene, &settings, 2, 1, Some(&path)).remove(0).unwrap().unwrap();
    assert!(bytes == expected);
}

/// Asks for the end while links of level 2 are traced.
#[derive(Default)]
struct StopOnceItLinks(AtomicBool);

impl Observer for StopOnceItLinks {
    fn progress(&self, progress: &rebounce::bake::Progress) {
        let is_time = progress.stage == rebounce::bake::Stage::Links && progress.level == Some(2);
        self.0.fetch_or(is_time, Ordering::Relaxed);
    }

    fn is_stopped(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

#[test]
fn members_with_other_arguments_are_found_out() {
    let (scene, settings) = (rebounce::io::load("builtin:cornell-box").unwrap(), small());
    let mut other = settings.clone();
    other.operator.rays = vec![99];
    let errors = std::thread::scope(|scope| {
        let ends: Vec<_> = communicator(2)
            .into_iter()
            .map(|member| {
                let (scene, settings) = (&scene, if member.rank == 0 { &settings } else { &other });
                scope.spawn(move || Baker::new(settings).communicator(&member).bake(scene).map(|_| ()))
            })
            .collect();
        ends.into_iter().map(|end| end.join().unwrap()).collect::<Vec<_>>()
    });
    for error in errors {
        let error = error.unwrap_err();
        assert!(matches!(error, BakeError::Apart(1)), "{error}");
        assert!(error.to_string().contains("process 1 works on another scene"), "{error}");
    }
}
