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

#[test]
fn a_limit_above_zero_is_asked_for() {
    let results = Results::new();
    for (name, date) in [("a", "2023-01-01"), ("b", "2024-01-01")] {
        results.add(name, "0001", date, |_| {});
    }
    for limit in ["0 ug", "-5 ug"] {
        let of_page = format!("--limit={limit}");
        for arguments in [&["unit", ".", &of_page][..], &["page", ".", "--out", "pages", &of_page]] {
            let (code, _, message) = results.run(arguments);
            assert_eq!(code, 2, "{arguments:?}");
            let said = format!("found \"{limit}\", expected an acceleration above zero");
            assert!(message.contains(&said), "{message}");
        }
    }
}

/// Values without a scatter have no limits, which is not a want of sessions.
#[test]
fn a_chart_says_why_it_has_no_limits() {
    let results = Results::new();
    for n in 0..3 {
        results.add(&n.to_string(), "0001", &format!("202{n}-01-01"), |_| {});
    }
    let message = |accepted: &str| results.run(&["chart", "df_1", ".", "--accepted", accepted]).2;
    let equal = "found 3 acceptable sessions with one value in all, expected values that scatter, or stated limits";
    assert!(message("3").contains(equal), "{}", message("3"));
    let few = "found 3 acceptable sessions, expected 4 for the limits, fewer by --accepted, or stated limits";
    assert!(message("4").contains(few), "{}", message("4"));
    let one = "found 1 acceptable session, expected 2 for the limits";
    assert!(message("1").contains(one), "{}", message("1"));
}

#[test]
fn a_batch_without_a_unit_is_named_with_the_unit_that_looks_like_it() {
    let results = Results::new();
    for serial in ["TA-1", "TA-2", "TA-3"] {
        results.add(serial, serial, "2024-01-01", |_| {});
    }
    let batches = |text: &str| fs::write(results.path().join("batches.csv"), text).unwrap();
    batches("serial,batch\nta1,a\nTA-2,a\nTA-3,b\nTA-9,b\n");
    let arguments = ["units", ".", "--batches", "batches.csv"];
    let expected = json!([{ "unit_serial": "ta1", "near": ["TA-1"] }, { "unit_serial": "TA-9", "near": [] }]);
    assert_eq!(results.document(&arguments)["without_unit"], expected);
    let (_, text, _) = results.run(&arguments);
    assert!(text.contains("NO UNIT  no unit has the serial \"ta1\" of the batches, expected \"TA-1\"?"), "{text}");
    assert!(text.contains("NO UNIT  no unit has these serials of the batches: \"TA-9\""), "{text}");
    batches("serial,batch\nTA-1,a\nTA-2,a\nTA-3,b\n");
    assert_eq!(results.document(&arguments)["without_unit"], Value::Null);
    assert!(!results.run(&arguments).1.contains("NO UNIT"));
}

/// A copy of a session differs in its experiment file alone; another session of the day has other records.
#[test]
fn a_session_under_another_title_is_of_the_same_files() {
    let results = Results::new();
    let experiment =
        |hash: &'static str| move |result: &mut Value| result["inputs"][0]["sha256"] = json!(hash.repeat(64));
    results.add("a", "0001", "2024-01-01", experiment("a"));
    results.add("b", "0001", "2024-01-01", experiment("b"));
    results.add("c", "0002", "2024-05-01", experiment("c"));
    results.add("d", "0001", "2024-01-01", |result| {
        result["inputs"][0]["sha256"] = json!("d".repeat(64));
        result["inputs"][1]["sha256"] = json!("e".repeat(64));
    });
    let doubts = |store: &str, option: &[&str]| {
        assert_eq!(results.run(&[&["add", store, "a", "b", "c", "d"], option].concat()).0, 0);
        let document = results.document(&["list", store, "--check"]);
        let found = document["doubts"].as_array().unwrap().clone();
        found.iter().map(|d| (d["kind"].clone(), d["of"].as_array().unwrap().len())).collect::<Vec<_>>()
    };
    assert_eq!(first()["inputs"][0]["path"], "experiment.toml");
    assert_eq!(doubts("store", &[]), [(json!("same-inputs"), 3), (json!("same-day"), 3)]);
    // Rows alone do not have the hashes of records.
    assert_eq!(doubts("rows", &["--rows-only"]), [(json!("same-day"), 3)]);
}

