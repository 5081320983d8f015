//! Every command prints one JSON document on `--json`, of a pinned form, with the numbers that the text and the files hold; and
//! nothing that was not asked for on `--quiet`.

use std::collections::BTreeSet;
use std::fs;

use serde_json::Value;

use crate::session::Copy;

/// Schema and keys of every document but those that `docs/session.md` describes. A key may be added; none is taken away.
const FORMS: &str = include_str!("json_forms.txt");

/// Runs a command and reads its standard output as one document.
fn json(copy: &Copy, arguments: &[&str]) -> Value {
    let output = copy.run(arguments);
    let (said, warned) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    serde_json::from_str(&said).unwrap_or_else(|error| panic!("{arguments:?}: {error}\n{said}{warned}"))
}

/// Paths of the keys below `value`, elements of lists alike.
fn keys(value: &Value, path: &str, found: &mut BTreeSet<String>) {
    match value {
        Value::Object(members) => {
            for (key, member) in members {
                let path = format!("{path}.{key}");
                keys(member, &path, found);
                found.insert(path);
            }
        }
        Value::Array(list) => list.iter().for_each(|element| keys(element, &format!("{path}[]"), found)),
        _ => {}
    }
}

fn hold(document: &Value) {
    let schema = document["schema"].as_str().expect("a schema");
    assert_eq!(document["program"]["name"], "centrical");
    let mut found = BTreeSet::new();
    keys(document, "", &mut found);
    let pinned = |line: &&str| line.split_once(' ').is_some_and(|(name, _)| name == schema);
    let pinned: BTreeSet<String> =
        FORMS.lines().filter(pinned).filter_map(|line| Some(line.split_once(' ')?.1.to_owned())).collect();
    let lines: Vec<String> = found.iter().map(|path| format!("{schema} {path}")).collect();
    assert!(!pinned.is_empty() && pinned == found, "json_forms.txt does not hold\n{}", lines.join("\n"));
}

fn numbers(list: &Value, key: &str) -> Vec<Option<f64>> {
    list.as_array().unwrap().iter().map(|element| element[key].as_f64()).collect()
}

/// The example, calibrated.
fn calibrated() -> (Copy, String, Value) {
    let copy = Copy::new();
    assert!(copy.calibrate(&["--quiet"]).status.success());
    let session = copy.session().to_str().unwrap().to_owned();
    let result = serde_json::from_slice(&fs::read(copy.out().join("result.json")).unwrap()).unwrap();
    (copy, session, result)
}

#[test]
fn compare_says_what_its_table_says() {
    let (copy, _, result) = calibrated();
    let mut other = result.clone();
    let bias = other["parameters"].as_array_mut().unwrap().iter_mut().find(|p| p["name"] == "df_1").unwrap();
    let shifted = bias["value"].as_f64().unwrap() + 10.0 * bias["standard_uncertainty"].as_f64().unwrap();
    bias["value"] = shifted.into();
    fs::write(copy.out().join("other.json"), other.to_string()).unwrap();
    let document = json(&copy, &["compare", "result.json", "other.json", "--years", "2", "--json"]);
    hold(&document);
    let pair = &document["comparisons"][0];
    assert_eq!((document["agree"].as_bool(), pair["agree"].as_bool()), (Some(false), Some(false)));
    let differing: Vec<&Value> =
        pair["differences"].as_array().unwrap().iter().filter(|d| d["disagrees"] == true).collect();
    assert_eq!(differing.len(), 1);
    assert_eq!(differing[0]["name"], "df_1");
    // Ten uncertainties of one are 10/sqrt(2) of the difference, and half that with k = 2.
    assert!((differing[0]["e_n"].as_f64().unwrap() - 5.0 / 2.0_f64.sqrt()).abs() < 1e-9);
    let [difference, per_year] = ["difference", "per_year"].map(|key| differing[0][key].as_f64().unwrap());
    assert_eq!(per_year, difference / 2.0);
    let same = json(&copy, &["compare", "result.json", "result.json", "-j"]);
    assert_eq!(same["agree"], true);
    assert!(same["comparisons"][0]["years"].is_null());
}

