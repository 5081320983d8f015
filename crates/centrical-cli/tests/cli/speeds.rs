//! Telemetry that contradicts the schedule, and speeds that are measured.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Output;

use serde_json::Value;

use crate::program;
use crate::session::{Copy, example};

/// The telemetry of a mounting with its columns changed.
fn change(copy: &Copy, mounting: usize, to: impl Fn(f64, f64) -> (f64, f64)) {
    copy.edit(&format!("telemetry/m{mounting:02}.csv"), |text| {
        let mut lines = text.lines();
        let mut changed = format!("{}\n", lines.next().unwrap());
        for line in lines {
            let (t, omega) = line.split_once(',').unwrap();
            let (t, omega) = to(t.parse().unwrap(), omega.parse().unwrap());
            writeln!(changed, "{t:.6},{omega:.6}").unwrap();
        }
        changed
    });
}

fn said(run: &Output, code: i32) -> String {
    let text = String::from_utf8_lossy(&run.stdout).into_owned();
    assert_eq!(run.status.code(), Some(code), "{text}\n{}", String::from_utf8_lossy(&run.stderr));
    text
}

fn refused(copy: &Copy, parts: &[&str]) {
    let text = said(&copy.calibrate(&[]), 1);
    let verdict: Vec<&str> = text.lines().take_while(|line| line.starts_with("NOT ACCEPTABLE")).collect();
    assert_eq!(verdict.len(), 1, "{text}");
    for part in parts {
        assert!(verdict[0].contains(part), "{part:?} is not in {}", verdict[0]);
    }
}

#[test]
fn speeds_that_contradict_the_schedule_are_refused() {
    for (scale, parts) in [
        (1.001, ["(mean +0.10 %", "in all 84 plateaus: a wrong unit, a wrong set-point, or a tachometer's scale"]),
        (1.02, ["(mean +2.00 %", "in all 84 plateaus: a wrong unit, a wrong set-point, or a tachometer's scale"]),
        (60.0 / TAU, ["telemetry says ", "in all 84 plateaus: speeds in rpm are read in rad/s"]),
        (360.0 / TAU, ["telemetry says ", "in all 84 plateaus: speeds in deg/s are read in rad/s"]),
    ] {
        let copy = Copy::new();
        (1..=12).for_each(|m| change(&copy, m, |t, omega| (t, scale * omega)));
        refused(&copy, &parts);
    }
    let copy = Copy::new();
    change(&copy, 4, |t, omega| (t, 1.001 * omega));
    refused(&copy, &["in all 7 plateaus of mounting 4", "the record follows the schedule"]);
}

#[test]
fn telemetry_of_another_record_is_refused_and_a_part_of_it_reported() {
    let copy = Copy::new();
    fs::copy(example().join("telemetry/m05.csv"), copy.session().join("telemetry/m02.csv")).unwrap();
    refused(&copy, &["telemetry of mounting 2 has", "of the 8 ramps", "that of another mounting"]);
    let copy = Copy::new();
    (1..=12).for_each(|m| change(&copy, m, |t, omega| (10.0 * t, omega)));
    refused(&copy, &["runs 10 times as fast", "a wrong sampling rate"]);
    let copy = Copy::new();
    copy.edit("telemetry/m03.csv", |text| text[..text.len() / 2].rsplit_once('\n').unwrap().0.to_owned() + "\n");
    let text = said(&copy.calibrate(&[]), 0);
    assert!(text.contains("telemetry of mounting 3 covers") && text.contains("3 plateaus without a speed"), "{text}");
}

/// The example without a word about speeds says nothing of them, and a tachometer whose scale is stated may be off by it.
#[test]
fn what_is_stated_of_a_tachometer_is_no_contradiction() {
    let text = said(&Copy::new().calibrate(&[]), 0);
    assert!(!text.contains("SPEED"), "{text}");
    let copy = Copy::new();
    (1..=12).for_each(|m| change(&copy, m, |t, omega| (t, 1.001 * omega)));
    copy.edit("experiment.toml", |text| {
        text.replace("rotation = \"+3\"", "rotation = \"+3\"\ntachometer_uncertainty = \"0.1 %\"")
    });
    let text = said(&copy.calibrate(&[]), 0);
    assert!(!text.contains("SPEED"), "{text}");
}

/// Records that count samples do not make the telemetry count them: it has a time of its own.
#[test]
fn a_sampling_rate_of_records_is_not_that_of_the_telemetry() {
    let copy = Copy::new();
    copy.edit("experiment.toml", |text| text.replace("time = \"t\"", "time = { rate = \"100 Hz\" }"));
    let text = said(&copy.calibrate(&["--json"]), 0);
    let result: Value = serde_json::from_str(&text).unwrap();
    assert!(result["speeds"].is_null(), "{}", result["speeds"]);
    let offset = |m: usize| result["mountings"][m]["clock_offset"].as_f64();
    assert!((0..12).all(|m| offset(m).is_some_and(|offset| offset.abs() < 2.0)));
}

