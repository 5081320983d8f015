//! A plan and a truth in, a session out: calibrating it gives the truth back.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use nalgebra::{DMatrix, DVector};
use serde_json::Value;
use tempfile::TempDir;

use crate::program;
use crate::session::example;

/// A typical unit, and a laboratory with most of what can be wrong with one.
const TRUTH: &str = r#"
typical = { size = 1.0 }
[parameters]
alpha_1 = "0.3 mrad"
"dR_1[A]" = "-0.4 mm"
df_2 = "3 mg"
[machine]
plateau_spread = "1 s"
settling = 1e-3
[sensor]
white = "0.2 mg"
coloured = { deviation = "0.05 mg", time = "0.3 s" }
quantum = "1e-5 m/s^2"
[recorder]
spikes = { probability = 1e-4, size = "2 g" }
gaps = { probability = 1e-3, length = 2 }
repeats = 1e-4
[tachometer]
clock_offset = "2 s"
clock_drift = "10 ppm"
"#;

/// A folder with a truth file, the example for a plan.
struct Laboratory(TempDir);

impl Laboratory {
    fn new(truth: &str) -> Self {
        let folder = TempDir::new().unwrap();
        fs::write(folder.path().join("truth.toml"), truth).unwrap();
        Self(folder)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn simulate(&self, plan: &Path, out: &str, more: &[&str]) -> Output {
        let mut command = program::centrical();
        command.arg("simulate").arg(plan).arg("--truth").arg(self.path("truth.toml")).arg("--out").arg(self.path(out));
        command.args(more).output().unwrap()
    }

    fn refused(&self, plan: &Path, parts: &[&str]) {
        let run = self.simulate(plan, "out", &["--seed", "1"]);
        let message = String::from_utf8(run.stderr).unwrap();
        assert_eq!(run.status.code(), Some(2), "{message}");
        for part in parts {
            assert!(message.contains(part), "{part:?} is not in {message}");
        }
        assert!(!self.path("out").join("experiment.toml").exists());
    }
}

fn done(run: &Output) {
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
}

fn json(file: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap()
}

/// Squared error of the calibration weighted by its inverse covariance, every parameter estimable; the truth's windows
/// hold the windows used, but for what was lost of their ends.
fn squared_error(session: &Path) -> f64 {
    let run = program::centrical().args(["calibrate", "--json"]).arg(session).output().unwrap();
    done(&run);
    let (result, truth): (Value, _) = (serde_json::from_slice(&run.stdout).unwrap(), json(&session.join("truth.json")));
    let (found, truth_of) = (result["parameters"].as_array().unwrap(), truth["parameters"].as_array().unwrap());
    assert_eq!((found.len(), truth_of.len()), (49, 49));
    let uncertainty = |j: usize| found[j]["standard_uncertainty"].as_f64().unwrap();
    let error = DVector::from_fn(49, |j, _| {
        assert_eq!(found[j]["name"], truth_of[j]["name"]);
        (found[j]["value"].as_f64().unwrap() - truth_of[j]["value"].as_f64().unwrap()) / uncertainty(j)
    });
    let correlation = DMatrix::from_fn(49, 49, |i, j| {
        result["covariance"][i][j].as_f64().unwrap() / (uncertainty(i) * uncertainty(j))
    });
    for (used, plateau) in result["plateaus"].as_array().unwrap().iter().zip(truth["plateaus"].as_array().unwrap()) {
        assert_eq!((&used["mounting"], &used["index"]), (&plateau["mounting"], &plateau["index"]));
        let end = |of: &Value, n: usize| of["window"][n].as_f64().unwrap();
        assert!(end(used, 0) > end(plateau, 0) - 0.1 && end(used, 1) < end(plateau, 1) + 0.1, "{used} of {plateau}");
    }
    correlation.cholesky().unwrap().l().solve_lower_triangular(&error).unwrap().norm_squared()
}

/// The 99.9 % band of chi^2 with 49 degrees of freedom.
const FORTY_NINE: std::ops::Range<f64> = 20.0..86.0;

#[test]
fn calibrating_gives_the_truth_back() {
    let laboratory = Laboratory::new(TRUTH);
    for (seed, format) in [("1", "csv"), ("2", "parquet")] {
        done(&laboratory.simulate(&example(), format, &["--seed", seed, "--format", format]));
        let squared = squared_error(&laboratory.path(format));
        assert!(FORTY_NINE.contains(&squared), "{format}: weighted squared error {squared}");
    }
    let truth = json(&laboratory.path("csv").join("truth.json"));
    let value = |name: &str| {
        let parameters = truth["parameters"].as_array().unwrap();
        parameters.iter().find(|p| p["name"] == name).unwrap()["value"].as_f64().unwrap()
    };
    assert_eq!((value("alpha_1"), value("dR_1[A]"), value("df_2")), (3e-4, -4e-4, 3e-3 * 9.80665));
    assert_ne!(value("alpha_2"), 0.0, "what is not named is drawn");
}

/// Settling that is slow beside the plateau looks like noise, which would explain the settling of the next plateau as well: each
/// window ends with its plateau all the same.
#[test]
fn slow_settling_joins_no_plateaus() {
    let laboratory = Laboratory::new(
        r#"
typical = { size = 1.0 }
[machine]
plateau = "30 s"
plateau_spread = "5 s"
ramp = "8 s"
settling = 1e-3
settling_time = "4 s"
[sensor]
white = "0.2 mg"
[tachometer]
clock_offset = "2 s"
"#,
    );
    done(&laboratory.simulate(&example(), "slow", &["--seed", "1", "--format", "parquet"]));
    let squared = squared_error(&laboratory.path("slow"));
    assert!(FORTY_NINE.contains(&squared), "weighted squared error {squared}");
}

/// The same bytes from one thread and from two; other bytes from another seed.
#[test]
fn files_follow_from_the_seed() {
    let laboratory = Laboratory::new(TRUTH);
    for (out, seed, threads) in [("a", "5", "1"), ("b", "5", "2"), ("c", "6", "2")] {
        let mut command = program::centrical();
        command.env("RAYON_NUM_THREADS", threads).arg("simulate").arg(example()).args(["--seed", seed]);
        let run = command.arg("--truth").arg(laboratory.path("truth.toml")).arg("--out").arg(laboratory.path(out));
        done(&run.output().unwrap());
    }
    for file in ["experiment.toml", "truth.json", "records/m01.csv", "records/m12.csv", "telemetry/m07.csv"] {
        let read = |out: &str| fs::read(laboratory.path(out).join(file)).unwrap();
        assert_eq!(read("a"), read("b"), "{file}");
        assert!(file == "experiment.toml" || read("a") != read("c"), "{file}");
    }
}

/// A plan without records, mountings in one line each, raw output in whole counts, the other way round: the session
/// names its files, keeps the rest of the text, and is calibrated.
#[test]
fn a_plan_needs_no_records() {
    let laboratory = Laboratory::new(&TRUTH.replace("quantum = \"1e-5 m/s^2\"\n", ""));
    let plan = fs::read_to_string(example().join("experiment.toml")).unwrap();
    let keep = |line: &&str| !line.starts_with("record =") && !line.starts_with("telemetry =");
    let plan = plan.lines().filter(keep).collect::<Vec<&str>>().join("\n");
    let counts = "output_unit = \"counts\"\ncounts = { scale = [4e4, 4.1e4, 4.2e4], bias = [0, 100.5, -3] }";
    let plan = plan.replace("output_unit = \"m/s^2\"", counts).replace("rotation = \"+3\"", "rotation = \"-3\"");
    fs::write(laboratory.path("plan.toml"), &plan).unwrap();
    done(&laboratory.simulate(&laboratory.path("plan.toml"), "out", &["--seed", "3"]));
    let session = laboratory.path("out");
    let text = fs::read_to_string(session.join("experiment.toml")).unwrap();
    let named = |line: &&str| line.contains("records/m") || line.contains("telemetry/m");
    assert_eq!(text.lines().filter(named).count(), 24);
    assert_eq!(text.lines().filter(|line| !named(line)).collect::<Vec<_>>(), plan.lines().collect::<Vec<_>>());
    let record = fs::read_to_string(session.join("records/m01.csv")).unwrap();
    assert!(record.lines().skip(1).all(|line| line.split(',').skip(1).all(|count| count.parse::<i64>().is_ok())));
    let telemetry = fs::read_to_string(session.join("telemetry/m01.csv")).unwrap();
    assert!(!telemetry.lines().skip(1).any(|line| line.contains(",-")), "a speed is one in the sense of rotation");
    let squared = squared_error(&session);
    assert!(FORTY_NINE.contains(&squared), "weighted squared error {squared}");
}

#[test]
fn nonsense_is_refused() {
    let refused = |truth: &str, parts: &[&str]| {
        Laboratory::new(truth).refused(&example(), &[&["truth.toml"], parts].concat());
    };
    refused("[sensor]\nwhite = \"2 kg\"\n", &["[sensor], white", "\"2 kg\"", "expected"]);
    refused("[sensor]\nnoise = 1\n", &["line 2", "noise", "expected"]);
    refused("[recorder]\nrate = 0\n", &["recorder.rate", "found 0", "above 0"]);
    refused("[parameters]\nG9_11 = 1\n", &["[parameters], G9_11", "unknown", "G0_11"]);
    refused("[parameters]\nG1_11 = \"1 ug\"\n", &["[parameters], G1_11", "expected"]);
    refused("[parameters]\nG1_11 = \"5 ppm\"\n", &["[parameters], G1_11", "\"5 ppm\"", "units: s^2/m, ug/g^2"]);
    refused("[parameters]\nG1_11 = nan\n", &["[parameters], G1_11", "found NaN"]);

    let laboratory = Laboratory::new(TRUTH);
    laboratory.refused(&laboratory.path("nowhere"), &["nowhere", "no such file"]);
    done(&laboratory.simulate(&example(), "twice", &["--seed", "1"]));
    let again = laboratory.simulate(&example(), "twice", &["--seed", "1"]);
    assert_eq!(again.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&again.stderr).contains("experiment.toml: found a session, expected"));
}
