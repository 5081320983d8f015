//! `centrical init` on files of other headers: FOUND stands beside what they say, and nothing is left out without a word.

use std::f64::consts::PI;
use std::fs;

use crate::session::{Copy, assert_lines, draft};

/// The draft of the example, every header of its records and of its telemetry being these.
fn drafted(records: &str, telemetry: &str) -> String {
    let copy = Copy::new();
    with_headers(&copy, records, telemetry);
    draft(&copy, &["records", "telemetry"])
}

fn with_headers(copy: &Copy, records: &str, telemetry: &str) {
    for (part, header) in [("records", records), ("telemetry", telemetry)] {
        for file in fs::read_dir(copy.session().join(part)).unwrap() {
            let path = file.unwrap().path();
            let text = fs::read_to_string(&path).unwrap();
            let (_, rows) = text.split_once('\n').unwrap();
            fs::write(&path, format!("{header}\n{rows}")).unwrap();
        }
    }
}

#[test]
fn the_unit_of_speed_stands_in_its_name() {
    let cases = [
        ("rpm", "speed_unit = \"rpm\"  # FOUND"),
        ("RPM", "speed_unit = \"rpm\"  # FOUND"),
        ("speed_rpm", "speed_unit = \"rpm\"  # FOUND"),
        ("n [rpm]", "speed_unit = \"rpm\"  # FOUND"),
        ("n 1/min", "speed_unit = \"rpm\"  # FOUND"),
        ("deg/s", "speed_unit = \"deg/s\"  # FOUND"),
        ("Hz", "speed_unit = \"Hz\"  # FOUND"),
        ("обороты", "speed_unit = \"rpm\"  # GUESS"),
        ("omega", "speed_unit = \"rad/s\"  # GUESS: the file names no unit"),
    ];
    for (name, line) in cases {
        let draft = drafted("t,f1,f2,f3", &format!("t,{name}"));
        assert_lines(&draft, &[line, &format!("speed = \"{name}\"  # FOUND")]);
    }
}

/// Readings and speed show the radius of the arm: of the units that a speed may be in, one alone makes it an arm.
#[test]
fn a_speed_without_a_unit_is_that_of_an_arm() {
    let arms = |draft: &str| -> Vec<String> {
        draft.lines().filter(|line| line.starts_with("arm = ")).map(str::to_owned).collect()
    };
    let expected = arms(&drafted("t,f1,f2,f3", "t,omega"));
    assert_eq!(expected.len(), 12);
    for (unit, factor) in [("rpm", 30.0 / PI), ("deg/s", 180.0 / PI), ("rev/s", 0.5 / PI)] {
        let copy = Copy::new();
        for file in fs::read_dir(copy.session().join("telemetry")).unwrap() {
            let path = file.unwrap().path();
            let text = fs::read_to_string(&path).unwrap();
            let row = |line: &str| {
                let (t, omega) = line.split_once(',').unwrap();
                format!("{t},{}\n", omega.parse::<f64>().unwrap() * factor)
            };
            fs::write(&path, format!("t,speed\n{}", text.lines().skip(1).map(row).collect::<String>())).unwrap();
        }
        let draft = draft(&copy, &["records", "telemetry"]);
        assert_lines(&draft, &[&format!("speed_unit = \"{unit}\"  # GUESS: the file names no unit")]);
        assert_eq!(arms(&draft), expected);
    }
}

#[test]
fn time_and_units_of_readings_stand_in_their_names() {
    let draft = drafted("ms,x_mg,y_mg,z_mg", "t,omega");
    let readings = "f = [{ column = \"x_mg\", unit = \"mg\" }, { column = \"y_mg\", unit = \"mg\" }";
    assert_lines(&draft, &["time = { column = \"ms\", unit = \"ms\" }  # FOUND", readings]);
    let draft = drafted("t_ms,x,y,z", "t,omega");
    assert_lines(
        &draft,
        &["time = { column = \"t_ms\", unit = \"ms\" }  # FOUND", "f = [\"x\", \"y\", \"z\"]  # FOUND"],
    );
    // By its name it could be anything: it rises.
    let draft = drafted("clock,x_g,y_g,z_g", "t,omega");
    assert_lines(&draft, &["time = \"clock\"  # GUESS: the first column", "output_unit = \"g\"  # FOUND"]);
}

