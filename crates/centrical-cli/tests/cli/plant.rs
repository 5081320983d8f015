//! `history unit | units | station | chart | page` on a plant whose faults are known.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use serde_json::{Value, json};
use tempfile::TempDir;

use crate::program::centrical;
use crate::random::Random;
use crate::session::example;

const UNITS: usize = 14;
const SESSIONS: usize = 4;

/// Calibrations of fourteen units in four years, results of the example with other values: a bias of unit 3 drifts, a scale of unit 7 is
/// off, and the tilt of the machine grows. Returns their folder.
fn plant() -> TempDir {
    let folder = TempDir::new().unwrap();
    let made = run(folder.path(), &["calibrate", example().to_str().unwrap(), "--out", "first", "-q"]);
    assert!(made.status.success(), "{made:?}");
    let first: Value = serde_json::from_slice(&fs::read(folder.path().join("first/result.json")).unwrap()).unwrap();
    fs::remove_dir_all(folder.path().join("first")).unwrap();
    let mut random = Random::new(6);
    for unit in 0..UNITS {
        let own: Vec<f64> = (0..49).map(|_| 20.0 * random.normal()).collect();
        for session in 0..SESSIONS {
            let mut result = first.clone();
            for (place, parameter) in result["parameters"].as_array_mut().unwrap().iter_mut().enumerate() {
                let name = parameter["name"].as_str().unwrap().to_owned();
                let u = parameter["standard_uncertainty"].as_f64().unwrap();
                let years = session as f64 + unit as f64 / 20.0;
                let planted = match (name.as_str(), unit) {
                    ("df_1", 3) => 40.0 * years,
                    ("G0_11", 7) => 400.0,
                    ("alpha_1", _) => 3.0 * years,
                    _ => 0.0,
                };
                let of_unit = if place >= 28 { own[place] } else { 0.0 };
                let value = parameter["value"].as_f64().unwrap() + u * (of_unit + planted + 0.5 * random.normal());
                parameter["value"] = json!(value);
            }
            result["session"]["unit_serial"] = json!(format!("{unit:04}"));
            result["session"]["date"] = json!(format!("{}-03-{:02}", 2021 + session, 1 + unit));
            let place = folder.path().join(format!("plant/{unit:04}/{session}"));
            fs::create_dir_all(&place).unwrap();
            fs::write(place.join("result.json"), result.to_string()).unwrap();
        }
    }
    assert!(run(folder.path(), &["history", "add", "store", "plant"]).status.success());
    folder
}

fn run(folder: &Path, arguments: &[&str]) -> Output {
    centrical().args(arguments).current_dir(folder).output().unwrap()
}

/// The document of a subcommand, and its exit code.
fn history(folder: &Path, arguments: &[&str]) -> (Value, i32) {
    let output = run(folder, &[&["history"], arguments, &["--json"]].concat());
    let document = serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{output:?}"));
    (document, output.status.code().unwrap())
}

fn names<'a>(rows: &'a Value, mark: &str) -> Vec<&'a str> {
    let marked = rows.as_array().unwrap().iter().filter(|row| row[mark] == true);
    marked.map(|row| row["name"].as_str().unwrap()).collect()
}

