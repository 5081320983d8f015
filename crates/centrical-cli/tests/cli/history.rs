//! Stores of calibrations, and series of sessions: nothing is lost by a kill, and a session that fails ends nothing.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::thread;
use std::time::Duration;

use serde_json::{Value, json};
use tempfile::TempDir;

use crate::program::centrical;
use crate::random::Random;
use crate::session::example;

fn run(folder: &Path, arguments: &[&str]) -> Output {
    centrical().args(arguments).current_dir(folder).output().unwrap()
}

/// A folder with `count` averaged sessions of units of their own; the last folder holds no session.
fn sessions(count: usize) -> (TempDir, Vec<String>) {
    let folder = TempDir::new().unwrap();
    let example = example();
    assert!(run(folder.path(), &["reduce", example.to_str().unwrap(), "--out", "reduced", "-q"]).status.success());
    let [text, table] = ["experiment.toml", "plateaus.csv"]
        .map(|name| fs::read_to_string(folder.path().join("reduced").join(name)).unwrap());
    let names: Vec<String> = (0..count).map(|n| format!("s{n:03}")).collect();
    for (n, name) in names.iter().enumerate() {
        let session = folder.path().join(name);
        fs::create_dir(&session).unwrap();
        let bad = if n + 1 == count { "broken\n" } else { "" };
        let text = text.replace("serial = \"0001\"", &format!("serial = \"{n:04}\""));
        let text = text.replace("rotation = \"+3\"", "rotation = \"+3\"\nstation = \"north\"");
        fs::write(session.join("experiment.toml"), text + bad).unwrap();
        fs::write(session.join("plateaus.csv"), &table).unwrap();
    }
    (folder, names)
}

fn series(folder: &Path, names: &[String], out: &str) -> Command {
    let mut command = centrical();
    command.arg("series").args(names).args(["--out", out, "--json"]).current_dir(folder);
    command
}

fn list(folder: &Path, arguments: &[&str]) -> Vec<Value> {
    let output = run(folder, &[&["history", "list"], arguments, &["--json"]].concat());
    let document: Value = serde_json::from_slice(&output.stdout).expect("a document");
    assert_eq!(document["schema"], "centrical-history-list/1");
    document["calibrations"].as_array().unwrap().clone()
}

#[test]
fn a_result_is_added_once_and_listed() {
    let folder = TempDir::new().unwrap();
    let example = example();
    let made = run(folder.path(), &["calibrate", example.to_str().unwrap(), "--out", "a", "--store", "store", "-q"]);
    assert!(made.status.success(), "{made:?}");
    for _ in 0..2 {
        let added = run(folder.path(), &["history", "add", "store", "a"]);
        assert_eq!(String::from_utf8_lossy(&added.stdout), "0 new, 1 known\n");
    }
    let listed = list(folder.path(), &["store"]);
    assert_eq!(listed.len(), 1);
    let copy = folder.path().join("store/results").join(format!("{}.json", listed[0]["key"].as_str().unwrap()));
    assert_eq!(fs::read(copy).unwrap(), fs::read(folder.path().join("a/result.json")).unwrap());
    assert_eq!(listed[0]["acceptable"], true);
    let again = run(folder.path(), &["history", "add", "store", "a", "--json"]);
    let again: Value = serde_json::from_slice(&again.stdout).unwrap();
    assert_eq!((&again["schema"], &again["new"], &again["known"]), (&json!("centrical-added/1"), &json!(0), &json!(1)));
    let none = run(folder.path(), &["history", "list", "nowhere"]);
    assert_eq!(none.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&none.stderr).contains("nowhere: found no such folder, expected a store"));
}

