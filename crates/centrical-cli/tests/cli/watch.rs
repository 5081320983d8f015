//! `centrical watch` on a complete folder, and on one to which the laboratory is still adding records.

use std::fmt::Write as _;
use std::fs::{self, OpenOptions};
use std::io::Write;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::program;
use crate::session::{Copy, example};

/// Longest time that any step of a run may take.
const PATIENCE: Duration = Duration::from_secs(120);

/// A complete folder: each plateau in the history, no alarm, and the bytes of the recursive calibration at the end, which
/// are those of the batch to the last digits shown.
#[test]
fn a_complete_session_is_followed_to_its_calibration() {
    let copy = Copy::new();
    let session = copy.session();
    let run = copy.run(&["watch", session.to_str().unwrap(), "--quiet", "0", "--once", "--target", "bias=0.05"]);
    let text = String::from_utf8(run.stdout).unwrap();
    assert_eq!(run.status.code(), Some(0), "{text}{}", String::from_utf8_lossy(&run.stderr));
    assert!(String::from_utf8_lossy(&run.stderr).starts_with("30 states of 49 unknowns"));
    for part in ["PLATEAU 108 of 108  RANK 49 of 49", "Every target is met", "The schedule is complete"] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
    assert!(!text.contains("DOES NOT FIT"), "{text}");
    assert!(fs::read_to_string(copy.out().join("watch-history.svg")).unwrap().starts_with("<svg"));
    let history = history(&copy.out());
    assert_eq!(history.len(), 108);
    let rank: Vec<u64> = history.iter().map(|line| line["rank"].as_u64().unwrap()).collect();
    assert!(rank.is_sorted() && rank[0] == 3 && rank[107] == 49, "{rank:?}");
    let freedom: u64 = history.iter().map(|line| line["innovation"]["degrees_of_freedom"].as_u64().unwrap()).sum();
    assert_eq!(freedom, 324 - 49);
    let watched = fs::read(copy.out().join("result.json")).unwrap();
    assert_eq!(copy.calibrate(&["--method", "recursive"]).status.code(), Some(0));
    assert!(watched == fs::read(copy.out().join("result.json")).unwrap());
    let batch: Value = serde_json::from_slice(&copy.calibrate(&["--json"]).stdout).unwrap();
    let watched: Value = serde_json::from_slice(&watched).unwrap();
    for (a, b) in watched["parameters"].as_array().unwrap().iter().zip(batch["parameters"].as_array().unwrap()) {
        let (difference, uncertainty) =
            (a["value"].as_f64().unwrap() - b["value"].as_f64().unwrap(), b["standard_uncertainty"].as_f64().unwrap());
        assert!(difference.abs() < 1e-6 * uncertainty, "{} {difference}", a["name"]);
    }
}

/// A record that was copied, and trimmed, is refused as soon as it is finished.
#[test]
fn a_copied_record_is_refused() {
    let copy = Copy::new();
    copy.edit("experiment.toml", |text| text.replacen("arm = [0.25, 0.0, 0.0]", "arm = [0.5, 0.0, 0.0]", 1));
    let first = fs::read_to_string(copy.session().join("records/m01.csv")).unwrap();
    let lines: Vec<&str> = first.lines().collect();
    copy.edit("records/m02.csv", |_| lines[..lines.len() - 30].join("\n") + "\n");
    let run = copy.run(&["watch", copy.session().to_str().unwrap(), "--quiet", "0", "--once"]);
    let message = String::from_utf8(run.stderr).unwrap();
    assert_eq!(run.status.code(), Some(2), "{message}");
    assert!(message.contains("m02.csv: found the readings of mounting 1, "), "{message}");
}

/// A gap that is longer than the time called quiet ends a watch, which says why the record counts as finished.
#[test]
fn a_record_that_pauses_for_too_long() {
    let copy = Copy::new();
    let records = copy.session().join("records");
    let first = fs::read_to_string(records.join("m01.csv")).unwrap();
    fs::remove_dir_all(&records).unwrap();
    fs::create_dir(&records).unwrap();
    let begun: Vec<&str> = first.lines().take(first.lines().count() / 3).collect();
    fs::write(records.join("m01.csv"), begun.join("\n") + "\n").unwrap();
    let session = copy.session();
    let run = copy.run(&["watch", session.to_str().unwrap(), "--quiet", "0.5", "--interval", "0.05"]);
    let message = String::from_utf8(run.stderr).unwrap();
    assert_eq!(run.status.code(), Some(2), "{message}");
    let why = "m01.csv counts as finished, since it has not changed for 0.5 s; --quiet SECONDS waits for longer gaps\n";
    let (_, then) = message.split_once(why).unwrap_or_else(|| panic!("{message}"));
    assert!(then.starts_with("centrical: ") && then.contains("m01.csv, mounting 1: "), "{message}");
}