#[test]
fn assess_holds_the_uncertainties_of_the_result() {
    let (copy, session, result) = calibrated();
    let document = json(&copy, &["assess", &session, "--without-outliers", "-j", "-q"]);
    hold(&document);
    let [own, known] = [&document, &result].map(|d| numbers(&d["parameters"], "standard_uncertainty"));
    assert_eq!(own.len(), 49);
    for (own, known) in own.into_iter().zip(known) {
        // Both are from one fit; the result's are the fit's own where nothing is stated beyond it.
        assert!((own.unwrap() / known.unwrap() - 1.0).abs() < 1e-9, "{own:?} {known:?}");
    }
    assert_eq!(document["without_outliers"]["left_out"], Value::Array(Vec::new()));
    assert_eq!(document["fit"]["chi_squared"], result["fit"]["chi_squared"]);
    assert_eq!(document["plateaus"].as_array().unwrap().len(), 108);
    assert!(json(&copy, &["assess", &session, "--json"])["without_outliers"].is_null());
}

#[test]
fn models_and_montecarlo_hold_what_their_tables_hold() {
    let (copy, session, _) = calibrated();
    let reduced = copy.run(&["reduce", &session, "-o", "reduced", "-q"]);
    assert!(reduced.status.success() && reduced.stdout.is_empty());
    let document = json(&copy, &["models", "reduced", "--json"]);
    hold(&document);
    let recommended = usize::try_from(document["recommended"].as_u64().unwrap()).unwrap();
    let candidates = document["candidates"].as_array().unwrap();
    let lowest = candidates.iter().filter(|c| c["converged"] == true).filter_map(|c| c["bic"].as_f64());
    assert_eq!(candidates[recommended]["bic"].as_f64(), lowest.reduce(f64::min));
    assert_eq!(candidates[recommended]["name"], "as stated");

    let document = json(&copy, &["montecarlo", "reduced", "--runs", "40", "--json"]);
    hold(&document);
    assert_eq!((document["runs"].as_u64(), document["failures"].as_u64()), (Some(40), Some(0)));
    assert_eq!(document["parameters"].as_array().unwrap().len(), 49);
    // One run has no standard deviation.
    assert_eq!(copy.run(&["montecarlo", "reduced", "--runs", "1", "--json"]).status.code(), Some(2));
}

#[test]
fn reduce_holds_the_plateaus_of_the_result() {
    let (copy, session, result) = calibrated();
    let document = json(&copy, &["reduce", &session, "--out", "reduced", "--json"]);
    hold(&document);
    let [own, known] = [&document, &result].map(|d| d["plateaus"].as_array().unwrap());
    assert_eq!(own.len(), known.len());
    for (own, known) in own.iter().zip(known) {
        for key in ["mounting", "index", "speed", "angle", "window", "samples", "mean", "covariance", "left_out"] {
            assert_eq!(own[key], known[key], "{key}");
        }
    }
}

#[test]
fn compensate_counts_the_readings() {
    let (copy, ..) = calibrated();
    let record = copy.session().join("records/m01.csv");
    let arguments = ["compensate", "result.json", record.to_str().unwrap(), "-o", "f.csv", "--range", "5 g", "--json"];
    let document = json(&copy, &arguments);
    hold(&document);
    let written = fs::read_to_string(copy.out().join("f.csv")).unwrap();
    assert_eq!(document["readings"].as_u64(), Some(written.lines().count() as u64 - 1));
    let missing = written.lines().filter(|line| line.ends_with("NaN") || line.ends_with("nan")).count();
    assert_eq!(document["outside_range"]["count"].as_u64(), Some(missing as u64));
    assert!(missing > 0 && document["beyond_calibration"]["first"].is_null());
}

