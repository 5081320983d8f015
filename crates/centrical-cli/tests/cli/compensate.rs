//! `centrical compensate` on the example session.

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::Path;
use std::process::{Output, Stdio};
use std::time::Duration;

use crate::program;
use crate::session::Copy;

fn text(output: &Output) -> String {
    [&output.stdout, &output.stderr].map(|part| String::from_utf8_lossy(part).into_owned()).concat()
}

/// Calibrates the example; the result is in the output folder.
fn calibrated() -> Copy {
    let copy = Copy::new();
    assert!(copy.calibrate(&[]).status.success());
    copy
}

fn compensate(copy: &Copy, arguments: &[&str]) -> Output {
    let record = copy.session().join("records/m01.csv");
    let mut all = vec!["compensate", "result.json", record.to_str().unwrap(), "--out"];
    all.extend(arguments);
    copy.run(&all)
}

/// Columns of a CSV table, without its header.
fn columns(csv: &str) -> Vec<[f64; 4]> {
    let row = |line: &str| {
        let numbers: Vec<f64> = line.split(',').map(|number| number.parse().unwrap()).collect();
        [numbers[0], numbers[1], numbers[2], numbers[3]]
    };
    csv.lines().skip(1).map(row).collect()
}

/// The products of undetermined combinations widen uncertainties beyond the budget: such a result is read by every command, also by the
/// one that replaces it.
#[test]
fn a_result_of_short_rank_is_read() {
    let copy = Copy::new();
    copy.edit("experiment.toml", |text| {
        text.replace("pair_relation = \"common\"", "pair_relation = \"common\"\nextensions = [\"mounting-turn\"]")
    });
    for _ in 0..2 {
        let run = copy.calibrate(&["--out", "."]);
        assert!(run.status.success(), "{}", text(&run));
    }
    let output = compensate(&copy, &["f.csv"]);
    assert!(output.status.success(), "{}", text(&output));
}

/// The specific forces read, by the result's own error model, as the record does.
#[test]
fn readings_are_explained() {
    let copy = calibrated();
    let output = compensate(&copy, &["f.csv"]);
    assert!(output.status.success(), "{}", text(&output));
    let result = centrical_session::CalibrationResult::read(&copy.out().join("result.json")).unwrap();
    let terms = result.error_terms().unwrap();
    assert_eq!(terms.len(), 21);
    // The region where the inverse is unique: the range asked for, and how far it could be.
    let range = result.compensation_range(&terms).unwrap();
    let margin = centrical_compensate::Compensation::new(&terms, range).unwrap().certificate().margin;
    let [range, farthest] = [range, margin * range].map(|f| f / centrical::STANDARD_GRAVITY);
    let said = format!(
        "range {} g on each axis; the inverse is unique there, and could be asked for up to {:.0} g",
        (range * 100.0).floor() / 100.0,
        farthest.floor()
    );
    // What is said to be possible is taken.
    let asked = format!("{:.0} g", farthest.floor());
    assert!(compensate(&copy, &["asked.csv", "--range", &asked]).status.success(), "{asked}");
    assert!(text(&output).contains(&said), "{said}: {}", text(&output));
    assert!(text(&output).contains("f.csv, specific forces to 9 decimals of a m/s^2"), "{}", text(&output));
    let before = columns(&fs::read_to_string(copy.session().join("records/m01.csv")).unwrap());
    let after = columns(&fs::read_to_string(copy.out().join("f.csv")).unwrap());
    assert_eq!(before.len(), after.len());
    let mut largest: f64 = 0.0;
    for ([t, b1, b2, b3], [u, f @ ..]) in before.into_iter().zip(after) {
        assert_eq!(t, u);
        let read = centrical_compensate::reading(&terms, f);
        for (found, expected) in read.into_iter().zip([b1, b2, b3]) {
            // Half a digit, as the gain takes it.
            let rounding = 0.51e-9 + 1e-12 * expected.abs().max(1.0);
            assert!((found - expected).abs() <= rounding, "{found} for {expected} at {t} s");
        }
        largest = [b1 - f[0], b2 - f[1], b3 - f[2]].iter().fold(largest, |l, e| l.max(e.abs()));
    }
    assert!(largest > 1e-3, "the compensation should do something, found {largest} m/s^2 at most");
}

/// Readings beyond the range are counted and become nan; the exit code says so.
#[test]
fn readings_from_beyond_the_range_are_told() {
    let copy = calibrated();
    let output = compensate(&copy, &["f.csv", "--range", "5 g"]);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output));
    let after = columns(&fs::read_to_string(copy.out().join("f.csv")).unwrap());
    let missing = after.iter().filter(|[_, f @ ..]| f.iter().all(|f| f.is_nan())).count();
    assert!(missing > 0 && missing < after.len());
    let said = format!("NOT ACCEPTABLE  {missing} readings beyond the range, written as nan, the first at t = ");
    assert!(text(&output).contains(&said), "{}", text(&output));
}