#[test]
fn planted_faults_are_found() {
    let folder = plant();
    let folder = folder.path();

    let (units, code) = history(folder, &["units", "store"]);
    assert_eq!((units["units"].as_u64(), units["sessions"].as_u64(), code), (Some(14), Some(56), 1));
    let outlying: Vec<&Value> = units["outlying"].as_array().unwrap().iter().map(|unit| &unit["unit_serial"]).collect();
    // In one plant of twenty a sound unit is called outlying too; the properties of the numerics hold that.
    assert_eq!(outlying[0], &json!("0007"));
    let findings = units["findings"].as_array().unwrap();
    assert!(findings.iter().all(|f| f["unit_serial"] == "0003" && f["parameter"] == "df_1"), "{findings:?}");
    assert!(findings.iter().any(|f| f["kind"] == "drifts"));

    // Capability against the laboratory's limits, and batches; of a store as of results.
    let laboratory = example().join("laboratory.toml");
    let batch = |unit: usize| format!("{unit:04},{}", if unit < 7 { "A" } else { "B" });
    let batches: Vec<String> = (0..UNITS).map(batch).collect();
    fs::write(folder.join("batches.csv"), format!("serial,batch\n{}\n", batches.join("\n"))).unwrap();
    let options = ["--laboratory", laboratory.to_str().unwrap(), "--batches", "batches.csv"];
    let (units, _) = history(folder, &[&["units", "store"], options.as_slice()].concat());
    let (of_results, _) = history(folder, &[&["units", "plant"], options.as_slice()].concat());
    for (p, of_results) in
        units["parameters"].as_array().unwrap().iter().zip(of_results["parameters"].as_array().unwrap())
    {
        let [mean, deviation] = ["mean", "deviation"].map(|key| p[key].as_f64().unwrap());
        let has_limits = p["name"].as_str().unwrap().starts_with("df_");
        assert!(has_limits != p["capability"].is_null() && p["batch_probability"].is_number(), "{p}");
        if has_limits {
            // The nearer limit of -0.15 and 0.15 m/s^2.
            let cpk = (0.15 - mean.abs()) / (3.0 * deviation);
            for capability in [&p["capability"], &of_results["capability"]] {
                assert!((capability["cpk"].as_f64().unwrap() / cpk - 1.0).abs() < 1e-9, "{capability}");
            }
        }
    }
    let unknown = fs::read_to_string(&laboratory).unwrap().replace("\"df_2\"", "\"df_9\"");
    fs::write(folder.join("laboratory.toml"), unknown).unwrap();
    let refused = run(folder, &["history", "units", "store", "--laboratory", "laboratory.toml"]);
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(refused.status.code() == Some(2) && said.contains("laboratory.toml, [[decision.limit]] 2"), "{said}");
    assert!(said.contains("found \"df_9\", expected one of "), "{said}");

    let (station, code) = history(folder, &["station", "store"]);
    assert_eq!((names(&station["parameters"], "changes"), code), (vec!["alpha_1"], 1));

    // The same from the results themselves.
    let (unit, code) = history(folder, &["unit", "plant", "--serial", "0003", "--limit", "100000 ug"]);
    assert!(names(&unit["parameters"], "drifts").contains(&"df_1") && code == 0);
    let (stored, _) = history(folder, &["unit", "store", "--serial", "0003", "--limit", "100000 ug"]);
    assert_eq!(stored["parameters"], unit["parameters"]);
    let slope = unit["parameters"].as_array().unwrap().iter().find(|p| p["name"] == "df_1").unwrap();
    let [low, high] = [0, 1].map(|end| slope["slope_interval"][end].as_f64().unwrap());
    let u = slope["standard_uncertainties"][0].as_f64().unwrap();
    assert!(low < 40.0 * u && 40.0 * u < high, "{slope}");
    let (overdue, code) = history(folder, &["unit", "store", "--serial", "0003", "--limit", "1 ug", "--together"]);
    assert_eq!((overdue["is_within"].as_bool(), overdue["units_together"].as_u64(), code), (Some(false), Some(14), 1));
    // Days are those of ISO 8601.
    assert_eq!((&overdue["sessions"][3]["date"], &overdue["until"]), (&json!("2024-03-04"), &json!("2025-03-04")));
    assert_eq!((&station["first"], &station["last"]), (&json!("2021-03-01"), &json!("2024-03-14")));

    let (chart, code) = history(folder, &["chart", "alpha_1", "store", "--out", "charts"]);
    assert!(code == 1 && chart["signals"].as_array().unwrap().iter().any(|s| s["rule"] == "cusum"), "{code}");
    let is_of_single_values = |signal: &Value| signal["rule"].as_str().unwrap().starts_with("nelson-");
    let (calm, code) = history(folder, &["chart", "alpha_2", "store", "--centre", "0", "--deviation", "1"]);
    assert!(code == 1 && calm["signals"].as_array().unwrap().iter().all(is_of_single_values));
    for name in ["individuals", "moving-ranges", "ewma", "cusum"] {
        assert!(fs::read_to_string(folder.join(format!("charts/{name}.svg"))).unwrap().starts_with("<svg"));
    }
}

