//! A session folder that is looked into while its records come: nothing is taken up that is not there yet.

use std::fs::{self, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use centrical::Observation;
use centrical_session::{RecordReader, RecordWriter, Session, Watch, unwatched};
use tempfile::TempDir;

/// Nobody stops the watch.
static GOES_ON: AtomicBool = AtomicBool::new(false);

/// Longer than any test: a record is finished when one of a later mounting is there, not by being left alone.
const NEVER: Duration = Duration::from_secs(1 << 20);

fn example(part: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/ta-200").join(part)
}

/// The example with no record yet; with records of the given ending.
fn folder(ending: &str) -> (TempDir, Session) {
    let folder = TempDir::new().unwrap();
    let text = fs::read_to_string(example("experiment.toml")).unwrap().replace(".csv\"\ntelemetry", "{}\"\ntelemetry");
    fs::write(folder.path().join("experiment.toml"), text.replace("{}", ending)).unwrap();
    fs::create_dir(folder.path().join("records")).unwrap();
    let session = Session::read(folder.path()).unwrap();
    (folder, session)
}

/// What a watch takes up of the first mounting when its record is there at once and left alone.
fn at_once() -> Vec<Observation> {
    let (folder, session) = folder(".csv");
    fs::copy(example("records/m01.csv"), folder.path().join("records/m01.csv")).unwrap();
    Watch::new(&session, Duration::ZERO, false).look(&GOES_ON).unwrap()
}

/// The same plateaus as from the whole record: means of the same windows, weighed by what was known of the noise then.
fn assert_same(came: &[Observation], whole: &[Observation]) {
    assert_eq!(came.len(), whole.len());
    for (a, b) in came.iter().zip(whole) {
        assert_eq!(a.set_point, b.set_point);
        for i in 0..3 {
            let u = b.covariance[(i, i)].sqrt();
            let difference = (a.mean[i] - b.mean[i]) / u;
            assert!(difference.abs() < 0.5, "plateau {}, axis {i}: off by {difference} u", a.set_point);
            let ratio = (a.covariance[(i, i)] / b.covariance[(i, i)]).sqrt();
            assert!((0.3..3.0).contains(&ratio), "plateau {}, axis {i}: u is {ratio} times the other", a.set_point);
        }
    }
}

/// A text that grows in pieces of any length, looked into after each.
#[test]
fn a_growing_text_is_taken_up_plateau_by_plateau() {
    let (folder, session) = folder(".csv");
    let text = fs::read(example("records/m01.csv")).unwrap();
    let file = folder.path().join("records/m01.csv");
    let mut watch = Watch::new(&session, NEVER, false);
    let mut came = Vec::new();
    let mut looks = 0;
    // No whole number of lines.
    for piece in text.chunks(text.len() / 60 + 7) {
        OpenOptions::new().create(true).append(true).open(&file).unwrap().write_all(piece).unwrap();
        came.extend(watch.look(&GOES_ON).unwrap());
        looks += 1;
    }
    assert!(looks >= 59 && came.len() == 8, "{looks} looks, {} plateaus: the last one has no end yet", came.len());
    fs::copy(example("records/m02.csv"), folder.path().join("records/m02.csv")).unwrap();
    came.extend(watch.look(&GOES_ON).unwrap());
    let (first, later): (Vec<_>, Vec<_>) = came.into_iter().partition(|o| o.set_point < 9);
    assert_same(&first, &at_once());
    assert_eq!(later.len(), 8, "of the second mounting all but the last, which has no end yet");
}

/// Parquet that grows by renaming a longer file over it, and one that is being copied in place and is there in part.
#[test]
fn a_parquet_record_replaced_by_rename_is_taken_up_plateau_by_plateau() {
    let (folder, session) = folder(".parquet");
    let record = RecordReader::open(&example("records/m01.csv"), &session.columns)
        .and_then(|reader| reader.into_record(&unwatched))
        .unwrap();
    let file = folder.path().join("records/m01.parquet");
    let write = |rows: usize| {
        let mut writer = RecordWriter::create(&file).unwrap();
        writer.write(record.as_slice().part(0..rows)).unwrap();
        writer.finish().unwrap();
    };
    let mut watch = Watch::new(&session, NEVER, false);
    let mut came = Vec::new();
    let all = record.t.len();
    for part in 1..=20 {
        write(all * part / 20);
        came.extend(watch.look(&GOES_ON).unwrap());
        if part % 4 == 0 {
            let whole = fs::read(&file).unwrap();
            fs::write(&file, &whole[..whole.len() * 2 / 3]).unwrap();
            assert_eq!(watch.look(&GOES_ON).unwrap(), [], "a file in part gives nothing");
            assert!(watch.note().unwrap().starts_with("not yet: "), "{:?}", watch.note());
            fs::write(&file, &whole).unwrap();
        }
    }
    came.extend(watch.look(&GOES_ON).unwrap());
    assert_eq!(came.len(), 8);
    // The second mounting begins while the end of the first is on its way: nothing is refused, nothing taken up.
    let whole = fs::read(&file).unwrap();
    fs::write(&file, &whole[..whole.len() - 5]).unwrap();
    fs::write(folder.path().join("records/m02.parquet"), b"PAR1").unwrap();
    assert_eq!(watch.look(&GOES_ON).unwrap(), []);
    write(all);
    came.extend(watch.look(&GOES_ON).unwrap());
    assert_same(&came, &at_once());
}

/// The second mounting begins while lines of the first are on their way: what is missing is waited for, a last line that
/// has come in part is not a number.
#[test]
fn a_record_that_another_follows_is_not_cut() {
    let text = fs::read(example("records/m01.csv")).unwrap();
    let (folder, session) = folder(".csv");
    let file = folder.path().join("records/m01.csv");
    let mut watch = Watch::new(&session, NEVER, false);
    fs::write(folder.path().join("records/m02.csv"), "t,f1,f2,f3\n").unwrap();
    // In the midst of the fifth plateau.
    fs::write(&file, &text[..text.len() / 2]).unwrap();
    assert_eq!(watch.look(&GOES_ON).unwrap(), []);
    assert!(watch.note().unwrap().starts_with("not yet: "), "{:?}", watch.note());
    // "9.81523" in part would be 9 or 9.8: a blow of g or of 15 mm/s^2 on one sample.
    fs::write(&file, &text[..text.len() - 6]).unwrap();
    assert_same(&watch.look(&GOES_ON).unwrap(), &at_once());
}

/// A record that has been left alone and does not show its schedule is wrong.
#[test]
fn a_record_left_alone_in_part_is_refused() {
    let text = fs::read(example("records/m01.csv")).unwrap();
    let (folder, session) = folder(".csv");
    fs::write(folder.path().join("records/m01.csv"), &text[..text.len() / 2]).unwrap();
    let error = Watch::new(&session, Duration::ZERO, false).look(&GOES_ON).unwrap_err().to_string();
    assert!(error.contains("m01.csv"), "{error}");
}

/// A look that is stopped reads no further record; the next look reads the others.
#[test]
fn a_stopped_look_leaves_the_other_records() {
    let session = Session::read(&example("")).unwrap();
    let mut watch = Watch::new(&session, Duration::ZERO, false);
    assert_eq!(watch.look(&AtomicBool::new(true)).unwrap(), []);
    let all = watch.look(&GOES_ON).unwrap();
    assert_eq!(all.len(), session.experiment.set_points.len());
}

/// A newtonometer that shows one number all the time is dead, unless its digit is stated: in a watch as in a calibration.
#[test]
fn a_stated_digit_is_known_while_a_session_is_watched() {
    let record = fs::read_to_string(example("records/m01.csv")).unwrap();
    let constant = |line: &str| {
        line.rsplit_once(',').map(|(rest, last)| match last {
            "f3" => line.to_owned(),
            _ => format!("{rest},9.81"),
        })
    };
    let record = record.lines().filter_map(constant).collect::<Vec<_>>().join("\n") + "\n";
    for (stated, plateaus) in [("", None), ("\n[uncertainty]\nresolution = \"1 g\"\n", Some(9))] {
        let (folder, _) = folder(".csv");
        OpenOptions::new()
            .append(true)
            .open(folder.path().join("experiment.toml"))
            .unwrap()
            .write_all(stated.as_bytes())
            .unwrap();
        let session = Session::read(folder.path()).unwrap();
        fs::write(folder.path().join("records/m01.csv"), &record).unwrap();
        let came = Watch::new(&session, Duration::ZERO, false).look(&GOES_ON);
        assert_eq!(came.as_ref().ok().map(Vec::len), plateaus, "{stated:?}: {came:?}");
    }
}
