//! `centrical init` on the files of the example: what it asks for, and that the filled draft calibrates to the same numbers.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::session::Copy;

/// The example's own values of what no file shows, by the start of the line that asks for them.
const FILLED: [(&str, &str); 5] = [
    ("latitude = \"?\"", "latitude = \"55.7 deg\""),
    ("gravity = \"?\"", "gravity = \"9.81523 m/s^2\""),
    ("serial = \"?\"", "serial = \"0001\""),
    (
        "proof_masses = [[0, 0, 0], [\"?\", \"?\", \"?\"], [\"?\", \"?\", \"?\"]]",
        "proof_masses = [[0, 0, 0], [0.0210, 0.0120, 0.0105], [0.0150, -0.0100, -0.0140]]",
    ),
    ("speed_uncertainty = \"?\"", "speed_uncertainty = 1e-5"),
];

fn drafted(copy: &Copy) -> String {
    fs::rename(copy.session().join("experiment.toml"), copy.session().join("own.toml")).unwrap();
    let draft = copy.session().join("experiment.toml");
    let output = copy.run(&["init", copy.session().to_str().unwrap(), "--out", draft.to_str().unwrap()]);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    said
}

fn parameters(result: &Value) -> Vec<(String, f64, f64)> {
    let row = |p: &Value| {
        (
            p["name"].as_str().unwrap().to_owned(),
            p["value"].as_f64().unwrap(),
            p["standard_uncertainty"].as_f64().unwrap(),
        )
    };
    result["parameters"].as_array().unwrap().iter().map(row).collect()
}

#[test]
fn a_filled_draft_calibrates_to_the_same_numbers() {
    let copy = Copy::new();
    assert_eq!(copy.calibrate(&[]).status.code(), Some(0));
    let expected = parameters(&serde_json::from_slice(&fs::read(copy.out().join("result.json")).unwrap()).unwrap());
    fs::remove_file(copy.out().join("result.json")).unwrap();

    let said = drafted(&copy);
    let asked = said.lines().filter(|line| line.trim_start().starts_with("line ")).count();
    assert!((1..=10).contains(&asked), "{said}");

    // Left as it is, the draft is refused by the first question.
    let refused = copy.calibrate(&[]);
    let message = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(2));
    assert!(message.contains("found \"?\", expected"), "{message}");

    copy.edit("experiment.toml", |mut text| {
        for (question, answer) in FILLED {
            assert!(text.contains(question), "{question}");
            text = text.replace(question, answer);
        }
        text.replacen("angle = \"?\"", "angle = \"0 deg\"", 1).replacen("angle = \"?\"", "angle = \"180 deg\"", 1)
    });
    let output = copy.calibrate(&[]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let found = parameters(&serde_json::from_slice(&fs::read(copy.out().join("result.json")).unwrap()).unwrap());
    assert_eq!(expected.len(), found.len());
    for ((name, value, u), (other, again, _)) in expected.iter().zip(&found) {
        assert_eq!(name, other);
        assert!((value - again).abs() <= 1e-6 * u, "{name}: {value} and {again}, u {u}");
    }

    // With the lines that the draft has as comments nothing counts as exact.
    copy.edit("experiment.toml", |text| {
        let (before, stated) = text.split_once("# [uncertainty]\n").unwrap();
        let (lines, after) = stated.split_once("\n\n").unwrap();
        assert_eq!(lines.matches("# ").count(), 8, "{lines}");
        format!("{before}[uncertainty]\n{}\n\n{after}", lines.replace("# ", ""))
    });
    let output = copy.calibrate(&[]);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        said.contains("no input quantity is treated as exact"),
        "{said}{}",
        String::from_utf8_lossy(&output.stderr)
    );
}

#[test]
fn a_draft_replaces_nothing_and_needs_a_record() {
    let copy = Copy::new();
    let session = copy.session();
    let own = session.join("experiment.toml");
    let output = copy.run(&["init", session.to_str().unwrap(), "--out", own.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("found a file that exists"));

    let output = copy.run(&["init", session.join("telemetry").to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(message.contains("found no record, expected a table with a time and three readings"), "{message}");
}

/// Without telemetry the levels of the readings are asked for their speed, and positions can be written out.
#[test]
fn records_alone_are_asked_for_speeds_and_positions() {
    let copy = Copy::new();
    let records = copy.session().join("records");
    let output = copy.run(&["init", records.to_str().unwrap(), "--positions", "six"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let draft = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(draft.matches("[[position]]").count(), 6);
    assert_eq!(draft.matches("speed = \"?\"").count(), 9 * draft.matches("plateaus = [").count(), "{draft}");
}

/// A tumble of the unit gives gravity, serial number and rests, and scale and bias where the records are in counts.
#[test]
fn a_tumble_of_the_unit_fills_lines_in() {
    let copy = Copy::new();
    let record = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/tumble/record.csv");
    let tumbled = |unit: &str, folder: &Path| {
        let (record, folder) = (record.to_str().unwrap(), folder.to_str().unwrap());
        let output =
            copy.run(&["tumble", record, "--gravity", "9.81523", "--unit", unit, "--serial", "0001", "--out", folder]);
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    };
    let folder = copy.session().join("tumbled");
    tumbled("m/s^2", &folder);
    let records = copy.session().join("records");
    let telemetry = copy.session().join("telemetry");
    let draft = |folder: &Path| {
        let inputs = [&records, &telemetry].map(|input| input.to_str().unwrap());
        copy.run(&["init", inputs[0], inputs[1], "--tumble", folder.to_str().unwrap()])
    };
    let output = draft(&folder);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    for line in [
        "gravity = \"9.81523 m/s^2\"  # GUESS",
        "serial = \"0001\"  # FOUND",
        "[[tumble]]\nrests = \"",
        "# bias_change = \"0 mg\"  #",
    ] {
        assert!(text.contains(line), "{line} in {text}");
    }
    let rests = text.lines().find(|line| line.starts_with("rests = ")).unwrap().split('"').nth(1).unwrap().to_owned();
    assert!(Path::new(&rests).is_file(), "{rests}");
    // The same readings as counts are another unit than that of the records.
    let counts = copy.session().join("counts");
    tumbled("counts", &counts);
    let output = draft(&counts);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2));
    assert!(
        message.contains("found readings in m/s^2, expected the unit of the tumble, which is another"),
        "{message}"
    );
    // A centrifuge session is not a tumble.
    let output = draft(&copy.session());
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        message.contains("found a session without rests, expected the folder of a result of centrical tumble"),
        "{message}"
    );
}