const TRUTH: &str = r#"
typical = { size = 1.0, seed = 4 }
[machine]
plateau_spread = "1 s"
settling = 1e-3
[sensor]
white = "0.2 mg"
[tachometer]
clock_offset = "1 s"
noise = "1e-3 rad/s"
[counter]
jitter = "3 us"
"#;

fn run(arguments: &[&str], folder: &Path) -> Output {
    program::centrical().args(arguments).current_dir(folder).output().unwrap()
}

/// The example as a plan whose speeds are measured `from` something, simulated.
fn simulated(from: &str, folder: &Path) {
    let text = fs::read_to_string(example().join("experiment.toml")).unwrap();
    let measured =
        format!("rotation = \"+3\"\nmeasured = {{ from = \"{from}\", uncertainty = \"1 ppm\", scale = \"1 ppm\" }}");
    let lines = text.replacen("rotation = \"+3\"", &measured, 1);
    let is_kept = |line: &&str| !line.starts_with("record =") && !line.starts_with("telemetry =");
    let plan: Vec<&str> = lines.lines().filter(is_kept).collect();
    fs::write(folder.join("plan.toml"), plan.join("\n")).unwrap();
    fs::write(folder.join("truth.toml"), TRUTH).unwrap();
    said(&run(&["simulate", "plan.toml", "--truth", "truth.toml", "--seed", "3", "--out", "session"], folder), 0);
}

/// From pulses to speeds known to 1 ppm: the result says so, and the uncertainties are those of speeds to 1 ppm. Reduced, the
/// session gives the same numbers.
#[test]
fn speeds_by_pulses_are_used_and_kept() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    simulated("pulses", at);
    let calibrate = |session: &str| -> Value {
        serde_json::from_str(&said(&run(&["calibrate", session, "--json"], at), 0)).unwrap()
    };
    let result = calibrate("session");
    let truth: Value = serde_json::from_str(&fs::read_to_string(at.join("session/truth.json")).unwrap()).unwrap();
    assert_eq!((&result["speeds"]["measured_by"], &result["speeds"]["measured"]), (&"pulses".into(), &84.into()));
    let mut square = 0.0;
    for (found, of_truth) in result["plateaus"].as_array().unwrap().iter().zip(truth["plateaus"].as_array().unwrap()) {
        let speed = of_truth["speed"].as_f64().unwrap();
        if speed != 0.0 {
            let u = found["speed_uncertainty"].as_f64().unwrap();
            assert!((1e-6..1.5e-6).contains(&u), "{found}");
            square += ((found["speed"].as_f64().unwrap() / speed - 1.0) / u).powi(2) / 84.0;
            assert_ne!(found["speed"], found["set_speed"]);
        }
    }
    // sqrt(2 / 84) = 0.15; four of them.
    assert!((square - 1.0).abs() < 0.6, "{square}");
    let squared: f64 = result["parameters"]
        .as_array()
        .unwrap()
        .iter()
        .zip(truth["parameters"].as_array().unwrap())
        .map(|(p, t)| {
            ((p["value"].as_f64().unwrap() - t["value"].as_f64().unwrap())
                / p["standard_uncertainty"].as_f64().unwrap())
            .powi(2)
        })
        .sum();
    assert!(squared / 49.0 < 4.0, "{squared}");
    said(&run(&["reduce", "session", "--out", "reduced"], at), 0);
    let reduced = calibrate("reduced");
    assert_eq!(reduced["parameters"], result["parameters"]);
    assert_eq!(reduced["speeds"]["measured_by"], "plateaus");
    assert!(
        said(&run(&["calibrate", "session", "--out", "out"], at), 0)
            .contains("SPEED   measured by a counter of revolutions on 84 of 84")
    );
}

/// Following a session takes measured speeds up as they come, and ends with the calibration's numbers.
#[test]
fn speeds_by_telemetry_are_followed() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    simulated("telemetry", at);
    let watch = run(&["watch", "session", "--out", "watched", "--quiet", "0", "--once"], at);
    let text = said(&watch, 0);
    assert!(!text.contains("ALARM"), "{text}");
    for command in ["observe", "assess"] {
        said(&run(&[command, "session"], at), 0);
    }
    said(&run(&["montecarlo", "session", "--runs", "20"], at), 0);
    said(&run(&["observe", "plan.toml"], at), 0);
}