/// A serial number alone does not distinguish two units.
#[test]
fn several_units_are_named_by_model_and_serial() {
    let results = Results::new();
    results.add("a", "0001", "2023-01-01", |_| {});
    results.add("b", "0001", "2024-01-01", |result| result["session"]["unit_model"] = json!(""));
    let (code, _, message) = results.run(&["unit", "."]);
    assert_eq!(code, 2);
    let said = "found 2 units: model \"\" serial \"0001\", model \"TA-200\" serial \"0001\", expected";
    assert!(message.contains(said), "{message}");
}

/// Calibrations that scatter less than they state leave no interval of zeros in a certificate.
#[test]
fn a_certificate_has_no_interval_of_zeros() {
    let results = Results::new();
    for n in 0..8 {
        results.add(&n.to_string(), "0001", &format!("201{n}-01-01"), |_| {});
    }
    let result = results.path().join("7/result.json");
    let mut report = centrical();
    report.arg("report").arg(&result).args(["--html", "report.html", "--past", "."]).current_dir(results.path());
    let made = report.output().unwrap();
    assert!(made.status.success(), "{made:?}");
    let text = fs::read_to_string(results.path().join("report.html")).unwrap();
    assert!(text.contains("0 (scatter less than stated)"), "no such cell");
    assert!(!text.contains("(0.0 \u{2026} 0.0)"));
}

/// Units of a station with fewer than ten are not called alike, and have no deviation when there is one.
#[test]
fn units_that_are_not_tested_are_not_called_alike() {
    let results = Results::new();
    for n in 0..11 {
        let serial = format!("n{n}");
        results.add(&serial, &serial, "2024-01-01", |result| {
            result["session"]["station"] = json!("N");
            let move_by = |p: &mut Value| {
                let own = f64::from(n * 7 % 11 - 5) * p["standard_uncertainty"].as_f64().unwrap();
                p["value"] = json!(p["value"].as_f64().unwrap() + 0.3 * own);
            };
            result["parameters"].as_array_mut().unwrap().iter_mut().for_each(move_by);
        });
    }
    let (_, text, _) = results.run(&["units", "."]);
    assert!(!text.contains("NOT TESTED") && !text.contains("FEW"), "{text}");
    results.add("s", "far", "2024-01-01", |result| {
        result["session"]["station"] = json!("S");
        set(result, "df_1", 1.0);
    });
    let (_, text, _) = results.run(&["units", "."]);
    assert!(!text.starts_with("ALIKE") && text.contains("1 unit at the station S"), "{text}");
    let document = results.document(&["units", "."]);
    assert_eq!(
        (&document["is_tested"], &document["untested"]),
        (&json!(false), &json!([{ "station": "S", "units": ["far"] }]))
    );
    let (code, text, _) = results.run(&["units", "s"]);
    assert!(text.starts_with("NOT TESTED") && code == 0, "{text}");
    assert_eq!(results.document(&["units", "s"])["parameters"][0]["deviation"], Value::Null);
}

