//! `centrical observe` on sessions and plans.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::session::{Copy, example};

fn plan(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/plans").join(name).to_str().unwrap().to_owned()
}

fn json(copy: &Copy, arguments: &[&str]) -> (Value, Option<i32>) {
    let run = copy.run(&[arguments, &["--json"]].concat());
    assert!(run.stderr.is_empty(), "{}", String::from_utf8_lossy(&run.stderr));
    (serde_json::from_slice(&run.stdout).unwrap(), run.status.code())
}

/// The printed relation: rank 47, two lost combinations of geometry, the instrument whole, so done.
#[test]
fn normalised_experiment() {
    let copy = Copy::new();
    let (report, code) = json(&copy, &["observe", &plan("normalised.toml"), "--combination", "dR_2[A] + drho_22"]);
    assert_eq!(code, Some(0));
    assert_eq!((report["rank"].as_u64(), report["columns"].as_u64()), (Some(47), Some(49)));
    assert_eq!(report["lost"][0]["text"], "dR_2[A] + dR_1[B] - drho_22");
    assert_eq!(report["lost"][0]["direction"]["drho_22"], -1.0);
    assert_eq!(report["lost"][1]["text"], "dR_2[B] + dR_1[C] - drho_33");
    assert_eq!(report["remedies"][0]["restores_rank"], true);
    assert_eq!(report["combinations"][0]["estimable"], true);
    let lost = |p: &&Value| p["estimable"] == false && p["standard_uncertainty"].is_null();
    assert_eq!(report["parameters"].as_array().unwrap().iter().filter(lost).count(), 6);
    let text = String::from_utf8(copy.run(&["observe", &plan("normalised.toml")]).stdout).unwrap();
    for part in ["RANK  47 of 49", "feels nothing but its own distance", "REMEDIES", "SUFFICIENT CONDITIONS"] {
        assert!(text.contains(part), "{text}");
    }
}

/// A plan that loses parameters of the instrument is not acceptable; its priors are accounted for.
#[test]
fn plan_of_ones_own() {
    let copy = Copy::new();
    let (report, code) = json(&copy, &["observe", &plan("four-positions.toml")]);
    assert_eq!(code, Some(1));
    let named = |name: &str| {
        let parameters = report["parameters"].as_array().unwrap();
        parameters.iter().find(|p| p["name"] == name).unwrap().clone()
    };
    assert_eq!(named("drho_22")["rests_on_prior"], true);
    assert!((named("drho_22")["prior"]["posterior_over_prior"].as_f64().unwrap() - 1.0).abs() < 1e-3);
    assert_eq!(named("G1_22")["estimable"], false);
    // The folder of a plan stands for it, as that of a session does.
    fs::copy(plan("four-positions.toml"), copy.out().join("experiment.toml")).unwrap();
    assert_eq!(json(&copy, &["observe", "."]).0["parameters"], report["parameters"]);
}

/// A plan of five positions on one radius, with a prior.
const FIVE_POSITIONS: &str = r#"
[session]
title = "five positions"
[site]
gravity = 9.81523
latitude = "55.7 deg"
[unit]
output_unit = "m/s^2"
proof_masses = [[0.0, 0.0, 0.0], [0.021, 0.012, 0.0105], [0.015, -0.01, -0.014]]
[centrifuge]
speed_uncertainty = 1e-5
rotation = "+3"
[model]
error_model = "kozlov-2017"
pair_relation = "common"
[plan]
noise = "20 ug/sqrt(Hz)"
floor = "1 ug"
[prior]
"delta_3[2]" = 1e-4
[schedule]
plateaus = [{ speed = 39.62595533727925, duration = 60.0 }, { speed = 62.653829488092434, duration = 60.0 }]
"#;

