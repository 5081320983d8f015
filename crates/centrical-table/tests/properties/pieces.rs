//! Texts of many pieces: no row is lost or doubled at a border, and a fault is found on its line.

use std::fmt::Write as _;
use std::fs;

use tempfile::TempDir;

use crate::record::{Record, named, read_record};

/// A text longer than many pieces, with comments, blank lines and quoted numbers here and there, and the line of each row.
fn text(rows: usize, end: &str) -> (String, Record, Vec<usize>) {
    let (mut text, mut record, mut lines) = (String::new(), Record::default(), Vec::new());
    let mut line = 1;
    let mut add = |text: &mut String, content: &str| {
        text.push_str(content);
        text.push_str(end);
        line += 1;
        line - 1
    };
    add(&mut text, "# a comment");
    add(&mut text, "t,f1,f2,f3");
    for k in 0..rows {
        if k % 1009 == 7 {
            add(&mut text, "# what a logger says, \"and, quotes");
        }
        if k % 2003 == 5 {
            add(&mut text, "");
        }
        let row = [k as f64 / 1000.0, (k * 7919 % 10_007) as f64 / 1e5, -9.81, (k % 13) as f64 * 1e-7 - 196.3];
        let mut content = String::new();
        match k % 501 {
            0 => write!(content, "\"{}\",{:e}, {} ,{}", row[0], row[1], row[2], row[3]).unwrap(),
            _ => write!(content, "{},{},{},{}", row[0], row[1], row[2], row[3]).unwrap(),
        }
        lines.push(add(&mut text, &content));
        record.iter_mut().zip(row).for_each(|(column, value)| column.push(value));
    }
    (text, record, lines)
}

#[test]
fn every_row_once_and_in_order() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("record.csv");
    for end in ["\n", "\r\n"] {
        let (text, record, _) = text(70_000, end);
        assert!(text.len() > 2 << 20);
        // The borders of the pieces fall elsewhere in every text.
        for shift in [0, 1, 2, 17] {
            fs::write(&file, format!("{}{text}", format!("#{end}").repeat(shift))).unwrap();
            assert!(read_record(&file, &named()).unwrap() == record, "{end:?} {shift}");
        }
    }
}

/// Numbers of every length and form, lines that end either way, now and then many that could be read together: each number is
/// what the standard library reads.
#[test]
fn every_number_is_read_to_the_last_bit() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("record.csv");
    let mut state = 5_u64;
    let mut below = |end: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        usize::try_from(state >> 33).unwrap() % end
    };
    for plainness in [2, 100, 3000] {
        let mut text = "t,f1,f2,f3\n".to_owned();
        let mut expected = Record::default();
        let mut usual = 3;
        for row in 0..30_000 {
            let is_plain = below(plainness) > 0;
            if below(500) == 0 {
                usual = below(8);
            }
            let time = format!("{:.4}", f64::from(row) * 1e-4);
            expected[0].push(time.parse().unwrap());
            text.push_str(&time);
            for column in &mut expected[1..] {
                let decimals = if is_plain { usual } else { below(18) };
                let size = 10_f64.powi(i32::try_from(below(if is_plain { 5 } else { 9 })).unwrap());
                let value = size * (below(2_000_001) as f64 / 1e6 - 1.0);
                let number = match if is_plain { 9 } else { below(5) } {
                    0 => format!("{value:e}"),
                    1 => format!("+{:.decimals$}", value.abs()),
                    _ => format!("{value:.decimals$}"),
                };
                column.push(number.parse().unwrap());
                write!(text, ",{number}").unwrap();
            }
            text.push_str(if is_plain || below(3) == 0 { "\n" } else { "\r\n" });
        }
        fs::write(&file, &text).unwrap();
        let found = read_record(&file, &named()).unwrap();
        let bits = |record: &Record| -> Vec<u64> { record.iter().flatten().map(|value| value.to_bits()).collect() };
        assert!(bits(&found) == bits(&expected), "one number of {plainness} lines is not plain");
    }
}

#[test]
fn a_fault_is_on_its_line() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("record.csv");
    let (text, record, lines) = text(70_000, "\n");
    for row in [0, 1, 500, 6_000, 6_001, 34_567, 50_001, 69_999] {
        let line = lines[row];
        let mut all: Vec<&str> = text.lines().collect();
        let wrong = |all: &[&str]| {
            fs::write(&file, all.join("\n")).unwrap();
            read_record(&file, &named()).unwrap_err().to_string()
        };
        all[line - 1] = "0,1,x,3";
        let expected = format!("{}, line {line}, f2: found \"x\", expected a number in m/s^2", file.display());
        assert_eq!(wrong(&all), expected);
        if row > 0 {
            all[line - 1] = "-1,1,2,3";
            let before = record[0][row - 1];
            let expected = format!(
                "{}, line {line}, t: found -1 after {before}, expected a time that does not run backwards",
                file.display()
            );
            assert_eq!(wrong(&all), expected);
        }
    }
}

#[test]
fn a_comment_with_as_many_delimiters_is_no_row() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("record.csv");
    let mut text = "note,t,f1,f2,f3\n".to_owned();
    for k in 0..1000 {
        if k % 100 == 50 {
            text.push_str("# noon,0.5,1.5,2.5,3.5\n");
        }
        writeln!(text, "\"a, b\",{},1.5,2.5,{}", f64::from(k) / 8.0, k % 7).unwrap();
        writeln!(text, "c,{},1.5,2.5,{}", f64::from(k) / 8.0 + 0.0625, k % 5).unwrap();
    }
    fs::write(&file, text).unwrap();
    let record = read_record(&file, &named()).unwrap();
    let times: Vec<f64> = (0..2000).map(|k| f64::from(k) / 16.0).collect();
    assert_eq!(record[0], times);
}

#[test]
fn a_line_of_too_many_fields_is_refused_where_it_is() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("record.csv");
    let long = format!("1,2,3,4{}", ",5".repeat(1000));
    fs::write(&file, format!("t,f1,f2,f3\n0,1,2,3\n{long}\n2,1,2,3\n")).unwrap();
    let error = read_record(&file, &named()).unwrap_err().to_string();
    assert!(
        error.contains("line 3: found 1004 fields") && error.ends_with("expected 4 as in the first line"),
        "{error}"
    );
}