/// The same bytes twice, and Parquet if its name says so.
#[test]
fn formats_and_bytes() {
    let copy = calibrated();
    for name in ["f.csv", "again.csv", "f.parquet"] {
        assert!(compensate(&copy, &[name]).status.success());
    }
    let read = |name: &str| fs::read(copy.out().join(name)).unwrap();
    assert_eq!(read("f.csv"), read("again.csv"));
    assert!(read("f.parquet").starts_with(b"PAR1"));
}

/// What cannot be done is refused before anything is written, with what was found and expected.
#[test]
fn refusals() {
    let copy = calibrated();
    let refused = |arguments: &[&str], said: &str| {
        let output = compensate(&copy, arguments);
        assert_eq!(output.status.code(), Some(2), "{}", text(&output));
        assert!(text(&output).contains(said), "{}", text(&output));
        assert!(!copy.out().join("f.csv").exists());
    };
    refused(&["f.csv", "--range", "5 parsecs"], "expected an acceleration such as");
    refused(&["f.csv", "--range", "5"], "found \"5\", expected an acceleration with its unit, such as '200 g'");
    refused(&["f.csv", "--range", "1e9 g"], "result.json: over twice the range the gain changes by up to");
    let result = copy.out().join("result.json");
    let text = fs::read_to_string(&result).unwrap();
    let mut json: serde_json::Value = serde_json::from_str(&text).unwrap();
    let parameters = json["parameters"].as_array_mut().unwrap();
    let lost = parameters.iter_mut().find(|p| p["name"] == "G1_31").unwrap();
    (lost["value"], lost["standard_uncertainty"]) = (serde_json::Value::Null, serde_json::Value::Null);
    fs::write(&result, json.to_string()).unwrap();
    refused(&["f.csv"], "result.json: G1_31: found no value, the data do not determine it");
}

/// Where the inverse is not certain over the calibrated range, the message has the range that could be asked for.
#[test]
fn a_range_that_is_not_certain() {
    let copy = calibrated();
    let result = copy.out().join("result.json");
    let mut json: serde_json::Value = serde_json::from_str(&fs::read_to_string(&result).unwrap()).unwrap();
    let parameters = json["parameters"].as_array_mut().unwrap();
    parameters.iter_mut().find(|p| p["name"] == "G1_31").unwrap()["value"] = 2e-4.into();
    fs::write(&result, json.to_string()).unwrap();
    for output in [compensate(&copy, &["f.csv"]), copy.run(&["report", "result.json", "--code", "code"])] {
        assert_eq!(output.status.code(), Some(2), "{}", text(&output));
        assert!(text(&output).contains(" g (--range)"), "{}", text(&output));
    }
}

/// A model with a jump has no inverse over any range: its coefficient is named.
#[test]
fn a_jump_has_no_inverse() {
    let copy = Copy::new();
    copy.edit("experiment.toml", |text| text.replace("\"kozlov-2017\"", "[\"kozlov-2017\", \"jump\"]"));
    copy.calibrate(&[]);
    for output in [compensate(&copy, &["f.csv"]), copy.run(&["report", "result.json", "--code", "code"])] {
        let said = "result.json: K_1[sgn(f1)]: found a jump of the reading where f1 changes its sign";
        assert!(output.status.code() == Some(2) && text(&output).contains(said), "{}", text(&output));
    }
}

/// Rows that lack a reading are left out with their stamps where the session says so, and refused where it does not.
#[test]
fn rows_that_lack_a_reading() {
    let copy = calibrated();
    let stamp = |k: usize| format!("2026-10-05T10:00:00.{k}Z");
    let row = |k: usize, f1: &str| format!("{},{f1},2,3\n", stamp(k));
    let record = ["t,f1,f2,f3\n".to_owned(), row(0, "1"), row(1, "NaN"), row(2, ""), row(3, "1")].concat();
    fs::write(copy.out().join("gaps.csv"), record).unwrap();
    let session = copy.session();
    let arguments = ["compensate", "result.json", "gaps.csv", "--out", "f.csv", "--session", session.to_str().unwrap()];
    assert_eq!(copy.run(&arguments).status.code(), Some(2));
    copy.edit("experiment.toml", |text| text.replace("[columns]\n", "[columns]\nmissing_readings = \"left out\"\n"));
    let output = copy.run(&arguments);
    assert!(output.status.success() && text(&output).contains("2 readings in m/s^2 compensated"), "{}", text(&output));
    let written = fs::read_to_string(copy.out().join("f.csv")).unwrap();
    let stamps: Vec<&str> = written.lines().skip(1).filter_map(|line| line.split(',').next()).collect();
    assert_eq!(stamps, [stamp(0), stamp(3)]);
}

