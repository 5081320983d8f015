//! A record in three files is the record in one.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use centrical_session::{Record, Session, Watch, reduce_without_inputs, unwatched};
use nalgebra::Vector3;
use tempfile::TempDir;

/// Nobody stops the watch.
static GOES_ON: AtomicBool = AtomicBool::new(false);

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
    let means = |session: &Session| format!("{:?}", reduce_without_inputs(session, &unwatched).unwrap().1.plateaus);
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

/// Samples at stamps of their own are taken to those of the slowest file: a straight line stays one, and nothing is made up.
#[test]
fn other_stamps_are_interpolated() {
    let all = whole();
    let count = all.t.len();
    let line = |t: f64| [1.0 + 0.5 * t, 2.0 - 0.25 * t, 0.125 * t];
    // The second is 0.37 of a step late and has every third sample; the third has a gap of three steps and ends early.
    let of = |j: usize, k: usize, t: f64| match j {
        1 => k.is_multiple_of(3).then_some(t + 0.0037),
        2 => (!(100..102).contains(&k) && k + 50 < count).then_some(t - 0.002),
        _ => Some(t),
    };
    let (folder, session) = split(of);
    for (j, name) in ["x.csv", "y.csv", "z.csv"].into_iter().enumerate() {
        let times = all.t.iter().enumerate().filter_map(|(k, t)| of(j, k, *t));
        let mut text = format!("t,f{}\n", j + 1);
        times.for_each(|t| writeln!(text, "{t},{}", line(t)[j]).unwrap());
        fs::write(folder.path().join(name), text).unwrap();
    }
    let record = session.record(0).unwrap();
    let has = |k: &usize| {
        let t = all.t[*k] + 0.0037;
        // The stamps of the third about the gap: those of samples 99 and 102.
        let in_gap = t > all.t[99] - 0.002 && t < all.t[102] - 0.002;
        k.is_multiple_of(3) && t <= all.t[count - 51] - 0.002 && !in_gap
    };
    let expected: Vec<f64> = (0..count).filter(has).map(|k| all.t[k] + 0.0037).collect();
    assert_eq!(record.t, expected);
    for (k, t) in record.t.iter().enumerate() {
        for (j, f) in line(*t).into_iter().enumerate() {
            // Some units of the last place of the readings and of the times, 60 at most.
            assert!((record.f_z[j][k] - f).abs() < 1e-12, "{t}, {j}: {}", record.f_z[j][k]);
        }
    }
}

/// Three files that grow in turn, one of them with stamps of its own: no plateau is taken up before it is there.
#[test]
fn growing_files_are_taken_up_plateau_by_plateau() {
    let (folder, session) = split(|j, _, t| Some(if j == 1 { t + 0.0037 } else { t }));
    let seen = |watch: &mut Watch| -> Vec<(usize, Vector3<f64>)> {
        watch
            .look(&GOES_ON)
            .unwrap()
            .iter()
            .map(|o| (o.set_point, o.mean))
            .filter(|(set_point, _)| *set_point < 9)
            .collect()
    };
    let whole = seen(&mut Watch::new(&session, Duration::ZERO, false));
    let names = ["x.csv", "y.csv", "z.csv"].map(|name| folder.path().join(name));
    let texts = names.each_ref().map(|name| fs::read(name).unwrap());
    let mut watch = Watch::new(&session, Duration::from_secs(1 << 20), false);
    let mut came = Vec::new();
    for part in 1..=20 {
        for (j, (name, text)) in names.iter().zip(&texts).enumerate() {
            // The third is behind the others, and no line is whole.
            let end = text.len() * (part - j / 2) / 20;
            fs::write(name, &text[..end.max(8)]).unwrap();
            came.extend(seen(&mut watch));
        }
    }
    // Records of later mountings are there: the last plateau ends with its files.
    assert_eq!(came.len(), 9);
    assert_eq!(whole.len(), 9);
    for ((set_point, mean), (expected, of_whole)) in came.iter().zip(&whole) {
        assert_eq!(set_point, expected);
        // Some hundredths of the noise of a sample, 5 mm/s^2, by windows that end a block earlier.
        assert!((mean - of_whole).norm() < 1e-3, "{set_point}: {mean} {of_whole}");
    }
}

#[test]
fn files_without_a_time_in_common_are_refused() {
    let message = |row: fn(usize, usize, f64) -> Option<f64>| {
        let (folder, session) = split(row);
        let error = session.record(0).unwrap_err().to_string();
        error.replace(&format!("{}/", folder.path().display()), "")
    };
    let end = whole().t.last().copied().unwrap();
    assert_eq!(
        message(|j, _, t| Some(if j == 1 { t + 1000.0 } else { t })),
        format!(
            "x.csv: found samples up to t = {end}, expected samples from t = 1000 on, where y.csv begins: the files of one mounting \
             have one clock"
        )
    );
    // The second file has a third of the time: once with other stamps, once with the same.
    let expected = "expected most of them between two samples without a gap: the files of one mounting have one clock";
    let few = message(|j, k, t| (j != 1 || k < 4000).then_some(if j == 1 { t + 0.001 } else { t }));
    assert!(few.starts_with("y.csv: found readings at ") && few.ends_with(expected), "{few}");
    let expected =
        "expected the stamps of x.csv to the end, as at the beginning: the files of one mounting have one clock";
    let few = message(|j, k, t| (j != 1 || k < 4000).then_some(t));
    assert!(few.starts_with("z.csv: found 4000 of ") && few.ends_with(expected), "{few}");
    let (folder, session) = split(|_, _, t| Some(t));
    fs::remove_file(folder.path().join("z.csv")).unwrap();
    let missing = session.record(0).unwrap_err().to_string();
    assert!(missing.ends_with("z.csv: found no such file, expected the record of a newtonometer"), "{missing}");
}