/// A record that lasts a thousand times as long as its telemetry has milliseconds, and telemetry alike; whole numbers count samples.
#[test]
fn a_time_without_a_unit_is_as_long_as_its_telemetry() {
    let with_times = |part: &str, time: &dyn Fn(usize, f64) -> f64| {
        let copy = Copy::new();
        for file in fs::read_dir(copy.session().join(part)).unwrap() {
            let path = file.unwrap().path();
            let text = fs::read_to_string(&path).unwrap();
            let (header, rows) = text.split_once('\n').unwrap();
            let row = |(k, line): (usize, &str)| {
                let (t, readings) = line.split_once(',').unwrap();
                format!("{},{readings}\n", time(k, t.parse().unwrap()))
            };
            fs::write(&path, format!("{header}\n{}", rows.lines().enumerate().map(row).collect::<String>())).unwrap();
        }
        draft(&copy, &["records", "telemetry"])
    };
    for (unit, factor) in [("ms", 1e3), ("us", 1e6), ("min", 1.0 / 60.0), ("h", 1.0 / 3600.0)] {
        let draft = with_times("records", &|_, t| t * factor);
        let time = format!("time = {{ column = \"t\", unit = \"{unit}\" }}  # GUESS: the file names no unit");
        assert_lines(&draft, &[&time, "telemetry_time = \"t\"  # FOUND"]);
        assert!(!draft.contains("arm = [\"?\""), "{draft}");
    }
    let draft = with_times("telemetry", &|_, t| t * 1e3);
    assert_lines(&draft, &["time = \"t\"  # FOUND", "telemetry_time = { column = \"t\", unit = \"ms\" }  # GUESS"]);
    let draft = with_times("records", &|k, _| k as f64);
    assert_lines(&draft, &["time = { column = \"t\", rate = \"?\" }"]);
    assert!(draft.contains("by the length of the telemetry about 100.0 Hz"), "{draft}");
}

#[test]
fn a_unit_that_stands_nowhere_is_not_found() {
    let copy = Copy::new();
    let draft = draft(&copy, &["records"]);
    assert_lines(&draft, &["output_unit = \"m/s^2\"  # GUESS: no file names the unit"]);
}

#[test]
fn gyroscopes_are_no_newtonometers() {
    let copy = Copy::new();
    fs::write(copy.session().join("records/gyro_01.csv"), "t,gx,gy,gz\n0,1,2,3\n1,1,2,3\n").unwrap();
    let draft = draft(&copy, &["records", "telemetry"]);
    assert!(draft.lines().any(|line| line.contains("gyro_01.csv: found rates of turn")), "{draft}");
    assert_lines(&draft, &["f = [\"f1\", \"f2\", \"f3\"]"]);
    // Beside the readings, and in front of them.
    let record = "t,gx,gy,gz,ax,ay,az\n0,9,9,9,1,2,3\n1,9,9,9,1,2,3\n2,9,9,9,1,2,3\n";
    let copy = Copy::new();
    let folder = copy.session().join("both");
    fs::create_dir(&folder).unwrap();
    fs::write(folder.join("m1.csv"), record).unwrap();
    let draft = self::draft(&copy, &["both"]);
    assert_lines(&draft, &["f = [\"ax\", \"ay\", \"az\"]"]);
}

#[test]
fn files_that_are_not_used_are_named() {
    let copy = Copy::new();
    fs::write(copy.session().join("records/notes.csv"), "mounting,n\n1,5\n2,6\n").unwrap();
    let draft = draft(&copy, &["records", "telemetry"]);
    let line = draft.lines().find(|line| line.starts_with("# NOT USED: ")).unwrap();
    assert!(line.contains("notes.csv: found one reading in columns mounting, n, expected three"), "{line}");
    let line_of_axes = draft.lines().find(|line| line.starts_with("axes = ")).unwrap();
    assert!(line_of_axes.contains("no axis reversed: the readings do not show it"), "{line_of_axes}");
    // A speed in a column whose name does not say so.
    let draft = drafted("t,f1,f2,f3", "t,n");
    assert_eq!(
        draft.matches(".csv: found columns t, n, expected a time and three readings, or a time and a speed").count(),
        12
    );
}