/// `report --c` leaves the source files; what they compute is checked where they are made.
#[test]
fn source_code() {
    let copy = calibrated();
    let output = copy.run(&["report", "result.json", "--code", "source"]);
    assert!(output.status.success(), "{}", text(&output));
    let name = |entry: std::io::Result<fs::DirEntry>| entry.unwrap().file_name().into_string().unwrap();
    let mut names: Vec<String> = fs::read_dir(copy.out().join("source")).unwrap().map(name).collect();
    names.sort();
    let extensions = [".c", ".h", ".m", ".py"];
    assert_eq!(names, extensions.map(|extension| format!("centrical_compensate{extension}")));
    let header = fs::read_to_string(copy.out().join("source/centrical_compensate.h")).unwrap();
    assert!(header.contains(" * Compensation of "), "{header}");
}

/// Any format, recognised by its bytes: the same record gives the same specific forces.
#[test]
fn any_format() {
    let copy = calibrated();
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../centrical-table/tests/data");
    let compensated = |name: &str| {
        let record = data.join(name);
        let run = copy.run(&["compensate", "result.json", record.to_str().unwrap(), "--out", "f.csv"]);
        assert!(run.status.success(), "{name}: {}", text(&run));
        fs::read(copy.out().join("f.csv")).unwrap()
    };
    let expected = compensated("record.csv");
    assert_eq!(columns(std::str::from_utf8(&expected).unwrap()).len(), 300);
    for name in
        ["record.csv.gz", "record.csv.zst", "savetxt.txt", "record.npy", "packed.npz", "packed.mat", "snappy.parquet"]
    {
        assert!(compensated(name) == expected, "{name}");
    }
}

/// The record streams through: one eight times as long takes no more memory, two threads working in both.
#[test]
#[cfg(target_os = "linux")]
fn memory_does_not_grow_with_the_record() {
    const ROWS: u64 = 8_000_000;
    let copy = calibrated();
    let short = peak_memory(&copy, ROWS / 8);
    let long = peak_memory(&copy, ROWS);
    // Buffers fill up by chance; the long record itself is 300 MB of text and 256 MB of numbers.
    assert!(long < short + 48 * 1024 * 1024, "{long} bytes after {short}");
}

/// Largest resident memory [B] of compensating a record of `rows` rows: the kernel keeps the largest so far, it is read
/// until the program ends.
#[cfg(target_os = "linux")]
fn peak_memory(copy: &Copy, rows: u64) -> u64 {
    let mut file = BufWriter::new(File::create(copy.out().join("long.csv")).unwrap());
    writeln!(file, "t,f1,f2,f3").unwrap();
    for k in 0..rows {
        writeln!(file, "{}.{:03},{}.25,-{}.125,9.8134277512345678", k / 1000, k % 1000, k % 1999, k % 1777).unwrap();
    }
    file.flush().unwrap();
    let mut program = program::centrical()
        .args(["compensate", "result.json", "long.csv", "--out", "f.parquet"])
        .current_dir(copy.out())
        .env("RAYON_NUM_THREADS", "2")
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let status = format!("/proc/{}/status", program.id());
    let mut peak = 0;
    while program.try_wait().unwrap().is_none() {
        let status = std::fs::read_to_string(&status).unwrap_or_default();
        let kibibytes = status.lines().find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix("kB"));
        peak = kibibytes.map_or(peak, |number| 1024 * number.trim().parse::<u64>().unwrap());
        std::thread::sleep(Duration::from_millis(2));
    }
    let output = program.wait_with_output().unwrap();
    assert!(output.status.success(), "{rows} rows");
    assert!(text(&output).contains(&format!("{rows} readings in m/s^2 compensated")), "{}", text(&output));
    assert!(peak > 0, "{rows} rows: the program ended unseen");
    peak
}