#[test]
fn pages_name_every_calibration_and_no_name_becomes_markup() {
    let folder = plant();
    let folder = folder.path();
    let file = folder.join("plant/0000/0/result.json");
    let mut result: Value = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
    result["session"]["unit_serial"] = json!("<script>alert(1)</script>");
    fs::write(&file, result.to_string()).unwrap();
    assert!(run(folder, &["history", "add", "store", file.to_str().unwrap()]).status.success());
    let made = run(folder, &["history", "page", "store", "--out", "pages", "--limit", "3000 ug"]);
    assert!(made.status.success(), "{made:?}");
    let index = fs::read_to_string(folder.join("pages/index.html")).unwrap();
    assert_eq!(index.matches("<tr><td>").count(), UNITS * SESSIONS + 1);
    assert!(!index.contains("<script>alert") && index.contains("&lt;script&gt;alert"));
    // The list, the due dates, a model, a station.
    assert_eq!(fs::read_dir(folder.join("pages")).unwrap().count(), 4 + UNITS);
    let unit = page(folder, "unit-0003-");
    assert!(unit.contains("serial 0003") && unit.contains("DRIFTS") && unit.matches("<svg").count() > 40);
    assert!(unit.contains("found 4 acceptable sessions, expected 20 for the limits"));
    assert!(
        !unit.contains("<pre") && unit.matches("<table class=\"sortable\">").count() == 3,
        "tables that can be sorted"
    );
    // The units of the model and those of the station, each with its page but the one that has come once.
    for of_all in [page(folder, "model-"), page(folder, "station-")] {
        assert_eq!(of_all.matches("<a href=\"unit-").count(), UNITS);
    }
    assert!(page(folder, "model-").contains("<td>DRIFTS: df_1</td>"));
    // Every link of every page leads to a page.
    for entry in fs::read_dir(folder.join("pages")).unwrap() {
        for link in fs::read_to_string(entry.unwrap().path()).unwrap().split("href=\"").skip(1) {
            let link = link.split('"').next().unwrap();
            assert!(link == "data:," || folder.join("pages").join(link).exists(), "{link}");
        }
    }
}

/// The page whose file begins so.
fn page(folder: &Path, begins: &str) -> String {
    let names = fs::read_dir(folder.join("pages")).unwrap().map(|entry| entry.unwrap().path());
    let is = |path: &PathBuf| path.file_name().unwrap().to_string_lossy().starts_with(begins);
    let found: Vec<PathBuf> = names.filter(is).collect();
    assert_eq!(found.len(), 1, "{begins}");
    fs::read_to_string(&found[0]).unwrap()
}

/// Capability against the laboratory's limits, batches and control charts stand in the pages as the commands have them.
#[test]
fn pages_show_what_the_commands_say() {
    let folder = plant();
    let folder = folder.path();
    let laboratory = example().join("laboratory.toml");
    let batches: Vec<String> = (0..UNITS).map(|unit| format!("{unit:04},batch {}", unit % 2)).collect();
    fs::write(folder.join("batches.csv"), batches.join("\n")).unwrap();
    let options = ["--laboratory", laboratory.to_str().unwrap(), "--batches", "batches.csv"];
    let made = run(folder, &[&["history", "page", "store", "--out", "pages"], options.as_slice()].concat());
    assert!(made.status.success(), "{made:?}");
    let (units, _) = history(folder, &[&["units", "store"], options.as_slice()].concat());
    let model = page(folder, "model-TA-200-");
    let parameters = units["parameters"].as_array().unwrap();
    for p in parameters.iter().filter(|p| !p["capability"].is_null()) {
        let [cp, cpk] = ["cp", "cpk"].map(|key| format!("{:.2}", p["capability"][key].as_f64().unwrap()));
        let name = p["name"].as_str().unwrap();
        let head = format!("<tr><th scope=\"row\">{name}</th>");
        let line = model.lines().find(|line| line.starts_with(&head) && line.contains(&cpk));
        assert!(line.is_some_and(|line| line.contains(&cp)), "{name} {cp} {cpk}");
    }
    let least = parameters.iter().filter_map(|p| p["capability"]["cpk"].as_f64()).fold(f64::INFINITY, f64::min);
    let index = page(folder, "index.html");
    assert!(index.contains(&format!("<td class=\"number\">{least:.2}</td>")), "the least Cpk, {least}");
    // A distribution and a drawing of the batches for each parameter, and four charts of each.
    assert_eq!(model.matches("<figure>").count(), (2 + 4) * parameters.len());
    assert!(model.contains(">batch 0<") && model.contains(">batch 1<"));
    let (chart, _) = history(folder, &["chart", "alpha_1", "store"]);
    let station = page(folder, "station-");
    let signals = chart["signals"].as_array().unwrap();
    assert!(!signals.is_empty() && station.contains(&format!("alpha_1: {} signals", signals.len())), "{signals:?}");
    let place = signals.last().unwrap()["session"].as_u64().unwrap();
    let last = &chart["sessions"][usize::try_from(place).unwrap()];
    let [day, serial] = ["date", "unit_serial"].map(|key| last[key].as_str().unwrap());
    let words = format!("{day}, serial {serial}: ");
    assert!(station.contains(&words), "{words}");
    let refused = run(folder, &["history", "page", "store", "--out", "other", "--laboratory", "nowhere.toml"]);
    assert!(refused.status.code() == Some(2) && !folder.join("other").exists(), "{refused:?}");
}

