//! Mutated files through a parser: it may not panic, hang, or take memory that its file does not account for.
//!
//! A file whose outcome is new (a message of another form, or success for the first time) joins those that are mutated
//! further, so that a run goes deeper than one mutation. A file that fails is kept in `tests/corpus` and is tried first
//! from then on. `CENTRICAL_FUZZ_SECONDS` says how long, `CENTRICAL_FUZZ_SEED` from where (the clock, printed),
//! `CENTRICAL_FUZZ_PARSER` which of them (all).

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use crate::mutate::mutated;
use crate::random::Random;

/// A parser to be tried.
pub struct Parser {
    pub name: &'static str,
    /// Name of the file it is given.
    pub file: &'static str,
    /// Files to begin with; a parser without any is left out.
    pub seeds: Vec<PathBuf>,
    /// Reads a file and describes the outcome.
    pub read: fn(&Path) -> String,
}

/// The longest that a file of some kilobytes may take.
const PATIENCE: Duration = Duration::from_secs(10);

/// Most memory of this process [KiB]: a page of 64 MiB, packed and unpacked, and a million rows.
const MEMORY: u64 = 300 << 10;

/// Files larger than this grow no further [bytes].
const LARGEST: usize = 64 << 10;

/// Mutates files for `seconds`, unless `CENTRICAL_FUZZ_SECONDS` says otherwise.
pub fn mutate_for(seconds: u64, mut parsers: Vec<Parser>) {
    let seconds = setting("CENTRICAL_FUZZ_SECONDS").unwrap_or(seconds);
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_secs();
    let seed = setting("CENTRICAL_FUZZ_SEED").unwrap_or(now);
    println!("CENTRICAL_FUZZ_SEED={seed}");
    parsers.retain(|parser| !parser.seeds.is_empty());
    if let Ok(only) = std::env::var("CENTRICAL_FUZZ_PARSER") {
        parsers.retain(|parser| parser.name == only);
    }
    let until = Instant::now() + Duration::from_secs(seconds);
    let share = until.saturating_duration_since(Instant::now()) / u32::try_from(parsers.len().max(1)).unwrap();
    for (k, parser) in parsers.into_iter().enumerate() {
        Fuzz::new(parser, seed.wrapping_add(k as u64)).run(Instant::now() + share);
    }
}

/// Tries the seeds and the files that once failed: as they are, and some mutated copies of each, always the same.
pub fn try_kept(mut parsers: Vec<Parser>) {
    const COPIES: usize = 30;
    parsers.retain(|parser| !parser.seeds.is_empty());
    for parser in parsers {
        let mut fuzz = Fuzz::new(parser, 0);
        for bytes in fuzz.corpus.clone() {
            fuzz.attempt(&bytes);
            for _ in 0..COPIES {
                let mutated = mutated(&bytes, &bytes, &mut fuzz.random);
                fuzz.attempt(&mutated);
            }
        }
    }
}

/// What came of a file, for a parser.
pub fn outcome<T, E: std::fmt::Display>(result: Result<T, E>) -> String {
    result.map_or_else(|error| error.to_string(), |_| "read".to_owned())
}

/// One parser and the files it is tried with.
struct Fuzz {
    parser: Parser,
    corpus: Vec<Vec<u8>>,
    outcomes: HashSet<String>,
    random: Random,
    folder: tempfile::TempDir,
}

impl Fuzz {
    fn new(parser: Parser, seed: u64) -> Self {
        let kept = corpus_folder().join(parser.name);
        let mut files: Vec<PathBuf> = parser.seeds.clone();
        files.extend(fs::read_dir(kept).into_iter().flatten().map(|entry| entry.unwrap().path()));
        files.sort();
        let corpus: Vec<Vec<u8>> = files.iter().map(|file| fs::read(file).unwrap()).collect();
        assert!(!corpus.is_empty(), "{}: nothing to begin with", parser.name);
        let folder = tempfile::tempdir().unwrap();
        Self { parser, corpus, outcomes: HashSet::new(), random: Random::new(seed), folder }
    }

    fn run(mut self, until: Instant) {
        for bytes in self.corpus.clone() {
            self.attempt(&bytes);
        }
        let mut runs = 0_u64;
        while Instant::now() < until {
            let original = &self.corpus[self.random.below(self.corpus.len())];
            let other = &self.corpus[self.random.below(self.corpus.len())];
            let bytes = mutated(original, other, &mut self.random);
            if self.attempt(&bytes) && bytes.len() <= LARGEST {
                self.corpus.push(bytes);
            }
            runs += 1;
        }
        println!("{}: {runs} files, {} outcomes, peak memory {} KiB", self.parser.name, self.outcomes.len(), peak());
        assert!(runs > 10, "{}: too few files to mean anything", self.parser.name);
    }

    /// Reads a file; whether the outcome is new.
    fn attempt(&mut self, bytes: &[u8]) -> bool {
        let file = self.folder.path().join(self.parser.file);
        fs::write(&file, bytes).unwrap();
        let (done, outcome) = mpsc::channel();
        let read = self.parser.read;
        let start = Instant::now();
        let path = file.clone();
        let worker = thread::spawn(move || done.send(read(&path)));
        let outcome = outcome.recv_timeout(PATIENCE);
        let wrong = match &outcome {
            Err(mpsc::RecvTimeoutError::Timeout) => Some(format!("took more than {:?}", start.elapsed())),
            Err(mpsc::RecvTimeoutError::Disconnected) => Some("panicked".to_owned()),
            Ok(_) if peak() > MEMORY => Some(format!("took the process to {} KiB", peak())),
            Ok(_) => None,
        };
        if let Some(wrong) = wrong {
            let kept = corpus_folder().join(self.parser.name);
            fs::create_dir_all(&kept).unwrap();
            let kept = kept.join(format!("{:016x}", hash(bytes)));
            fs::write(&kept, bytes).unwrap();
            panic!("{} {wrong}; the file is kept as {}", self.parser.name, kept.display());
        }
        worker.join().unwrap().unwrap();
        self.outcomes.insert(shape(&outcome.unwrap()))
    }
}

/// A message without what differs from file to file: digits, and what stands in quotes.
fn shape(message: &str) -> String {
    let outside = message.split('"').step_by(2).collect::<String>();
    let words = outside.split(|c: char| !c.is_alphabetic()).filter(|word| word.len() > 1);
    words.take(24).collect::<Vec<&str>>().join(" ")
}

fn setting(name: &str) -> Option<u64> {
    std::env::var(name).ok().map(|text| text.parse().unwrap_or_else(|_| panic!("{name}: not a number")))
}

fn corpus_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus")
}

/// FNV-1a.
fn hash(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}

/// Peak memory of this process [KiB], where the system tells it.
fn peak() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|rest| rest.trim().strip_suffix(" kB")?.trim().parse().ok()).unwrap_or(0)
}