/// Units beyond a limit are named and end with 1; what was done with batches is said.
#[test]
fn limits_and_batches_reach_the_reader() {
    let results = Results::new();
    for (serial, bias) in [("a", 1e-3), ("b", 2e-3), ("c", 3e-3), ("d", 9e-3)] {
        results.add(serial, serial, "2024-01-01", |result| set(result, "df_1", bias));
    }
    let laboratory = fs::read_to_string(example().join("laboratory.toml")).unwrap();
    let without_limits = &laboratory[..laboratory.find("[[decision.limit]]").unwrap()];
    let limits = format!("{without_limits}[[decision.limit]]\nparameter = \"df_1\"\nhigh = 5e-3\n");
    fs::write(results.path().join("limits.toml"), limits).unwrap();
    fs::write(results.path().join("batches.csv"), "serial,batch\na,x\nb,x\nc,y\nd,y\n").unwrap();
    fs::write(results.path().join("one.csv"), "serial,batch\na,x\nb,y\n").unwrap();
    let (code, text, message) = results.run(&["units", ".", "--laboratory", "limits.toml"]);
    assert!(text.starts_with("NOT WITHIN LIMITS") && code == 1, "{text}{message}");
    assert!(text.contains("BEYOND LIMITS  df_1: 1 unit, serial d"), "{text}");
    assert!(results.run(&["units", ".", "--batches", "batches.csv"]).1.contains("BATCHES ALIKE  x (2), y (2)"));
    assert!(results.run(&["units", ".", "--batches", "one.csv"]).1.contains("BATCHES NOT COMPARED  x (1), y (1)"));
}

/// A machine whose seat turns while units come one after another is not called steady; a single session that stands out is named.
#[test]
fn a_machine_that_changes_with_its_units_is_not_called_steady() {
    let results = Results::new();
    let scatter = |n: i32| 1e-6 * f64::from(n * 7 % 5 - 2);
    for n in 0..10 {
        let date = format!("20{}-03-01", 10 + n);
        let tilt = if n < 5 { 0.0 } else { 1e-3 };
        let unit = if n < 5 { "one" } else { "other" };
        results.add(&format!("blocks/{n}"), unit, &date, |result| set(result, "alpha_1", tilt + scatter(n)));
        let tilt = if n == 3 { 1e-3 } else { 0.0 };
        results.add(&format!("single/{n}"), "one", &date, |result| set(result, "alpha_1", tilt + scatter(n)));
    }
    let (code, text, _) = results.run(&["station", "blocks"]);
    assert!(text.starts_with("NOT TESTED") && !text.contains("STEADY") && code == 0, "{text}");
    assert_eq!(results.document(&["station", "blocks"])["is_steady"], Value::Null);
    let (code, text, _) = results.run(&["station", "single"]);
    assert!(text.starts_with("NOT STEADY") && text.contains("2013-03-01 STANDS OUT") && code == 1, "{text}");
}

/// Stations and models are not mixed; Python says the same (`test_what_a_history_is_not_asked`).
#[test]
fn a_history_is_of_one_station_and_model() {
    let results = Results::new();
    for n in 0..8 {
        results.add(&n.to_string(), "0001", &format!("202{n}-03-01"), |result| {
            set(result, "df_1", 1e-6 * f64::from(n));
            result["session"]["station"] = json!(if n < 4 { "N" } else { "S" });
            result["session"]["unit_model"] = json!(if n % 2 == 0 { "even" } else { "odd" });
        });
    }
    let refused = |arguments: &[&str], sentence: &str| {
        let (code, _, message) = results.run(arguments);
        assert!(message.contains(sentence) && code == 2, "{message}");
    };
    let (models, stations) =
        ("found \"even\", \"odd\", expected one, by --model", "found \"N\", \"S\", expected one, by --station");
    refused(&["units", "."], models);
    refused(&["station", "."], stations);
    refused(&["chart", "df_1", "."], models);
    refused(&["chart", "df_1", ".", "--model", "even"], stations);
    let (code, text, _) = results.run(&["chart", "df_1", ".", "--accepted", "2", "--model", "even", "--station", "N"]);
    assert!(code == 0 && text.starts_with("IN CONTROL"), "{text}");
}

/// What rests on a calibration with an objection says so.
#[test]
fn a_last_calibration_with_an_objection_is_named() {
    let results = Results::new();
    for n in 0..4 {
        results.add(&n.to_string(), "0001", &format!("202{n}-03-01"), |result| {
            if n == 3 {
                result["fit"]["termination"] = json!("stalled");
            }
        });
    }
    let (code, text, message) = results.run(&["unit", ".", "--limit", "1 m/s^2"]);
    assert!(text.contains("NOT ACCEPTABLE  the last calibration has an objection") && code == 1, "{text}{message}");
    fs::remove_dir_all(results.path().join("3")).unwrap();
    assert_eq!(results.run(&["unit", ".", "--limit", "1 m/s^2"]).0, 0);
}

