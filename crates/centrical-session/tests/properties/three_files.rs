//! A record in three files is the record in one.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use centrical_session::{Record, Session, reduce_without_inputs};
use tempfile::TempDir;

const EXAMPLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/ta-200");

/// The example with the record of its first mounting split into `x.csv`, `y.csv`, `z.csv` by `row`: whether newtonometer `j` has
/// sample `k`, and at what time.
fn split(row: impl Fn(usize, usize, f64) -> Option<f64>) -> (TempDir, Session) {
    let folder = tempfile::tempdir().unwrap();
    let record = Session::read(Path::new(EXAMPLE)).unwrap().record(0).unwrap();
    for (j, name) in ["x.csv", "y.csv", "z.csv"].into_iter().enumerate() {
        let mut text = format!("t,f{}\n", j + 1);
        for (k, t) in record.t.iter().enumerate() {
            if let Some(t) = row(j, k, *t) {
                writeln!(text, "{t},{}", record.f_z[j][k]).unwrap();
            }
        }
        fs::write(folder.path().join(name), text).unwrap();
    }
    let experiment = fs::read_to_string(Path::new(EXAMPLE).join("experiment.toml")).unwrap();
    let three = "record = [\"x.csv\", \"y.csv\", \"z.csv\"]";
    let experiment = experiment
        .replace("record = \"records/m01.csv\"", three)
        .replace("\"records/", &format!("\"{EXAMPLE}/records/"));
    let experiment = experiment.replace("\"telemetry/", &format!("\"{EXAMPLE}/telemetry/"));
    fs::write(folder.path().join("experiment.toml"), experiment).unwrap();
    let session = Session::read(folder.path()).unwrap();
    (folder, session)
}

fn whole() -> Record {
    Session::read(Path::new(EXAMPLE)).unwrap().record(0).unwrap()
}

#[test]
fn equal_stamps_are_joined_row_by_row() {
    let (_folder, session) = split(|_, _, t| Some(t));
    assert!(session.record(0).unwrap() == whole());
    assert_eq!(session.files().len(), Session::read(Path::new(EXAMPLE)).unwrap().files().len() + 2);
    let means = |session: &Session| format!("{:?}", reduce_without_inputs(session, &|_| ()).unwrap().plateaus);
    assert_eq!(means(&session), means(&Session::read(Path::new(EXAMPLE)).unwrap()));
}

#[test]
fn what_one_file_lacks_is_a_gap_of_all() {
    // The second began later, the third ended earlier and lost samples.
    let all = whole();
    let count = all.t.len();
    let has = move |j: usize, k: usize| match j {
        1 => k >= 5,
        2 => k + 7 < count && k % 100 != 17,
        _ => true,
    };
    let (_folder, session) = split(move |j, k, t| has(j, k).then_some(t));
    let kept: Vec<usize> = (0..count).filter(|k| (0..3).all(|j| has(j, *k))).collect();
    let record = session.record(0).unwrap();
    assert_eq!(record.t, kept.iter().map(|k| all.t[*k]).collect::<Vec<_>>());
    for j in 0..3 {
        assert_eq!(record.f_z[j], kept.iter().map(|k| all.f_z[j][*k]).collect::<Vec<_>>());
    }
}

#[test]
fn other_clocks_and_rates_are_refused() {
    let message = |row: fn(usize, usize, f64) -> Option<f64>| {
        let (folder, session) = split(row);
        let error = session.record(0).unwrap_err().to_string();
        error.replace(&format!("{}/", folder.path().display()), "")
    };
    let count = whole().t.len();
    let expected =
        "expected the stamps of x.csv: the files of one mounting have one clock and one rate (nothing is resampled)";
    assert_eq!(
        message(|j, _, t| Some(if j == 1 { t + 0.001 } else { t })),
        format!("y.csv: found 0 of {count} samples with a stamp that the other files have too, {expected}")
    );
    let few = message(|j, k, t| (j != 2 || k % 3 == 0).then_some(t));
    assert!(few.starts_with("y.csv: found") && few.ends_with(expected), "{few}");
    let (folder, session) = split(|_, _, t| Some(t));
    fs::remove_file(folder.path().join("z.csv")).unwrap();
    let missing = session.record(0).unwrap_err().to_string();
    assert!(missing.ends_with("z.csv: found no such file, expected the record of a newtonometer"), "{missing}");
}
