//! A session from memory is the session from files, to the byte.

use std::fs;
use std::path::{Path, PathBuf};

use centrical_session::{
    Error, ErrorKind, Method, Recorded, Session, calibrate, calibrate_reduced, reduce, reduce_recorded, unwatched,
};

fn example() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/ta-200")
}

/// What the files of a session in SI hold.
fn recorded(session: &Session) -> Vec<Recorded> {
    let of_mounting = |m: usize| Recorded {
        record: session.record(m).unwrap(),
        telemetry: session.telemetry(m).unwrap(),
        pulses: None,
    };
    (0..session.mountings.len()).map(of_mounting).collect()
}

#[test]
fn the_result_has_the_bytes_of_that_from_files() {
    let files = Session::read(&example()).unwrap();
    let text = fs::read_to_string(&files.file).unwrap();
    let memory = Session::parse(&text, &files.file).unwrap();
    assert_eq!(memory, files);
    let of_files = reduce(&files, &unwatched).unwrap();
    let mut of_memory = reduce_recorded(&memory, recorded(&files), &unwatched).unwrap();
    // Memory has no files to be known by.
    assert!(of_memory.inputs.is_empty());
    of_memory.inputs.clone_from(&of_files.inputs);
    assert_eq!(format!("{of_memory:?}"), format!("{of_files:?}"));
    let json = |reduced| calibrate_reduced(&files, reduced, Method::Exact).unwrap().to_json().unwrap();
    assert_eq!(json(&of_memory), calibrate(&files, Method::Exact, &unwatched).unwrap().to_json().unwrap());
}

/// With half a volt per m/s^2, which is exact, the means are those in SI to the bit.
#[test]
fn numbers_are_in_the_units_of_the_columns() {
    let files = Session::read(&example()).unwrap();
    let text = fs::read_to_string(&files.file).unwrap();
    let volts = "output_unit = \"V\"\nvolts = { scale = [0.5, 0.5, 0.5], bias = [0.0, 0.0, 0.0] }";
    let session = Session::parse(&text.replace("output_unit = \"m/s^2\"", volts), &files.file).unwrap();
    let mut in_volts = recorded(&files);
    in_volts.iter_mut().flat_map(|r| r.record.f_z.iter_mut().flatten()).for_each(|f| *f *= 0.5);
    let plateaus = |session, recorded| reduce_recorded(session, recorded, &unwatched).unwrap().plateaus;
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
    let empty = refused(&|recorded| recorded[5] = Recorded::default());
    assert!(empty.contains("mounting 6: record too short"), "{empty}");
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
    let error = Session::parse(&text, &file).unwrap_err();
    assert_eq!((error.kind(), error.file()), (ErrorKind::Input, Some(file.as_path())));
    assert_eq!(error.place().map(ToString::to_string).as_deref(), Some(", [site], gravity"));
    assert_eq!(error.found(), Some("\"9.8 ft\""));
    assert!(error.expected().is_some_and(|expected| expected.contains("acceleration")));
}
