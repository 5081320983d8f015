//! `centrical tumble` on the record of the examples and on records that are none.

use std::fs;
use std::process::Output;

use serde_json::Value;

use crate::session::Copy;

fn said(output: &Output) -> String {
    [&output.stdout, &output.stderr].map(|part| String::from_utf8_lossy(part).into_owned()).concat()
}

fn example(name: &str) -> String {
    format!("{}/../../examples/tumble/{name}", env!("CARGO_MANIFEST_DIR"))
}

fn json(file: &std::path::Path) -> Value {
    serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap()
}

/// Value and standard uncertainty of a parameter of a result.
fn estimate(result: &Value, name: &str) -> (f64, f64) {
    let parameters = result["parameters"].as_array().unwrap();
    let found = parameters.iter().find(|parameter| parameter["name"] == name).expect(name);
    (found["value"].as_f64().unwrap(), found["standard_uncertainty"].as_f64().unwrap())
}

#[test]
fn the_example_is_calibrated_to_its_truth() {
    let copy = Copy::new();
    let output = copy.run(&["tumble", &example("record.csv"), "--gravity", "9.81523 m/s^2", "--out", "tumbled"]);
    let text = said(&output);
    assert_eq!(output.status.code(), Some(0), "{text}");
    assert!(text.starts_with("ACCEPTABLE") && text.contains("24 rests, of "), "{text}");
    let folder = copy.out().join("tumbled");
    let (result, truth) = (json(&folder.join("result.json")), json(example("truth.json").as_ref()));
    let (df, g0) = (&truth["df"], &truth["G0"]);
    let mut names: Vec<(String, f64)> = (0..3).map(|i| (format!("df_{}", i + 1), df[i].as_f64().unwrap())).collect();
    for (i, j) in (0..3).flat_map(|i| (0..=i).map(move |j| (i, j))) {
        names.push((format!("G0_{}{}", i + 1, j + 1), g0[i][j].as_f64().unwrap()));
    }
    for (name, truth) in names {
        let (value, uncertainty) = estimate(&result, &name);
        assert!((value - truth).abs() < 3.5 * uncertainty, "{name}: {value} +- {uncertainty}, in truth {truth}");
        assert!(uncertainty < 1e-3, "{name}: {uncertainty}");
    }
    assert!(fs::read_to_string(folder.join("report.html")).unwrap().contains("G0"));
    // The folder is a session: it gives the same numbers again.
    assert_eq!(copy.run(&["calibrate", "tumbled", "--out", "again"]).status.code(), Some(0));
    assert_eq!(json(&copy.out().join("again/result.json"))["parameters"], result["parameters"]);
    let compensated = ["compensate", "tumbled/result.json", &example("record.csv"), "--out", "forces.csv"];
    assert_eq!(copy.run(&compensated).status.code(), Some(0));
}

/// Gravity of an unknown place is uncertain by 2 parts in a thousand, and so are the scales.
#[test]
fn an_unknown_gravity_is_said_to_be_uncertain() {
    let copy = Copy::new();
    let output = copy.run(&["tumble", &example("record.csv"), "--json"]);
    let result: Value = serde_json::from_slice(&output.stdout).unwrap();
    for axis in 1..=3 {
        let (_, uncertainty) = estimate(&result, &format!("G0_{axis}{axis}"));
        assert!((uncertainty / 2.04e-3 - 1.0).abs() < 0.01, "{uncertainty}");
    }
}

/// Readings in counts: scale and bias come with the result, and the accelerations are those of m/s^2.
#[test]
fn counts_need_no_data_sheet() {
    let copy = Copy::new();
    let text = fs::read_to_string(example("record.csv")).unwrap();
    let row = |line: &str| {
        let mut numbers = line.split(',').map(|number| number.parse::<f64>().unwrap());
        let t = numbers.next().unwrap();
        let counts: Vec<String> = numbers.map(|f| format!("{:.0}", 5000.0 * f + 40_000.0)).collect();
        format!("{t},{}", counts.join(","))
    };
    let counts: Vec<String> = text.lines().skip(1).map(row).collect();
    fs::write(copy.out().join("counts.csv"), format!("t,f1,f2,f3\n{}\n", counts.join("\n"))).unwrap();
    let run = |arguments: &[&str]| -> Value {
        let output = copy.run(&[&["tumble"], arguments, &["--gravity", "9.81523", "--json"]].concat());
        serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{}", said(&output)))
    };
    let (in_si, in_counts) = (run(&[&example("record.csv")]), run(&["counts.csv", "--unit", "counts"]));
    for axis in 0..3 {
        let name = format!("G0_{0}{0}", axis + 1);
        let scale = |result: &Value| 1.0 + estimate(result, &name).0;
        let own = in_counts["output"]["scale"][axis].as_f64().unwrap() * scale(&in_counts);
        assert!((own / (5000.0 * scale(&in_si)) - 1.0).abs() < 2e-5, "{own}");
    }
}

#[test]
fn records_that_show_nothing_are_refused() {
    let copy = Copy::new();
    let row = |i: u32| format!("{},0.0{},0.02,9.8{}", f64::from(i) / 50.0, i % 7, i % 3);
    let still: Vec<String> = (0..600).map(row).collect();
    fs::write(copy.out().join("still.csv"), format!("t,f1,f2,f3\n{}\n", still.join("\n"))).unwrap();
    let record = example("record.csv");
    let refused = |arguments: &[&str]| {
        let output = copy.run(&[&["tumble"], arguments].concat());
        assert_eq!(output.status.code(), Some(2), "{}", said(&output));
        said(&output)
    };
    let text = refused(&["still.csv"]);
    assert!(
        text.contains("still.csv: found ") && text.contains("in which the unit rests, expected a unit that is turned"),
        "{text}"
    );
    let text = refused(&[&record, "--readings", "f1,f2"]);
    assert!(text.contains("found 2 columns, expected three"), "{text}");
    let text = refused(&[&record, "--readings", "f1,f2,f4"]);
    assert!(text.contains("f4"), "{text}");
    let text = refused(&[&record, "--terms", "df_1,bananas"]);
    assert!(text.contains("bananas"), "{text}");
    fs::create_dir(copy.out().join("own")).unwrap();
    fs::copy(&record, copy.out().join("own/rests.csv")).unwrap();
    let text = refused(&["own/rests.csv", "--out", "own"]);
    assert!(text.contains("rests.csv"), "{text}");
}