#[test]
fn a_series_gives_the_table_of_its_sessions_also_after_a_kill() {
    let (folder, names) = sessions(8);
    let whole = series(folder.path(), &names, "whole").output().unwrap();
    assert_eq!(whole.status.code(), Some(2), "one session failed: {whole:?}");
    let said: Value = serde_json::from_slice(&whole.stdout).unwrap();
    assert_eq!(
        (said["sessions"].as_u64(), said["failed"].as_u64(), said["known"].as_u64()),
        (Some(8), Some(1), Some(0))
    );
    let tables =
        |out: &str| ["series.csv", "series.parquet"].map(|name| fs::read(folder.path().join(out).join(name)).unwrap());
    let text = String::from_utf8(tables("whole")[0].clone()).unwrap();
    assert!(text.contains("s007,failed,") && text.contains("s007/experiment.toml, line "), "{text}");
    // The result is that of the command.
    let _ = run(folder.path(), &["calibrate", "s000", "--out", "one", "-q"]);
    let own = fs::read(folder.path().join("one/result.json")).unwrap();
    let first = list(folder.path(), &["whole", "--serial", "0000", "--station", "north"]);
    let copy = folder.path().join("whole/results").join(format!("{}.json", first[0]["key"].as_str().unwrap()));
    assert!(fs::read(copy).unwrap() == own);
    for pause in [50, 300, 900, 2300] {
        let mut killed = series(folder.path(), &names, "killed").arg("--jobs").arg("1").spawn().unwrap();
        thread::sleep(Duration::from_millis(pause));
        let _ = killed.kill();
        killed.wait().unwrap();
    }
    let resumed = series(folder.path(), &names, "killed").output().unwrap();
    assert_eq!(resumed.status.code(), Some(2));
    assert!(tables("killed") == tables("whole"));
    let again = series(folder.path(), &names, "killed").output().unwrap();
    let said: Value = serde_json::from_slice(&again.stdout).unwrap();
    assert_eq!(said["known"], 7);
    assert!(tables("killed") == tables("whole"));
    assert_eq!(list(folder.path(), &["killed"]).len(), 8);
    // A pattern that the shell leaves stands for the same sessions.
    let of_pattern = series(folder.path(), &["s*".to_owned()], "pattern").output().unwrap();
    assert_eq!(of_pattern.status.code(), Some(2));
    assert!(tables("pattern") == tables("whole"));
    let of_results = run(folder.path(), &["history", "add", "again", "whole/results/*.json"]);
    assert_eq!(String::from_utf8_lossy(&of_results.stdout), "7 new, 0 known\n");
    let of_nothing = series(folder.path(), &["t*".to_owned()], "nothing").output().unwrap();
    let said = String::from_utf8_lossy(&of_nothing.stderr).into_owned();
    assert_eq!(
        (of_nothing.status.code(), said.contains("t*: found no path of this pattern")),
        (Some(2), true),
        "{said}"
    );
}