/// The result of another unit is not written over, and neither is a file that is no result.
#[test]
fn a_result_of_another_unit_stays() {
    let copy = Copy::new();
    assert!([(); 2].iter().all(|()| copy.calibrate(&["--out", "."]).status.code() == Some(0)), "its own is replaced");
    let result = copy.out().join("result.json");
    copy.edit("experiment.toml", |text| text.replacen("serial = \"0001\"", "serial = \"0002\"", 1));
    let (session, record) = (copy.session(), copy.session().join("records/m01.csv"));
    let (session, record) = (session.to_str().unwrap(), record.to_str().unwrap());
    let found = "result.json: found the result of unit \"TA-200\" \"0001\", ";
    for found in [found, "result.json: found a file that is no result of this program, "] {
        let before = fs::read(&result).unwrap();
        for command in [
            &["watch", session, "--quiet", "0", "--once"][..],
            &["calibrate", session],
            &["calibrate", session, "--out", "."],
            &["tumble", record, "--serial", "0002", "--out", "."],
        ] {
            let run = copy.run(command);
            let message = String::from_utf8(run.stderr).unwrap();
            assert_eq!(run.status.code(), Some(2), "{command:?}: {message}");
            assert!(message.contains(found), "{command:?}: {message}");
            assert!(fs::read(&result).unwrap() == before, "{command:?}");
        }
        fs::write(&result, "{}").unwrap();
    }
}

/// Records that come piece by piece, lines in part; Ctrl-C in the middle, and the same command again: the end is the same as
/// without.
#[test]
fn a_growing_session_is_followed_over_a_stop() {
    let copy = Copy::new();
    let records = copy.session().join("records");
    fs::remove_dir_all(&records).unwrap();
    fs::create_dir(&records).unwrap();
    let mut watch = start(&copy);
    let first = fs::read(example().join("records/m01.csv")).unwrap();
    // No whole lines, and not all of them at once.
    for piece in first.chunks(first.len() / 7 + 1) {
        append(&records.join("m01.csv"), piece);
        thread::sleep(Duration::from_millis(100));
    }
    // Written again with the same bytes, and gone for a moment: it is the same experiment file.
    let experiment = copy.session().join("experiment.toml");
    let aside = experiment.with_extension("aside");
    fs::copy(&experiment, &aside).unwrap();
    fs::remove_file(&experiment).unwrap();
    thread::sleep(Duration::from_millis(200));
    fs::rename(&aside, &experiment).unwrap();
    until("a plateau of the first mounting", || history(&copy.out()).len() >= 3);
    thread::sleep(Duration::from_millis(200));
    interrupt(&watch);
    assert_eq!(watch.wait().unwrap().code(), Some(0));
    let come = history(&copy.out()).len();
    assert!((3..9).contains(&come), "{come}: the last plateau has not ended yet");
    assert!(!copy.out().join("result.json").exists());

    let mut watch = start(&copy);
    for number in 2..=12 {
        let name = format!("m{number:02}.csv");
        // As a logger does that shows whole files only.
        fs::copy(example().join("records").join(&name), records.join("coming")).unwrap();
        fs::rename(records.join("coming"), records.join(&name)).unwrap();
    }
    until("the calibration", || watch.try_wait().unwrap().is_some());
    assert_eq!(watch.wait().unwrap().code(), Some(0));
    let numbers: Vec<u64> = history(&copy.out()).iter().map(|line| line["plateau"].as_u64().unwrap()).collect();
    assert_eq!(numbers, (1..=108).collect::<Vec<_>>());
    let watched = fs::read(copy.out().join("result.json")).unwrap();
    assert_eq!(copy.calibrate(&["--method", "recursive"]).status.code(), Some(0));
    assert!(watched == fs::read(copy.out().join("result.json")).unwrap());
}

