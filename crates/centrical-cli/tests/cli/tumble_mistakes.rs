//! `centrical tumble` names the record, the columns and the option that are wrong.

use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;

use crate::session::Copy;

const RECORD: &str = "../../examples/tumble/record.csv";

/// The record of the examples with readings changed row by row, in the folder of output.
fn changed(copy: &Copy, name: &str, change: impl Fn([f64; 3]) -> [f64; 3]) -> String {
    let text = fs::read_to_string(PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(RECORD)).unwrap();
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let mut changed = format!("{}\n", lines.next().unwrap());
    for line in lines {
        let row: Vec<f64> = line.split(',').map(|number| number.parse().unwrap()).collect();
        let [x, y, z] = change([row[1], row[2], row[3]]);
        writeln!(changed, "{},{x},{y},{z}", row[0]).unwrap();
    }
    fs::write(copy.out().join(name), changed).unwrap();
    name.to_owned()
}

/// What is said beside the exit code 2.
#[track_caller]
fn refused(copy: &Copy, arguments: &[&str]) -> String {
    let output = copy.run(&[&["tumble"], arguments].concat());
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{message}");
    message
}

#[test]
fn the_record_in_another_unit_is_named() {
    let copy = Copy::new();
    let (good, in_g) = (changed(&copy, "a.csv", |f| f), changed(&copy, "b.csv", |f| f.map(|f| f / 9.80665)));
    for order in [[&good, &in_g], [&in_g, &good]] {
        let message = refused(&copy, &[order[0], order[1], "--gravity", "9.81523"]);
        assert!(message.contains("b.csv: found rests of 1.00"), "{message}");
        assert!(message.contains("--unit g would fit this record alone"), "{message}");
    }
}

/// A date that histories could not sort by is refused before the records are read.
#[test]
fn a_text_that_is_no_day_is_refused() {
    let message = refused(&Copy::new(), &["none.csv", "--date", "31.12.2025"]);
    assert!(message.contains("found \"31.12.2025\", expected a day such as 2026-10-05"), "{message}");
}

/// One newtonometer alone: no other unit fits the record, and its file is the one that is there.
#[test]
fn a_column_in_another_unit_is_refused_in_its_record() {
    let copy = Copy::new();
    let record = changed(&copy, "a.csv", |[x, y, z]| [x / 9.80665, y, z]);
    let message = refused(&copy, &[&record, "--out", "out"]);
    assert!(message.starts_with("centrical: a.csv: found readings of 0.10"), "{message}");
    assert!(message.contains("(G0_11 = -0.89") && message.contains("), as if in g, expected 0.7 to 1.3"), "{message}");
}

#[test]
fn equal_columns_are_named() {
    let copy = Copy::new();
    let record = changed(&copy, "a.csv", |[x, _, z]| [x, x, z]);
    let message = refused(&copy, &[&record, "--gravity", "9.81523"]);
    assert!(message.contains("a.csv: found the same readings in columns f1 and f2 in all "), "{message}");
    // The same of a record on an arm.
    copy.edit("records/m03.csv", |text| {
        let row = |line: &str| {
            let fields: Vec<&str> = line.split(',').collect();
            format!("{},{},{},{}\n", fields[0], fields[1], fields[2], fields[1])
        };
        let (header, rows) = text.split_once('\n').unwrap();
        format!("{header}\n{}", rows.lines().map(row).collect::<String>())
    });
    let output = copy.calibrate(&[]);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("m03.csv: found the same readings in columns f1 and f3"), "{message}");
}

#[test]
fn gravity_is_that_of_the_earth() {
    let copy = Copy::new();
    for gravity in ["98", "0", "9.6 m/s^2"] {
        let message = refused(&copy, &[RECORD, "--gravity", gravity]);
        assert!(message.contains("expected gravity on Earth, 9.7 to 9.9 m/s^2"), "{message}");
    }
    copy.edit("experiment.toml", |text| text.replace("\"9.81523 m/s^2\"", "\"98 m/s^2\""));
    let output = copy.calibrate(&[]);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("found \"98 m/s^2\", expected gravity on Earth"), "{message}");
}

#[test]
fn rests_without_noise_are_said_to_have_none() {
    let copy = Copy::new();
    // Twelve rests of 4 s without noise, a second of turning between them.
    let place = |rest: usize| {
        let (height, angle) = (1.0 - (2.0 * rest as f64 + 1.0) / 12.0, 2.4 * rest as f64);
        let around = (1.0 - height * height).sqrt();
        [around * angle.cos(), around * angle.sin(), height].map(|part| 9.81523 * part)
    };
    let mut text = "t,f1,f2,f3\n".to_owned();
    for k in 0..12 * 500 {
        let (rest, turned) = (k / 500, ((k % 500) as f64 / 100.0 - 4.0).max(0.0));
        let [x, y, z] = [0, 1, 2].map(|j| place(rest)[j] + turned * (place((rest + 1) % 12)[j] - place(rest)[j]));
        writeln!(text, "{:.2},{x:.6},{y:.6},{z:.6}", k as f64 / 100.0).unwrap();
    }
    let record = "a.csv";
    fs::write(copy.out().join(record), text).unwrap();
    let message = refused(&copy, &[record, "--gravity", "9.81523"]);
    assert!(message.contains("a.csv: found the same three readings in "), "{message}");
}

#[test]
fn a_rate_beside_a_time_is_remarked() {
    let copy = Copy::new();
    let record = changed(&copy, "a.csv", |f| f);
    let output = copy.run(&["tumble", &record, "--gravity", "9.81523", "--rate", "100 Hz"]);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(message.contains("a.csv: the time in column t is not used, --rate is"), "{message}");
    let message = refused(&copy, &[&record, "--rate", "100 Hz", "--time", "t"]);
    assert!(message.contains("cannot be used with"), "{message}");
}
