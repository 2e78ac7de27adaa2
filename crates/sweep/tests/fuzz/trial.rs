//! A reader is tried on broken files: it must neither panic nor take long.
//!
//! Files of the corpus are broken at random. What gets an answer that no file before got joins them,
//! so that the trial works its way past one mistake after the other. All follows from the seed.

use crate::random::Random;
use std::collections::HashSet;
use std::fs::{self, File};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::os::unix::fs::FileExt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::{Duration, Instant};

/// What no file may take, on a machine that does other things, too.
const LIMIT: Duration = Duration::from_secs(10);
/// Files that are kept to be broken on.
const KEPT: usize = 4096;

/// How files of a kind are broken.
pub trait Mutate: Send {
    /// `file`, broken once or a few times, with pieces of `other`.
    fn mutate(&self, file: &[u8], other: &[u8], random: &mut Random) -> Vec<u8>;
}

/// A file, and its name.
pub type Seed = (String, Vec<u8>);

/// The folder of the corpus.
pub fn corpus() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/fuzz/corpus")
}

/// The files of `tests/fuzz/corpus/{kind}`, with their names.
pub fn seeds(kind: &str) -> Vec<Seed> {
    let entries = fs::read_dir(corpus().join(kind)).expect("a folder of the corpus");
    let file = |path: PathBuf| {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        (name, fs::read(path).unwrap())
    };
    let mut seeds: Vec<_> = entries.map(|entry| file(entry.unwrap().path())).collect();
    seeds.sort();
    seeds
}

/// How many files are tried in a trial of `usual`: so many parts of a thousand of what
/// `CROSSHEAD_FUZZ` says, where it does.
pub fn executions(usual: u64, parts: u64) -> u64 {
    let asked = std::env::var("CROSSHEAD_FUZZ").ok();
    asked.map_or(usual, |count| {
        count.parse::<u64>().expect("CROSSHEAD_FUZZ is a number") * parts / 1000
    })
}

/// Hands `executions` files to `read`, which answers in words: the seeds first, which it must accept
/// unless they are called `broken-...`, and then broken ones.
pub fn trial(
    kind: &'static str,
    seeds: Vec<Seed>,
    mutator: impl Mutate + 'static,
    executions: u64,
    mut read: impl FnMut(&[u8]) -> Result<String, String> + Send + 'static,
) {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("fuzz-{kind}"));
    // Whatever ends the process, the file that it was at stands there.
    let current = File::create(&path).unwrap();
    let done = std::sync::Arc::new(AtomicU64::new(0));
    let counter = std::sync::Arc::clone(&done);
    let begun = Instant::now();
    let worker = std::thread::spawn(move || {
        let sound = |(name, _): &Seed| !name.starts_with("broken-");
        let sound: Vec<bool> = seeds.iter().map(sound).collect();
        let mut pool = Pool::new(seeds, Box::new(mutator));
        let mut slowest = (Duration::ZERO, Vec::new());
        for execution in 0..executions {
            let file = pool.next(execution as usize);
            current.set_len(0).unwrap();
            current.write_all_at(&file, 0).unwrap();
            let started = Instant::now();
            let answer = catch_unwind(AssertUnwindSafe(|| read(&file)));
            let took = started.elapsed();
            let Ok(answer) = answer else {
                return Err(execution);
            };
            if took > slowest.0 {
                slowest = (took, file.clone());
            }
            let refused = sound.get(execution as usize) == Some(&true) && answer.is_err();
            assert!(
                !refused,
                "{kind}: a file of the corpus is refused: {answer:?}"
            );
            pool.keep(file, &answer.unwrap_or_else(|message| message));
            counter.store(execution + 1, Relaxed);
        }
        Ok((pool, slowest))
    });
    watch(&worker, &done, executions, kind, &path);
    match worker.join().expect("a trial") {
        Err(execution) => panic!(
            "{kind}: panicked at file {execution}, which is {}",
            path.display()
        ),
        Ok((pool, slowest)) => {
            let seconds = begun.elapsed().as_secs_f64();
            eprintln!(
                "{kind}: {executions} files in {seconds:.0} s ({:.0} a second), {} answers, the slowest {:.3} s",
                executions as f64 / seconds,
                pool.answers.len(),
                slowest.0.as_secs_f64()
            );
            fs::write(path.with_extension("slowest"), slowest.1).unwrap();
            pool.write(&path.with_extension("found"));
        }
    }
}

