//! A session from memory is the session from files, to the byte.

use std::fs;
use std::path::{Path, PathBuf};

use centrical_session::{
    Error, ErrorKind, Folder, Method, PlateauRow, PlateauTable, Record, Recorded, Session, TableFormat, calibrate,
    calibrate_reduced, reduce, reduce_recorded, unwatched, write_reduced,
};
use centrical_table::Extent;

use crate::rests::alone;

fn example() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/ta-200")
}

/// What the files of a session in SI hold.
fn recorded(session: &Session) -> Vec<Recorded> {
    let of_mounting = |m: usize| Recorded {
        record: session.record(m).unwrap(),
        telemetry: session.telemetry(m, Extent::Whole).unwrap(),
        pulses: None,
    };
    (0..session.mountings.len()).map(of_mounting).collect()
}

#[test]
fn the_result_has_the_bytes_of_that_from_files() {
    let files = Session::read(&example()).unwrap();
    let text = fs::read_to_string(&files.file).unwrap();
    let memory = Session::parse(&text, Folder::at(&example())).unwrap();
    assert_eq!((&memory.experiment, &memory.mountings), (&files.experiment, &files.mountings));
    let (_, of_files) = reduce(&files, &unwatched).unwrap();
    let (_, mut of_memory) = reduce_recorded(&memory, recorded(&files), &unwatched).unwrap();
    // Memory has no files to be known by.
    assert!(of_memory.inputs.is_empty());
    of_memory.inputs.clone_from(&of_files.inputs);
    assert_eq!(format!("{of_memory:?}"), format!("{of_files:?}"));
    let json = |reduced| calibrate_reduced(&files, reduced, Method::Exact, &unwatched).unwrap().to_json().unwrap();
    assert_eq!(json(&of_memory), calibrate(&files, &[], Method::Exact, &unwatched).unwrap().to_json().unwrap());
}

/// The session of the same files in memory, and none on disk.
fn in_memory(session: &Session) -> Session {
    let on_disk = session.file.parent().unwrap();
    let text = fs::read_to_string(&session.file).unwrap();
    let nowhere = Folder::at(Path::new("nowhere"));
    let missing = Session::parse(&text, nowhere.clone()).and_then(|s| calibrate(&s, &[], Method::Exact, &unwatched));
    assert_eq!(missing.unwrap_err().kind(), ErrorKind::Missing);
    let with = |folder: Folder, file: &Path| {
        folder.with(file.strip_prefix(on_disk).unwrap().to_str().unwrap(), fs::read(file).unwrap().into())
    };
    Session::parse(&text, session.files().into_iter().skip(1).fold(nowhere, with)).unwrap()
}

/// Records, telemetry, a record of rests, its attitudes; and the tables to which these are reduced.
#[test]
fn files_in_memory_give_the_bytes_of_those_on_disk() {
    let folder = tempfile::tempdir().unwrap();
    let of_rests = folder.path().join("rests");
    fs::create_dir(&of_rests).unwrap();
    for name in ["record.csv", "attitudes.csv"] {
        fs::copy(example().join("../tumble").join(name), of_rests.join(name)).unwrap();
    }
    let names = "record = \"record.csv\"\nattitudes = \"attitudes.csv\"\nattitude_uncertainty = \"1 mrad\"";
    fs::write(of_rests.join("experiment.toml"), alone(names)).unwrap();
    for (n, of_records) in [example(), of_rests].into_iter().enumerate() {
        let of_tables = folder.path().join(format!("reduced{n}"));
        for on_disk in [of_records, of_tables.clone()] {
            let files = Session::read(&on_disk).unwrap();
            let memory = in_memory(&files);
            assert_eq!(memory.record_bytes(), files.record_bytes());
            let json = |session| calibrate(session, &[], Method::Exact, &unwatched).unwrap().to_json().unwrap();
            assert_eq!(json(&memory), json(&files));
            // The experiment file is in memory, too.
            let (session, reduced) = reduce(&memory, &unwatched).unwrap();
            if on_disk != of_tables {
                write_reduced(&session, &reduced, None, TableFormat::Csv, &of_tables, &unwatched).unwrap();
            }
        }
    }
}

/// With half a volt per m/s^2, which is exact, the means are those in SI to the bit.
#[test]
fn numbers_are_in_the_units_of_the_columns() {
    let files = Session::read(&example()).unwrap();
    let text = fs::read_to_string(&files.file).unwrap();
    let volts = "output_unit = \"V\"\nvolts = { scale = [0.5, 0.5, 0.5], bias = [0.0, 0.0, 0.0] }";
    let session = Session::parse(&text.replace("output_unit = \"m/s^2\"", volts), Folder::at(&example())).unwrap();
    let mut in_volts = recorded(&files);
    in_volts.iter_mut().flat_map(|r| r.record.f_z.iter_mut().flatten()).for_each(|f| *f *= 0.5);
    let plateaus = |session, recorded| reduce_recorded(session, recorded, &unwatched).unwrap().1.plateaus;
    assert_eq!(format!("{:?}", plateaus(&session, in_volts)), format!("{:?}", plateaus(&files, recorded(&files))));
}

