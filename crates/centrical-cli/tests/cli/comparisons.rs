//! Calibrations of one unit compared: by what the unit does, whatever its nominal output, and with what sessions share taken out.

use std::fs;
use std::path::Path;

use serde_json::Value;
use tempfile::TempDir;

use crate::program::centrical;
use crate::session::example;

fn json(folder: &Path, arguments: &[&str]) -> Value {
    let output = centrical().args(arguments).current_dir(folder).output().unwrap();
    serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{output:?}"))
}

fn named<'a>(list: &'a Value, name: &str) -> &'a Value {
    list.as_array().unwrap().iter().find(|element| element["name"] == name).expect("a parameter of that name")
}

/// The example's rests in counts, `scale` of them per unit of the record and `zero` at no force, calibrated.
fn rests_in_counts(folder: &Path, name: &str, date: &str, scale: f64, zero: f64) {
    let record = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/tumble/record.csv")).unwrap();
    let lines = record.lines().filter(|line| !line.starts_with('#')).enumerate().map(|(n, line)| {
        let mut cells = line.split(',');
        let time = cells.next().unwrap_or_default();
        let counts = cells.map(|cell| cell.trim().parse::<f64>().map(|f| format!("{:.0}", f * scale + zero)));
        let counts: Vec<String> = counts.map(Result::unwrap_or_default).collect();
        if n == 0 { "t,f1,f2,f3".to_owned() } else { format!("{time},{}", counts.join(",")) }
    });
    fs::write(folder.join(format!("{name}.csv")), lines.collect::<Vec<_>>().join("\n")).unwrap();
    let file = format!("{name}.csv");
    let arguments = ["tumble", &file, "--unit", "counts", "--gravity", "9.81523 m/s^2", "--serial", "7"];
    let output =
        centrical().args(arguments).args(["--date", date, "--out", name]).current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{output:?}");
}

/// Rests in counts find their nominal output anew each time. A unit whose scale grew by 1 % and whose zero moved by 98,000 counts has changed by that much,
/// beside whichever nominal output.
#[test]
fn a_change_shows_beside_any_nominal_output() {
    let folder = TempDir::new().unwrap();
    rests_in_counts(folder.path(), "first", "2024-01-01", 1e5, 0.0);
    rests_in_counts(folder.path(), "second", "2025-01-01", 1.01e5, 98_000.0);
    let files = ["first/result.json", "second/result.json"];
    let compared = json(folder.path(), &["compare", files[0], files[1], "--json"]);
    assert_eq!(compared["agree"], false);
    let history = json(folder.path(), &["history", "unit", files[0], files[1], "--json"]);
    assert!(history["sameness"]["probability"].as_f64().unwrap() < 1e-9, "{history}");
    for axis in 1..=3 {
        // The scale error is relative to the second nominal output, which is 1.01 times the first.
        let change = named(&compared["comparisons"][0]["differences"], &format!("G0_{axis}{axis}"));
        let size = change["difference"].as_f64().unwrap();
        assert!((size - 0.01 / 1.01).abs() < 5.0 * change["standard_uncertainty"].as_f64().unwrap(), "{change}");
        let values = &named(&history["parameters"], &format!("G0_{axis}{axis}"))["values"];
        assert!((values[1].as_f64().unwrap() - values[0].as_f64().unwrap() - size).abs() < 1e-12, "{values}");
    }
    // Nothing says how many counts a volt is.
    let mut other: Value = serde_json::from_slice(&fs::read(folder.path().join(files[0])).unwrap()).unwrap();
    other["output"]["unit"] = "V".into();
    fs::write(folder.path().join("volts.json"), other.to_string()).unwrap();
    let refused = centrical().args(["compare", files[0], "volts.json"]).current_dir(folder.path()).output().unwrap();
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(refused.status.code() == Some(2) && said.contains("found output in V, expected counts"), "{said}");
    // Nor 1 m/s^2.
    other.as_object_mut().unwrap().remove("output");
    fs::write(folder.path().join("si.json"), other.to_string()).unwrap();
    for command in [&["compare"][..], &["history", "unit"]] {
        let pair = [files[0], "si.json"];
        let refused = centrical().args(command).args(pair).current_dir(folder.path()).output().unwrap();
        let said = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert!(refused.status.code() == Some(2) && said.contains("output in "), "{said}");
    }
}

/// Gravity that both sessions of a station share cancels in the difference: a change of the scales by 40 ppm shows beside 100 ppm of gravity, in
/// `compare` as in the history.
#[test]
fn what_both_share_cancels() {
    let folder = TempDir::new().unwrap();
    let session = folder.path().join("session");
    let example = example();
    let reduced = centrical().args(["reduce", example.to_str().unwrap(), "--out"]).arg(&session).arg("-q").output();
    assert!(reduced.unwrap().status.success());
    let file = session.join("experiment.toml");
    let text = fs::read_to_string(&file).unwrap() + "\n[uncertainty]\ngravity = \"0.001 m/s^2\"\nradius = \"0.5 mm\"\n";
    fs::write(&file, text).unwrap();
    let result = json(folder.path(), &["calibrate", "session", "--json"]);
    let mut changed = result.clone();
    for parameter in changed["parameters"].as_array_mut().unwrap() {
        if ["G0_11", "G0_22", "G0_33"].contains(&parameter["name"].as_str().unwrap()) {
            parameter["value"] = (parameter["value"].as_f64().unwrap() + 4e-5).into();
        }
    }
    changed["session"]["date"] = "2027-10-05".into();
    for (name, result) in [("first.json", &result), ("second.json", &changed)] {
        fs::write(folder.path().join(name), result.to_string()).unwrap();
    }
    assert!(named(&result["parameters"], "G0_11")["standard_uncertainty"].as_f64().unwrap() > 9e-5);
    let compared = json(folder.path(), &["compare", "first.json", "second.json", "--json"]);
    let history = json(folder.path(), &["history", "unit", "first.json", "second.json", "--json"]);
    let change = named(&compared["comparisons"][0]["differences"], "G0_11");
    let [by_compare, by_history] =
        [&change["e_n"], &named(&history["parameters"], "G0_11")["e_n_previous"]].map(|e_n| e_n.as_f64().unwrap());
    assert!((by_compare / by_history - 1.0).abs() < 1e-9, "{by_compare} {by_history}");
    assert!(change["standard_uncertainty"].as_f64().unwrap() < 2e-5 && by_compare > 1.0, "{change}");
    // Another gravity, stated for another place, is another error: 1e-4 of each place is in the difference of the scales.
    changed["model"]["gravity"] = 9.79.into();
    fs::write(folder.path().join("elsewhere.json"), changed.to_string()).unwrap();
    let compared = json(folder.path(), &["compare", "first.json", "elsewhere.json", "--json"]);
    let history = json(folder.path(), &["history", "unit", "first.json", "elsewhere.json", "--json"]);
    let change = named(&compared["comparisons"][0]["differences"], "G0_11");
    assert!(change["standard_uncertainty"].as_f64().unwrap() > 1.3e-4, "{change}");
    let by_history = named(&history["parameters"], "G0_11")["e_n_previous"].as_f64().unwrap();
    assert!((change["e_n"].as_f64().unwrap() / by_history - 1.0).abs() < 1e-9, "{change} {by_history}");
}
