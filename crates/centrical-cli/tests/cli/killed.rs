//! A command that dies inside its write, or cannot write on, leaves no part of a file under its name.
//!
//! A limit on the size of files (`ulimit -f`) makes it certain: the write that crosses it kills the process, or fails if
//! the signal is ignored.

use std::collections::BTreeMap;
use std::fs;
use std::io::{BufRead, BufReader};
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

use crate::program;
use crate::session::{Copy, example};

/// The signal of the limit.
const SIGXFSZ: i32 = 25;

/// What `ulimit -f` counts in [bytes].
const BLOCK: usize = 512;

const TRUTH: &str = "typical = { size = 1.0 }\n[sensor]\nwhite = \"0.2 mg\"\n[recorder]\nrate = \"10 Hz\"\n";

/// What `plan` chooses from: little, so that it is soon done.
const PLAN: &str = r#"
session = { title = "" }
plan = { noise = "20 ug/sqrt(Hz)", floor = "1 ug" }
candidates = { radii = ["0.5 m"], loads = { from = "5 g", to = "200 g", count = 2 }, rest_angles = ["0 deg", "180 deg"], durations = ["60 s"], repeats = 1 }
cost = { position = "20 min", seat = "10 min", run_up = "2 min", ramp = "20 s", turn = "10 s" }
target = { criterion = "I", range = "200 g", time = "8 h" }
site = { gravity = "9.8 m/s^2", latitude = "55.7 deg" }
unit = { output_unit = "m/s^2", proof_masses = [[0, 0, 0], [0.02, 0.01, 0.01], [0.01, -0.01, -0.01]] }
centrifuge = { speed_uncertainty = "10 ppm", rotation = "+3" }
model = { error_model = "kozlov-2017", pair_relation = "common" }
position = [{ id = "1", axes = "+1 +2 +3", pair = "A" }, { id = "2", axes = "-1 -2 +3", pair = "A" }]
"#;

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

/// Runs the binary in a folder; no file grows beyond `blocks` blocks; the shell runs `before` first.
fn run(folder: &Path, before: &str, blocks: usize, arguments: &[&str]) -> Output {
    let binary = env!("CARGO_BIN_EXE_centrical");
    let script = format!("{before} ulimit -c 0; ulimit -f {blocks}; exec \"$0\" \"$@\"");
    Command::new("sh").args(["-c", &script, binary]).args(arguments).current_dir(folder).output().unwrap()
}

/// Runs the binary in a folder to its end.
fn whole(folder: &Path, arguments: &[&str]) {
    let run = program::centrical().args(arguments).current_dir(folder).output().unwrap();
    assert!(matches!(run.status.code(), Some(0 | 1)), "{arguments:?}: {}", String::from_utf8_lossy(&run.stderr));
}

/// Kills a command, and makes it fail, in its first write and in that of its largest file; all it writes goes to `out`.
fn dies_in_its_writes(arguments: &[&str]) {
    let folder = TempDir::new().unwrap();
    let made = |name: &str| {
        let path = folder.path().join(name);
        fs::create_dir_all(path.join("out")).unwrap();
        fs::write(path.join("truth.toml"), TRUTH).unwrap();
        fs::write(path.join("plan.toml"), PLAN).unwrap();
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
    let [session, record, laboratory] =
        [session.clone(), session.join("records/m01.csv"), session.join("laboratory.toml")]
            .map(|path| path.to_str().unwrap().to_owned());
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
        &["plan", "plan.toml", "--out", "out/schedule.toml"],
        &["plan", "plan.toml", "--frontier", "--levels", "1", "--svg", "out/frontier.svg"],
        &["report", &result, "--html", "out/report.html"],
        &["report", &result, "--pdf", "out/certificate.pdf", "--laboratory", &laboratory],
        &["report", &result, "--dcc", "out/certificate.xml", "--laboratory", &laboratory],
        &["report", &result, "--c", "out"],
    ] {
        dies_in_its_writes(arguments);
    }
}

/// Outputs that belong together appear together: a kill within the write of the last leaves none of them.
#[test]
fn outputs_that_belong_together() {
    let session = example();
    let [record, session] = [session.join("records/m01.csv"), session].map(|path| path.to_str().unwrap().to_owned());
    let result = TempDir::new().unwrap();
    whole(result.path(), &["calibrate", &session, "--out", "."]);
    let result = result.path().join("result.json").to_str().unwrap().to_owned();
    for arguments in [
        &["calibrate", &session, "--out", "out"][..],
        &["noise", &record, "--out", "out"],
        &["report", &result, "--c", "out", "--html", "out/report.html"],
    ] {
        let folder = TempDir::new().unwrap();
        whole(folder.path(), arguments);
        let largest = files(&folder.path().join("out")).values().map(Vec::len).max().unwrap();
        let folder = TempDir::new().unwrap();
        assert_eq!(run(folder.path(), "", (largest - 1) / BLOCK, arguments).status.signal(), Some(SIGXFSZ));
        let left = files(&folder.path().join("out"));
        assert!(
            !left.is_empty() && left.keys().all(|name| std::path::Path::new(name).extension() == Some("tmp".as_ref())),
            "{arguments:?}: {:?}",
            left.keys()
        );
    }
}

