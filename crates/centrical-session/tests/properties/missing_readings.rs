//! A row that lacks a reading refuses the record, or is left out as if the recorder had lost it.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use centrical_session::{Record, Session, reduce_without_inputs, unwatched};
use tempfile::TempDir;

const EXAMPLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/ta-200");

/// How programs write a reading that they lack.
const WORDS: [&str; 5] = ["", "NaN", "#N/A", "null", "-nan(ind)"];

/// Which newtonometer lacks sample `k`: single ones, and a second of the third one.
fn lacks(j: usize, k: usize) -> bool {
    k % 97 == 5 && j == k % 3 || j == 2 && (700..800).contains(&k)
}

/// Writes a line of readings, words in place of those that are missing.
fn line(text: &mut String, record: &Record, k: usize, axes: impl Iterator<Item = usize>) {
    write!(text, "{}", record.t[k]).unwrap();
    for j in axes {
        let number = record.f_z[j][k].to_string();
        write!(text, ",{}", if lacks(j, k) { WORDS[k % WORDS.len()] } else { &number }).unwrap();
    }
    text.push('\n');
}

/// The example with another record of its first mounting, and `stated` under `[columns]`.
fn session(folder: &Path, record: &str, stated: &str) -> Session {
    let experiment = fs::read_to_string(Path::new(EXAMPLE).join("experiment.toml")).unwrap();
    let experiment = experiment
        .replace("record = \"records/m01.csv\"", &format!("record = {record}"))
        .replace("\"records/", &format!("\"{EXAMPLE}/records/"))
        .replace("\"telemetry/", &format!("\"{EXAMPLE}/telemetry/"))
        .replace("[columns]\n", &format!("[columns]\n{stated}"));
    fs::write(folder.join("experiment.toml"), experiment).unwrap();
    Session::read(folder).unwrap()
}

#[test]
fn rows_that_lack_a_reading_are_as_rows_that_are_lost() {
    let whole = Session::read(Path::new(EXAMPLE)).unwrap().record(0).unwrap();
    let count = whole.t.len();
    let folder = TempDir::new().unwrap();
    let (mut one, mut lost) = ("t,f1,f2,f3\n".to_owned(), "t,f1,f2,f3\n".to_owned());
    for k in 0..count {
        line(&mut one, &whole, k, 0..3);
        if (0..3).all(|j| !lacks(j, k)) {
            line(&mut lost, &whole, k, 0..3);
        }
    }
    let write = |name: &str, text: String| fs::write(folder.path().join(name), text).unwrap();
    for (j, name) in ["x.csv", "y.csv", "z.csv"].into_iter().enumerate() {
        let mut text = format!("t,f{}\n", j + 1);
        (0..count).for_each(|k| line(&mut text, &whole, k, j..=j));
        write(name, text);
    }
    write("one.csv", one);
    write("lost.csv", lost);
    let means = |session: &Session| reduce_without_inputs(session, &unwatched).unwrap().1.plateaus;
    let expected = session(folder.path(), "\"lost.csv\"", "");
    let (record, plateaus) = (expected.record(0).unwrap(), format!("{:?}", means(&expected)));
    assert!(record.t.len() < count - 100);
    for record_of in ["\"one.csv\"", "[\"x.csv\", \"y.csv\", \"z.csv\"]"] {
        let left_out = session(folder.path(), record_of, "missing_readings = \"left out\"\n");
        assert!(left_out.record(0).unwrap() == record, "{record_of}");
        assert_eq!(format!("{:?}", means(&left_out)), plateaus);
        let refused = session(folder.path(), record_of, "").record(0).unwrap_err().to_string();
        assert!(
            refused.contains("expected a number in m/s^2, or missing_readings = \"left out\" under [columns]"),
            "{refused}"
        );
    } // A row needs its time.
    let one = fs::read_to_string(folder.path().join("one.csv")).unwrap();
    let time = one.lines().nth(5).unwrap().split(',').next().unwrap();
    write("one.csv", one.replacen(&format!("\n{time},"), "\n,", 1));
    let refused = session(folder.path(), "\"one.csv\"", "").record(0).unwrap_err().to_string();
    assert!(refused.contains("line 6, t") && !refused.contains("missing_readings"), "{refused}");
}