/// Waits for the end, tells every minute how far it is, and panics where a file takes too long.
fn watch<T>(
    worker: &std::thread::JoinHandle<T>,
    done: &AtomicU64,
    executions: u64,
    kind: &str,
    path: &Path,
) {
    let mut last = (done.load(Relaxed), Instant::now());
    let mut told = Instant::now();
    while !worker.is_finished() {
        std::thread::sleep(Duration::from_millis(20));
        let now = done.load(Relaxed);
        if now != last.0 {
            last = (now, Instant::now());
        }
        if told.elapsed() > Duration::from_secs(60) {
            eprintln!("{kind}: {now} of {executions} files");
            told = Instant::now();
        }
        assert!(
            last.1.elapsed() < LIMIT,
            "{kind}: file {now} takes too long: {}",
            path.display()
        );
    }
}

/// The files that are broken.
struct Pool {
    mutator: Box<dyn Mutate>,
    random: Random,
    seeds: usize,
    files: Vec<Vec<u8>>,
    answers: HashSet<u64>,
}

impl Pool {
    fn new(seeds: Vec<Seed>, mutator: Box<dyn Mutate>) -> Self {
        let seed = std::env::var("CROSSHEAD_FUZZ_SEED").map_or(1, |seed| seed.parse().unwrap());
        assert!(!seeds.is_empty(), "a corpus");
        Self {
            mutator,
            random: Random::new(seed),
            seeds: seeds.len(),
            files: seeds.into_iter().map(|(_, file)| file).collect(),
            answers: HashSet::new(),
        }
    }

    fn next(&mut self, execution: usize) -> Vec<u8> {
        if execution < self.seeds {
            return self.files[execution].clone();
        }
        let random = &mut self.random;
        // Every other time a seed, however many there are of the others.
        let within = if random.below(2) == 0 {
            self.seeds
        } else {
            self.files.len()
        };
        let (file, other) = (random.below(within), random.below(self.files.len()));
        self.mutator
            .mutate(&self.files[file], &self.files[other], random)
    }

    /// Keeps a file with a new answer.
    fn keep(&mut self, file: Vec<u8>, answer: &str) {
        if !self.answers.insert(signature(answer)) {
            return;
        }
        if self.files.len() < self.seeds + KEPT {
            self.files.push(file);
        } else {
            let at = self.seeds + self.random.below(KEPT);
            self.files[at] = file;
        }
    }

    /// Writes the files that joined the seeds.
    fn write(&self, folder: &Path) {
        let _ = fs::remove_dir_all(folder);
        fs::create_dir_all(folder).unwrap();
        for (number, file) in self.files[self.seeds..].iter().enumerate() {
            fs::write(folder.join(format!("{number:04}")), file).unwrap();
        }
    }
}

/// What is the same for answers that say the same of other values: without numbers, and without what
/// was found in the file.
fn signature(answer: &str) -> u64 {
    let mut hasher = DefaultHasher::new();
    let (head, tail) = answer.split_once("found ").unwrap_or((answer, ""));
    let expected = tail.find(", expected").map_or(tail, |at| &tail[at..]);
    for text in [head, expected] {
        let mut quoted = false;
        for c in text.chars() {
            quoted ^= "'\"`".contains(c);
            if !quoted && !c.is_ascii_digit() {
                c.hash(&mut hasher);
            }
        }
    }
    hasher.finish()
}
