//! `centrical watch` of a session with rests in attitudes of their own: they join when their file is there.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::thread;
use std::time::{Duration, Instant, SystemTime};

use serde_json::Value;
use tempfile::TempDir;

use crate::program;
use crate::session::example;

/// Longest time that any step of a run may take.
const PATIENCE: Duration = Duration::from_secs(120);

const TRUTH: &str = r#"
typical = { size = 1.0 }
[sensor]
white = "0.3 mg"
[hand]
rests = 12
tremor = { deviation = "1 mrad" }
"#;

/// The example with a record of rests after a switch-off.
struct Laboratory(TempDir);

impl Laboratory {
    fn new() -> Self {
        let folder = TempDir::new().unwrap();
        let text = fs::read_to_string(example().join("experiment.toml")).unwrap();
        let tumbles = "[uncertainty]\nbias_change = \"2 mg\"\n[[tumble]]\nrecord = \"tumble.csv\"\n";
        fs::write(folder.path().join("plan.toml"), format!("{text}\n{tumbles}")).unwrap();
        fs::write(folder.path().join("truth.toml"), TRUTH).unwrap();
        let laboratory = Self(folder);
        laboratory.run(&["simulate", "plan.toml", "--truth", "truth.toml", "--seed", "5", "--out", "session"]);
        laboratory
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn record(&self) -> PathBuf {
        self.path("session/records/tumble-1.csv")
    }

    /// What the command says, on both streams.
    fn run(&self, arguments: &[&str]) -> String {
        let run = program::centrical().args(arguments).current_dir(self.0.path()).output().unwrap();
        let text = [run.stdout, run.stderr].map(|part| String::from_utf8(part).unwrap()).concat();
        assert_eq!(run.status.code(), Some(0), "{text}");
        text
    }

    /// The result of the watch in `out` has the bytes of the recursive calibration.
    fn assert_calibrated(&self, out: &str) {
        self.run(&["calibrate", "session", "--method", "recursive", "--out", "calibrated"]);
        let [watched, calibrated] =
            [out, "calibrated"].map(|out| fs::read(self.path(out).join("result.json")).unwrap());
        assert!(watched == calibrated);
    }
}

fn history(out: &Path) -> Vec<Value> {
    let text = fs::read_to_string(out.join("watch-history.jsonl")).unwrap_or_default();
    text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect()
}

fn until(what: &str, mut done: impl FnMut() -> bool) {
    let start = Instant::now();
    while !done() {
        assert!(start.elapsed() < PATIENCE, "waited for {what} in vain");
        thread::sleep(Duration::from_millis(5));
    }
}

fn start(laboratory: &Laboratory, out: &str) -> Child {
    let mut command = program::centrical();
    command.args(["watch", "session", "--interval", "0.05", "--quiet", "1", "--out", out]);
    command.current_dir(laboratory.0.path()).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
}

/// Rests that are there before the arm turns come first. A watch that looks once, and again, ends as the calibration does.
#[test]
fn rests_that_are_there_come_first() {
    let laboratory = Laboratory::new();
    let arguments = ["watch", "session", "--once", "--quiet", "0", "--out", "watched"];
    let text = laboratory.run(&arguments);
    for part in ["PLATEAU 1 of 120", "rest r12: ", "PLATEAU 120 of 120  RANK 73 of 73", "The schedule is complete"] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
    assert!(!text.contains("DOES NOT FIT"), "{text}");
    let history = history(&laboratory.path("watched"));
    let come: Vec<u64> = history.iter().map(|line| line["set_point"].as_u64().unwrap()).collect();
    assert_eq!(come, (108..120).chain(0..108).collect::<Vec<_>>());
    laboratory.assert_calibrated("watched");
    fs::remove_file(laboratory.path("watched/result.json")).unwrap();
    laboratory.run(&arguments);
    laboratory.assert_calibrated("watched");
    assert_eq!(self::history(&laboratory.path("watched")).len(), 120);
}

/// Rests whose record comes when the arm has stopped are waited for, and join the plateaus that have come. What is known then is known to
/// a watch of all of them at once.
#[test]
fn rests_that_come_later_join() {
    let laboratory = Laboratory::new();
    let later = laboratory.path("later.csv");
    fs::rename(laboratory.record(), &later).unwrap();
    let text = laboratory.run(&["watch", "session", "--once", "--quiet", "0", "--out", "watched"]);
    assert!(text.contains("PLATEAU 108 of 108  RANK 49 of 49") && text.contains("tumble-1.csv"), "{text}");
    assert!(!laboratory.path("watched/result.json").exists());
    let mut watch = start(&laboratory, "watched");
    fs::rename(&later, laboratory.record()).unwrap();
    until("the calibration", || watch.try_wait().unwrap().is_some());
    assert_eq!(watch.wait().unwrap().code(), Some(0));
    let known = history(&laboratory.path("watched"));
    let come: Vec<u64> = known.iter().map(|line| line["set_point"].as_u64().unwrap()).collect();
    assert_eq!(come, (0..120).collect::<Vec<_>>());
    laboratory.assert_calibrated("watched");
    laboratory.run(&["watch", "session", "--once", "--quiet", "0", "--out", "at-once"]);
    let at_once = history(&laboratory.path("at-once"));
    let [later, first] = [&known, &at_once].map(|known| known[119]["estimates"].as_array().unwrap().clone());
    assert_eq!(later.len(), 73);
    for (a, b) in later.iter().zip(&first) {
        let number = |estimate: &Value, key: &str| estimate[key].as_f64().unwrap();
        let (difference, u) = (number(a, "value") - number(b, "value"), number(b, "standard_uncertainty"));
        assert!(a["name"] == b["name"] && difference.abs() < 0.02 * u, "{a} {b}");
    }
}

/// A table of rests need not be there when a watch begins.
#[test]
fn a_table_of_rests_is_waited_for() {
    let laboratory = Laboratory::new();
    laboratory.run(&["reduce", "session", "--out", "reduced"]);
    fs::rename(laboratory.path("reduced/rests.csv"), laboratory.path("later.csv")).unwrap();
    let arguments = ["watch", "reduced", "--once", "--quiet", "0", "--out", "watched"];
    assert!(laboratory.run(&arguments).contains("waiting for reduced/rests.csv"));
    fs::rename(laboratory.path("later.csv"), laboratory.path("reduced/rests.csv")).unwrap();
    assert!(laboratory.run(&arguments).contains("PLATEAU 120 of 120"));
    laboratory.run(&["calibrate", "reduced", "--method", "recursive", "--out", "calibrated"]);
    let [a, b] = ["watched", "calibrated"].map(|out| fs::read(laboratory.path(out).join("result.json")).unwrap());
    assert!(a == b);
}

/// A prior of a rest that has not come yet has no parameter to be of. Rests that have gone since they were taken up are what is wrong, and not
/// the experiment file.
#[test]
fn rests_that_have_not_come_and_rests_that_have_gone() {
    let laboratory = Laboratory::new();
    laboratory.run(&["reduce", "session", "--out", "reduced"]);
    let experiment = laboratory.path("reduced/experiment.toml");
    let text = fs::read_to_string(&experiment).unwrap();
    fs::write(&experiment, format!("{text}\n[prior]\n\"theta_1[r3]\" = \"10 mrad\"\n")).unwrap();
    let rests = laboratory.path("reduced/rests.csv");
    fs::rename(&rests, laboratory.path("later.csv")).unwrap();
    let arguments = ["watch", "reduced", "--once", "--quiet", "0", "--out", "watched"];
    assert!(laboratory.run(&arguments).contains("PLATEAU 108 of 108"));
    let table = fs::read_to_string(laboratory.path("later.csv")).unwrap();
    fs::write(&rests, &table).unwrap();
    assert!(laboratory.run(&arguments).contains("PLATEAU 120 of 120"));
    let fewer: Vec<&str> = table.lines().take(11).collect();
    fs::write(&rests, fewer.join("\n") + "\n").unwrap();
    let run = program::centrical().args(arguments).current_dir(laboratory.0.path()).output().unwrap();
    let said = String::from_utf8(run.stderr).unwrap();
    assert_eq!(run.status.code(), Some(2), "{said}");
    assert!(said.contains("watch.json") && said.contains("a session of 120 plateaus or more"), "{said}");
}

/// Rests dated to the future, as by a file server whose clock is ahead, are waited for by a watch that goes on as by one that begins.
#[test]
fn rests_dated_to_the_future_are_waited_for() {
    let laboratory = Laboratory::new();
    laboratory.run(&["watch", "session", "--once", "--quiet", "0", "--out", "watched"]);
    fs::remove_file(laboratory.path("watched/result.json")).unwrap();
    let record = fs::File::options().append(true).open(laboratory.record()).unwrap();
    record.set_modified(SystemTime::now() + Duration::from_secs(3600)).unwrap();
    let text = laboratory.run(&["watch", "session", "--once", "--out", "watched"]);
    assert!(text.contains("waiting for session/records/tumble-1.csv\nStopped after 120 plateaus"), "{text}");
    let mut watch = start(&laboratory, "watched");
    until("the calibration", || watch.try_wait().unwrap().is_some());
    assert_eq!(watch.wait().unwrap().code(), Some(0));
    assert_eq!(history(&laboratory.path("watched")).len(), 120);
    laboratory.assert_calibrated("watched");
}
