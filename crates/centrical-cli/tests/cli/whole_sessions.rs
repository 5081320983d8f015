//! A plant as whole sessions: simulated records of units that scatter between sessions, one that drifts, and a machine whose tilt grows, through
//! `series` and `history`.

use std::fs;
use std::path::Path;
use std::process::Output;

use serde_json::Value;
use tempfile::TempDir;

use crate::program::centrical;
use crate::random::Random;
use crate::session::example;

const UNITS: usize = 5;
const SESSIONS: usize = 4;

/// Standard deviation of the bias of newtonometer 1 between sessions [m/s^2]: five times what a session states.
const BETWEEN: f64 = 1e-4;

/// The unit whose scale error of newtonometer 1 drifts, and how much in a year: ten times what a session states.
const DRIFTING: (usize, f64) = (3, 3e-5);

/// How much the tilt grows in a year [rad]: four times what a session states.
const TILTING: f64 = 5e-6;

fn run(folder: &Path, arguments: &[&str]) -> Output {
    centrical().args(arguments).current_dir(folder).output().unwrap()
}

/// The sessions of a plant in a folder, by their names.
fn sessions(folder: &Path) -> Vec<String> {
    let plan = fs::read_to_string(example().join("experiment.toml")).unwrap();
    let mut random = Random::new(1);
    let mut names = Vec::new();
    for unit in 0..UNITS {
        let own = [1e-2, 1e-3].map(|size| size * random.normal());
        for session in 0..SESSIONS {
            let years = session as f64 + unit as f64 / 10.0;
            let drift = if unit == DRIFTING.0 { DRIFTING.1 * years } else { 0.0 };
            let truth = format!(
                "typical = {{ size = 1.0, seed = {unit} }}\n[parameters]\nalpha_1 = {}\ndf_1 = {}\nG0_11 = {}\n\
                 [machine]\nplateau_spread = \"1 s\"\nsettling = 1e-3\n[sensor]\nwhite = \"0.2 mg\"\n",
                3e-4 + TILTING * years,
                own[0] + BETWEEN * random.normal(),
                own[1] + drift
            );
            let place = folder.join(format!("plan-{unit}-{session}"));
            fs::create_dir(&place).unwrap();
            let text = plan.replace("serial = \"0001\"", &format!("serial = \"{unit:04}\""));
            let text = text.replace("date = 2026-10-05", &format!("date = {}-0{}-05", 2021 + session, 1 + unit));
            let text = text.replace("rotation = \"+3\"", "rotation = \"+3\"\nstation = \"north\"");
            fs::write(place.join("experiment.toml"), text).unwrap();
            fs::write(place.join("truth.toml"), truth).unwrap();
            let (name, seed) = (format!("session-{unit}-{session}"), (100 * unit + session).to_string());
            let plan = place.join("experiment.toml");
            let made = centrical()
                .arg("simulate")
                .args([&plan, Path::new("--truth"), &place.join("truth.toml")])
                .args(["--seed", &seed, "--out", &name, "-q"])
                .current_dir(folder)
                .output()
                .unwrap();
            assert!(made.status.success(), "{made:?}");
            names.push(name);
        }
    }
    names
}

fn history(folder: &Path, arguments: &[&str]) -> Value {
    let output = run(folder, &[&["history"], arguments, &["--json"]].concat());
    serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{output:?}"))
}

/// Names of the parameters that have a mark.
fn marked<'a>(report: &'a Value, mark: &str) -> Vec<&'a str> {
    let parameters = report["parameters"].as_array().unwrap().iter();
    parameters.filter(|p| p[mark] == true).map(|p| p["name"].as_str().unwrap()).collect()
}

fn interval(report: &Value, parameter: &str, key: &str) -> [f64; 2] {
    let found = report["parameters"].as_array().unwrap().iter().find(|p| p["name"] == parameter).unwrap();
    [0, 1].map(|end| found[key][end].as_f64().unwrap())
}

#[test]
fn a_plant_of_whole_sessions_shows_what_was_planted() {
    let folder = TempDir::new().unwrap();
    let folder = folder.path();
    let names = sessions(folder);
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let made = run(folder, &[&["series", "--out", "store", "--rows-only", "--json"], names.as_slice()].concat());
    let said: Value = serde_json::from_slice(&made.stdout).unwrap();
    assert_eq!((said["sessions"].as_u64(), said["failed"].as_u64()), (Some(20), Some(0)), "{said}");
    // One good session in ten thousand has an objection.
    assert_eq!(made.status.code(), Some(0), "{said}");

    let station = history(folder, &["station", "store"]);
    assert_eq!(marked(&station, "changes"), ["alpha_1"]);
    let units = history(folder, &["units", "store"]);
    let findings: Vec<(&str, &str, &str)> = units["findings"].as_array().unwrap().iter().map(finding).collect();
    assert_eq!(findings, [("0003", "G0_11", "drifts")]);
    for unit in 0..UNITS {
        let serial = format!("{unit:04}");
        let report = history(folder, &["unit", "store", "--serial", &serial, "--together"]);
        let drifting: &[&str] = if unit == DRIFTING.0 { &["G0_11"] } else { &[] };
        assert_eq!(marked(&report, "drifts"), drifting, "{serial}");
        assert_eq!(marked(&report, "scatters"), ["df_1"], "{serial}");
        let [low, high] = interval(&report, "df_1", "between_interval");
        assert!(low < BETWEEN && BETWEEN < high, "{serial}: {low} {high}");
        if unit == DRIFTING.0 {
            let [low, high] = interval(&report, "G0_11", "slope_interval");
            assert!(low < DRIFTING.1 && DRIFTING.1 < high, "{low} {high}");
        }
    }
}

fn finding(finding: &Value) -> (&str, &str, &str) {
    let text = |key: &str| finding[key].as_str().unwrap();
    (text("unit_serial"), text("parameter"), text("kind"))
}