/// A plateau that is off is said at once, held out if asked for, and then the calibration is the one without it.
#[test]
fn a_plateau_that_does_not_fit_is_held_out() {
    let copy = Copy::new();
    // All readings of the fifth mounting's last rest plateau 20 mg off.
    copy.edit("records/m05.csv", |text| disturbed(&text));
    let session = copy.session();
    let run = copy.run(&["watch", session.to_str().unwrap(), "--quiet", "0", "--once", "--hold-out-alarms"]);
    let text = String::from_utf8(run.stdout).unwrap();
    let alarms: Vec<Value> = history(&copy.out()).into_iter().filter(|line| line["alarm"] == true).collect();
    let named: Vec<u64> = alarms.iter().map(|line| line["set_point"].as_u64().unwrap()).collect();
    assert_eq!(named, [44], "{text}{}", String::from_utf8_lossy(&run.stderr));
    assert!(text.contains("5:9, rest at 180 deg") && text.contains("DOES NOT FIT, held out"), "{text}");
    let watched = fs::read(copy.out().join("result.json")).unwrap();
    copy.calibrate(&["--method", "recursive", "--hold-out", "5:9"]);
    assert!(watched == fs::read(copy.out().join("result.json")).unwrap());
}

/// The first plateau has its line in the history, although nothing is known without it.
#[test]
fn the_first_plateau_can_be_held_out() {
    let copy = averaged();
    let run = copy.run(&["watch", copy.session().to_str().unwrap(), "--quiet", "0", "--once", "--hold-out", "1:1"]);
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    let history = history(&copy.out());
    let numbers: Vec<u64> = history.iter().map(|line| line["plateau"].as_u64().unwrap()).collect();
    assert_eq!(numbers, (1..=108).collect::<Vec<_>>());
    assert!(history[0]["held_out"] == true && history[0]["rank"] == 0 && history[1]["rank"] == 3, "{}", history[0]);
}

/// A plateau that is off before much is known makes good ones raise alarms. The result holds out the one that all plateaus single out.
#[test]
fn alarms_by_an_early_plateau_that_is_off_are_traced_to_it() {
    let copy = averaged();
    copy.edit("plateaus.csv", |text| shifted(&text, 10));
    let session = copy.session();
    let run = copy.run(&["watch", session.to_str().unwrap(), "--quiet", "0", "--once", "--hold-out-alarms"]);
    let text = [run.stdout, run.stderr].map(|part| String::from_utf8(part).unwrap()).concat();
    assert!(
        text.contains("plateaus raised an alarm while the session ran; of all plateaus together 2:2 stands out"),
        "{text}"
    );
    assert!(text.contains("1 plateau held out of the fit: 2:2"), "{text}");
    assert!(history(&copy.out()).iter().filter(|line| line["held_out"] == true).count() > 1);
    let watched = fs::read(copy.out().join("result.json")).unwrap();
    copy.calibrate(&["--method", "recursive", "--hold-out", "2:2"]);
    assert!(watched == fs::read(copy.out().join("result.json")).unwrap());
}

/// A watch begins anew where what was taken up reads otherwise now.
#[test]
fn a_plateau_that_was_corrected_is_noticed() {
    let copy = averaged();
    let session = copy.session();
    let arguments = ["watch", session.to_str().unwrap(), "--quiet", "0", "--once"];
    let said = |run: Output| [run.stdout, run.stderr].map(|part| String::from_utf8(part).unwrap()).concat();
    assert!(!said(copy.run(&arguments)).contains("otherwise than before"));
    let sound = fs::read(copy.out().join("watch-history.jsonl")).unwrap();
    assert!(!said(copy.run(&arguments)).contains("otherwise than before"));
    let table = fs::read_to_string(session.join("plateaus.csv")).unwrap();
    copy.edit("plateaus.csv", |text| shifted(&text, 10));
    let text = said(copy.run(&arguments));
    assert!(text.contains("plateau 2:2 reads otherwise than before; the watch begins anew"), "{text}");
    assert!(sound != fs::read(copy.out().join("watch-history.jsonl")).unwrap() && lines(&copy.out()) == 108);
    fs::write(session.join("plateaus.csv"), table).unwrap();
    copy.run(&arguments);
    assert!(sound == fs::read(copy.out().join("watch-history.jsonl")).unwrap());
}