/// A due date is held against the day that is asked for: today, or another.
#[test]
fn a_due_date_that_has_passed_is_overdue() {
    let results = Results::new();
    for n in 0..4 {
        results.add(&n.to_string(), "0001", &format!("201{n}-03-01"), |result| {
            let bias = result["parameters"].as_array().unwrap().iter().find(|p| p["name"] == "df_1").unwrap();
            let value = bias["value"].as_f64().unwrap() + 0.1 * f64::from(n);
            set(result, "df_1", value);
        });
    }
    let unit = ["unit", ".", "--limit", "100 mg"];
    let due = results.document(&unit)["due"]["date"].as_str().unwrap().to_owned();
    assert!(due.as_str() > "2013-03-01" && due.as_str() < "2026-01-01", "{due}");
    let (code, text, _) = results.run(&unit);
    assert!(text.starts_with(&format!("OVERDUE  since {due}")) && code == 1, "{text}");
    let (code, text, _) = results.run(&[&unit[..], &["--on", "2013-03-02"]].concat());
    assert!(text.starts_with(&format!("DUE  {due}")) && code == 0, "{text}");
    assert!(text.contains("forecast"), "{text}");
    // Without a limit there is nothing that fails: scatter and drift are what is measured.
    assert_eq!(results.run(&["unit", "."]).0, 0);
}

/// One text that is not a date does not stop a plant: it is refused at the door, and left out by name where it is in a store
/// already.
#[test]
fn a_date_that_is_no_day_is_refused_and_left_out() {
    let results = Results::new();
    for n in 0..3 {
        results.add(&format!("good/{n}"), "0001", &format!("202{n}-03-01T23:30:00+03:00"), |_| {});
    }
    results.add("bad", "0001", "05.10.2026", |_| {});
    let (code, _, message) = results.run(&["add", "store", "good", "bad"]);
    let expected = "session, date: found \"05.10.2026\", expected a day such as 2026-10-05";
    assert!(code == 2 && message.contains("bad/result.json") && message.contains(expected), "{message}");
    results.add("none", "0001", "", |_| {});
    assert_eq!(results.run(&["add", "store", "good", "none"]).0, 0);
    let (code, text, message) = results.run(&["unit", "store"]);
    assert!(code == 0 && text.contains("2022-03-01") && text.contains("3 calibrations"), "{text}");
    assert!(message.starts_with("NO DAY  ") && message.contains("left out"), "{message}");
    assert_eq!(results.run(&["page", "store", "--out", "pages"]).0, 0);
    let index = fs::read_to_string(results.path().join("pages/index.html")).unwrap();
    assert!(index.contains("(no day: in no history)"));
}

/// A session far beyond the scatter of the others is named, as are two with the same values and another spelling of the serial number.
#[test]
fn sessions_that_may_not_be_meant_are_named() {
    let results = Results::new();
    for n in 0..6 {
        let off = if n == 2 { 1.0 } else { 1e-3 * f64::from(n * 7 % 5 - 2) };
        results.add(&n.to_string(), "0001", &format!("202{n}-03-01"), |result| set(result, "df_1", off));
    }
    results.add("again", "0001", "2025-03-02", |result| set(result, "df_1", 1e-3 * f64::from(5 * 7 % 5 - 2)));
    results.add("other", "00-01", "2025-04-01", |_| {});
    results.add("spreadsheet", "1", "2025-05-01", |_| {});
    let (_, text, message) = results.run(&["unit", ".", "--serial", "0001"]);
    assert!(text.contains("DEVIATES  2022-03-01"), "{text}");
    assert!(text.contains("TWICE  2025-03-01"), "{text}");
    assert!(message.contains("SPELLING  calibrations of serial \"00-01\", \"1\" are not taken"), "{message}");
}