/// The search for the simplest null directions ends, though the sums that cancel a term bring it back when they are made anew.
#[test]
fn the_search_for_the_simplest_null_directions_ends() {
    let copy = Copy::new();
    let positions = [
        ("1", "+1 +2 +3", "A"),
        ("2", "-1 -2 +3", "A"),
        ("4", "+3 -1 -2", "B"),
        ("5", "-2 -3 +1", "C"),
        ("6", "+2 -3 -1", "C"),
    ];
    let mut text = FIVE_POSITIONS.to_owned();
    for (id, axes, pair) in positions {
        writeln!(text, "[[position]]\nid = \"{id}\"\naxes = \"{axes}\"\npair = \"{pair}\"").unwrap();
        writeln!(text, "[[mounting]]\nposition = \"{id}\"\narm = [0.5, 0, 0]").unwrap();
    }
    fs::write(copy.out().join("plan.toml"), text).unwrap();
    let (report, code) = json(&copy, &["observe", "plan.toml"]);
    assert!(code == Some(1) && report["rank"].as_u64() < report["columns"].as_u64(), "{}", report["rank"]);
}

/// A session is weighted by its data; the same bytes twice.
#[test]
fn session() {
    let copy = Copy::new();
    let example = example();
    let arguments = ["observe", example.to_str().unwrap(), "--json"];
    let first = copy.run(&arguments);
    assert_eq!(first.status.code(), Some(0));
    assert_eq!(first.stdout, copy.run(&arguments).stdout);
    let report: Value = serde_json::from_slice(&first.stdout).unwrap();
    assert_eq!((report["rank"].as_u64(), report["doubtful"].as_bool()), (Some(49), Some(false)));
    assert_eq!(report["weighted_by"], "the noise of its data");
}

/// `[plan]` counts until something is measured: then the data do, as for the same session in memory.
#[test]
fn a_session_with_records_and_a_plan_is_weighted_by_its_data() {
    let copy = Copy::new();
    let session = copy.session().display().to_string();
    let (measured, _) = json(&copy, &["observe", &session]);
    copy.edit("experiment.toml", |text| format!("{text}\n[plan]\nnoise = \"20 ug/sqrt(Hz)\"\nfloor = \"1 ug\"\n"));
    assert_eq!(json(&copy, &["observe", &session]).0, measured);
    let montecarlo = ["montecarlo", &session, "--runs", "2"];
    assert_eq!(json(&copy, &montecarlo).0["weighted_by"], "the noise of its data");
    fs::remove_dir_all(copy.session().join("records")).unwrap();
    for command in [&["observe", &session][..], &montecarlo] {
        assert_eq!(json(&copy, command).0["weighted_by"], "a planned noise of 20.000 ug/sqrt(Hz)");
    }
}

/// A prior in a session reaches the result, which says what rests on it.
#[test]
fn calibrate_tells_what_rests_on_a_prior() {
    let copy = Copy::new();
    copy.edit("experiment.toml", |text| {
        text.replacen("\"common\"", "\"opposite\"", 1) + "\n[prior]\n\"proof mass\" = \"50 um\"\n"
    });
    let run = copy.calibrate(&["--json"]);
    let result: Value = serde_json::from_slice(&run.stdout).unwrap();
    assert_eq!(result["observability"]["rank"], 49);
    let parameters = result["parameters"].as_array().unwrap();
    let resting: Vec<&str> =
        parameters.iter().filter(|p| p["rests_on_prior"] == true).map(|p| p["name"].as_str().unwrap()).collect();
    assert_eq!(resting, ["dR_2[A]", "dR_1[B]", "dR_2[B]", "dR_1[C]", "drho_22", "drho_33"]);
    let prior = &parameters.iter().find(|p| p["name"] == "drho_33").unwrap()["prior"];
    assert!((prior["standard_uncertainty"].as_f64().unwrap() / 5e-5 - 1.0).abs() < 1e-15);
    assert!(prior["posterior_over_prior"].as_f64().unwrap() <= 1.0);
}

#[test]
fn refusals() {
    let copy = Copy::new();
    let run = copy.run(&["observe", &plan("normalised.toml"), "--combination", "dR_2[A] + drho_44"]);
    assert_eq!(run.status.code(), Some(2));
    let message = String::from_utf8(run.stderr).unwrap();
    assert!(message.contains("character 11: found \"drho_44\", expected a parameter such as drho_22"), "{message}");
    let run = copy.run(&["observe", "missing.toml"]);
    assert_eq!(run.status.code(), Some(2));
    let message = String::from_utf8(copy.run(&["observe", &plan("best.toml")]).stderr).unwrap();
    assert!(
        message.contains("found [candidates] without a schedule, expected a schedule in [[mounting]]"),
        "{message}"
    );
}
