//! Layouts that other programs write: `init` finds the columns, and the session calibrates to the numbers of the example.

use std::f64::consts::PI;
use std::fmt::Write;
use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::session::{Copy, assert_lines, draft};

/// Names, values and standard uncertainties of the parameters that the session has.
fn parameters(copy: &Copy) -> Value {
    let output = copy.calibrate(&["--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let result: Value = serde_json::from_slice(&output.stdout).unwrap();
    result["parameters"].clone()
}

/// Writes every record and telemetry anew, from the values of its rows, as files of another ending.
fn rewrite(copy: &Copy, ending: &str, write: impl Fn(&Path, &[Vec<f64>])) {
    for part in ["records", "telemetry"] {
        for file in fs::read_dir(copy.session().join(part)).unwrap() {
            let path = file.unwrap().path();
            let text = fs::read_to_string(&path).unwrap();
            let row = |line: &str| line.split(',').map(|number| number.parse().unwrap()).collect();
            let rows: Vec<Vec<f64>> = text.lines().skip(1).map(row).collect();
            fs::remove_file(&path).unwrap();
            write(&path.with_extension(ending), &rows);
        }
    }
    copy.edit("experiment.toml", |text| text.replace(".csv\"", &format!(".{ending}\"")));
}

/// A matrix of MATLAB 5, uncompressed; its rows are those of `rows`.
fn matrix(name: &str, rows: &[&[f64]]) -> Vec<u8> {
    let element = |kind: u32, bytes: &[u8]| -> Vec<u8> {
        let length = u32::try_from(bytes.len()).unwrap();
        let mut element = [kind.to_le_bytes(), length.to_le_bytes()].concat();
        element.extend_from_slice(bytes);
        element.resize(element.len().next_multiple_of(8), 0);
        element
    };
    let integers = |numbers: [u32; 2]| numbers.map(u32::to_le_bytes).concat();
    let columns = rows[0].len();
    let numbers: Vec<u8> = (0..columns).flat_map(|j| rows.iter().flat_map(move |row| row[j].to_le_bytes())).collect();
    let shape = [rows.len(), columns].map(|count| u32::try_from(count).unwrap());
    let parts = [element(6, &integers([6, 0])), element(5, &integers(shape)), element(1, name.as_bytes())];
    element(14, &[parts.concat(), element(9, &numbers)].concat())
}

fn write_matlab(path: &Path, variables: &[Vec<u8>]) {
    let mut file = b"MATLAB 5.0 MAT-file".to_vec();
    file.resize(124, b' ');
    file.extend_from_slice(&[0, 1, b'I', b'M']);
    file.extend_from_slice(&variables.concat());
    fs::write(path, file).unwrap();
}

/// A vector of times beside a matrix of readings, upright or on its side, and a sampling rate.
#[test]
fn a_matrix_beside_a_vector() {
    let expected = parameters(&Copy::new());
    for (is_on_side, listed) in [(false, "f(:,1) to f(:,3)"), (true, "f(1,:), f(2,:), f(3,:)")] {
        let copy = Copy::new();
        rewrite(&copy, "mat", |path, rows| {
            let [t, f] = [0..1, 1..rows[0].len()].map(|columns| rows.iter().map(|row| &row[columns.clone()]).collect());
            let (t, f): (Vec<&[f64]>, Vec<&[f64]>) = (t, f);
            let turned: Vec<Vec<f64>> = (0..f[0].len()).map(|j| f.iter().map(|row| row[j]).collect()).collect();
            let turned: Vec<&[f64]> = turned.iter().map(Vec::as_slice).collect();
            let name = if f[0].len() == 1 { "omega" } else { "f" };
            let f = matrix(name, if is_on_side { &turned } else { &f });
            write_matlab(path, &[matrix("fs", &[&[100.0]]), matrix("t", &t), f]);
        });
        let of_axis = |axis: u8| if is_on_side { format!("\"f({axis},:)\"") } else { format!("\"f(:,{axis})\"") };
        let names = format!("f = [{}]", [1, 2, 3].map(of_axis).join(", "));
        let found = format!("{names}  # FOUND");
        assert_lines(&draft(&copy, &["records", "telemetry"]), &["time = \"t\"  # FOUND", &found]);
        let refused = copy.calibrate(&[]);
        let message = String::from_utf8_lossy(&refused.stderr).into_owned();
        let missing = format!("f1: found columns \"fs, t, {listed}\", expected a column of this name");
        assert!(message.contains(&missing), "{message}");
        copy.edit("experiment.toml", |text| text.replace("f = [\"f1\", \"f2\", \"f3\"]", &names));
        assert_eq!(parameters(&copy), expected);
    }
}

/// Rows as a data logger writes them that begins 30 s before midnight, the date and the time divided so.
fn write_logged(path: &Path, rows: &[Vec<f64>], divided: char) {
    const DAY: i64 = 86_400 * 10_000;
    #[expect(clippy::cast_possible_truncation, reason = "minutes in tenths of a millisecond")]
    let ticks = |t: f64| (t * 1e4).round() as i64 + DAY - 300_000;
    let row = |row: &Vec<f64>| {
        let (day, of_day) = (ticks(row[0]) / DAY, ticks(row[0]) % DAY);
        let (seconds, fraction) = (of_day / 10_000, of_day % 10_000);
        let time = format!("{:02}:{:02}:{:02},{fraction:04}", seconds / 3600, seconds / 60 % 60, seconds % 60);
        let readings: String = row[1..].iter().map(|reading| format!(";{reading}").replace('.', ",")).collect();
        format!("{:02}.10.2026{divided}{time}{readings}\n", 5 + day)
    };
    let readings = if rows[0].len() == 2 { "omega" } else { "f1;f2;f3" };
    fs::write(path, format!("Date{divided}Time;{readings}\n{}", rows.iter().map(row).collect::<String>())).unwrap();
}

/// A time of the day beside its date, over midnight.
#[test]
fn a_date_beside_a_time_of_the_day() {
    let copy = Copy::new();
    rewrite(&copy, "txt", |path, rows| write_logged(path, rows, ';'));
    let line = "time = { date = \"Date\", column = \"Time\" }";
    let drafted = draft(&copy, &["records", "telemetry"]);
    assert_lines(&drafted, &[&format!("{line}  # FOUND"), "f = [\"f1\", \"f2\", \"f3\"]  # FOUND"]);
    assert!(!drafted.contains("telemetry_time"), "{drafted}");
    copy.edit("experiment.toml", |text| text.replace("time = \"t\"", "time = \"Time\""));
    let refused = copy.calibrate(&[]);
    let message = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(message.contains("after midnight a time of the day needs a date, as in time = { date"), "{message}");
    copy.edit("experiment.toml", |text| text.replace("time = \"Time\"", line));
    let stamped = Copy::new();
    rewrite(&stamped, "txt", |path, rows| write_logged(path, rows, ' '));
    stamped.edit("experiment.toml", |text| text.replace("time = \"t\"", "time = \"Date Time\""));
    assert_eq!(parameters(&copy), parameters(&stamped));
}

/// The same in Parquet and Arrow, where both are types.
#[test]
fn a_date_beside_a_time_of_the_day_in_binary_formats() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../centrical-table/tests/data");
    for name in ["dates.parquet", "dates.feather"] {
        let copy = Copy::new();
        let record = data.join(name).display().to_string();
        let run = copy.run(&["init", &record]);
        let drafted = String::from_utf8(run.stdout).unwrap();
        assert_lines(&drafted, &["time = { date = \"Date\", column = \"Time\" }  # FOUND"]);
    }
}

#[test]
fn a_date_is_that_of_a_time() {
    for (own, entry, expected) in [
        ("time", "{ date = \"Date\" }", "found a date alone, expected column = that of the times of the day"),
        (
            "time",
            "{ date = 1, column = 2, unit = \"s\" }",
            "found a date beside a rate or a unit, expected one of them",
        ),
        ("speed", "{ date = 1, column = 2 }", "found a date, expected no date (it belongs to a column of time)"),
    ] {
        let copy = Copy::new();
        copy.edit("experiment.toml", |text| {
            let line = text.lines().find(|line| line.starts_with(&format!("{own} = "))).unwrap();
            text.replacen(line, &format!("{own} = {entry}"), 1).replace("speed_unit = \"rad/s\"\n", "")
        });
        let message = String::from_utf8_lossy(&copy.calibrate(&[]).stderr).into_owned();
        assert!(message.contains(expected), "{message}");
    }
}

/// A count of samples has no rate: it is asked for, and plateaus are matched to those of the telemetry in their order.
#[test]
fn a_count_of_samples_is_asked_for_its_rate() {
    for (header, names) in [("sample,", "column = \"sample\", "), ("counter,", "column = \"counter\", "), ("", "")] {
        let copy = Copy::new();
        for file in fs::read_dir(copy.session().join("records")).unwrap() {
            let path = file.unwrap().path();
            let text = fs::read_to_string(&path).unwrap();
            let row = |(number, line): (usize, &str)| {
                let readings = line.split_once(',').unwrap().1;
                if header.is_empty() { format!("{readings}\n") } else { format!("{number},{readings}\n") }
            };
            let rows: String = text.lines().skip(1).enumerate().map(row).collect();
            fs::write(&path, format!("{header}f1,f2,f3\n{rows}")).unwrap();
        }
        let drafted = draft(&copy, &["records", "telemetry"]);
        let time = format!("time = {{ {names}rate = \"?\" }}  # FILL IN: such as \"1 kHz\": the records have no time");
        assert_lines(&drafted, &[&time, "telemetry_time = \"t\"  # FOUND", "f = [\"f1\", \"f2\", \"f3\"]  # FOUND"]);
        assert!(drafted.contains("; by the length of the telemetry about 100.0 Hz"), "{drafted}");
        assert!(!drafted.contains("samples per second"), "{drafted}");
        for arm in ["arm = [0.500, 0.0, 0.0]  # GUESS", "arm = [0.250, 0.0, 0.0]  # GUESS"] {
            assert_eq!(drafted.matches(arm).count(), 6, "{drafted}");
        }
        let drafted = draft(&copy, &["records"]);
        assert_lines(&drafted, &[&time]);
        assert!(drafted.contains(" samples; no file has the speed"), "{drafted}");
    }
}

/// What names do not show is a guess, and an arm is a fraction of a metre or some metres long.
#[test]
fn an_order_and_an_arm_that_no_file_shows() {
    let factor = 180.0 / PI;
    let copy = Copy::new();
    rewrite(&copy, "txt", |path, rows| {
        let header = if rows[0].len() == 2 { "t,speed [rpm]" } else { "t,up,left,fore" };
        let row = |row: &Vec<f64>| match row.as_slice() {
            [t, omega] => format!("{t},{}\n", omega * factor),
            [t, f1, f2, f3] => format!("{t},{f1},{f2},{f3}\n"),
            _ => unreachable!(),
        };
        fs::write(path, format!("{header}\n{}", rows.iter().map(row).collect::<String>())).unwrap();
    });
    let drafted = draft(&copy, &["records", "telemetry"]);
    assert_lines(
        &drafted,
        &["f = [\"up\", \"left\", \"fore\"]  # GUESS: the order in which they stand", "speed_unit = \"rpm\"  # FOUND"],
    );
    let arm = "arm = [\"?\", 0.0, 0.0]  # FILL IN: radius of the reference point by the drawing, m; readings and speeds in rpm make 0.0";
    assert_eq!(drafted.matches(arm).count(), 12, "{drafted}");
    assert!(drafted.contains("which is no arm; with speeds in deg/s it would be 0."), "{drafted}");
}

/// All mountings in one record are no mounting.
#[test]
fn one_record_of_several_mountings_is_to_be_split() {
    let copy = Copy::new();
    let folder = copy.session().join("long");
    fs::create_dir(&folder).unwrap();
    for (part, header) in [("records", "t,f1,f2,f3"), ("telemetry", "t,omega")] {
        let mut long = format!("{header}\n");
        for (k, mounting) in ["m01.csv", "m03.csv", "m05.csv"].iter().enumerate() {
            let text = fs::read_to_string(copy.session().join(part).join(mounting)).unwrap();
            for line in text.lines().skip(1) {
                let (t, values) = line.split_once(',').unwrap();
                let t: f64 = t.parse().unwrap();
                writeln!(long, "{},{values}", t + 200.0 * k as f64).unwrap();
            }
        }
        fs::write(folder.join(format!("{part}.csv")), long).unwrap();
    }
    for inputs in [&["records.csv", "telemetry.csv"][..], &["records.csv"]] {
        let inputs: Vec<String> = inputs.iter().map(|input| folder.join(input).display().to_string()).collect();
        let arguments: Vec<&str> = std::iter::once("init").chain(inputs.iter().map(String::as_str)).collect();
        let output = copy.run(&arguments);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{message}");
        let expected = "records.csv: found several mountings: the arm pulls in 3 directions of the unit, one after the other, expected a \
                        file for each mounting, and one of its telemetry: split them at rest, at about 163 s, 36";
        assert!(message.contains(expected), "{message}");
    }
}