/// A gravity that one session of a station states otherwise than the others is named before its parameters deviate; a store names its
/// sessions by digits that fit on a line.
#[test]
fn gravities_of_one_station_that_differ_are_named() {
    let results = Results::new();
    for n in 0..4_usize {
        // The last differs as tides do.
        let gravity = [9.81523, 9.81523, 9.8162, 9.815_231][n];
        results.add(&n.to_string(), "0001", &format!("202{n}-03-01"), |result| {
            result["model"]["gravity"] = json!(gravity);
        });
    }
    let (_, text, _) = results.run(&["unit", "."]);
    let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("states 9.81523 m/s^2 and 2022-03-01"), "{text}");
    assert_eq!(words.matches("GRAVITY").count(), 2, "{text}");
    assert_eq!(results.document(&["unit", "."])["sessions"][2]["gravity"], 9.8162);
    assert_eq!(results.run(&["add", "store", "."]).0, 0);
    let (_, text, _) = results.run(&["unit", "store"]);
    let key = text.lines().find(|line| line.trim_start().starts_with("1  2020-03-01")).unwrap();
    let key = key.split_whitespace().last().unwrap();
    assert!(key.len() == 12 && key.bytes().all(|digit| digit.is_ascii_hexdigit()), "{text}");
}

/// The table of batches of a spreadsheet begins with a byte order mark; means of batches that differ are shown.
#[test]
fn batches_that_differ_are_shown_with_their_means() {
    let results = Results::new();
    for n in 0..8 {
        let batch = if n < 4 { 0.0 } else { 0.1 };
        results.add(&n.to_string(), &n.to_string(), "2024-03-01", |result| {
            set(result, "df_1", batch + 1e-3 * f64::from(n * 7 % 5 - 2));
        });
    }
    let batches = "\u{feff}serial,batch\n0,east\n1,east\n2,east\n3,east\n4,west\n5,west\n6,west\n7,west\n";
    fs::write(results.path().join("batches.csv"), batches).unwrap();
    let (code, text, message) = results.run(&["units", ".", "--batches", "batches.csv"]);
    assert!(code == 1 && !text.contains("NO UNIT"), "{text}{message}");
    let row =
        |batch: &str| text.lines().any(|line| line.contains("df_1") && line.contains(batch) && line.contains('±'));
    assert!(text.contains("BATCHES  mean") && row("east") && row("west"), "{text}");
}

/// A session that lacks a parameter hides its change in no other: the change is found, and the joint test differs.
#[test]
fn a_change_is_seen_beside_a_session_that_lacks_the_parameter() {
    let results = Results::new();
    let u = |name: &str| {
        let parameters = first()["parameters"].as_array().unwrap();
        parameters.iter().find(|p| p["name"] == name).unwrap()["standard_uncertainty"].as_f64().unwrap()
    };
    let step = 15.0 * u("G1_11");
    for session in 0..8 {
        results.add(&format!("s{session}"), "0001", &format!("{}-01-01", 2012 + session), |result| {
            for parameter in result["parameters"].as_array_mut().unwrap() {
                if parameter["name"] == "G1_11" {
                    parameter["value"] = json!(parameter["value"].as_f64().unwrap() + step * f64::from(session));
                    if session == 4 {
                        parameter["value"] = Value::Null;
                        parameter["standard_uncertainty"] = Value::Null;
                        parameter["estimable"] = json!(false);
                    }
                }
            }
        });
    }
    let unit = results.document(&["unit", "."]);
    let of = unit["parameters"].as_array().unwrap().iter().find(|p| p["name"] == "G1_11").unwrap();
    assert!(of["drifts"] == true && unit["not_compared"].is_null(), "{of}");
    let (_, text, _) = results.run(&["unit", "."]);
    assert!(text.contains("DIFFERS") && text.contains("INCOMPLETE  2016-01-01"), "{text}");
}

