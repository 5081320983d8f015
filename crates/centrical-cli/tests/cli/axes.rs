//! `--axes`: results, specific forces and documents in other axes than those of the newtonometers.

use std::fs;
use std::path::Path;
use std::process::Output;

use serde_json::Value;

use crate::session::Copy;

fn said(output: &Output) -> String {
    [&output.stdout, &output.stderr].map(|part| String::from_utf8_lossy(part).into_owned()).concat()
}

fn json(file: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap()
}

/// Rows of numbers of a CSV without its head.
fn rows(file: &Path) -> Vec<Vec<f64>> {
    let text = fs::read_to_string(file).unwrap();
    text.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect()
}

fn matrix(axes: &Value) -> [[f64; 3]; 3] {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| axes["matrix"][i][j].as_f64().unwrap()))
}

fn value(axes: &Value, name: &str) -> f64 {
    let parameters = axes["parameters"].as_array().unwrap();
    parameters.iter().find(|p| p["name"] == name).expect(name)["value"].as_f64().unwrap()
}

/// A session of the example, calibrated with `--axes`.
fn calibrated(copy: &Copy, axes: &str) -> Value {
    let folder = axes.trim_end_matches(".toml");
    let output = copy.run(&["calibrate", copy.session().to_str().unwrap(), "--out", folder, "--axes", axes]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    assert!(said(&output).contains("OTHER AXES"), "{}", said(&output));
    assert!(fs::read_to_string(copy.out().join(folder).join("report.html")).unwrap().contains("in other axes"));
    json(&copy.out().join(folder).join("result.json"))["axes"].clone()
}

#[test]
fn specific_forces_are_in_the_axes_of_the_result() {
    let copy = Copy::new();
    let axes = calibrated(&copy, "symmetric");
    assert_eq!(axes["name"], "symmetric");
    assert!((value(&axes, "scale_12") - value(&axes, "scale_21")).abs() < 1e-15);
    let readings = "t,f1,f2,f3\n0,9.8,0.1,0.2\n1,120,-300,9.8\n";
    fs::write(copy.out().join("readings.csv"), readings).unwrap();
    let compensate = |arguments: &[&str]| {
        let output = copy.run(&[&["compensate", "symmetric/result.json", "readings.csv", "--out"], arguments].concat());
        assert!([Some(0), Some(1)].contains(&output.status.code()), "{}", said(&output));
        rows(&copy.out().join(arguments[0]))
    };
    let (own, lower) = (compensate(&["own.csv"]), compensate(&["lower.csv", "--axes", "lower"]));
    let c_zb = matrix(&axes);
    for (own, lower) in own.iter().zip(&lower) {
        for i in 0..3 {
            let turned: f64 = (0..3).map(|j| c_zb[i][j] * own[1 + j]).sum();
            assert!((turned - lower[1 + i]).abs() < 1e-8, "{turned} {}", lower[1 + i]);
        }
        assert!((own[2] - lower[2]).abs() > 1e-4, "{own:?} {lower:?}");
    }
    let output = copy.run(&["report", "symmetric/result.json", "--code", "code", "--axes", "upper"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    assert!(fs::read_to_string(copy.out().join("code/centrical_compensate.h")).unwrap().contains("upper triangular"));
}

/// The case, and a body that is mounted on it by a known rotation.
#[test]
fn a_file_fixes_axes_to_the_case() {
    let copy = Copy::new();
    let case = calibrated(&copy, "case");
    assert_eq!(case["positions"], 6);
    let write = |text: &str| fs::write(copy.out().join("body.toml"), text).unwrap();
    let body = "[axes]\nname = \"body\"\nof = \"case\"\nmatrix = [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]\nuncertainty = \"1 mrad\"\n";
    write(body);
    let body_axes = calibrated(&copy, "body.toml");
    let (c_zc, c_zb) = (matrix(&case), matrix(&body_axes));
    // Axis 1 of the body is axis 2 of the case, axis 2 its axis 1 reversed.
    for i in 0..3 {
        assert!((c_zb[i][0] - c_zc[i][1]).abs() < 1e-15 && (c_zb[i][1] + c_zc[i][0]).abs() < 1e-15);
    }
    let u = |axes: &Value, name: &str| {
        let parameters = axes["parameters"].as_array().unwrap();
        parameters.iter().find(|p| p["name"] == name).unwrap()["standard_uncertainty"].as_f64().unwrap()
    };
    let expected = u(&case, "turn_3").hypot(1e-3);
    assert!((u(&body_axes, "turn_3") / expected - 1.0).abs() < 1e-12);
    // Bias does not turn.
    assert_eq!(value(&case, "df_2"), value(&body_axes, "df_2"));

    let refused = |text: &str, expected: &str| {
        write(text);
        let output = copy.run(&["report", "case/result.json", "--html", "r.html", "--axes", "body.toml"]);
        assert_eq!(output.status.code(), Some(2), "{}", said(&output));
        assert!(said(&output).contains(expected), "{}", said(&output));
        assert!(!copy.out().join("r.html").exists());
    };
    refused(&body.replace("[-1, 0, 0]", "[1, 0, 0]"), "expected a right-handed rotation");
    refused(&body.replace("case", "car"), "body.toml, line 3");
    refused(&body.replace("1 mrad", "1 mm"), "expected an angle");
    refused("", "found no key `axes`");
}

/// A matrix that somebody edited does not turn forces.
#[test]
fn axes_of_a_result_are_a_rotation() {
    let copy = Copy::new();
    let axes = calibrated(&copy, "upper");
    let file = copy.out().join("upper/result.json");
    let mut result = json(&file);
    result["axes"]["matrix"][0][0] = (axes["matrix"][0][0].as_f64().unwrap() + 1e-3).into();
    fs::write(&file, result.to_string()).unwrap();
    let output = copy.run(&["report", "upper/result.json", "--html", "r.html", "--laboratory", "laboratory.toml"]);
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    assert!(said(&output).contains("expected a rotation"), "{}", said(&output));
}

/// A result that somebody edited contradicts itself: no command takes it.
#[test]
fn a_result_agrees_with_itself() {
    let copy = Copy::new();
    calibrated(&copy, "upper");
    let file = copy.out().join("upper/result.json");
    let whole = json(&file);
    let refused = |edit: &dyn Fn(&mut Value), expected: &str| {
        let mut result = whole.clone();
        edit(&mut result);
        fs::write(&file, result.to_string()).unwrap();
        let output = copy.run(&["compare", "upper/result.json", "upper/result.json"]);
        let message = said(&output);
        assert!(output.status.code() == Some(2) && message.contains(expected), "{message}");
        assert!(message.contains("upper/result.json: found "), "{message}");
    };
    let halved = |value: &mut Value| *value = (0.5 * value.as_f64().unwrap()).into();
    refused(&|r| halved(&mut r["parameters"][3]["standard_uncertainty"]), "the square of its standard uncertainty");
    refused(&|r| r["covariance"][2][0] = 1e-3.into(), "as on the other side of the diagonal");
    let correlated = |r: &mut Value| [(2, 0), (0, 2)].iter().for_each(|&(i, j)| r["covariance"][i][j] = 1e-3.into());
    refused(&correlated, "at most, the product of their standard uncertainties");
    let both = |r: &mut Value| {
        halved(&mut r["parameters"][3]["standard_uncertainty"]);
        let row = r["covariance"][3].as_array().unwrap().len();
        (0..row).for_each(|k| {
            halved(&mut r["covariance"][3][k]);
            halved(&mut r["covariance"][k][3]);
        });
    };
    refused(&both, "its standard uncertainty");
    refused(&|r| halved(&mut r["budget"]["sources"][0]["standard_uncertainty"][3]), "the squares of its sources");
    refused(&|r| drop(r["budget"]["combined"].as_array_mut().unwrap().pop()), "the number of parameters");
    refused(&|r| r["parameters"][3]["value"] = Value::Null, "both or neither");
    refused(&|r| r["parameters"][3]["name"] = "df_1".into(), "each once");
    refused(&|r| drop(r["covariance"].as_array_mut().unwrap().pop()), "the number of parameters");
    refused(&|r| r["fit"]["chi_squared"] = (-1.0).into(), "zero or more");
    let raw =
        |unit: &str, scale: f64| serde_json::json!({"unit": unit, "scale": [1.0, scale, 1.0], "bias": [0.0, 0.0, 0.0]});
    refused(&|r| r["output"] = raw("mV", 1.0), "one of counts, V");
    refused(&|r| r["output"] = raw("mg", 1.0), "per m/s^2 and no bias");
    refused(&|r| r["output"] = raw("counts", 0.0), "numbers other than zero");
    let of_unit = |r: &mut Value| {
        let parameters = r["parameters"].as_array_mut().unwrap();
        parameters.iter_mut().find(|p| p["name"] == "df_1").unwrap()["unit"] = "mg".into();
    };
    refused(&of_unit, "found df_1 in \"mg\", expected \"m/s^2\", the unit of its term");
    refused(&|r| r["parameters"][3]["estimable"] = false.into(), "a value and estimable: false");
    let terms = |r: &mut Value| r["model"]["error_model"].as_array_mut().unwrap().clone();
    refused(
        &|r| r["model"]["error_model"][9]["powers"] = serde_json::json!([0, 2, 0]),
        "K_1[f2^2] as the term G1_11 in error_model",
    );
    refused(&|r| r["model"]["error_model"][9]["axis"] = 2.into(), "the name G1_21 or K_2[f1^2]");
    refused(&|r| r["model"]["error_model"] = terms(r)[1..].to_vec().into(), "without its term in error_model");
    refused(&|r| r["model"]["error_model"] = [&terms(r)[..], &terms(r)[..1]].concat().into(), "twice in error_model");
    refused(&|r| r["observability"]["rank"] = 10.into(), "observability with rank 10");
    refused(
        &|r| drop(r["convergence"]["standard_uncertainty"][0].as_array_mut().unwrap().pop()),
        "[0] with 48 numbers",
    );
    refused(&|r| r["plateaus"][2]["mounting"] = 13.into(), "plateaus[2] with mounting 13");
    refused(&|r| r["plateaus"][2]["covariance"][1][1] = (-1.0).into(), "plateaus[2] with the variance -1e0");
    refused(&|r| r["tilt"]["probability"] = (-3.0).into(), "a probability of -3 in tilt.probability");
    refused(&|r| r["drift"]["chi_squared"] = (-1.0).into(), "drift.chi_squared = -1");
}

#[test]
fn rests_do_not_show_the_case() {
    let copy = Copy::new();
    let record = format!("{}/../../examples/tumble/record.csv", env!("CARGO_MANIFEST_DIR"));
    let output = copy.run(&["tumble", &record, "--out", "tumbled", "--axes", "case"]);
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    assert!(said(&output).contains("found 0 positions on an arm"), "{}", said(&output));
    let output = copy.run(&["tumble", &record, "--out", "tumbled", "--axes", "upper", "--gravity", "9.81523"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let axes = json(&copy.out().join("tumbled/result.json"))["axes"].clone();
    let uncertainty = |name: &str| {
        let parameters = axes["parameters"].as_array().unwrap();
        parameters.iter().find(|p| p["name"] == name).unwrap()["standard_uncertainty"].as_f64().unwrap()
    };
    assert!(
        ["scale_21", "scale_31", "scale_32"].iter().all(|name| (value(&axes, name), uncertainty(name)) == (0.0, 0.0))
    );
    let output = copy.run(&["compensate", "tumbled/result.json", &record, "--out", "f.csv", "--axes", "missing.toml"]);
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    assert!(said(&output).contains("one of lower, upper, symmetric, case"), "{}", said(&output));
}

/// What is not determined is said as without `--axes`, and the other axes are left out.
#[test]
fn a_result_that_is_not_determined_has_no_other_axes() {
    let copy = Copy::new();
    let record = format!("{}/../../examples/tumble/record.csv", env!("CARGO_MANIFEST_DIR"));
    let terms = "df_1,df_2,df_3,G0_11,G0_21,G0_22,G0_31,G0_32,G0_33,G1_11,G1_12,G1_13";
    let output =
        copy.run(&["tumble", &record, "--out", "tumbled", "--gravity", "9.81523", "--terms", terms, "--axes", "upper"]);
    let text = said(&output);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("axes upper are left out") && text.contains("df_1: found no value"), "{text}");
    let result = json(&copy.out().join("tumbled/result.json"));
    assert!(result["axes"].is_null() && copy.out().join("tumbled/report.html").exists());
}
