//! A session reduced to its plateau means is calibrated to the same numbers, and is there whole or not at all.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::thread::sleep;
use std::time::Duration;

use serde_json::Value;
use tempfile::TempDir;

use crate::program;
use crate::session::example;

fn centrical(arguments: &[&str], threads: &str) -> Command {
    let mut command = program::centrical();
    command.args(arguments).env("RAYON_NUM_THREADS", threads);
    command
}

fn reduce(out: &Path, format: &str, threads: &str) -> Output {
    let session = example();
    let arguments = ["reduce", session.to_str().unwrap(), "--out", out.to_str().unwrap(), "--format", format];
    centrical(&arguments, threads).output().unwrap()
}

fn calibrated(session: &Path) -> Value {
    let run = centrical(&["calibrate", session.to_str().unwrap(), "--json"], "2").output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    serde_json::from_slice(&run.stdout).unwrap()
}

#[test]
fn the_same_numbers_to_the_last_digit() {
    let folder = TempDir::new().unwrap();
    let records = calibrated(&example());
    for format in ["csv", "parquet"] {
        let out = folder.path().join(format);
        let run = reduce(&out, format, "2");
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        assert_eq!(String::from_utf8(run.stderr).unwrap(), "", "a bar is for terminals");
        let plateaus = calibrated(&out);
        for key in ["parameters", "covariance", "observability", "fit", "model", "drift", "tilt", "validity"] {
            assert_eq!(plateaus[key], records[key], "{format}: {key}");
        }
        let rows = |result: &Value| result["plateaus"].as_array().unwrap().clone();
        assert_eq!(rows(&plateaus).len(), 108);
        for (one, other) in rows(&plateaus).iter().zip(rows(&records)) {
            for key in ["mounting", "index", "speed", "angle", "samples", "mean", "covariance", "residual"] {
                assert_eq!(one[key], other[key], "{format}: {key}");
            }
        }
    }
}

#[test]
fn the_same_bytes_for_any_number_of_threads() {
    let folder = TempDir::new().unwrap();
    let tables = ["1", "2", "5"].map(|threads| {
        let out = folder.path().join(threads);
        assert!(reduce(&out, "csv", threads).status.success());
        fs::read(out.join("plateaus.csv")).unwrap()
    });
    assert_eq!(tables[0], tables[1]);
    assert_eq!(tables[0], tables[2]);
}

/// Killed after any time, the command leaves a whole table or none, and no experiment file without its table.
#[test]
fn killed_it_leaves_nothing_half_written() {
    let folder = TempDir::new().unwrap();
    let whole = folder.path().join("whole");
    assert!(reduce(&whole, "csv", "2").status.success());
    let table = fs::read(whole.join("plateaus.csv")).unwrap();
    let experiment = fs::read(whole.join("experiment.toml")).unwrap();
    let session = example();
    let mut before = 0;
    for k in 0..24 {
        let out = folder.path().join(format!("killed {k}"));
        let arguments = ["reduce", session.to_str().unwrap(), "--out", out.to_str().unwrap()];
        let mut run = centrical(&arguments, "2").stdout(Stdio::null()).spawn().unwrap();
        sleep(Duration::from_millis(1 << (k % 12)));
        run.kill().unwrap();
        run.wait().unwrap();
        let written = |name: &str| fs::read(out.join(name)).ok();
        before += usize::from(written("plateaus.csv").is_none());
        assert!(written("plateaus.csv").is_none_or(|bytes| bytes == table), "run {k}");
        assert!(written("experiment.toml").is_none_or(|bytes| bytes == experiment), "run {k}");
        assert!(written("experiment.toml").is_none() || written("plateaus.csv").is_some(), "run {k}");
    }
    assert!(before > 0, "some runs must have been killed before they wrote");
}

#[test]
fn a_session_is_not_written_over() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    assert!(reduce(&out, "csv", "2").status.success());
    let path = out.to_str().unwrap();
    let run = centrical(&["reduce", path, "--out", path], "2").output().unwrap();
    assert_eq!(run.status.code(), Some(2));
    let message = String::from_utf8(run.stderr).unwrap();
    assert!(message.contains("expected another folder than the session's own"), "{message}");
    // Another session stays as it is if it has records; one of means is what the command writes.
    let file = out.join("experiment.toml");
    let experiment = fs::read(example().join("experiment.toml")).unwrap();
    fs::write(&file, &experiment).unwrap();
    let run = reduce(&out, "csv", "2");
    let message = String::from_utf8(run.stderr).unwrap();
    assert!(run.status.code() == Some(2) && message.contains("experiment.toml: found a session, "), "{message}");
    assert!(fs::read(&file).unwrap() == experiment);
    fs::remove_file(&file).unwrap();
    assert!(reduce(&out, "csv", "2").status.success() && reduce(&out, "csv", "2").status.success());
}

/// Means of one unit do not replace those of another, but those of the same.
#[test]
fn means_of_another_unit_stay() {
    let folder = TempDir::new().unwrap();
    let reduced = || reduce(folder.path(), "csv", "2");
    assert!(reduced().status.success() && reduced().status.success());
    let file = folder.path().join("experiment.toml");
    let other = fs::read_to_string(&file).unwrap().replace("serial = \"0001\"", "serial = \"0002\"");
    fs::write(&file, &other).unwrap();
    let refused = reduced();
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(
        (refused.status.code(), said.contains("of plateau means alone and of the same unit")),
        (Some(2), true),
        "{said}"
    );
    assert!(fs::read_to_string(&file).unwrap() == other);
}
