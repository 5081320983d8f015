//! Needs the sessions with known truth in the shared data: `CENTRICAL_SHARED` names the folder that holds `data`.
//! Run by `.ci/run`; the ordinary test command leaves these out.

mod certificate;
mod compensation;

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use nalgebra::{DMatrix, DVector};
use serde_json::Value;

fn data() -> PathBuf {
    PathBuf::from(std::env::var("CENTRICAL_SHARED").expect("CENTRICAL_SHARED names the shared folder")).join("data")
}

fn calibrate(session: &str) -> Value {
    let mut command = Command::new(env!("CARGO_BIN_EXE_centrical"));
    let run = command.arg("calibrate").arg(data().join(session)).arg("--json").output().unwrap();
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    serde_json::from_slice(&run.stdout).unwrap()
}

/// True value of a parameter by its name in the result.
fn true_value(truth: &Value, name: &str) -> f64 {
    let number = |value: &Value| value.as_f64().unwrap();
    let g = number(&truth["gravity"]);
    let (stem, rest) = name.split_once('_').unwrap();
    let digit = |n: usize| rest.as_bytes()[n] as usize - b'1' as usize;
    let index = || rest.split_once('[').unwrap().1.trim_end_matches(']');
    match stem {
        "alpha" => number(&truth["alpha"][digit(0)]),
        "delta" => number(&truth["delta"][index().parse::<usize>().unwrap() - 1][digit(0)]),
        "dR" => number(&truth["dR"][index().as_bytes()[0] as usize - b'A' as usize][digit(0)]),
        "drho" => number(&truth["drho"][digit(0) - 1]),
        "df" => number(&truth["df"][digit(0)]),
        "G0" => number(&truth["G0"][digit(0)][digit(1)]),
        "G1" => number(&truth["G1_per_g"][digit(0)][digit(1)]) / g,
        "G2" => number(&truth["G2_per_g2"][digit(0)]) / (g * g),
        _ => panic!("{name}"),
    }
}

/// Every |error| below 4 standard uncertainties; the squared error weighted by the inverse covariance and chi^2 in
/// their bands. Returns the number of estimable parameters.
fn check(session: &str, squared_error: std::ops::Range<f64>) -> (Value, usize) {
    let result = calibrate(session);
    let truth: Value =
        serde_json::from_str(&fs::read_to_string(data().join(session).join("truth.json")).unwrap()).unwrap();
    let parameters = result["parameters"].as_array().unwrap();
    let seen: Vec<usize> = (0..parameters.len()).filter(|&j| parameters[j]["estimable"] == true).collect();
    let uncertainty = |j: usize| parameters[j]["standard_uncertainty"].as_f64().unwrap();
    // In standard uncertainties, so that the factorisation sees a correlation matrix.
    let error = DVector::from_iterator(
        seen.len(),
        seen.iter().map(|&j| {
            let name = parameters[j]["name"].as_str().unwrap();
            let error = (parameters[j]["value"].as_f64().unwrap() - true_value(&truth, name)) / uncertainty(j);
            assert!(error.abs() < 4.0, "{session}: {name} is off by {error} standard uncertainties");
            error
        }),
    );
    let correlation = DMatrix::from_fn(seen.len(), seen.len(), |a, b| {
        let (i, j) = (seen[a], seen[b]);
        result["covariance"][i][j].as_f64().unwrap() / (uncertainty(i) * uncertainty(j))
    });
    let squared =
        correlation.cholesky().expect("positive definite").l().solve_lower_triangular(&error).unwrap().norm_squared();
    assert!(squared_error.contains(&squared), "{session}: weighted squared error {squared}");
    let fit = &result["fit"];
    let reduced = fit["chi_squared"].as_f64().unwrap() / fit["degrees_of_freedom"].as_f64().unwrap();
    assert!((0.8..1.25).contains(&reduced), "{session}: chi^2 per degree of freedom {reduced}");
    println!("{session}: weighted squared error {squared:.1} of {}, chi^2 per degree {reduced:.3}", seen.len());
    (result, seen.len())
}

/// The 99.9 % band of chi^2 with 49 degrees of freedom.
const FORTY_NINE: std::ops::Range<f64> = 20.0..86.0;
/// The same for 43.
const FORTY_THREE: std::ops::Range<f64> = 17.0..79.0;

#[test]
#[ignore = "needs the shared data: set CENTRICAL_SHARED"]
fn clean_csv() {
    assert_eq!(check("clean-csv", FORTY_NINE).1, 49);
}

#[test]
#[ignore = "needs the shared data: set CENTRICAL_SHARED"]
fn rough_parquet() {
    assert_eq!(check("rough-parquet", FORTY_NINE).1, 49);
}

#[test]
#[ignore = "needs the shared data: set CENTRICAL_SHARED"]
fn printed_relation() {
    let (result, estimable) = check("printed-relation", FORTY_THREE);
    assert_eq!(estimable, 43);
    assert_eq!(result["observability"]["rank"], 47);
    let directions = result["observability"]["null_directions"].as_array().unwrap();
    assert_eq!(directions[0], serde_json::json!({"dR_2[A]": 1.0, "dR_1[B]": 1.0, "drho_22": -1.0}));
    assert_eq!(directions[1], serde_json::json!({"dR_2[B]": 1.0, "dR_1[C]": 1.0, "drho_33": -1.0}));
}