/// A mounting is repeated, and its new record replaces the old one while the watch is at the next: the alarms go.
#[test]
fn a_mounting_that_is_repeated_is_taken_up_anew() {
    let copy = Copy::new();
    let records = copy.session().join("records");
    fs::remove_dir_all(&records).unwrap();
    fs::create_dir(&records).unwrap();
    let mut watch = start(&copy);
    let come = |number: usize, change: fn(f64) -> f64| {
        let name = format!("m{number:02}.csv");
        let text = fs::read_to_string(example().join("records").join(&name)).unwrap();
        let row = |line: &str| {
            let cells: Vec<&str> = line.splitn(3, ',').collect();
            cells[1].parse().map_or(line.to_owned(), |f1| format!("{},{},{}", cells[0], change(f1), cells[2]))
        };
        let text: String = text.lines().map(|line| row(line) + "\n").collect();
        fs::write(records.join("coming"), text).unwrap();
        fs::rename(records.join("coming"), records.join(&name)).unwrap();
    };
    let alarms = || history(&copy.out()).iter().filter(|line| line["alarm"] == true).count();
    (1..=3).for_each(|number| come(number, |f1| f1));
    come(4, |f1| if f1.abs() > 60.0 { f1 + 0.3 } else { f1 });
    (5..=8).for_each(|number| come(number, |f1| f1));
    until("eight mountings", || lines(&copy.out()) >= 70);
    assert!(alarms() > 0);
    come(4, |f1| f1);
    until("the repeated mounting", || lines(&copy.out()) >= 70 && alarms() == 0);
    (9..=12).for_each(|number| come(number, |f1| f1));
    until("the calibration", || watch.try_wait().unwrap().is_some());
    assert_eq!((watch.wait().unwrap().code(), alarms(), lines(&copy.out())), (Some(0), 0, 108));
}

/// The table of plateaus with the row `row`, from 0, off by 20 mm/s^2.
fn shifted(table: &str, row: usize) -> String {
    let moved = |(n, line): (usize, &str)| {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        for (cell, off) in cells[3..6].iter_mut().zip([0.02, 0.014, 0.02]).filter(|_| n == row + 1) {
            *cell = (cell.parse::<f64>().unwrap() + off).to_string();
        }
        cells.join(",") + "\n"
    };
    table.lines().enumerate().map(moved).collect()
}

/// An order that does not keep positions together is followed as well, and it is said what it costs.
#[test]
fn an_order_by_radius_is_told_its_cost() {
    let copy = Copy::new();
    copy.edit("experiment.toml", |text| {
        let (head, mountings) = text.split_once("[[mounting]]").unwrap();
        let mountings: Vec<&str> = mountings.split("[[mounting]]").collect();
        let ordered = (0..12).step_by(2).chain((1..12).step_by(2)).map(|n| format!("[[mounting]]{}\n", mountings[n]));
        head.to_owned() + &ordered.collect::<String>()
    });
    let run = copy.calibrate(&["--method", "recursive"]);
    assert_eq!(run.status.code(), Some(0));
    let told = String::from_utf8(run.stderr).unwrap();
    assert!(
        told.starts_with("49 states of 49 unknowns at a time\nThe order does not keep positions together"),
        "{told}"
    );
    assert!(told.contains("which costs 19 states; waiting at the fullest: delta_1[1]"), "{told}");
}

/// Adds 0.2 m/s^2 to the last 13 s of a record (rest and the end of the ramp down to it), all three readings.
pub fn disturbed(text: &str) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let time = |line: &str| line.split(',').next().and_then(|t| t.parse::<f64>().ok());
    let last = time(lines.last().unwrap()).unwrap();
    for line in &mut lines {
        if time(line).is_some_and(|t| t > last - 13.0) {
            let mut fields: Vec<f64> = line.split(',').map(|field| field.parse().unwrap()).collect();
            fields[1..].iter_mut().for_each(|f| *f += 0.2);
            *line = fields.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
        }
    }
    lines.join("\n") + "\n"
}