#[test]
fn documents_drafts_and_simulations_are_listed() {
    let (copy, session, _) = calibrated();
    let document = json(&copy, &["report", "result.json", "--html", "report.html", "--code", "code", "--json"]);
    hold(&document);
    assert_eq!(document["acceptable"], true);
    let kinds: Vec<&str> = document["written"].as_array().unwrap().iter().filter_map(|d| d["kind"].as_str()).collect();
    assert_eq!(kinds, ["report", "code"]);

    let records = copy.session().join("records");
    let document = json(&copy, &["init", records.to_str().unwrap(), "--out", "draft.toml", "--json"]);
    hold(&document);
    assert_eq!(document["text"], fs::read_to_string(copy.out().join("draft.toml")).unwrap());
    let lines: Vec<&str> = document["text"].as_str().unwrap().lines().collect();
    for asked in document["fill_in"].as_array().unwrap() {
        let line = lines[usize::try_from(asked["line"].as_u64().unwrap()).unwrap() - 1];
        assert!(line.contains("FILL IN"), "{line}");
    }

    fs::write(copy.out().join("truth.toml"), "typical = { size = 1.0, seed = 7 }\n[machine]\nplateau = \"2 s\"\n")
        .unwrap();
    let arguments = ["simulate", &session, "--truth", "truth.toml", "--seed", "3", "-o", "simulated", "--json"];
    let document = json(&copy, &arguments);
    hold(&document);
    assert_eq!((document["mountings"].as_u64(), document["plateaus"].as_u64()), (Some(12), Some(108)));
}

#[test]
fn watch_prints_the_lines_of_its_history() {
    let copy = Copy::new();
    let session = copy.session();
    let output = copy.run(&["watch", session.to_str().unwrap(), "--once", "--quiet", "0", "-o", "watched", "--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let history = fs::read(copy.out().join("watched/watch-history.jsonl")).unwrap();
    assert_eq!(history, output.stdout);
    assert!(history.split(|byte| *byte == b'\n').count() > 101);
}

/// The exit code and the messages stay; a document that was asked for is printed.
#[test]
fn quiet_commands_print_nothing_else() {
    let (copy, session, _) = calibrated();
    for arguments in [
        &["observe", &session, "-q"][..],
        &["assess", &session, "--quiet"],
        &["compare", "result.json", "result.json", "-q"],
        &["noise", &session, "--plateau", "2:1", "-q"],
        &["man", "--out", "pages", "-q"],
    ] {
        let output = copy.run(arguments);
        assert_eq!((output.status.code(), output.stdout.len(), output.stderr.len()), (Some(0), 0, 0), "{arguments:?}");
    }
    let recursive = copy.calibrate(&["--method", "recursive", "-q"]);
    assert_eq!((recursive.status.code(), recursive.stdout.len(), recursive.stderr.len()), (Some(0), 0, 0));
    let schema = |further: &[&str]| copy.run(&[&["schema", "truth"], further].concat()).stdout;
    assert_eq!(schema(&["-q", "-j"]), schema(&[]));
    let refused = copy.run(&["observe", "nothing.toml", "-q"]);
    assert_eq!((refused.status.code(), refused.stdout.len()), (Some(2), 0));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("nothing.toml"));
}

/// What a terminal would obey is escaped in JSON, the same text to whoever reads it, and replaced in a table as text.
#[test]
fn names_that_are_not_shown() {
    let copy = Copy::new();
    copy.edit("experiment.toml", |text| text.replacen("\"0001\"", r#""a\u001bb\u202Ec\u009bd\uFFFE""#, 1));
    let session = copy.session();
    let series = copy.run(&["series", session.to_str().unwrap(), "--out", "store", "-q"]);
    assert_eq!(series.status.code(), Some(0), "{}", String::from_utf8_lossy(&series.stderr));
    let table = fs::read_to_string(copy.out().join("store/series.csv")).unwrap();
    assert!(table.contains(",a\u{fffd}b\u{fffd}c\u{fffd}d\u{fffd},"), "{table}");
    assert_eq!(copy.calibrate(&[]).status.code(), Some(0));
    let result = fs::read_to_string(copy.out().join("result.json")).unwrap();
    assert!(result.contains(r#""a\u001bb\u202ec\u009bd\ufffe""#), "{}", &result[..400]);
    let result: Value = serde_json::from_str(&result).unwrap();
    assert_eq!(result["session"]["unit_serial"], "a\u{1b}b\u{202e}c\u{9b}d\u{fffe}");
}
