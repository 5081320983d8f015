use std::fs;

use serde_json::Value;

use crate::session::{Copy, example};

/// The form of session.md: names, order, units, finite numbers, and the table a person reads.
#[test]
fn the_example_gives_a_result_and_a_table() {
    let copy = Copy::new();
    let run = copy.calibrate(&[]);
    let table = String::from_utf8(run.stdout).unwrap();
    assert_eq!(run.status.code(), Some(0), "{table}{}", String::from_utf8_lossy(&run.stderr));
    assert!(run.stderr.is_empty(), "no bar where there is no terminal");
    for part in ["ERROR MODEL", "MOUNTING", "chi^2 per degree of freedom", "ug/g^2", "rejected"] {
        assert!(table.contains(part), "{part} is not in\n{table}");
    }
    let result: Value = serde_json::from_slice(&fs::read(copy.out().join("result.json")).unwrap()).unwrap();
    assert_eq!(result["schema"], "centrical-result/1");
    let names: Vec<&str> =
        result["parameters"].as_array().unwrap().iter().map(|p| p["name"].as_str().unwrap()).collect();
    assert_eq!(names.len(), 49);
    assert_eq!(names[..5], ["alpha_1", "alpha_2", "delta_1[1]", "delta_2[1]", "delta_3[1]"]);
    assert_eq!(names[20..28], ["dR_1[A]", "dR_2[A]", "dR_1[B]", "dR_2[B]", "dR_1[C]", "dR_2[C]", "drho_22", "drho_33"]);
    assert_eq!(names[28..38], ["df_1", "df_2", "df_3", "G0_11", "G0_21", "G0_22", "G0_31", "G0_32", "G0_33", "G1_11"]);
    assert_eq!(names[46..], ["G2_11", "G2_22", "G2_33"]);
    assert_eq!(result["observability"]["rank"], 49);
    assert_eq!(result["plateaus"].as_array().unwrap().len(), 108);
    assert_eq!(result["inputs"].as_array().unwrap().len(), 25);
    assert_eq!(result["inputs"][1]["path"], "records/m01.csv");
}

/// The estimates of the example against its truth: |error| below 4 standard uncertainties, every one.
#[test]
fn the_example_agrees_with_its_truth() {
    let copy = Copy::new();
    let run = copy.calibrate(&["--json"]);
    let result: Value = serde_json::from_slice(&run.stdout).unwrap();
    let truth: Value = serde_json::from_str(&fs::read_to_string(example().join("truth.json")).unwrap()).unwrap();
    let of = |name: &str| {
        let p = result["parameters"].as_array().unwrap().iter().find(|p| p["name"] == name).unwrap();
        (p["value"].as_f64().unwrap(), p["standard_uncertainty"].as_f64().unwrap())
    };
    let g = truth["gravity"].as_f64().unwrap();
    for i in 0..3 {
        for j in 0..3 {
            let (value, uncertainty) = of(&format!("G1_{}{}", i + 1, j + 1));
            let error = value - truth["G1_per_g"][i][j].as_f64().unwrap() / g;
            assert!(error.abs() < 4.0 * uncertainty, "G1_{}{}: {error} of {uncertainty}", i + 1, j + 1);
        }
        for j in 0..=i {
            let (value, uncertainty) = of(&format!("G0_{}{}", i + 1, j + 1));
            let error = value - truth["G0"][i][j].as_f64().unwrap();
            assert!(error.abs() < 4.0 * uncertainty, "G0_{}{}: {error} of {uncertainty}", i + 1, j + 1);
        }
        for k in 0..6 {
            let (value, uncertainty) = of(&format!("delta_{}[{}]", i + 1, k + 1));
            let error = value - truth["delta"][k][i].as_f64().unwrap();
            assert!(error.abs() < 4.0 * uncertainty, "delta_{}[{}]: {error} of {uncertainty}", i + 1, k + 1);
        }
    }
}

/// `--json` prints the file's bytes and writes none; the same inputs give the same bytes.
#[test]
fn json_is_the_file_and_the_same_every_time() {
    let copy = Copy::new();
    let printed = copy.calibrate(&["--json"]).stdout;
    assert!(copy.left_behind().is_empty());
    assert_eq!(copy.calibrate(&["--out", "deep/er"]).status.code(), Some(0));
    assert_eq!(fs::read(copy.out().join("deep/er/result.json")).unwrap(), printed);
}

/// The linear fit alone is said to be linear, and its second-order error shows.
#[test]
fn linear_alone_is_off() {
    let copy = Copy::new();
    let read = |arguments: &[&str]| -> Value { serde_json::from_slice(&copy.calibrate(arguments).stdout).unwrap() };
    let (linear, exact) = (read(&["--json", "--linear"]), read(&["--json"]));
    assert_eq!(linear["fit"]["termination"], "linear");
    assert_eq!(exact["fit"]["termination"], "converged");
    assert!(linear["fit"]["chi_squared"].as_f64() > exact["fit"]["chi_squared"].as_f64());
}

/// One pass of the filter gives the linear estimates, and is said to.
#[test]
fn the_linear_filter_gives_the_linear_estimates() {
    let copy = Copy::new();
    let read = |arguments: &[&str]| -> Value { serde_json::from_slice(&copy.calibrate(arguments).stdout).unwrap() };
    let (batch, filtered) =
        (read(&["--json", "--linear"]), read(&["--json", "--linear", "--method", "recursive", "-q"]));
    assert_eq!(filtered["fit"]["method"], "linear [K5.3], recursive filter");
    let parameters = |result: &Value| result["parameters"].as_array().unwrap().clone();
    for (by_batch, by_filter) in parameters(&batch).iter().zip(parameters(&filtered)) {
        let number = |parameter: &Value, key: &str| parameter[key].as_f64().unwrap();
        let u = number(by_batch, "standard_uncertainty");
        assert!((number(by_batch, "value") - number(&by_filter, "value")).abs() < 1e-6 * u, "{by_batch}");
        assert!((u - number(&by_filter, "standard_uncertainty")).abs() < 1e-6 * u, "{by_batch}");
    }
}

/// The printed pair relation: rank 47, the lost ones null throughout, all 21 of the instrument there, exit code 0.
#[test]
fn the_printed_relation_says_what_it_cannot_see() {
    let copy = Copy::new();
    copy.edit("experiment.toml", |text| text.replace("pair_relation = \"common\"", "pair_relation = \"free\""));
    let run = copy.calibrate(&["--json"]);
    assert_eq!(run.status.code(), Some(0));
    let result: Value = serde_json::from_slice(&run.stdout).unwrap();
    assert_eq!(result["observability"]["rank"], 53);
    assert_eq!(result["observability"]["columns"], 55);
    assert_eq!(result["observability"]["null_directions"].as_array().unwrap().len(), 2);
    for (j, p) in result["parameters"].as_array().unwrap().iter().enumerate() {
        let lost = p["estimable"] == false;
        assert_eq!(p["value"].is_null(), lost);
        assert_eq!(p["standard_uncertainty"].is_null(), lost);
        for other in 0..55 {
            assert!(!lost || (result["covariance"][j][other].is_null() && result["covariance"][other][j].is_null()));
        }
        assert!(!lost || p["group"] == "shift" || p["group"] == "proof mass");
    }
    let table = String::from_utf8(copy.calibrate(&[]).stdout).unwrap();
    assert!(table.contains("rank 53 of 55") && table.contains("All 21 parameters"), "{table}");
}