#[test]
fn what_is_no_record_is_refused() {
    let session = Session::read(&example()).unwrap();
    let refused = |spoil: &dyn Fn(&mut Vec<Recorded>)| {
        let mut recorded = recorded(&session);
        spoil(&mut recorded);
        let error: Error = reduce_recorded(&session, recorded, &unwatched).unwrap_err();
        assert_eq!((error.kind(), error.file()), (ErrorKind::Input, Some(session.file.as_path())));
        error.to_string()
    };
    let few = refused(&|recorded| recorded.truncate(11));
    assert!(few.ends_with("found 11 records in memory, expected 12, one for each mounting"), "{few}");
    let unequal = refused(&|recorded| recorded[2].record.f_z[1].truncate(100));
    assert!(unequal.contains("mounting 3: columns of different lengths"), "{unequal}");
    let backwards = refused(&|recorded| recorded[0].record.t[700] = 1.0);
    assert!(backwards.contains("mounting 1: sample 701: found time 1 s"), "{backwards}");
    let missing = refused(&|recorded| recorded[0].record.f_z[1][500] = f64::NAN);
    let expected = "[[mounting]] 1, record: found no reading f2 in sample 501, expected a number in m/s^2, or missing_readings = \"left out\" \
                    under [columns]";
    assert!(missing.contains(expected), "{missing}");
    let empty = refused(&|recorded| recorded[5] = Recorded::default());
    assert!(empty.contains("mounting 6: record too short"), "{empty}");
    // Nanoseconds in columns of seconds.
    let years = |key: &str, spoil: &dyn Fn(&mut Recorded)| {
        let message = refused(&|recorded| spoil(&mut recorded[1]));
        assert!(message.contains(&format!("[[mounting]] 2, {key}: found readings over ")), "{message}");
        assert!(message.contains(" years, expected time in s; another unit"), "{message}");
    };
    years("record", &|recorded| recorded.record.t.iter_mut().for_each(|t| *t *= 1e9));
    years("telemetry", &|recorded| recorded.telemetry.as_mut().unwrap().t.iter_mut().for_each(|t| *t *= 1e9));
    years("pulses", &|recorded| recorded.pulses = Some(vec![0.0, 1e9]));
}

/// Samples that lack a reading are left out where the session says so, as rows of a file.
#[test]
fn missing_readings_are_lost_samples() {
    let text = fs::read_to_string(&Session::read(&example()).unwrap().file).unwrap();
    let text = text.replace("[columns]\n", "[columns]\nmissing_readings = \"left out\"\n");
    let session = Session::parse(&text, Folder::at(&example())).unwrap();
    let (mut lacking, mut lost) = (recorded(&session), recorded(&session));
    lacking[2].record.f_z[1][700..720].fill(f64::NAN);
    let Record { t, f_z } = &mut lost[2].record;
    f_z.iter_mut().chain([t]).for_each(|column| drop(column.drain(700..720)));
    let plateaus = |recorded| format!("{:?}", reduce_recorded(&session, recorded, &unwatched).unwrap().1.plateaus);
    assert_eq!(plateaus(lacking), plateaus(lost));
}

/// A reduced session, its table as columns: the plateaus of its own file.
#[test]
fn plateaus_from_memory_are_those_of_a_file() {
    let session = Session::read(&example()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let (_, reduced) = reduce(&session, &unwatched).unwrap();
    write_reduced(&session, &reduced, None, TableFormat::Csv, folder.path(), &unwatched).unwrap();
    let from_file = Session::read(folder.path()).unwrap();
    let rows = &from_file.plateaus.as_ref().unwrap().rows;
    let column = |of: &dyn Fn(&PlateauRow) -> f64| rows.iter().map(of).collect::<Vec<f64>>();
    let mut columns = vec![
        column(&|p| (p.mounting + 1) as f64),
        column(&|p| p.speed),
        column(&|p| if p.speed == 0.0 { p.angle } else { f64::NAN }),
    ];
    columns.extend((0..3).map(|i| column(&move |p| p.mean[i])));
    columns.extend([(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|at| column(&move |p| p.covariance[at])));
    columns.push(column(&|p| p.samples as f64));
    let memory = session.clone().with_plateaus(&columns).unwrap();
    assert_eq!(memory.experiment, from_file.experiment);
    assert_eq!(&memory.plateaus.as_ref().unwrap().rows, rows);
    assert_eq!(PlateauTable::columns().count(), columns.len() + 1);

    columns[3].pop();
    let error = session.clone().with_plateaus(&columns).unwrap_err().to_string();
    assert!(error.contains("found plateaus in columns of [108, 108, 108, 107, "), "{error}");
    columns[3].push(f64::NAN);
    columns[0][7] = 13.0;
    let error = session.with_plateaus(&columns).unwrap_err().to_string();
    assert!(error.ends_with("row 8, mounting: found 13, expected the number of a mounting, 1 to 12"), "{error}");
}

#[test]
fn errors_tell_their_parts() {
    let error = Session::read(Path::new("no/such/session.toml")).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Missing);
    assert_eq!((error.file(), error.found()), (Some(Path::new("no/such/session.toml")), Some("no such file")));
    assert!(
        error.expected().is_some_and(|expected| expected.starts_with("an experiment file")) && error.place().is_none()
    );

    let file = example().join("experiment.toml");
    let text = fs::read_to_string(&file).unwrap().replace("gravity = ", "gravity = \"9.8 ft\" # ");
    let error = Session::parse(&text, Folder::at(&example())).unwrap_err();
    assert_eq!((error.kind(), error.file()), (ErrorKind::Input, Some(file.as_path())));
    assert_eq!(error.place().map(ToString::to_string).as_deref(), Some(", [site], gravity"));
    assert_eq!(error.found(), Some("\"9.8 ft\""));
    assert!(error.expected().is_some_and(|expected| expected.contains("acceleration")));
}
