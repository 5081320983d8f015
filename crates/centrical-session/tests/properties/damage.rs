//! Damaged files: whatever happens to them on the way, reading ends soon, in bounded memory, with rows or an error.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use centrical_session::{Columns, Session, read_plateaus, read_record};

use crate::random::Random;

/// Damaged copies of every file.
const COPIES: u64 = 200;

/// The longest that reading a file of a few kilobytes may take.
const PATIENCE: Duration = Duration::from_secs(10);

/// Most memory of this process [KiB]: a page of 64 MiB, packed and unpacked, and a million rows.
const MEMORY: u64 = 300 << 10;

#[test]
fn damaged_files_are_read_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let mut random = Random::new(1);
    for original in originals() {
        let bytes = fs::read(&original).unwrap();
        let copy = folder.path().join(original.file_name().unwrap());
        for _ in 0..COPIES {
            fs::write(&copy, damaged(&bytes, &mut random)).unwrap();
            let start = Instant::now();
            read(&copy);
            assert!(start.elapsed() < PATIENCE, "{}", original.display());
        }
        assert!(peak_memory() < MEMORY, "{}: {} KiB", original.display(), peak_memory());
    }
}

/// Whatever a file is, as everything that it could be.
fn read(file: &Path) {
    if let Ok(record) = read_record(file, &Columns::default()) {
        assert!(record.t.is_sorted(), "time runs backwards");
        assert!(record.f_z.iter().flatten().all(|f| f.is_finite()), "a reading is no number");
    }
    let _ = read_plateaus(file, 12);
    if file.extension().is_some_and(|extension| extension == "toml") {
        let _ = Session::read(file);
    }
}

/// One file of every format.
fn originals() -> Vec<PathBuf> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let mut files: Vec<PathBuf> = fs::read_dir(data).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files.retain(|file| file.extension().is_some_and(|extension| extension != "py"));
    assert!(files.len() > 10);
    files
}

/// A copy with a few bytes changed, cut out, doubled, or claiming to be huge.
fn damaged(bytes: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..=random.below(4) {
        if bytes.is_empty() {
            break;
        }
        let at = random.place(bytes.len(), 200);
        match random.below(6) {
            0 => bytes[at] ^= 1 << random.below(8),
            1 => bytes[at] = b"\0\x01\x7f\x80\xff,;\"'\n\r[]{}=.-+e#naif09"[random.below(27)],
            2 => bytes.truncate(at),
            3 => drop(bytes.drain(at..(at + 1 + random.below(64)).min(bytes.len()))),
            4 => {
                let piece = bytes[at..(at + 1 + random.below(64)).min(bytes.len())].to_vec();
                bytes.splice(at..at, piece);
            }
            // The largest numbers of a variable-length and of a fixed-length field.
            _ => {
                let huge = [&b"\xfe\xff\xff\xff\x0f"[..], b"\xff\xff\xff\x7f"][random.below(2)];
                let end = (at + huge.len()).min(bytes.len());
                bytes.splice(at..end, huge.iter().copied());
            }
        }
    }
    bytes
}

/// Peak memory of this process [KiB], where the system tells it.
fn peak_memory() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|rest| rest.trim().strip_suffix(" kB")?.trim().parse().ok()).unwrap_or(0)
}