/// A session that failed is listed as failed until it succeeds, with its last message alone, and does not count as a calibration.
#[test]
fn a_session_that_succeeds_is_no_longer_listed_as_failed() {
    let (folder, names) = sessions(2);
    let file = folder.path().join(&names[1]).join("experiment.toml");
    let broken = fs::read_to_string(&file).unwrap();
    let head = || {
        let listed = run(folder.path(), &["history", "list", "out", "--check"]);
        String::from_utf8_lossy(&listed.stdout).lines().next().unwrap().to_owned()
    };
    let verdicts = || {
        let listed = list(folder.path(), &["out"]);
        listed.iter().map(|line| line["status"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(series(folder.path(), &names, "out").output().unwrap().status.code(), Some(2));
    assert_eq!(head(), "CALIBRATIONS  1 calibration, 1 failed session");
    fs::write(&file, broken.replace("broken\n", "also = broken\n")).unwrap();
    assert_eq!(series(folder.path(), &names, "out").output().unwrap().status.code(), Some(2));
    assert_eq!(head(), "CALIBRATIONS  1 calibration, 1 failed session");
    fs::write(&file, broken.replace("broken\n", "")).unwrap();
    assert!(series(folder.path(), &names, "out").output().unwrap().status.success());
    assert_eq!(head(), "CALIBRATIONS  2 calibrations, 0 failed sessions");
    assert_eq!(verdicts(), ["done", "done"]);
    let pages = run(folder.path(), &["history", "page", "out", "--out", "pages"]);
    assert!(pages.status.success(), "{pages:?}");
    let index = fs::read_to_string(folder.path().join("pages/index.html")).unwrap();
    assert!(index.contains("<p>2 calibrations, 0 failed sessions</p>"));
}

/// An input that the command would replace or remove is refused, by whatever name, and stays as it was.
#[test]
fn what_is_read_is_not_written() {
    let (folder, names) = sessions(1);
    let (session, store) = (folder.path().join(&names[0]), folder.path().join("store"));
    let text = fs::read_to_string(session.join("experiment.toml")).unwrap().replace("broken\n", "");
    let table = fs::read(session.join("plateaus.csv")).unwrap();
    let refused = |arguments: &[&str], output: &str, input: &str| {
        let ended = run(folder.path(), arguments);
        let message = String::from_utf8_lossy(&ended.stderr).into_owned();
        assert_eq!(ended.status.code(), Some(2), "{arguments:?}: {message}");
        let said = message.contains(&format!("{output}: found an input of the same command ("));
        assert!(said && message.contains(&format!("{input})")), "{message}");
    };
    // The table of a series, or its list, is the table of plateaus by another name.
    fs::write(session.join("experiment.toml"), &text).unwrap();
    fs::create_dir(folder.path().join("out")).unwrap();
    for name in ["series.csv", "series.jsonl"] {
        let output = folder.path().join("out").join(name);
        fs::hard_link(session.join("plateaus.csv"), &output).unwrap();
        refused(&["series", &names[0], "--out", "out"], &format!("out/{name}"), "plateaus.csv");
        assert!(fs::read(session.join("plateaus.csv")).unwrap() == table);
        fs::remove_file(output).unwrap();
    }
    // What a killed writer left in a store is removed by the next one.
    assert!(run(folder.path(), &["calibrate", &names[0], "--out", "a", "--store", "store", "-q"]).status.success());
    fs::hard_link(session.join("plateaus.csv"), store.join("rows/left.tmp")).unwrap();
    refused(&["calibrate", &names[0], "--out", "b", "--store", "store"], "store/rows/left.tmp", "plateaus.csv");
    assert!(!folder.path().join("b/result.json").exists());
    fs::remove_file(store.join("rows/left.tmp")).unwrap();
    fs::hard_link(folder.path().join("a/result.json"), store.join("rows/left.tmp")).unwrap();
    refused(&["history", "add", "store", "a"], "store/rows/left.tmp", "a/result.json");
    fs::remove_file(store.join("rows/left.tmp")).unwrap();
    // The copies of a store are never replaced: another store can be made from them, and the same.
    let copy = fs::read_dir(store.join("results")).unwrap().next().unwrap().unwrap().path();
    for (to, said) in [("store", "0 new, 1 known\n"), ("other", "1 new, 0 known\n")] {
        let added = run(folder.path(), &["history", "add", to, copy.to_str().unwrap()]);
        assert_eq!(String::from_utf8_lossy(&added.stdout), said);
    }
}

/// Copies of one session that are calibrated together have one reduced session, and none of them fails.
#[test]
fn copies_of_a_session_are_kept_reduced_once() {
    let (folder, names) = sessions(2);
    let copies: Vec<String> = (0..8).map(|n| format!("copy{n}")).collect();
    for copy in &copies {
        fs::create_dir(folder.path().join(copy)).unwrap();
        for file in ["experiment.toml", "plateaus.csv"] {
            fs::copy(folder.path().join(&names[0]).join(file), folder.path().join(copy).join(file)).unwrap();
        }
    }
    let output = series(folder.path(), &copies, "fleet").args(["--reduced", "--jobs", "8"]).output().unwrap();
    let summary: Value = serde_json::from_slice(&output.stdout).expect("a document");
    assert_eq!((&summary["sessions"], &summary["failed"]), (&json!(8), &json!(0)), "{output:?}");
    assert_eq!(fs::read_dir(folder.path().join("fleet/reduced")).unwrap().count(), 1);
}

/// Sixteen processes add results to one store, and each is killed after a few milliseconds, whatever it does. What was added stays whole, and
/// the same commands once more leave every result once.
#[test]
fn sixteen_killed_writers_lose_nothing_and_add_nothing_twice() {
    const WRITERS: usize = 16;
    const EACH: usize = 4;
    let folder = TempDir::new().unwrap();
    let made = run(folder.path(), &["calibrate", example().to_str().unwrap(), "--out", "first", "-q"]);
    assert!(made.status.success(), "{made:?}");
    let first = fs::read_to_string(folder.path().join("first/result.json")).unwrap();
    let writers: Vec<String> = (0..WRITERS).map(|writer| format!("w{writer:02}")).collect();
    for (writer, name) in writers.iter().enumerate() {
        for n in 0..EACH {
            let place = folder.path().join(name).join(n.to_string());
            fs::create_dir_all(&place).unwrap();
            // Each writer shares its last result with the next one.
            let number = (writer * (EACH - 1) + n) % (WRITERS * (EACH - 1));
            let text = first.replace("\"unit_serial\": \"0001\"", &format!("\"unit_serial\": \"unit-{number}\""));
            assert_ne!(text, first);
            fs::write(place.join("result.json"), text).unwrap();
        }
    }
    let add = |name: &String| {
        let mut command = centrical();
        command.args(["history", "add", "store", name, "-q"]).current_dir(folder.path());
        command
    };
    let mut random = Random::new(7);
    let mut before = 0;
    for _ in 0..3 {
        let mut running: Vec<_> = writers.iter().map(|name| add(name).spawn().unwrap()).collect();
        for child in &mut running {
            thread::sleep(Duration::from_secs_f64(0.04 * random.normal().abs()));
            // It may have ended.
            let _ = child.kill();
            child.wait().unwrap();
        }
        if folder.path().join("store").exists() {
            let count = list(folder.path(), &["store"]).len();
            assert!(count >= before, "{count} after {before}");
            before = count;
        }
    }
    let mut running: Vec<_> = writers.iter().map(|name| add(name).spawn().unwrap()).collect();
    for child in &mut running {
        assert!(child.wait().unwrap().success());
    }
    let listed = list(folder.path(), &["store"]);
    let serials: BTreeSet<&str> = listed.iter().map(|c| c["unit_serial"].as_str().unwrap()).collect();
    assert_eq!((listed.len(), serials.len()), (WRITERS * (EACH - 1), WRITERS * (EACH - 1)));
    for calibration in &listed {
        let copy = format!("store/results/{}.json", calibration["key"].as_str().unwrap());
        assert!(fs::read(folder.path().join(copy)).unwrap().len() > first.len() / 2);
    }
}

/// What laboratories do wrong with a store is found with its kind, and nothing is found in a store without mistakes.
#[test]
fn mistakes_in_a_store_are_found() {
    let folder = TempDir::new().unwrap();
    let made = run(folder.path(), &["calibrate", example().to_str().unwrap(), "--out", "first", "-q"]);
    assert!(made.status.success(), "{made:?}");
    let first: Value = serde_json::from_slice(&fs::read(folder.path().join("first/result.json")).unwrap()).unwrap();
    let add = |name: &str, serial: &str, date: &str, hash: Option<&str>| {
        let mut result = first.clone();
        result["session"]["unit_serial"] = json!(serial);
        result["session"]["date"] = json!(date);
        result["session"]["title"] = json!(name);
        if let Some(hash) = hash {
            for (n, input) in result["inputs"].as_array_mut().unwrap().iter_mut().enumerate() {
                input["sha256"] = json!(format!("{}{n:02}", hash.repeat(62)));
            }
        }
        fs::create_dir(folder.path().join(name)).unwrap();
        fs::write(folder.path().join(name).join("result.json"), result.to_string()).unwrap();
        let added = run(folder.path(), &["history", "add", "store", name]);
        assert_eq!(String::from_utf8_lossy(&added.stdout), "1 new, 0 known\n");
    };
    let doubts = || {
        let output = run(folder.path(), &["history", "list", "store", "--check", "--json"]);
        let document: Value = serde_json::from_slice(&output.stdout).unwrap();
        let found = document["doubts"].as_array().unwrap().clone();
        assert_eq!(output.status.code(), Some(i32::from(!found.is_empty())));
        found.iter().map(|doubt| (doubt["kind"].as_str().unwrap().to_owned(), doubt["of"].clone())).collect::<Vec<_>>()
    };
    add("a", "TA-1", "2021-03-04", Some("a"));
    add("b", "TA-2", "2021-03-04", Some("b"));
    assert_eq!(doubts(), []);
    // The first two letters of the serial number are Cyrillic.
    add("c", "\u{422}\u{410}-1 ", "2022-03-04", Some("c"));
    let asked = run(folder.path(), &["history", "unit", "store", "--serial", "ta 1"]);
    let said = String::from_utf8_lossy(&asked.stderr).into_owned();
    assert!(
        said.contains("found no such calibration but those of serial \"TA-1\", \"\u{422}\u{410}-1 \", expected"),
        "{said}"
    );
    add("d", "TA-2", "2021-03-04", Some("d"));
    add("e", "TA-3", "2021-03-04", Some("d"));
    add("f", "TA-4", "2999-03-04", Some("f"));
    add("g", "TA-5", "", Some("e"));
    let listed = list(folder.path(), &["store"]);
    let key = |title: &str| {
        let found = listed.iter().find(|calibration| calibration["title"] == title).unwrap();
        found["key"].as_str().unwrap().to_owned()
    };
    fs::remove_file(folder.path().join(format!("store/results/{}.json", key("a")))).unwrap();
    fs::write(folder.path().join(format!("store/results/{}.json", key("b"))), "{}").unwrap();
    let pair = |one: &str, other: &str| {
        let mut keys = [key(one), key(other)];
        keys.sort();
        json!(keys)
    };
    let model = first["session"]["unit_model"].as_str().unwrap();
    let names = json!([format!("{model:?} \"TA-1\""), format!("{model:?} \"\u{422}\u{410}-1 \"")]);
    let mut found = doubts();
    found.sort_by(|a, b| a.0.cmp(&b.0));
    let expected = [
        ("ahead", json!([key("f")])),
        ("changed", json!([key("b")])),
        ("missing", json!([key("a")])),
        ("no-day", json!([key("g")])),
        ("same-day", pair("b", "d")),
        ("same-inputs", pair("d", "e")),
        ("spelling", names),
    ];
    assert_eq!(found, expected.map(|(kind, of)| (kind.to_owned(), of)));
}
