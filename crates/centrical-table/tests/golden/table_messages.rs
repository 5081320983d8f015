//! What is wrong with a record.

use std::fs;

use centrical_table::ColumnName;

use crate::record::{named, numbered, read_record};

/// The message for a record with this content.
fn message(content: impl AsRef<[u8]>) -> String {
    message_by(content, &named())
}

fn message_by(content: impl AsRef<[u8]>, columns: &[ColumnName; 4]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("m01.csv");
    fs::write(&file, content).unwrap();
    let error = read_record(&file, columns).expect_err("the record is wrong");
    error.to_string().replace(&format!("{}/", folder.path().display()), "")
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

/// A spreadsheet says in its own language what it could not compute. A comment in the midst of rows is left out.
#[test]
fn a_row_that_was_not_computed_is_no_comment() {
    let words = ["#SPILL!", "#GETTING_DATA", "#Н/Д", "#ДЕЛ/0!", "#NV", "#¡DIV/0!", "#N/V", "######"];
    for rest in ["1,2,3", "1,#NV,3"] {
        for word in words {
            let text = format!("t,f1,f2,f3\n0,1,2,3\n{word},{rest}\n1,1,2,3\n");
            let expected = format!("m01.csv, line 3, t: found {word:?}, expected a number in s");
            assert_eq!(message(text), expected);
        }
    }
    let comments = "#time,f1,f2,f3\n#comment, with 3 commas, in it, x\n#0.5,1,2,3\n##0.5,1,2,3\n# made,1,2,3\n#,1,2,3\n#rate,100\n#see,,,\n";
    let text = format!("t,f1,f2,f3\n{comments}0,1,2,3\n{comments}1,1,2,3\nwrong,1,2,3\n");
    assert_eq!(message(text), r#"m01.csv, line 20, t: found "wrong", expected a number in s"#);
    // Without a header the first row can be one.
    let first = message_by("# made today\n#NV,1,2,3\n1,1,2,3\n", &numbered());
    assert!(first.contains(r##", line 2, column 1: found "#NV", "##), "{first}");
    let after_comments = message_by(format!("{comments}1,1,2,3\nwrong,1,2,3\n"), &numbered());
    assert!(after_comments.contains(", line 10, column 1: "), "{after_comments}");
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
        message(b"t,f1,f2,\xb0C\n0,1,2,20\n"),
        "m01.csv, line 1, f3: found columns \"t, f1, f2, \u{b0}C\", expected a column of this name"
    );
    assert_eq!(
        message(vec![b'x'; 3 << 20]),
        "m01.csv, line 1: found a line longer than 1048576 bytes, expected a table of numbers as text"
    );
}

#[test]
fn lines_above_the_header() {
    compare(&[
        (
            "Date;05.10.2026\nSamples;3\nt;f1;f2;f33\n0;1;2;3\n",
            r#", line 3, f3: found columns "t, f1, f2, f33", expected a column of this name"#,
        ),
        (
            "Date;05.10.2026\nSamples;3\nTime;A;B;C\ns;g;g;g\n0;1;2;3\n1;1;2;3\n",
            r#", line 3, t: found columns "Time, A, B, C", expected a column of this name"#,
        ),
        ("t;f1;f2;f3\ns;g;g;fine\n0;1;2;3\n", r#", line 2, t: found "s", expected a number in s"#),
        (
            "t;f1;f2;f3\n0;1;2;3\n\u{feff}t;f1;f2;f3\n1;1;2;3\n",
            ", line 3: found the names of the columns again, expected a row of numbers (two files in one?)",
        ),
    ]);
}
