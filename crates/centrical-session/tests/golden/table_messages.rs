//! What is wrong with a record, with telemetry or with a table of plateaus.

use std::fs;

use centrical_session::{Columns, Session, read_plateaus, read_record, read_telemetry};

use crate::sample::{EXPERIMENT, Sample};

/// The message for a record with this content.
fn message(content: impl AsRef<[u8]>) -> String {
    let sample = Sample::new("");
    let file = sample.file("m01.csv", content);
    let error = read_record(&file, &Columns::default()).expect_err("the record is wrong");
    sample.relative(&error.to_string())
}

/// Rows of `(content, message)`: all are compared.
fn compare(cases: &[(&str, &str)]) {
    for (content, expected) in cases {
        assert_eq!(message(content), format!("m01.csv{expected}"));
    }
}

#[test]
fn what_is_no_number() {
    compare(&[
        ("t,f1,f2,f3\n0,1,2,3\n0.1,1,NaN(ind),3\n", r#", line 3, f2: found "NaN(ind)", expected a number in m/s^2"#),
        ("t,f1,f2,f3\n0,1,2,nan\n", r#", line 2, f3: found "nan", expected a number in m/s^2"#),
        ("t,f1,f2,f3\n0,1,2,-inf\n", r#", line 2, f3: found "-inf", expected a number in m/s^2"#),
        ("t,f1,f2,f3\n0,1,2,1e999\n", r#", line 2, f3: found "1e999", expected a number in m/s^2"#),
        ("t,f1,f2,f3\n0,1,,3\n", r#", line 2, f2: found "", expected a number in m/s^2"#),
        ("# x\n\nt,f1,f2,f3\r\nzero,1,2,3\r\n", r#", line 4, t: found "zero", expected a number in s"#),
        ("t,f1,f2,f3\n0,1,0x10,3\n", r#", line 2, f2: found "0x10", expected a number in m/s^2"#),
        ("t,f1,f2,f3\n0,1,\"2\n", r#", line 2: found "\"2", expected a closing quote"#),
    ]);
}

#[test]
fn columns() {
    compare(&[
        ("t,f1,f3\n0,1,2\n", r#", line 1, f2: found columns "t, f1, f3", expected a column of this name"#),
        ("t,f1,f2,f2,f3\n0,1,2,3,4\n", r#", line 1, f2: found two such columns in "t, f1, f2, f2, f3", expected one"#),
        (
            "0,1,2,3\n1,1,2,3\n",
            r#", line 1: found "0,1,2,3", expected the names of the columns (for a file without them give [columns] by number)"#,
        ),
        ("t,f1,f2,f3\n0,1,2\n", r#", line 2: found 3 fields in "0,1,2", expected 4 as in the first line"#),
        ("t,f1,f2,f3\n0,1,2,3,4\n", r#", line 2: found 5 fields in "0,1,2,3,4", expected 4 as in the first line"#),
        (
            "t,f1,f2,f3\n0,00,1,00,2,00,3,00\n",
            r#", line 2: found 8 fields in "0,00,1,00,2,00,3,00", expected 4 as in the first line"#,
        ),
    ]);
}

#[test]
fn time() {
    compare(&[(
        "t,f1,f2,f3\n0.5,1,2,3\n0.5,1,2,3\n0.25,1,2,3\n",
        ", line 4, t: found 0.25 after 0.5, expected a time that does not run backwards",
    )]);
}

#[test]
fn what_is_no_table() {
    compare(&[
        ("", ": found an empty file, expected a record"),
        ("\n\n", ": found a table without rows, expected a record"),
        ("t,f1,f2,f3\n", ": found a table without rows, expected a record"),
        (
            "PAR1",
            ": found damaged Parquet (EOF: Parquet file too small. Size is 4 but need 8), expected a whole Parquet file",
        ),
    ]);
    assert_eq!(
        message(b"t,f1,f2,f3,\xb0C\n0,1,2,3,20\n"),
        "m01.csv, line 1: found byte 0xb0 after \"t,f1,f2,f3,\", expected text in UTF-8"
    );
    assert_eq!(
        message(vec![b'x'; 3 << 20]),
        "m01.csv, line 1: found a line longer than 1048576 bytes, expected a table of numbers as text"
    );
}

#[test]
fn what_is_no_file() {
    let sample = Sample::new(EXPERIMENT);
    let session = Session::read(&sample.path()).unwrap();
    let missing = session.record(1).unwrap_err();
    assert_eq!(sample.relative(&missing.to_string()), "records/m02.csv: found no such file, expected a record");
    fs::create_dir_all(sample.path().join("records/m01.csv")).unwrap();
    let folder = session.record(0).unwrap_err();
    assert_eq!(sample.relative(&folder.to_string()), "records/m01.csv: found a folder, expected a record");
    let telemetry = read_telemetry(&sample.file("telemetry.csv", "t,rpm\n0,0\n"), &session.columns).unwrap_err();
    assert_eq!(
        sample.relative(&telemetry.to_string()),
        "telemetry.csv, line 1, omega: found columns \"t, rpm\", expected a column of this name"
    );
    let without = Sample::new(EXPERIMENT.replace("record = \"records/m01.csv\"\n", ""));
    let none = Session::read(&without.path()).unwrap().record(0).unwrap_err();
    assert_eq!(
        without.relative(&none.to_string()),
        "experiment.toml, [[mounting]] 1, record: found no record, expected the path of one"
    );
}

#[test]
fn tables_of_plateaus() {
    const HEADER: &str =
        "mounting,speed,angle,mean_1,mean_2,mean_3,cov_11,cov_12,cov_13,cov_22,cov_23,cov_33,samples\n";
    let cases = [
        (
            "1,0,0,0,0,9.8,1e-8,0,0,1e-8,0,1e-8,100\n3,0,0,0,0,9.8,1e-8,0,0,1e-8,0,1e-8,100\n",
            ", row 2, mounting: found 3, expected the number of a mounting, 1 to 2",
        ),
        (
            "1.5,0,0,0,0,9.8,1e-8,0,0,1e-8,0,1e-8,100\n",
            ", row 1, mounting: found 1.5, expected the number of a mounting, 1 to 2",
        ),
        (
            "1,-1,,0,0,9.8,1e-8,0,0,1e-8,0,1e-8,100\n",
            ", row 1, speed: found -1, expected a speed in rad/s from 0 to 1e6 rpm, without sign",
        ),
        (
            "1,0,,0,0,9.8,1e-8,0,0,1e-8,0,1e-8,100\n",
            ", row 1, angle: found an empty field, expected the carousel angle of a plateau at rest",
        ),
        ("1,2,0,0,0,9.8,1e-8,0,0,1e-8,0,1e-8,100\n", ", row 1, angle: found 0, expected no angle while spinning"),
        (
            "1,2,,0,0,9.8,1e-8,2e-8,0,1e-8,0,1e-8,100\n",
            ", row 1, cov_11: found 0.00000001, expected a positive definite covariance",
        ),
        ("1,2,,0,0,9.8,1e-8,0,0,1e-8,0,1e-8,0\n", ", row 1, samples: found 0, expected how many samples were averaged"),
        ("1,2,,0,,9.8,1e-8,0,0,1e-8,0,1e-8,0\n", ", line 2, mean_2: found \"\", expected a mean in m/s^2"),
    ];
    let sample = Sample::new("");
    for (rows, expected) in cases {
        let file = sample.file("plateaus.csv", format!("{HEADER}{rows}"));
        let error = read_plateaus(&file, 2).unwrap_err();
        assert_eq!(sample.relative(&error.to_string()), format!("plateaus.csv{expected}"));
    }
}