/// Of two sessions of one day that with the later time is the last, whatever their names and hashes.
#[test]
fn sessions_of_one_day_stand_in_the_order_of_their_times() {
    for hour in ["T08:00:00", "T09:00:00", "T10:00:00", "T11:00:00"] {
        let results = Results::new();
        results.add("z", "0001", &format!("2024-05-01{hour}"), |result| set(result, "df_1", 1e-3));
        results.add("a", "0001", "2024-05-01T15:00:00", |result| set(result, "df_1", 2e-3));
        results.add("b", "0001", "2023-05-01", |result| set(result, "df_1", 1e-3));
        assert_eq!(results.run(&["add", "s", "z", "a", "b"]).0, 0);
        for place in [".", "s"] {
            let unit = results.document(&["unit", place]);
            let of = unit["parameters"].as_array().unwrap().iter().find(|p| p["name"] == "df_1").unwrap();
            assert_eq!(of["values"][2], 2e-3, "{of}");
            assert_eq!(unit["sessions"][2]["stamp"], "2024-05-01T15:00:00");
        }
        assert!(results.run(&["unit", "s"]).1.contains("SAME DAY  2024-05-01"));
    }
}

/// A date to come is no day that a limit holds on, and no day before the last calibration is asked.
#[test]
fn a_date_to_come_is_named() {
    let results = Results::new();
    results.add("a", "0001", "2024-05-01", |result| set(result, "df_1", 1e-3));
    results.add("b", "0001", "2994-05-01", |result| set(result, "df_1", 1e-3));
    let (code, text, _) = results.run(&["unit", ".", "--limit", "1 g"]);
    assert!(code == 1 && text.contains("AHEAD  the last calibration is of 2994-05-01, later than today"), "{text}");
    assert_eq!(results.document(&["unit", "."])["ahead"], true);
    let (code, _, message) = results.run(&["unit", ".", "--limit", "1 g", "--on", "2024-06-01"]);
    assert!(code == 2 && message.contains("found --on 2024-06-01, expected 2994-05-01"), "{message}");
}

/// Sessions of one day have no line in time; with a limit below what they state the unit is overdue.
#[test]
fn sessions_of_a_single_day_have_no_trend() {
    let results = Results::new();
    for session in 0..5 {
        results.add(&format!("s{session}"), "0001", "2024-05-01", |result| {
            set(result, "df_1", 1e-3 + 1e-5 * f64::from(session));
        });
    }
    let (code, text, _) = results.run(&["unit", ".", "--limit", "1 ug"]);
    assert!(code == 1 && text.contains("OVERDUE"), "{text}");
    assert_eq!(results.document(&["unit", "."])["trend"], false);
    let (_, text, _) = results.run(&["unit", ".", "--limit", "1 g"]);
    assert!(text.contains("NOT KNOWN  calibrations of a single day do not show until when"), "{text}");
    let due = results.document(&["unit", ".", "--limit", "1 g"]);
    assert!(due["due"].is_null() && due["due_after"].is_null(), "{due}");
}

/// Two calibrations show no drift: no day follows from them unless parameters are taken as constant.
#[test]
fn two_calibrations_give_a_due_date_without_a_trend_alone() {
    let results = Results::new();
    for (session, date) in [(0, "2024-05-01"), (1, "2025-05-01")] {
        results.add(&format!("s{session}"), "0001", date, |result| {
            set(result, "df_1", 1e-3 + 1e-5 * f64::from(session));
        });
    }
    let (_, text, _) = results.run(&["unit", ".", "--limit", "1 g"]);
    assert!(text.contains("NOT KNOWN  two calibrations do not show until when"), "{text}");
    let due = results.document(&["unit", ".", "--limit", "1 g"]);
    assert!(due["due"].is_null() && due["due_after"].is_null(), "{due}");
    let due = results.document(&["unit", ".", "--limit", "1 g", "--without-trend"]);
    assert!(due["due_after"].is_string() && due["is_within"] == true, "{due}");
}