/// With a limit the pages say of each unit what the command says today, in the list of due dates as on the page of the unit; of a unit
/// of a single calibration nothing is known.
#[test]
fn due_dates_of_all_units_stand_in_a_list() {
    let folder = plant();
    let folder = folder.path();
    let once = fs::read_to_string(folder.join("plant/0001/0/result.json")).unwrap().replace("\"0001\"", "\"once\"");
    fs::write(folder.join("once.json"), once).unwrap();
    assert!(run(folder, &["history", "add", "store", "once.json"]).status.success());
    let limit = ["--limit", "2 mg"];
    let made = run(folder, &[&["history", "page", "store", "--out", "pages"], limit.as_slice()].concat());
    assert!(made.status.success(), "{made:?}");
    let due = page(folder, "due.html");
    let (mut overdue, mut within) = (0, 0);
    for unit in 0..UNITS {
        let serial = format!("{unit:04}");
        let ask = ["unit", "store", "--serial", &serial, limit[0], limit[1]];
        let (report, code) = history(folder, &ask);
        let is_overdue = report["is_within"] == false;
        assert_eq!(code, i32::from(is_overdue));
        let line = due.lines().find(|line| line.contains(&format!(">{serial}</a>"))).unwrap();
        assert_eq!(line.contains("<td class=\"bad\">overdue</td>"), is_overdue, "{line}");
        if let Some(day) = report["due"]["date"].as_str() {
            assert!(line.ends_with(&format!("<td>{day}</td></tr>")), "{line}");
        }
        assert_eq!(page(folder, &format!("unit-{serial}")).contains("OVERDUE"), is_overdue, "{serial}");
        *(if is_overdue { &mut overdue } else { &mut within }) += 1;
    }
    assert!(overdue > 0, "{overdue} {within}");
    assert!(due.contains(&format!(
        "of {} units, for compensated readings within 2000 µg: {overdue} overdue, 1 not known.",
        UNITS + 1
    )));
    assert!(due.lines().any(|line| line.contains(">once</th>") && line.contains("<td>not known</td>")), "{due}");
    assert!(page(folder, "index.html").contains("<a href=\"due.html\">"));
}

