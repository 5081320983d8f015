//! Histories that a laboratory asks wrongly, or that show less than they seem to.

use std::fs;
use std::path::Path;
use std::sync::OnceLock;

use serde_json::{Value, json};
use tempfile::TempDir;

use crate::program::centrical;
use crate::session::example;

/// The result of the example.
fn first() -> &'static Value {
    static FIRST: OnceLock<Value> = OnceLock::new();
    FIRST.get_or_init(|| {
        let folder = TempDir::new().unwrap();
        let out = folder.path().join("first");
        let made = centrical().arg("calibrate").arg(example()).arg("--out").arg(&out).arg("-q").output().unwrap();
        assert!(made.status.success(), "{made:?}");
        serde_json::from_slice(&fs::read(out.join("result.json")).unwrap()).unwrap()
    })
}

/// A folder of results that differ from the first.
struct Results(TempDir);

impl Results {
    fn new() -> Self {
        Self(TempDir::new().unwrap())
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    /// The first result of another unit and day, edited.
    fn add(&self, name: &str, serial: &str, date: &str, edit: impl FnOnce(&mut Value)) {
        let mut result = first().clone();
        result["session"]["unit_serial"] = json!(serial);
        result["session"]["date"] = json!(date);
        result["session"]["title"] = json!(name);
        edit(&mut result);
        let place = self.path().join(name);
        fs::create_dir_all(&place).unwrap();
        fs::write(place.join("result.json"), result.to_string()).unwrap();
    }

    /// Exit code, what is printed, and the message.
    fn run(&self, arguments: &[&str]) -> (i32, String, String) {
        let output = centrical().arg("history").args(arguments).current_dir(self.path()).output().unwrap();
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        (output.status.code().unwrap(), text(&output.stdout), text(&output.stderr))
    }

    fn document(&self, arguments: &[&str]) -> Value {
        let (_, text, message) = self.run(&[arguments, &["--json"]].concat());
        serde_json::from_str(&text).unwrap_or_else(|_| panic!("{message}"))
    }
}

/// Gives a parameter of a result a value.
fn set(result: &mut Value, name: &str, value: f64) {
    let parameters = result["parameters"].as_array_mut().unwrap();
    let parameter = parameters.iter_mut().find(|parameter| parameter["name"] == name).unwrap();
    parameter["value"] = json!(value);
}

/// The tilt grows by hundreds of its standard uncertainties from session to session, and seven sessions test nothing.
#[test]
fn a_machine_that_is_not_tested_is_not_called_steady() {
    let results = Results::new();
    for n in 0..7 {
        let date = format!("20{}-03-01", 10 + n);
        results.add(&n.to_string(), "0001", &date, |result| set(result, "alpha_1", 1e-3 * f64::from(n)));
    }
    let (code, text, _) = results.run(&["station", "."]);
    assert!(!text.contains("STEADY") && text.contains("FEW"), "{text}");
    assert!(text.contains("the sessions do not show whether the machine is steady"), "{text}");
    assert_eq!(code, 0);
    assert_eq!(results.document(&["station", "."])["is_steady"], Value::Null);
    // The eighth session makes a test of them.
    results.add("7", "0001", "2017-03-01", |result| {
        set(result, "alpha_1", 7.1e-3);
        set(result, "alpha_2", 1e-6);
    });
    let (code, text, _) = results.run(&["station", "."]);
    assert!(text.contains("NOT STEADY") && code == 1, "{text}");
    assert_eq!(results.document(&["station", "."])["is_steady"], false);
}

#[test]
fn the_median_of_an_even_number_of_units_is_the_mean_of_both_middle_ones() {
    let results = Results::new();
    for (serial, bias) in [("a", 6e-3), ("b", 0.0), ("c", 5e-3), ("d", 1e-3), ("e", 9e-3)] {
        results.add(serial, serial, "2024-01-01", |result| set(result, "df_1", bias));
    }
    for (units, median) in [("abcde", 5e-3), ("abcd", 3e-3), ("bd", 5e-4)] {
        let units: Vec<&str> = units.split("").filter(|unit| !unit.is_empty()).collect();
        let document = results.document(&[&["units"], units.as_slice()].concat());
        let parameters = document["parameters"].as_array().unwrap();
        let found =
            parameters.iter().find(|parameter| parameter["name"] == "df_1").unwrap()["median"].as_f64().unwrap();
        assert!((found - median).abs() < 1e-15, "{units:?}: {found}");
    }
}