/// Results of the same records agree better than independent calibrations do.
#[test]
fn results_that_are_too_alike_are_named() {
    let results = Results::new();
    for (session, day) in ["2024-01-01", "2024-02-01", "2024-03-01"].into_iter().enumerate() {
        results.add(day, "0001", day, |result| set(result, "df_1", 1e-3 * (1.0 + 1e-9 * session as f64)));
    }
    let (_, text, _) = results.run(&["unit", "."]);
    assert!(text.contains("TOO ALIKE") && !text.contains("THE SAME"), "{text}");
}

/// Batches are compared by the sessions at one station, by the last value as by the mean; a spreadsheet that dropped zeros is understood.
#[test]
fn batches_are_compared_at_one_station() {
    let results = Results::new();
    for unit in 0..8 {
        let (serial, station) = (format!("000{unit}"), if unit < 5 { "east" } else { "west" });
        let bias = if unit < 5 { 1e-3 } else { 9e-3 } + 1e-5 * f64::from(unit);
        results.add(&serial, &serial, "2024-01-01", |result| {
            set(result, "df_1", bias);
            result["session"]["station"] = json!(station);
        });
    }
    let batches = |text: &str| fs::write(results.path().join("b.csv"), text).unwrap();
    let ask = ["units", ".", "--batches", "b.csv"];
    batches("serial,batch\n0000,a\n0001,a\n0002,b\n0003,b\n0005,b\n0006,b\n");
    assert_eq!(results.document(&ask)["batches_at"], "east");
    assert!(results.run(&ask).1.contains("BATCHES ALIKE  a (2), b (2)"), "{}", results.run(&ask).1);
    batches("serial,batch\n0000,a\n0001,a\n0005,b\n0006,b\n");
    let (code, text, _) = results.run(&ask);
    assert!(code == 1 && text.contains("BATCHES NOT COMPARED") && !text.contains("BATCHES DIFFER"), "{text}");
    batches("serial,batch\n0,a\n1,a\n2,b\n3,b\n");
    let (code, text, _) = results.run(&ask);
    assert!(code == 1 && text.contains("no unit has the serial \"0\" of the batches, expected \"0000\"?"), "{text}");
}

/// What a longer error model has, a shorter one takes for zero: among eight calibrations with the longer one the ninth is left out and named.
#[test]
fn a_calibration_with_a_shorter_model_is_left_out() {
    let results = Results::new();
    let run = |arguments: &[&str]| {
        let made = centrical().args(arguments).arg("-q").current_dir(results.path()).output().unwrap();
        assert!(made.status.success(), "{made:?}");
    };
    run(&["reduce", example().to_str().unwrap(), "--out", "reduced"]);
    let file = results.path().join("reduced/experiment.toml");
    let text = fs::read_to_string(&file).unwrap();
    let model = text.lines().find(|line| line.starts_with("error_model")).unwrap();
    fs::write(&file, text.replace(model, "error_model = [\"kozlov-2017\", \"odd-quadratic\"]")).unwrap();
    run(&["calibrate", "reduced", "--out", "longer"]);
    let longer: Value = serde_json::from_slice(&fs::read(results.path().join("longer/result.json")).unwrap()).unwrap();
    fs::remove_dir_all(results.path().join("longer")).unwrap();
    fs::remove_dir_all(results.path().join("reduced")).unwrap();
    for session in 0..9 {
        let date = format!("{}-01-01", 2012 + session);
        results.add(&format!("s{session}"), "0001", &date, |result| {
            if session != 4 {
                let of = result["session"].clone();
                result.clone_from(&longer);
                result["session"] = of;
            }
        });
    }
    results.add("other", "0002", "2012-01-01", |_| {});
    let units = results.document(&["units", "."]);
    // Units are compared by what all determine, and what the longer model alone has is named.
    assert!(units["left_out"].is_null(), "{units}");
    assert_eq!(units["not_compared"][0], json!({ "name": "K_1[f1*|f1|]", "sessions": 8 }));
    fs::remove_dir_all(results.path().join("other")).unwrap();
    let unit = results.document(&["unit", "."]);
    assert_eq!(unit["sessions"].as_array().unwrap().len(), 8);
    assert_eq!(unit["left_out"][0]["date"], "2016-01-01");
    assert!(unit["incomplete"].is_null() && !unit["left_out"][0]["lacks"].as_array().unwrap().is_empty());
}