/// Killed without warning again and again, whatever it is doing, and started again: history, state and result end with
/// the bytes of a run that was never stopped.
#[test]
fn a_watch_killed_anywhere_ends_with_the_same_bytes() {
    let through = averaged();
    let run = through.run(&["watch", through.session().to_str().unwrap(), "--once"]);
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    // A fast machine is soon through: as many passes as it takes to be killed 30 times.
    let mut kills = 0;
    while kills < 30 {
        let stopped = averaged();
        let kills_before = kills;
        while !killed_after_a_plateau(&stopped, Duration::from_micros(700 * (kills % 17))) {
            kills += 1;
            assert!(kills < 1000, "no end in sight");
        }
        assert!(kills > kills_before, "the watch ended before it could be killed");
        for name in ["watch-history.jsonl", "watch.json", "result.json", "watch-history.svg"] {
            let [a, b] = [&through, &stopped].map(|copy| fs::read(copy.out().join(name)).unwrap());
            assert!(a == b, "{name}");
        }
    }
}

/// What is stated in `[uncertainty]` is among the unknowns of a watch: it goes on from its own state.
#[test]
fn a_watch_with_stated_uncertainties_resumes() {
    let copy = averaged();
    copy.edit("experiment.toml", |text| format!("{text}\n[uncertainty]\ngravity = \"1e-5 m/s^2\"\n"));
    let arguments = ["watch", copy.session().to_str().unwrap(), "--once"].map(str::to_owned);
    let state = || fs::read(copy.out().join("watch.json")).unwrap();
    let run = || copy.run(&arguments.each_ref().map(String::as_str)).status.code();
    assert_eq!(run(), Some(0));
    let before = state();
    assert_eq!(run(), Some(0));
    assert!(before == state() && lines(&copy.out()) == 108);
}

/// Starts a watch and kills it when it has written a plateau more, and `later`; whether it had ended by then.
fn killed_after_a_plateau(copy: &Copy, later: Duration) -> bool {
    let before = lines(&copy.out());
    let mut command = program::centrical();
    command.args(["watch", copy.session().to_str().unwrap(), "--once"]).current_dir(copy.out());
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    until("a plateau", || lines(&copy.out()) > before || child.try_wait().unwrap().is_some());
    thread::sleep(later);
    let _ = child.kill();
    child.wait().unwrap().code() == Some(0)
}

/// The example already averaged: its start takes no time.
fn averaged() -> Copy {
    let copy = Copy::new();
    let result: Value = serde_json::from_slice(&copy.calibrate(&["--json"]).stdout).unwrap();
    let mut table =
        String::from("mounting,speed,angle,mean_1,mean_2,mean_3,cov_11,cov_12,cov_13,cov_22,cov_23,cov_33,samples\n");
    for plateau in result["plateaus"].as_array().unwrap() {
        let c = &plateau["covariance"];
        let angle = if plateau["angle"].is_null() { String::new() } else { plateau["angle"].to_string() };
        let cells = [&plateau["mean"][0], &plateau["mean"][1], &plateau["mean"][2]];
        let of_covariance = [&c[0][0], &c[0][1], &c[0][2], &c[1][1], &c[1][2], &c[2][2]];
        let numbers: Vec<String> = cells.into_iter().chain(of_covariance).map(Value::to_string).collect();
        let (mounting, speed, samples) = (&plateau["mounting"], &plateau["speed"], &plateau["samples"]);
        let _ = writeln!(table, "{mounting},{speed},{angle},{},{samples}", numbers.join(","));
    }
    fs::write(copy.session().join("plateaus.csv"), table).unwrap();
    copy.edit("experiment.toml", |text| format!("plateaus = \"plateaus.csv\"\n{text}"));
    copy
}

/// Lines of the history that are whole.
fn lines(out: &Path) -> usize {
    fs::read_to_string(out.join("watch-history.jsonl")).unwrap_or_default().matches('\n').count()
}

fn start(copy: &Copy) -> Child {
    let mut command = program::centrical();
    command.arg("watch").arg(copy.session()).args(["--interval", "0.05", "--quiet", "2"]);
    command.current_dir(copy.out()).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
}

fn interrupt(child: &Child) {
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
}

fn append(file: &Path, bytes: &[u8]) {
    OpenOptions::new().create(true).append(true).open(file).unwrap().write_all(bytes).unwrap();
}

fn until(what: &str, mut done: impl FnMut() -> bool) {
    let start = Instant::now();
    while !done() {
        assert!(start.elapsed() < PATIENCE, "waited for {what} in vain");
        thread::sleep(Duration::from_millis(1));
    }
}

fn history(out: &Path) -> Vec<Value> {
    let text = fs::read_to_string(out.join("watch-history.jsonl")).unwrap_or_default();
    text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect()
}