/// A page is made anew if one of its calibrations is new, or something else is asked.
#[test]
fn pages_of_units_without_news_are_left() {
    let folder = plant();
    let folder = folder.path();
    let write = |further: &[&str]| {
        let made = run(folder, &[&["history", "page", "store", "--out", "pages"], further].concat());
        assert!(made.status.success(), "{made:?}");
    };
    write(&[]);
    let units = || -> Vec<(PathBuf, Vec<u8>)> {
        let entries = fs::read_dir(folder.join("pages")).unwrap().map(|entry| entry.unwrap().path());
        let is_of_unit = |path: &PathBuf| path.file_name().unwrap().to_string_lossy().starts_with("unit-");
        let mut files: Vec<_> =
            entries.filter(is_of_unit).map(|path| (path.clone(), fs::read(&path).unwrap())).collect();
        files.sort();
        files
    };
    let whole = units();
    // Marks at the end of each page: a page that is made anew has none.
    for (path, bytes) in &whole {
        fs::write(path, [bytes.as_slice(), b"<!-- left -->"].concat()).unwrap();
    }
    let file = folder.join("plant/0005/3/result.json");
    let mut result: Value = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
    result["session"]["date"] = json!("2026-03-01");
    fs::write(&file, result.to_string()).unwrap();
    assert!(run(folder, &["history", "add", "store", file.to_str().unwrap()]).status.success());
    write(&[]);
    let is_left = |bytes: &[u8]| bytes.ends_with(b"<!-- left -->");
    for (path, bytes) in units() {
        assert_eq!(is_left(&bytes), !path.to_string_lossy().contains("unit-0005-"), "{}", path.display());
    }
    write(&["--limit", "300 ug"]);
    assert!(units().iter().all(|(_, bytes)| !is_left(bytes)));
    write(&[]);
    let again = units();
    assert!(again.iter().zip(&whole).filter(|(a, b)| a == b).count() == UNITS - 1);
}