/// A limit without a unit would be one in m/s^2.
#[test]
fn a_limit_has_a_unit() {
    let results = Results::new();
    results.add("a", "0001", "2023-01-01", |_| {});
    results.add("b", "0001", "2024-01-01", |_| {});
    for arguments in [&["unit", ".", "--limit", "300"][..], &["page", ".", "--out", "pages", "--limit", "300"]] {
        let (code, _, message) = results.run(arguments);
        assert!(code == 2 && message.contains("found \"300\", expected an acceleration with its unit"), "{message}");
    }
}

/// Days before the last calibration, names that nothing has and days of long ago are said to be so.
#[test]
fn days_and_names_that_nothing_has_are_named() {
    let results = Results::new();
    results.add("a", "0001", "1924-05-01", |_| {});
    results.add("b", "0001", "2024-01-01", |_| {});
    let (code, _, message) = results.run(&["unit", ".", "--until", "2023-01-01"]);
    assert!(code == 2 && message.contains("found --until 2023-01-01, expected 2024-01-01"), "{message}");
    assert_eq!(results.run(&["add", "store", "a", "b"]).0, 0);
    let (code, text, _) = results.run(&["list", "store", "--check"]);
    assert!(code == 1 && text.contains("LONG AGO") && text.contains("found a date before 1980"), "{text}");
    let (code, _, message) = results.run(&["list", "store", "--station", "nowhere"]);
    assert!(code == 2 && message.contains("found no such calibration"), "{message}");
}

/// A repair is a step between two sessions, not a drift; a session with an objection counts, which is said.
#[test]
fn a_repair_is_named_as_a_step() {
    let results = Results::new();
    for n in 0..6 {
        let date = format!("{}-01-01", 2019 + n);
        let bias = |result: &Value| {
            result["parameters"].as_array().unwrap().iter().find(|p| p["name"] == "df_1").unwrap().clone()
        };
        results.add(&n.to_string(), "0001", &date, |result| {
            let of = |key: &str| bias(result)[key].as_f64().unwrap();
            let (value, u) = (of("value"), of("standard_uncertainty"));
            let noise = [0.4, -0.8, 0.9, -0.5, 0.7, -0.2][n];
            set(result, "df_1", value + u * (noise + if n < 4 { 0.0 } else { 25.0 }));
            if n == 2 {
                result["validity"]["probability"] = json!(1e-9);
                result["fit"]["chi_squared"] = json!(1e4);
            }
        });
    }
    let (_, text, _) = results.run(&["unit", "."]);
    assert!(text.contains("STEP") && text.contains("between 2022-01-01 and 2023-01-01"), "{text}");
    assert!(text.contains("1 calibration before the last with an objection"), "{text}");
    let document = results.document(&["unit", "."]);
    let steps = document["parameters"].as_array().unwrap().iter().filter(|p| !p["step"].is_null());
    let steps: Vec<(&str, &Value)> = steps.map(|p| (p["name"].as_str().unwrap(), &p["step"])).collect();
    assert_eq!(steps, [("df_1", &json!(["2022-01-01", "2023-01-01"]))]);
}

/// A linear fit has another budget than its covariance: the row of a store holds what agrees, and the store stays readable.
#[test]
fn a_store_reads_the_result_of_a_linear_fit() {
    let results = Results::new();
    let mut command = centrical();
    command.arg("calibrate").arg(example()).args(["--linear", "--out", "linear", "--store", "store", "-q"]);
    assert_eq!(command.current_dir(results.path()).output().unwrap().status.code(), Some(1));
    let (code, _, message) = results.run(&["list", "store", "--check"]);
    assert_eq!(code, 0, "{message}");
}
