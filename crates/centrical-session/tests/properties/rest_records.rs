//! Rests that a session finds in the records of its `[[tumble]]`.

use std::fs;
use std::path::{Path, PathBuf};

use centrical_session::{
    CalibrationResult, ColumnName, Folder, Method, Session, StatedAttitudes, TableFormat, TumbleRequest, calibrate,
    reduce, tumble, unwatched, write_reduced,
};

use crate::rests::alone;

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(name)
}

/// A session of the example's record alone, with these lines under `[[tumble]]`.
fn of_example(more: &str) -> String {
    alone(&format!("record = \"{}\"\n{more}", example("tumble/record.csv").display()))
}

fn tumbled(folder: &Path, attitudes: Option<StatedAttitudes>) -> CalibrationResult {
    let request = TumbleRequest {
        files: vec![example("tumble/record.csv")],
        folder: Folder::default(),
        time: ColumnName::Name("t".to_owned()),
        rate: None,
        readings: ["f1", "f2", "f3"].map(|name| ColumnName::Name(name.to_owned())),
        unit: "m/s^2".to_owned(),
        gravity: 9.81523,
        gravity_uncertainty: 0.0,
        attitudes,
        turning_radius: None,
        terms: TumbleRequest::USUAL_TERMS.map(str::to_owned).to_vec(),
        model: String::new(),
        serial: String::new(),
        date: String::new(),
    };
    tumble(&request, folder, &unwatched).unwrap().result
}

/// One search for rests: a session that names the record has the numbers of `tumble`, to the last digit, and so has the session that
/// it is reduced to.
#[test]
fn a_session_finds_the_rests_that_a_tumble_finds() {
    let folder = tempfile::tempdir().unwrap();
    let table = example("tumble/attitudes.csv");
    let known = format!("attitudes = \"{}\"\nattitude_uncertainty = \"1 mrad\"", table.display());
    for (n, more) in ["", &known].into_iter().enumerate() {
        let session = Session::parse(&of_example(more), Folder::at(folder.path())).unwrap();
        let stated = (!more.is_empty()).then(|| StatedAttitudes::named(&table, 1e-3).unwrap());
        let expected = tumbled(folder.path(), stated);
        let result = calibrate(&session, &[], Method::Exact, &unwatched).unwrap();
        assert_eq!(result.parameters, expected.parameters);
        assert_eq!(result.plateaus, expected.plateaus);
        assert_eq!(result.inputs.len(), if more.is_empty() { 2 } else { 3 });
        let (session, reduced) = reduce(&session, &unwatched).unwrap();
        assert_eq!(session.rests().count(), 24);
        let again = folder.path().join(format!("reduced{n}"));
        write_reduced(&session, &reduced, None, TableFormat::Csv, &again, &unwatched).unwrap();
        let again = calibrate(&Session::read(&again).unwrap(), &[], Method::Exact, &unwatched).unwrap();
        assert_eq!(again.parameters, expected.parameters);
    }
}

/// What a session with a record of rests says wrong of it is named.
#[test]
fn wrong_records_of_rests_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |text: &str| {
        let session = Session::parse(text, Folder::at(folder.path()));
        session.and_then(|session| calibrate(&session, &[], Method::Exact, &unwatched)).unwrap_err().to_string()
    };
    for (more, expected) in [
        ("rests = \"rests.csv\"", "record: found a record beside a table of rests, expected one or the other"),
        ("duration = \"4 s\"", "duration: found a duration, expected no such key beside rests"),
        ("attitudes = \"cube\"", "attitude_uncertainty: found no such key beside attitudes"),
    ] {
        let message = refused(&of_example(more));
        assert!(message.contains(expected), "{message}");
    }
    let in_g = of_example("").replace("output_unit = \"m/s^2\"", "output_unit = \"g\"");
    let message = refused(&in_g);
    assert!(message.contains("record.csv: found rests of 96.4") && message.contains("of gravity"), "{message}");
    let message = refused(&of_example("").replace("record.csv", "nowhere.csv"));
    assert!(message.contains("nowhere.csv"), "{message}");
    let seconds = fs::read_to_string(example("tumble/record.csv")).unwrap();
    let row = |line: &str| match line.split_once(',') {
        Some((t, readings)) => t.parse().map_or(line.to_owned(), |t: f64| format!("{},{readings}", 1e9 * t)),
        None => line.to_owned(),
    };
    fs::write(folder.path().join("ns.csv"), seconds.lines().map(row).collect::<Vec<_>>().join("\n")).unwrap();
    let message = refused(&alone("record = \"ns.csv\""));
    assert!(message.contains("ns.csv: found readings over ") && message.contains("expected time in s"), "{message}");
}
