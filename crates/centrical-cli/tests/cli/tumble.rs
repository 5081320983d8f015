//! `centrical tumble` on the record of the examples and on records without rests.

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

/// The rests of a session give what their record gave, also beside an arm; what the session states is not stated again.
#[test]
fn rests_of_a_session_are_taken_alone() {
    let copy = Copy::new();
    let of_record = ["tumble", &example("record.csv"), "--gravity", "9.81523 m/s^2", "--out", "tumbled"];
    assert_eq!(copy.run(&of_record).status.code(), Some(0));
    assert_eq!(copy.run(&["tumble", "tumbled", "--out", "again"]).status.code(), Some(0));
    let parameters = |folder: &str| json(&copy.out().join(folder).join("result.json"))["parameters"].clone();
    assert_eq!(parameters("again"), parameters("tumbled"));
    let refused = |arguments: &[&str], message: &str| {
        let output = copy.run(arguments);
        assert!(output.status.code() == Some(2) && said(&output).contains(message), "{}", said(&output));
    };
    refused(&["tumble", "tumbled", "--gravity", "9.8"], "tumbled: found --gravity beside a session");
    refused(&["tumble", "tumbled", "--terms", "G9"], "[model], error_model: found \"G9\"");
    refused(&["tumble", "../session"], "[[tumble]] 1, rests: found no such table");
    copy.edit("experiment.toml", |text| text + "\n[[tumble]]\nrests = \"../out/tumbled/rests.csv\"\n");
    let output = copy.run(&["tumble", "../session", "--out", "beside"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let (own, beside) = ("tumbled", "beside");
    for name in ["df_1", "df_2", "df_3", "G0_11", "G0_21", "G0_22", "G0_31", "G0_32", "G0_33"] {
        let [own, beside] = [own, beside].map(|out| estimate(&json(&copy.out().join(out).join("result.json")), name));
        // What the session states besides moves the uncertainty, not the estimate.
        assert!((own.0 - beside.0).abs() < 0.01 * own.1, "{name}: {own:?} {beside:?}");
    }
}

/// The noise of a record that is given twice would count for half.
#[test]
fn a_record_counts_once() {
    let copy = Copy::new();
    fs::copy(example("record.csv"), copy.out().join("again.csv")).unwrap();
    let output = copy.run(&["tumble", &example("record.csv"), "again.csv", "--gravity", "9.81523"]);
    let text = said(&output);
    assert!(output.status.code() == Some(2) && text.contains("again.csv: found the same bytes as in "), "{text}");
    let of_record = ["tumble", &example("record.csv"), "--gravity", "9.81523", "--out", "tumbled"];
    assert_eq!(copy.run(&of_record).status.code(), Some(0));
    fs::copy(copy.out().join("tumbled/rests.csv"), copy.out().join("rests.csv")).unwrap();
    let twice = "\n[[tumble]]\nrests = \"tumbled/rests.csv\"\n\n[[tumble]]\nrests = \"rests.csv\"\n";
    let alone = fs::read_to_string(copy.out().join("tumbled/experiment.toml")).unwrap();
    let alone = alone.split("[[tumble]]").next().unwrap();
    fs::write(copy.out().join("twice.toml"), format!("{alone}{twice}")).unwrap();
    let text = said(&copy.run(&["calibrate", "twice.toml", "--json"]));
    assert!(text.contains("rests.csv: found the readings of [[tumble]] 1, "), "{text}");
}

/// So does one that is pasted twice, or stands beside its own rests.
#[test]
fn a_record_that_is_pasted_twice_counts_once() {
    let copy = Copy::new();
    let record = fs::read_to_string(example("record.csv")).unwrap();
    let (head, rows) = record.split_once('\n').unwrap();
    let later = rows.lines().map(|row| {
        let (time, readings) = row.split_once(',').unwrap();
        format!("{:.3},{readings}\n", time.parse::<f64>().unwrap() + 200.017)
    });
    let twice: String = std::iter::once(format!("{head}\n{rows}")).chain(later).collect();
    fs::write(copy.out().join("twice.csv"), twice).unwrap();
    let text = said(&copy.run(&["tumble", "twice.csv", "--gravity", "9.81523"]));
    assert!(text.contains("twice.csv: found the readings of earlier rests in 24 others, in rest 25 at 2"), "{text}");
    let of_record = ["tumble", &example("record.csv"), "--gravity", "9.81523", "--out", "tumbled"];
    assert_eq!(copy.run(&of_record).status.code(), Some(0));
    fs::copy(example("record.csv"), copy.out().join("record.csv")).unwrap();
    let alone = fs::read_to_string(copy.out().join("tumbled/experiment.toml")).unwrap();
    let alone = alone.split("[[tumble]]").next().unwrap();
    let beside = "\n[[tumble]]\nrests = \"tumbled/rests.csv\"\n\n[[tumble]]\nrecord = \"record.csv\"\n";
    fs::write(copy.out().join("beside.toml"), format!("{alone}{beside}")).unwrap();
    let text = said(&copy.run(&["calibrate", "beside.toml", "--json"]));
    assert!(text.contains("record.csv: found the readings of earlier rests in 24 others"), "{text}");
}

/// A session with records is not written over.
#[test]
fn a_session_with_records_stays() {
    let copy = Copy::new();
    let file = copy.session().join("experiment.toml");
    let before = fs::read(&file).unwrap();
    let output = copy.run(&["tumble", &example("record.csv"), "--gravity", "9.81523", "--out", "../session"]);
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    assert!(said(&output).contains("experiment.toml: found a session, "), "{}", said(&output));
    assert!(fs::read(&file).unwrap() == before);
}

/// Names go into the session of the rests as TOML writes them.
#[test]
fn names_of_any_characters_are_written() {
    let copy = Copy::new();
    let serial = "a\u{1b}[31m\u{202e}\"\\";
    let output =
        copy.run(&["tumble", &example("record.csv"), "--gravity", "9.81523", "--serial", serial, "--out", "tumbled"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let copied = copy.run(&["calibrate", "tumbled", "--out", "again"]);
    assert_eq!(copied.status.code(), Some(0), "{}", said(&copied));
    let serial_of = |folder: &str| json(&copy.out().join(folder).join("result.json"))["session"]["unit_serial"].clone();
    assert_eq!((serial_of("again"), serial_of("tumbled")), (serial.into(), serial.into()));
}

/// The model goes into the session of the rests and into the draft that begins from it, and a session states its own.
#[test]
fn the_model_of_the_unit_is_stated() {
    let copy = Copy::new();
    let gravity = ["--gravity", "9.81523"];
    let named = ["--model", "TA-200", "--serial", "0001", "--out", "tumbled"];
    let output = copy.run(&[&["tumble", &example("record.csv")][..], &gravity, &named].concat());
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    assert_eq!(copy.run(&["calibrate", "tumbled", "--out", "again"]).status.code(), Some(0));
    for folder in ["tumbled", "again"] {
        let session = json(&copy.out().join(folder).join("result.json"))["session"].clone();
        assert_eq!((&session["unit_model"], &session["unit_serial"]), (&"TA-200".into(), &"0001".into()), "{folder}");
    }
    let records = copy.session().join("records");
    let drafted = copy.run(&["init", records.to_str().unwrap(), "--tumble", "tumbled", "--out", "draft.toml"]);
    let draft = fs::read_to_string(copy.out().join("draft.toml")).unwrap_or_else(|_| panic!("{}", said(&drafted)));
    assert!(draft.contains("model = \"TA-200\"  # FOUND"), "{draft}");
    let refused = copy.run(&["tumble", "tumbled", "--model", "TA-200"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(said(&refused).contains("found --model beside a session, expected the same in its experiment file"));
}

/// Stated attitudes, in any order, show the case besides; the folder keeps them with their rests.
#[test]
fn known_attitudes_show_the_case() {
    let copy = Copy::new();
    let attitudes = example("attitudes.csv");
    let arguments = ["tumble", &example("record.csv"), "--gravity", "9.81523 m/s^2", "--out", "tumbled"];
    let known = ["--attitudes", &attitudes, "--attitude-uncertainty", "1 mrad"];
    let output = copy.run(&[&arguments[..], &known].concat());
    let text = said(&output);
    assert_eq!(output.status.code(), Some(0), "{text}");
    assert!(text.contains("24 in attitudes known to 0.06 deg") && text.contains("case_turn_3"), "{text}");
    let folder = copy.out().join("tumbled");
    let (result, truth) = (json(&folder.join("result.json")), json(example("truth.json").as_ref()));
    for i in 0..3 {
        let (value, uncertainty) = estimate(&result, &format!("case_turn_{}", i + 1));
        let truth = truth["case_turn"][i].as_f64().unwrap();
        assert!((value - truth).abs() < 3.5 * uncertainty, "{i}: {value} +- {uncertainty}, in truth {truth}");
        // Each of the 24 rests shows two of three components.
        assert!((uncertainty / (1e-3 / 16.0_f64.sqrt()) - 1.0).abs() < 0.2, "{uncertainty}");
    }
    assert_eq!(copy.run(&["calibrate", "tumbled", "--out", "again", "--axes", "case"]).status.code(), Some(0));
    let again = json(&copy.out().join("again/result.json"));
    assert!(again["parameters"] == result["parameters"]);
    let in_case = again["axes"]["parameters"].as_array().unwrap();
    let turn = in_case.iter().find(|parameter| parameter["name"] == "turn_1").unwrap();
    assert!((turn["value"].as_f64().unwrap() / estimate(&result, "case_turn_1").0 - 1.0).abs() < 1e-10);
    let refused = |arguments: &[&str]| {
        let output = copy.run(arguments);
        assert_eq!(output.status.code(), Some(2), "{}", said(&output));
        said(&output).replace('\\', "/")
    };
    // Half of the attitudes fit some rests by chance in any order of the columns; all fit in one.
    let cyclic = ["tumble", &example("record.csv"), "--readings", "f2,f3,f1", "--gravity", "9.81523 m/s^2"];
    let text = refused(&[&cyclic[..], &known].concat());
    assert!(text.contains(" of 24 rests in one of these attitudes, and 24 of 24 with "), "{text}");
    // The rows are those of the rests.
    let table = folder.join("attitudes.csv");
    let rows = fs::read_to_string(&table).unwrap();
    let mut lines: Vec<&str> = rows.lines().collect();
    lines.swap(3, 7);
    fs::write(&table, lines.join("\n")).unwrap();
    let text = refused(&["calibrate", "tumbled"]);
    assert!(
        text.contains("tumbled/attitudes.csv, row 3") && text.contains("deg from that of the mean reading"),
        "{text}"
    );
    lines.truncate(20);
    fs::write(&table, lines.join("\n")).unwrap();
    let text = refused(&["calibrate", "tumbled"]);
    assert!(text.contains("found 19 rows, expected a row for each of the 24 rests"), "{text}");
    // A rest of unknown attitude is a row of zeros. Two rows are out of order still.
    lines.extend(["0,0,0"; 5]);
    (lines[3], lines[7]) = ("0,0,0", "0,0,0");
    fs::write(&table, lines.join("\n")).unwrap();
    let text = said(&copy.run(&["calibrate", "tumbled"]));
    assert!(text.contains("17 in attitudes known to 0.06 deg, 7 in attitudes that only gravity shows"), "{text}");
    let experiment = folder.join("experiment.toml");
    let without = fs::read_to_string(&experiment).unwrap().replace("attitude_uncertainty", "# ");
    fs::write(&experiment, without).unwrap();
    let text = refused(&["calibrate", "tumbled"]);
    assert!(text.contains("[[tumble]] 1, attitude_uncertainty: found no such key beside attitudes"), "{text}");
}

/// A certificate of rests alone says so, in print and for programs: no centrifuge and no speed.
#[test]
fn a_certificate_of_rests_names_no_centrifuge() {
    let copy = Copy::new();
    let record = example("record.csv");
    let tumble = ["tumble", &record, "--gravity", "9.81523 m/s^2", "--serial", "0001", "--out", "tumbled"];
    let table = example("attitudes.csv");
    let known = ["--attitudes", &table, "--attitude-uncertainty", "1 mrad"];
    let laboratory = format!("{}/../../examples/ta-200/laboratory.toml", env!("CARGO_MANIFEST_DIR"));
    for (options, attitudes) in [(&[][..], "not known beforehand"), (&known[..], "Of 24 attitudes 24 are known")] {
        let run = copy.run(&[&tumble[..], options].concat());
        assert_eq!(run.status.code(), Some(0), "{}", said(&run));
        let options = ["--laboratory", &laboratory, "--html", "certificate.html", "--dcc", "certificate.xml"];
        // Its limits are those of another unit: the certificate is written, and says that they are not kept.
        let run = copy.run(&[&["report", "tumbled/result.json"], &options[..]].concat());
        assert!(run.status.code() != Some(2), "{}", said(&run));
        let digital = fs::read_to_string(copy.out().join("certificate.xml")).unwrap();
        assert!(digital.contains("Static calibration by gravity") && digital.contains(attitudes));
        assert!(!digital.contains("Kozlov") && !digital.contains("centrical_speedUncertainty"));
        let printed = fs::read_to_string(copy.out().join("certificate.html")).unwrap();
        assert!(printed.contains("gravity in the fitted attitudes") && !printed.contains("plateau’s own speed"));
    }
    // Beside the document, which does not hold it, stands why the command ends with 1.
    let run = copy.run(&["tumble", &record, "--gravity", "9.81523 m/s^2", "--laboratory", &laboratory, "--json"]);
    assert_eq!(run.status.code(), Some(1));
    serde_json::from_slice::<Value>(&run.stdout).unwrap();
    let remark = String::from_utf8_lossy(&run.stderr);
    assert!(remark.contains("UNIT"), "{remark}");
}

#[test]
fn attitudes_that_are_none_are_refused() {
    let copy = Copy::new();
    let record = example("record.csv");
    let refused = |arguments: &[&str]| {
        let output = copy.run(&[&["tumble", &record], arguments].concat());
        assert_eq!(output.status.code(), Some(2), "{}", said(&output));
        said(&output)
    };
    let text = refused(&["--attitudes", "cube"]);
    assert!(text.contains("--attitude-uncertainty"), "{text}");
    let text = refused(&["--attitudes", "cube", "--attitude-uncertainty", "20 deg"]);
    assert!(text.contains("expected a standard uncertainty of 1e-12 rad to 10 deg"), "{text}");
    let text = refused(&["--attitudes", &record, "--attitude-uncertainty", "1 deg"]);
    assert!(text.contains("up_1"), "{text}");
    fs::write(copy.out().join("one.csv"), "up_1,up_2,up_3\n0,0,0\n").unwrap();
    let text = refused(&["--attitudes", "one.csv", "--attitude-uncertainty", "1 deg"]);
    assert!(text.contains("one.csv, row 1") && text.contains("found a row of zeros"), "{text}");
    fs::write(copy.out().join("one.csv"), "up_1,up_2,up_3\n1,2,0\n").unwrap();
    let text = refused(&["--attitudes", "one.csv", "--attitude-uncertainty", "1 deg"]);
    assert!(text.contains("none of them within 10 deg of any of the 24 rests"), "{text}");
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

    // Biases and scale errors are relative to what the rests showed: no statement on them, no error before compensation.
    let laboratory = format!("{}/../../examples/ta-200/laboratory.toml", env!("CARGO_MANIFEST_DIR"));
    let tumble = ["tumble", "counts.csv", "--unit", "counts", "--gravity", "9.81523", "--out"];
    let certificate = |folder: &str| {
        let (result, html) = (format!("{folder}/result.json"), format!("{folder}.html"));
        let file = format!("{folder}.xml");
        let run = copy.run(&["report", &result, "--laboratory", &laboratory, "--html", &html, "--dcc", &file]);
        (run.status.code(), said(&run), fs::read_to_string(copy.out().join(file)).unwrap_or_default())
    };
    copy.run(&[&tumble[..], &["named", "--serial", "7"]].concat());
    let (code, said_of_unit, digital) = certificate("named");
    assert!(code == Some(1) && said_of_unit.contains("conformity not stated"), "{said_of_unit}");
    assert!(!digital.contains("<dcc:conformity>") && !digital.contains("centrical_asReceived"), "{digital}");
    let page = fs::read_to_string(copy.out().join("named.html")).unwrap();
    assert!(page.contains("found the nominal values itself") && !page.contains("Before compensation"));

    // A certificate identifies its item (ISO/IEC 17025, 7.8.2.1 g).
    copy.run(&[&tumble[..], &["nameless"]].concat());
    let (code, refusal, digital) = certificate("nameless");
    assert_eq!((code, digital.as_str()), (Some(2), ""), "{refusal}");
    assert!(
        refusal.contains("found a unit without a serial number, expected the serial number under [unit]"),
        "{refusal}"
    );
    // Where other documents are asked for as well, they are written.
    let run = copy.run(&[&tumble[..], &["kept", "--laboratory", &laboratory]].concat());
    let is_there = |name: &str| copy.out().join("kept").join(name).exists();
    assert_eq!(run.status.code(), Some(2), "{}", said(&run));
    assert_eq!(["result.json", "report.html", "certificate.pdf"].map(is_there), [true, true, false]);
}

#[test]
fn records_that_show_nothing_are_refused() {
    let copy = Copy::new();
    let row = |i: u32| format!("{},0.0{},0.02{},9.8{}", f64::from(i) / 50.0, i % 7, i % 5, i % 3);
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
    for unit in ["furlong", "mV", ""] {
        let text = refused(&[&record, "--unit", unit]);
        assert!(text.contains("expected a unit of acceleration"), "{text}");
    }
    let text = refused(&[&record, "--terms", "df_1,bananas"]);
    assert!(text.contains("bananas"), "{text}");
    fs::create_dir(copy.out().join("own")).unwrap();
    fs::copy(&record, copy.out().join("own/rests.csv")).unwrap();
    let text = refused(&["own/rests.csv", "--out", "own"]);
    assert!(text.contains("rests.csv"), "{text}");
}

/// What a laboratory does wrong and a fit would not say: a wrong unit, a dead newtonometer, an axis that never turns.
#[test]
fn mistakes_of_a_laboratory_are_named() {
    let copy = Copy::new();
    let text = fs::read_to_string(example("record.csv")).unwrap();
    let rows: Vec<[f64; 4]> = (text.lines().skip(1))
        .map(|line| {
            let mut numbers = line.split(',').map(|number| number.parse().unwrap());
            std::array::from_fn(|_| numbers.next().unwrap())
        })
        .collect();
    let said_of = |change: &dyn Fn(&[f64; 4]) -> [f64; 3], arguments: &[&str], code: i32| {
        let line = |row: &[f64; 4]| {
            let [a, b, c] = change(row);
            format!("{},{a:.7},{b:.7},{c:.7}", row[0])
        };
        let lines: Vec<String> = rows.iter().map(line).collect();
        fs::write(copy.out().join("changed.csv"), format!("t,f1,f2,f3\n{}\n", lines.join("\n"))).unwrap();
        let output = copy.run(&[&["tumble", "changed.csv", "--gravity", "9.81523"], arguments].concat());
        assert_eq!(output.status.code(), Some(code), "{}", said(&output));
        said(&output)
    };
    let g = 9.806_65;
    let text = said_of(&|row| [row[1] / g, row[2] / g, row[3] / g], &[], 2);
    assert!(text.contains("--unit g would fit") && text.contains("found rests of 1.0"), "{text}");
    let text = said_of(&|row| [row[1], row[2], row[3]], &["--unit", "g"], 2);
    assert!(text.contains("--unit m/s^2 would fit") && text.contains("found rests of 9.8"), "{text}");
    let text = said_of(&|row| [row[1] * 415.0, row[2] * 413.0, row[3] * 415.0], &[], 2);
    assert!(text.contains("--unit counts would fit"), "{text}");
    let text = said_of(&|row| [row[1], 0.25, row[3]], &[], 2);
    assert!(text.contains("found the same reading in all rows of column f2"), "{text}");
    // Dead, but with noise.
    let text = said_of(&|row| [row[1], 0.01 * (1e4 * row[0]).sin(), row[3]], &[], 2);
    assert!(text.contains("found newtonometer 2 between -0.00") && text.contains("points up and others"), "{text}");
    // Gravity shows neither signs nor the order of columns: that is said with the result.
    let text = said_of(&|row| [row[2], -row[1], row[3]], &[], 0);
    assert!(text.contains("gravity shows neither the sign of an axis nor which column is which"), "{text}");
}
