//! A command that dies inside its write, or cannot write on, leaves no part of a file under its name.
//!
//! A limit on the size of files (`ulimit -f`) makes it certain: the write that crosses it kills the process, or fails if
//! the signal is ignored.

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, Output};

use tempfile::TempDir;

use crate::session::example;

/// The signal of the limit.
const SIGXFSZ: i32 = 25;

/// What `ulimit -f` counts in [bytes].
const BLOCK: usize = 512;

const TRUTH: &str = "typical = { size = 1.0 }\n[sensor]\nwhite = \"0.2 mg\"\n[recorder]\nrate = \"10 Hz\"\n";

/// Files of a folder and those below it, by name.
type Files = BTreeMap<String, Vec<u8>>;

fn files(folder: &Path) -> Files {
    let mut files = Files::new();
    for entry in fs::read_dir(folder).into_iter().flatten().map(Result::unwrap) {
        let name = entry.file_name().into_string().unwrap();
        if entry.file_type().unwrap().is_dir() {
            files.extend(self::files(&entry.path()).into_iter().map(|(file, bytes)| (format!("{name}/{file}"), bytes)));
        } else {
            files.insert(name, fs::read(entry.path()).unwrap());
        }
    }
    files
}

/// Runs the binary in a folder, no file to become larger than so many blocks; `before` is told the shell first.
fn run(folder: &Path, before: &str, blocks: usize, arguments: &[&str]) -> Output {
    let binary = env!("CARGO_BIN_EXE_centrical");
    let script = format!("{before} ulimit -c 0; ulimit -f {blocks}; exec \"$0\" \"$@\"");
    Command::new("sh").args(["-c", &script, binary]).args(arguments).current_dir(folder).output().unwrap()
}

/// Runs the binary in a folder to its end.
fn whole(folder: &Path, arguments: &[&str]) {
    let run = Command::new(env!("CARGO_BIN_EXE_centrical")).args(arguments).current_dir(folder).output().unwrap();
    assert!(matches!(run.status.code(), Some(0 | 1)), "{arguments:?}: {}", String::from_utf8_lossy(&run.stderr));
}

/// Kills a command, and makes it fail, in its first write and in that of its largest file; all it writes goes to `out`.
fn dies_in_its_writes(arguments: &[&str]) {
    let folder = TempDir::new().unwrap();
    let made = |name: &str| {
        let path = folder.path().join(name);
        fs::create_dir_all(path.join("out")).unwrap();
        fs::write(path.join("truth.toml"), TRUTH).unwrap();
        path
    };
    let expected = made("whole");
    whole(&expected, arguments);
    let expected = files(&expected.join("out"));
    let largest = expected.values().map(Vec::len).max().unwrap();
    for blocks in [1, (largest - 1) / BLOCK] {
        let place = made(&format!("killed by {blocks}"));
        let killed = run(&place, "", blocks, arguments);
        assert_eq!(killed.status.signal(), Some(SIGXFSZ), "{arguments:?}, {blocks}: {killed:?}");
        let left = files(&place.join("out"));
        let is_begun = |name: &str| Path::new(name).extension().is_some_and(|end| end == "tmp");
        let begun: Vec<_> = left.iter().filter(|(name, _)| is_begun(name)).collect();
        assert!(begun.iter().any(|(_, bytes)| bytes.len() == blocks * BLOCK), "{arguments:?}: killed inside a write");
        for (name, bytes) in left.iter().filter(|(name, _)| !is_begun(name)) {
            assert!(bytes == &expected[name], "{arguments:?}, {blocks}: {name}");
            assert!(bytes.len() <= blocks * BLOCK, "{arguments:?}, {blocks}: {name}");
        }

        let place = made(&format!("failed by {blocks}"));
        let failed = run(&place, "trap '' XFSZ;", blocks, arguments);
        let message = String::from_utf8(failed.stderr).unwrap();
        assert_eq!(failed.status.code(), Some(2), "{arguments:?}, {blocks}: {message}");
        let left = files(&place.join("out"));
        assert!(
            left.iter().all(|(name, bytes)| bytes == &expected[name]),
            "{arguments:?}, {blocks}: {:?}",
            left.keys()
        );
        let missing = expected.iter().filter(|(name, bytes)| bytes.len() > blocks * BLOCK && !left.contains_key(*name));
        let named: Vec<_> =
            missing.filter(|(name, _)| message.contains(&format!("out/{name}: cannot be written"))).collect();
        assert_eq!(named.len(), 1, "{arguments:?}, {blocks}: {message}");

        // What is there from before stays.
        let place = made(&format!("again {blocks}"));
        whole(&place, arguments);
        for before in ["", "trap '' XFSZ;"] {
            assert!(!matches!(run(&place, before, blocks, arguments).status.code(), Some(0 | 1)));
            let left = files(&place.join("out"));
            assert!(expected.iter().all(|(name, bytes)| left.get(name) == Some(bytes)), "{arguments:?}, {blocks}");
        }
    }
}

#[test]
fn every_file_of_every_command() {
    let session = example();
    let [session, record] =
        [session.clone(), session.join("records/m01.csv")].map(|path| path.to_str().unwrap().to_owned());
    let result = TempDir::new().unwrap();
    whole(result.path(), &["calibrate", &session, "--out", "."]);
    let result = result.path().join("result.json").to_str().unwrap().to_owned();
    for arguments in [
        &["reduce", &session, "--out", "out"][..],
        &["reduce", &session, "--out", "out", "--format", "parquet"],
        &["calibrate", &session, "--out", "out"],
        &["compensate", &result, &record, "--out", "out/f.csv"],
        &["compensate", &result, &record, "--out", "out/f.parquet"],
        &["simulate", &session, "--truth", "truth.toml", "--seed", "1", "--out", "out"],
        &["simulate", &session, "--truth", "truth.toml", "--seed", "1", "--out", "out", "--format", "parquet"],
        &["noise", &record, "--out", "out"],
        &["report", &result, "--html", "out/report.html"],
        &["report", &result, "--c", "out"],
    ] {
        dies_in_its_writes(arguments);
    }
}