#[test]
fn wrong_requests_say_what_was_expected() {
    let folder = plant();
    let said = |arguments: &[&str]| {
        let output = run(folder.path(), &[&["history"], arguments].concat());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    assert!(said(&["unit", "store"]).contains("14 units"));
    assert!(said(&["unit", "store", "--serial", "none"]).contains("no such calibration"));
    assert!(said(&["unit", "store", "--serial", "0001", "--confidence", "1.5"]).contains("between 0.5 and 1"));
    assert!(said(&["chart", "beta", "store"]).contains("no session that determines beta"));
    assert!(said(&["chart", "df_1", "store", "--accepted", "500"]).contains("56 acceptable sessions"));
    assert!(said(&["station", "nowhere"]).contains("nowhere"));
    fs::write(folder.path().join("batches.csv"), "serial,batch\n0001,A,7\n").unwrap();
    assert!(said(&["units", "store", "--batches", "batches.csv"]).contains("batches.csv, line 2"));
}

/// The certificate's and the report's words on a switch-on, from the earlier calibrations of the unit alone.
#[test]
fn documents_say_what_the_past_means_for_a_reading() {
    let folder = plant();
    let result = "plant/0003/2/result.json";
    let laboratory = example().join("laboratory.toml");
    let made = run(
        folder.path(),
        &[
            "report",
            result,
            "--past",
            "store",
            "--html",
            "r.html",
            "--dcc",
            "c.xml",
            "--laboratory",
            laboratory.to_str().unwrap(),
        ],
    );
    assert_ne!(made.status.code(), Some(2), "{made:?}");
    // The laboratory's file is of another certificate.
    let said = String::from_utf8_lossy(&made.stderr).into_owned();
    assert!(said.starts_with("OTHER DAYS  found [certificate] begun = 2026-10-05"), "{said}");
    let page = fs::read_to_string(folder.path().join("r.html")).unwrap();
    assert!(page.contains("After a switch-on"));
    // Three calibrations up to the day of this one; the fourth came later.
    assert!(page.contains("3 (2021-03-04 – 2023-03-04)"), "the calibrations of the unit");
    let digital = fs::read_to_string(folder.path().join("c.xml")).unwrap();
    assert!(digital.contains("after a switch-on: u = "));
    let alone = run(folder.path(), &["report", result, "--past", "plant/0004", "--html", "x.html"]);
    assert_eq!(alone.status.code(), Some(2));
    let said = String::from_utf8_lossy(&alone.stderr).into_owned();
    assert!(said.contains("plant/0004: found no earlier calibration of the unit, expected one or more of"), "{said}");
    assert!(!folder.path().join("x.html").exists());
}

/// A calibration that does not determine what the others do, as by rests alone, is named and compared by what it has; so are the parameters that only
/// the last one determines. Units beside each other leave it out.
#[test]
fn a_calibration_with_fewer_parameters_is_named() {
    let folder = plant();
    let folder = folder.path();
    let without = |result: &Path, prefix: &str| {
        let mut document: Value = serde_json::from_slice(&fs::read(result).unwrap()).unwrap();
        for parameter in document["parameters"].as_array_mut().unwrap() {
            if parameter["name"].as_str().unwrap().starts_with(prefix) {
                parameter["value"] = Value::Null;
                parameter["standard_uncertainty"] = Value::Null;
                parameter["estimable"] = json!(false);
            }
        }
        fs::write(result, document.to_string()).unwrap();
    };
    without(&folder.join("plant/0001/1/result.json"), "G1_");
    let ask = ["unit", "plant/0001", "--limit", "100 mg", "--on", "2024-03-02"];
    let (unit, code) = history(folder, &ask);
    let count = |key: &str| unit[key].as_array().unwrap().len();
    assert_eq!((count("sessions"), count("incomplete"), code), (4, 1, 0));
    assert!(unit["incomplete"][0]["date"] == "2022-03-02" && unit["incomplete"][0]["lacks"][0] == "G1_11", "{unit}");
    assert_eq!(unit["left_out"], Value::Null);
    let of = |name: &str| unit["parameters"].as_array().unwrap().iter().find(|p| p["name"] == name).unwrap();
    let values = of("G1_11")["values"].as_array().unwrap();
    assert!(values[1].is_null() && values[0].is_f64() && values.len() == 4 && of("df_1")["values"][1].is_f64());
    assert!(unit["is_within"].is_boolean() || unit["due_after"].is_string());
    let (units, _) = history(folder, &["units", "plant"]);
    assert_eq!((units["sessions"].as_u64(), units["left_out"].as_array().unwrap().len()), (Some(55), 1));
    assert!(units["parameters"].as_array().unwrap().iter().any(|p| p["name"] == "G1_11"));
    let shown = String::from_utf8(run(folder, &[&["history"], ask.as_slice()].concat()).stdout).unwrap();
    assert!(shown.contains("INCOMPLETE  2022-03-02"), "{shown}");

    // A last calibration that lacks them says so, and up to which force its days hold.
    let last = folder.join("plant/0001/3/result.json");
    let whole = fs::read(&last).unwrap();
    without(&last, "G1_");
    let (unit, _) = history(folder, &ask);
    assert!(unit["not_in_last"].as_array().unwrap().contains(&json!("G1_11")), "{unit}");
    let shown = String::from_utf8(run(folder, &[&["history"], ask.as_slice()].concat()).stdout).unwrap();
    assert!(shown.contains("NOT IN LAST") && shown.contains("µg up to"), "{shown}");
    fs::write(&last, whole).unwrap();

    // Where only the last has them, the others are compared by what they have, and no day is promised.
    for session in [0, 2] {
        without(&folder.join(format!("plant/0001/{session}/result.json")), "G1_");
    }
    let (unit, _) = history(folder, &ask);
    assert_eq!(unit["sessions"].as_array().unwrap().len(), 4);
    assert!(unit["not_compared"].as_array().unwrap().contains(&json!("G1_11")), "{unit}");
    assert!(unit["due_after"].is_null() && unit["is_within"] != true, "{unit}");
    let shown = String::from_utf8(run(folder, &[&["history"], ask.as_slice()].concat()).stdout).unwrap();
    assert!(shown.contains("NOT KNOWN") && shown.contains("NOT COMPARED"), "{shown}");
}

/// Attitudes of rests are as a hand laid the unit down: a station does not answer for them.
#[test]
fn attitudes_of_rests_are_not_of_the_machine() {
    let folder = plant();
    let folder = folder.path();
    let (station, code) = history(folder, &["station", "plant"]);
    assert!(names(&station["parameters"], "changes").contains(&"alpha_1") && code == 1);
    for unit in 0..UNITS {
        for session in 0..SESSIONS {
            let file = folder.join(format!("plant/{unit:04}/{session}/result.json"));
            let mut result: Value = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
            let parameters = result["parameters"].as_array_mut().unwrap();
            for parameter in parameters.iter_mut().filter(|p| p["name"] == "alpha_1") {
                parameter["group"] = json!("attitude");
            }
            fs::write(&file, result.to_string()).unwrap();
        }
    }
    let (station, _) = history(folder, &["station", "plant"]);
    assert!(station["parameters"].as_array().unwrap().iter().all(|p| p["name"] != "alpha_1"), "{station}");
}