/// A calibration with an objection compensates, says so, and so does the code that is made of it.
#[test]
fn a_calibration_with_an_objection_is_named() {
    let copy = Copy::new();
    copy.edit("records/m05.csv", |text| crate::watch::disturbed(&text));
    assert_eq!(copy.calibrate(&["-q"]).status.code(), Some(1));
    let output = compensate(&copy, &["f.csv"]);
    assert!(output.status.code() == Some(1) && text(&output).contains("NOT ACCEPTABLE"), "{}", text(&output));
    let output = compensate(&copy, &["f.csv", "--json"]);
    let document: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&document["acceptable"], output.status.code()), (&false.into(), Some(1)));
    assert_eq!(copy.run(&["report", "result.json", "--code", "code"]).status.code(), Some(1));
    let code = fs::read_to_string(copy.out().join("code/centrical_compensate.c")).unwrap();
    assert!(code.contains("NOT ACCEPTABLE: "), "{}", &code[..400]);
}

/// The session that names columns is one of the unit that was calibrated.
#[test]
fn a_session_of_another_unit_is_refused() {
    let copy = calibrated();
    let session = copy.session();
    let own = ["f.csv", "--session", session.to_str().unwrap()];
    assert!(compensate(&copy, &own).status.success());
    copy.edit("experiment.toml", |text| text.replace("serial = \"0001\"", "serial = \"0002\""));
    let output = compensate(&copy, &own);
    let expected = "found a unit of the serial number \"0002\", expected \"0001\", as in result.json";
    assert!(output.status.code() == Some(2) && text(&output).contains(expected), "{}", text(&output));
}

/// Coefficients are relative to the nominal output: a session in counts does not say what those of a result in m/s^2 do to a count.
#[test]
fn a_session_of_another_output_is_refused() {
    let copy = calibrated();
    let counts = "output_unit = \"counts\"\ncounts = { scale = [1.0, 1.01, 0.99], bias = [0.5, 0.0, -0.25] }";
    copy.edit("experiment.toml", |text| text.replace("output_unit = \"m/s^2\"", counts));
    let output = compensate(&copy, &["f.csv", "--session", copy.session().to_str().unwrap()]);
    let expected = "expected output in a unit of acceleration, as in result.json";
    assert!(output.status.code() == Some(2) && text(&output).contains(expected), "{}", text(&output));
}

/// Text under the name of a packed file or a workbook would deceive its reader.
#[test]
fn formats_that_are_not_written_are_refused() {
    let copy = calibrated();
    for (name, format) in [("f.csv.gz", "packed text"), ("f.xlsx", "workbook"), ("f.npy", "NumPy")] {
        let output = compensate(&copy, &[name]);
        let found = format!("{name}: found the name of a format that is not written ({format})");
        let expected = format!("{found}, expected a name that ends in .csv, or in .parquet");
        assert!(output.status.code() == Some(2) && text(&output).contains(&expected), "{}", text(&output));
    }
    assert!(compensate(&copy, &["f.pq"]).status.success());
    assert!(fs::read(copy.out().join("f.pq")).unwrap().starts_with(b"PAR1"));
}

/// A record in g is read in the unit of the calibration's records, and FLT_MAX among its readings is one spike.
#[test]
fn readings_are_in_the_unit_of_the_records() {
    let copy = calibrated();
    assert!(compensate(&copy, &["si.csv"]).status.success());
    let experiment = copy.session().join("experiment.toml");
    let text_of = fs::read_to_string(&experiment).unwrap();
    fs::write(&experiment, text_of.replace("output_unit = \"m/s^2\"", "output_unit = \"g\"")).unwrap();
    for file in fs::read_dir(copy.session().join("records")).unwrap() {
        let file = file.unwrap().path();
        let rows = columns(&fs::read_to_string(&file).unwrap()).into_iter().enumerate();
        let row = |(n, [t, f1, f2, f3]): (usize, [f64; 4])| {
            let [f1, f2, f3] = [f1, f2, f3].map(|f| f / centrical::STANDARD_GRAVITY);
            let f1 = if n == 500 { f64::from(f32::MAX) } else { f1 };
            format!("{t},{f1:.12},{f2:.12},{f3:.12}\n")
        };
        fs::write(&file, format!("t,f1,f2,f3\n{}", rows.map(row).collect::<String>())).unwrap();
    }
    let calibration = copy.calibrate(&[]);
    assert!(calibration.status.success(), "{}", text(&calibration));
    // Four of the example, one in each of twelve records.
    assert!(text(&calibration).contains("spikes 16"), "{}", text(&calibration));
    // That reading has no force.
    assert_eq!(compensate(&copy, &["g.csv"]).status.code(), Some(1));
    let [si, g] = ["si.csv", "g.csv"].map(|file| columns(&fs::read_to_string(copy.out().join(file)).unwrap()));
    let is_near = |(n, (a, b)): (usize, (&[f64; 4], &[f64; 4]))| n == 500 || (1..4).all(|i| (a[i] - b[i]).abs() < 2e-4);
    assert!(si.iter().zip(&g).enumerate().all(is_near));
}