/// A store that does not take the result takes nothing else with it, and the message says what is written.
#[test]
fn a_store_that_fails() {
    let copy = Copy::new();
    fs::create_dir(copy.out().join("store")).unwrap();
    fs::write(copy.out().join("store/results"), "").unwrap();
    let run = copy.calibrate(&["--out", "out", "--store", "store", "-q"]);
    let message = String::from_utf8(run.stderr).unwrap();
    assert_eq!(run.status.code(), Some(2), "{message}");
    assert!(message.contains("store: the result is not in this store; all other files are written"), "{message}");
    assert!(message.contains("store/results: cannot be written"), "{message}");
    let written = files(&copy.out().join("out"));
    assert!(["result.json", "report.html"].iter().all(|name| written.contains_key(*name)), "{:?}", written.keys());
    assert!(written.keys().any(|name| name.starts_with("plots/")), "{:?}", written.keys());
}

/// Who waits for a store says so, and for whom.
#[test]
fn a_store_that_is_locked() {
    let copy = Copy::new();
    whole(&copy.out(), &["calibrate", copy.session().to_str().unwrap(), "--out", ".", "--store", "store"]);
    let lock = fs::File::options().append(true).open(copy.out().join("store/lock")).unwrap();
    for arguments in [
        &["calibrate", copy.session().to_str().unwrap(), "--out", ".", "--store", "store", "-q"][..],
        &["history", "add", "store", "result.json"],
        &["series", copy.session().to_str().unwrap(), "--out", "store"],
    ] {
        lock.lock().unwrap();
        let mut waiting = program::centrical();
        waiting.args(arguments).current_dir(copy.out()).stdout(Stdio::null()).stderr(Stdio::piped());
        let mut waiting = waiting.spawn().unwrap();
        let said = BufReader::new(waiting.stderr.take().unwrap()).lines().next().unwrap().unwrap();
        let holder = format!(" (process {})", std::process::id());
        let holder = if cfg!(target_os = "linux") { holder.as_str() } else { "" };
        assert_eq!(said, format!("waiting for the store store: another process writes into it{holder}"));
        lock.unlock().unwrap();
        assert!(waiting.wait().unwrap().success(), "{arguments:?}");
    }
}

/// A watch adds to its files with every plateau. Whichever it dies in, what is there is whole, but for the last line of the
/// history after a kill, which nobody reads; and the same command goes on from there to the bytes of a watch that never died.
#[test]
fn a_watch_goes_on_from_every_write() {
    let begun = Copy::new();
    for mounting in 2..=12 {
        fs::remove_file(begun.session().join(format!("records/m{mounting:02}.csv"))).unwrap();
    }
    let [begun, complete] = [begun.session(), example()].map(|path| path.to_str().unwrap().to_owned());
    let history = "watch-history.jsonl";
    dies_in_a_watch(&[&begun], history, |_| 1);
    dies_in_a_watch(&[&begun], history, |length| (length - 1) / BLOCK);
    dies_in_a_watch(&[&complete], "result.json", |length| (length - 1) / BLOCK);
}

/// Kills a watch within its write of a file, and makes that write fail: no file grows beyond the blocks that `blocks` gives for its length.
fn dies_in_a_watch(arguments: &[&str], file: &str, blocks: impl Fn(usize) -> usize) {
    let folder = TempDir::new().unwrap();
    let arguments = [&["watch"], arguments, &["--once", "--quiet", "0", "--out", "out"]].concat();
    whole(folder.path(), &arguments);
    let out = folder.path().join("out");
    let expected = files(&out);
    let blocks = blocks(expected[file].len());
    let history = out.join("watch-history.jsonl");
    for before in ["", "trap '' XFSZ;"] {
        fs::remove_dir_all(&out).unwrap();
        let died = run(folder.path(), before, blocks, &arguments);
        let message = String::from_utf8_lossy(&died.stderr);
        let left = files(&out);
        if before.is_empty() {
            assert_eq!(died.status.signal(), Some(SIGXFSZ), "{arguments:?}, {blocks}: {message}");
            let is_begun =
                |name: &str| name.starts_with(file) && Path::new(name).extension().is_some_and(|end| end == "tmp");
            let cut = left.iter().find(|(name, _)| is_begun(name)).map_or_else(|| &left[file], |(_, bytes)| bytes);
            assert_eq!(cut.len(), blocks * BLOCK, "{arguments:?}: killed inside the write of {file}");
        } else {
            assert_eq!(died.status.code(), Some(2), "{arguments:?}, {blocks}: {message}");
            assert!(message.contains(&format!("out/{file}: cannot be written")), "{message}");
            assert!(left.keys().all(|name| expected.contains_key(name)), "{arguments:?}, {blocks}: {:?}", left.keys());
            let there = left.get("watch-history.jsonl").map_or(&[][..], Vec::as_slice);
            assert!(there.last().is_none_or(|end| *end == b'\n'), "{arguments:?}, {blocks}: a line in part");
        }
        if history.exists() {
            let lines = fs::read_to_string(&history).unwrap().matches('\n').count();
            assert_eq!(centrical_session::read_history(&history).unwrap().len(), lines, "{arguments:?}, {blocks}");
        }
        whole(folder.path(), &arguments);
        let ended = files(&out);
        for (name, bytes) in &expected {
            assert!(ended.get(name) == Some(bytes), "{arguments:?}, {blocks}: {name}");
        }
    }
}
