//! Bad input: exit code 2, one message that names the file, the place, what was found and what was expected,
//! no panic, nothing left behind.

use std::f64::consts::TAU;
use std::fs;
use std::path::PathBuf;

use crate::session::Copy;

/// Calibrates a spoilt session and checks how it is refused.
fn refused(copy: &Copy, parts: &[&str]) {
    let run = copy.calibrate(&["--out", "."]);
    let message = String::from_utf8(run.stderr).unwrap();
    assert_eq!(run.status.code(), Some(2), "{message}{}", String::from_utf8_lossy(&run.stdout));
    assert_eq!(message.trim_end().lines().count(), 1, "one message: {message}");
    assert!(!message.contains("panicked"), "{message}");
    for part in parts {
        assert!(message.contains(part), "{part:?} is not in {message}");
    }
    assert!(run.stdout.is_empty());
    assert_eq!(copy.left_behind(), Vec::<String>::new());
}

/// The session with one replacement in its experiment file.
fn toml(from: &str, to: &str, parts: &[&str]) {
    let copy = Copy::new();
    copy.edit("experiment.toml", |text| text.replacen(from, to, 1));
    refused(&copy, &[&["experiment.toml"], parts].concat());
}

/// The session with one line of a record replaced.
fn line(number: usize, to: &str, parts: &[&str]) {
    let copy = Copy::new();
    copy.edit("records/m07.csv", |text| {
        let mut lines: Vec<&str> = text.lines().collect();
        lines[number - 1] = to;
        lines.join("\n")
    });
    refused(&copy, &[&["m07.csv"], parts].concat());
}

/// The first record of the example with other rows.
fn edited(row: impl Fn(&[f64]) -> String) -> Vec<String> {
    let text = fs::read_to_string(crate::session::example().join("records/m01.csv")).unwrap();
    let edited = |line: &str| match line.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>() {
        Ok(cells) => row(&cells),
        Err(_) => line.to_owned(),
    };
    text.lines().map(edited).collect()
}

/// A copy need not be one to the byte: without its end, by another clock, or rounded its means are the same but for a part of the noise.
#[test]
fn copies_of_a_record_are_found_by_their_means() {
    let row = |cells: &[f64], shift: f64| format!("{},{},{},{}", cells[0] + shift, cells[1], cells[2], cells[3]);
    let shortened = |lines: Vec<String>| lines[..lines.len() - 30].to_vec();
    let copies = [
        shortened(edited(|cells| row(cells, 0.0))),
        edited(|cells| row(cells, 5.0)),
        edited(|cells| format!("{},{:.3},{:.3},{:.3}", cells[0], cells[1], cells[2], cells[3])),
    ];
    for lines in copies {
        let copy = Copy::new();
        fs::write(copy.session().join("records/m13.csv"), lines.join("\n")).unwrap();
        copy.edit("experiment.toml", |text| {
            let mountings: Vec<&str> = text.split("[[mounting]]").collect();
            let again = mountings[1].replace("records/m01.csv", "records/m13.csv");
            format!("{text}\n[[mounting]]{again}")
        });
        refused(&copy, &["m13.csv", "found the readings of mounting 1, ", "two records have means so alike"]);
    }
}

/// A record that was copied for another mounting, or named twice: its noise would count for half.
#[test]
fn readings_belong_to_one_mounting() {
    for copied in ["records/m01.csv", "records/m13.csv"] {
        let copy = Copy::new();
        fs::copy(copy.session().join("records/m01.csv"), copy.session().join("records/m13.csv")).unwrap();
        copy.edit("experiment.toml", |text| {
            let mountings: Vec<&str> = text.split("[[mounting]]").collect();
            format!("{text}\n[[mounting]]{}", mountings[1].replace("records/m01.csv", copied))
        });
        refused(&copy, &[copied, "found the readings of mounting 1, ", "expected readings of its own for mounting 13"]);
    }
}

#[test]
fn files() {
    let copy = Copy::new();
    fs::remove_file(copy.session().join("records/m03.csv")).unwrap();
    refused(&copy, &["m03.csv", "no such file", "expected"]);

    let copy = Copy::new();
    fs::write(copy.session().join("records/m03.csv"), "").unwrap();
    refused(&copy, &["m03.csv", "empty", "expected"]);

    let copy = Copy::new();
    fs::write(copy.session().join("records/m03.csv"), "t,f1,f2,f3\n").unwrap();
    refused(&copy, &["m03.csv", "without rows", "expected"]);

    let copy = Copy::new();
    fs::write(copy.session().join("experiment.toml"), b"[session]\ntitle = \"\xff\xfe\"\n").unwrap();
    refused(&copy, &["experiment.toml", "line 2", "0xff", "UTF-8"]);

    let copy = Copy::new();
    fs::write(copy.session().join("records/m03.csv"), b"t,f1,f2,f3\n0,1,\xff,3\n").unwrap();
    refused(&copy, &["m03.csv", "line 2", "f2", "\u{fffd}", "expected a number"]);

    let copy = Copy::new();
    fs::write(copy.session().join("records/m03.csv"), b"PAR1\x15\x04\x15\x00PAR").unwrap();
    refused(&copy, &["m03.csv", "expected"]);
}

#[test]
fn records() {
    line(1, "t,f1,f2,g3", &["f3", "expected"]);
    line(500, "4.9800,-0.1,NaN(ind),9.8", &["line 500", "f2", "NaN(ind)", "a number in m/s^2"]);
    line(500, "4.9800,-0.1,inf,9.8", &["line 500", "f2", "inf", "expected"]);
    line(500, "4.9800,-0.1,twelve,9.8", &["line 500", "f2", "twelve", "expected"]);
    line(500, "4.9800,-0.1", &["line 500", "expected"]);
    line(500, "0.0100,-0.1,0.1,9.8", &["line 500", "0.01", "expected"]);
}

/// A record with fewer plateaus than the schedule says which one is missing, what was looked for and what was seen.
#[test]
fn fewer_plateaus_than_scheduled() {
    let copy = Copy::new();
    copy.edit("records/m07.csv", |text| text.lines().take(8_000).collect::<Vec<_>>().join("\n"));
    refused(&copy, &["m07.csv", "mounting 7", "plateau 7 of 9", "looked for", "seen"]);
}

/// Records of two mountings exchanged, an attitude and a place that the unit did not have: the message says what the record fits.
#[test]
fn what_a_record_fits_instead_is_said() {
    let copy = Copy::new();
    copy.edit("experiment.toml", |text| {
        text.replace("records/m03.csv", "x").replace("records/m04.csv", "records/m03.csv").replacen(
            "\"x\"",
            "\"records/m04.csv\"",
            1,
        )
    });
    refused(
        &copy,
        &["m04.csv, mounting 3: the record shows all plateaus of mounting 4 (position \"2\", arm (0.25, 0, 0) m)"],
    );
    let copy = Copy::new();
    copy.edit("experiment.toml", |text| text.replace("axes = \"+3 +1 +2\"", "axes = \"+3 +2 -1\""));
    refused(&copy, &["mounting 5: the record shows all plateaus if axes = \"+3 +1 +2\"", "plateau 3 of 9 not found"]);
}

#[test]
fn experiment() {
    toml("gravity = \"9.81523 m/s^2\"", "gravity = 0", &["[site]", "gravity", "found", "expected"]);
    toml("gravity = \"9.81523 m/s^2\"", "gravity = \"9.81523 furlong\"", &["gravity", "furlong", "expected"]);
    toml("speed_uncertainty = 1e-05", "speed_uncertainty = -1e-05", &["speed_uncertainty", "-1e-5", "expected"]);
    toml("speed_uncertainty", "speed_uncertianty", &["speed_uncertianty", "expected"]);
    toml("axes = \"+1 +2 +3\"", "axes = \"+1 +1 +3\"", &["axes", "+1 +1 +3", "expected"]);
    toml("axes = \"+1 +2 +3\"", "axes = \"-1 +2 +3\"", &["axes", "-1 +2 +3", "expected", "right-handed"]);
    toml("axes = \"+1 +2 +3\"", "matrix = [[0, 1, 0], [1, 0, 0], [0, 0, 1]]", &["matrix", "right-handed"]);
    toml("id = \"2\"", "id = \"1\"", &["id", "\"1\"", "expected"]);
    toml("arm = [0.5, 0.0, 0.0]", "arm = [-0.5, 0.0, 0.0]", &["arm", "-0.5", "expected"]);
    toml("arm = [0.5, 0.0, 0.0]", "arm = [\"half\", 0.0, 0.0]", &["half", "expected"]);
    toml("arm = [0.5, 0.0, 0.0]", "arm = [nan, 0.0, 0.0]", &["arm", "NaN", "expected"]);
    toml("position = \"1\"", "position = \"9\"", &["position", "\"9\"", "expected"]);
}

#[test]
fn lines_that_end_with_cr_alone() {
    let copy = Copy::new();
    copy.edit("records/m07.csv", |text| text.replace('\n', "\r"));
    refused(&copy, &["m07.csv, line 1", "found lines that end with CR alone"]);
}

#[test]
fn an_uncertainty_of_gravity_beyond_the_earth() {
    let uncertain = "[uncertainty]\ngravity = \"10 m/s^2\"\n[model]";
    toml("[model]", uncertain, &["[uncertainty]", "gravity: found \"10 m/s^2\", expected a standard uncertainty"]);
}

#[test]
fn positions_and_schedules() {
    let copy = Copy::new();
    copy.edit("experiment.toml", |text| {
        text.replace("[[mounting]]\nposition = \"4\"", "[[mounting]]\nposition = \"3\"")
    });
    refused(&copy, &["experiment.toml", "\"4\"", "mounting"]);

    let copy = Copy::new();
    copy.edit("experiment.toml", |text| {
        text.lines().filter(|line| !line.contains("rpm\" },") || line.contains("angle")).collect::<Vec<_>>().join("\n")
    });
    refused(&copy, &["experiment.toml", "at rest", "expected"]);
}

/// A mean that no unit explains is named, and not what it does to the fit.
#[test]
fn a_mean_beyond_all_measure() {
    let copy = Copy::new();
    assert_eq!(copy.run(&["reduce", "../session", "--out", "reduced"]).status.code(), Some(0));
    let file = copy.out().join("reduced/plateaus.csv");
    let table = fs::read_to_string(&file).unwrap();
    let mut rows: Vec<Vec<&str>> = table.lines().map(|row| row.split(',').collect()).collect();
    rows[11][3] = "99999";
    let rows: Vec<String> = rows.iter().map(|row| row.join(",")).collect();
    fs::write(&file, rows.join("\n")).unwrap();
    let output = copy.run(&["calibrate", "reduced", "--out", "out"]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("plateaus.csv: found 99999 m/s^2 as mean_1 of plateau 2:2, where "), "{message}");
}

/// Speeds of a table in another unit: the means say which.
#[test]
fn speeds_of_a_table_in_another_unit() {
    let copy = Copy::new();
    assert_eq!(copy.run(&["reduce", "../session", "--out", "reduced"]).status.code(), Some(0));
    let file = copy.out().join("reduced/plateaus.csv");
    let table = fs::read_to_string(&file).unwrap();
    for (unit, factor) in [("rpm", 60.0 / TAU), ("rev/s", 1.0 / TAU), ("deg/s", 360.0 / TAU)] {
        let row = |line: &str| {
            let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
            cells[1] = cells[1].parse::<f64>().map_or(cells[1].clone(), |speed| (factor * speed).to_string());
            cells.join(",") + "\n"
        };
        fs::write(&file, table.lines().map(row).collect::<String>()).unwrap();
        let run = copy.run(&["calibrate", "reduced", "--out", "out"]);
        let message = String::from_utf8(run.stderr).unwrap();
        assert_eq!(run.status.code(), Some(2), "{unit}: {message}");
        assert!(
            message.contains("plateaus.csv: found a speed of ") && message.contains("expected speeds in rad/s"),
            "{message}"
        );
        assert!(message.contains(&format!(" fits a speed in {unit}, ")), "{unit}: {message}");
    }
}

/// Numbers of options that stand for nothing.
#[test]
fn numbers_of_options() {
    let copy = Copy::new();
    let refused = |arguments: &[&str], option: &str| {
        let output = copy.run(arguments);
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(2) && message.contains(option), "{arguments:?}: {message}");
    };
    for number in ["nan", "inf", "-1", "0"] {
        refused(&["assess", "../session", "--range", number], "--range");
        refused(&["compare", "a.json", "b.json", "--years", number], "--years");
        refused(&["montecarlo", "../session", "--noise", number], "--noise");
    }
    for runs in ["0", "10000001", "1e3"] {
        refused(&["montecarlo", "../session", "--runs", runs], "--runs");
    }
    let twice = ["watch", "../session", "--once", "--out", "w", "--target", "bias=1", "--target", "bias=2"];
    refused(&twice, "found two targets for \"bias\", expected one for each group");
    refused(&["noise", "../session/records/m01.csv", "--rate", "1e-300"], "--rate");
    // A second's samples are few, and no reason to stop.
    let slow = copy.run(&["noise", "../session/records/m01.csv", "--rate", "1"]);
    assert!(slow.status.code().is_some_and(|code| code < 2), "{}", String::from_utf8_lossy(&slow.stderr));
}

#[test]
fn usage() {
    let copy = Copy::new();
    assert_eq!(copy.run(&["calibrate"]).status.code(), Some(2));
    assert_eq!(copy.run(&["calibrate", "nowhere"]).status.code(), Some(2));
    assert_eq!(copy.run(&["calibrade"]).status.code(), Some(2));
    assert_eq!(copy.run(&["--help"]).status.code(), Some(0));
    let message = |arguments: &[&str]| String::from_utf8(copy.run(arguments).stderr).unwrap();
    let hostile = message(&["a\u{202e}b\u{2066}c\u{200b}d\u{9b}e"]);
    assert!(hostile.contains("'a\u{fffd}b\u{fffd}c\u{fffd}d\u{fffd}e'"), "{hostile:?}");
    let long = message(&["calibrate", "nowhere", "--hold-out", &"Z".repeat(4000)]);
    assert!(long.len() < 1200 && long.contains("expected MOUNTING:PLATEAU such as 4:3"), "{long}");
}

/// The example as a table of means, whose readings are then changed.
struct Means {
    file: PathBuf,
    table: String,
}

impl Means {
    fn of(copy: &Copy) -> Self {
        let session = copy.session();
        assert!(copy.run(&["reduce", session.to_str().unwrap(), "--out", "reduced"]).status.success());
        let file = copy.out().join("reduced/plateaus.csv");
        Self { table: fs::read_to_string(&file).unwrap(), file }
    }

    /// Writes the means with those of newtonometer `axis` times `factor`, of one mounting or of all.
    fn write_scaled(&self, axis: usize, mounting: Option<usize>, factor: f64) {
        let (header, rows) = self.table.split_once('\n').unwrap();
        let mean = header.split(',').position(|name| name == format!("mean_{axis}")).expect("a column of means");
        let scaled = |row: &str| {
            let mut cells: Vec<String> = row.split(',').map(str::to_owned).collect();
            if mounting.is_none_or(|mounting| cells[0] == mounting.to_string()) {
                cells[mean] = (cells[mean].parse::<f64>().unwrap() * factor).to_string();
            }
            cells.join(",") + "\n"
        };
        fs::write(&self.file, format!("{header}\n{}", rows.lines().map(scaled).collect::<String>())).unwrap();
    }
}

/// Means of plateaus in another unit, or with the sign of an axis reversed, have no samples to ask: their scale says so.
#[test]
fn means_in_another_unit_or_sign_are_refused() {
    for (factor, name, as_if) in [
        (1.0 / 9.80665, "in g", "), as if in g, expected 0.7 to 1.3"),
        (-1.0, "reversed", "), as if its sign were reversed, expected"),
        (0.5, "halved", "), expected"),
    ] {
        let copy = Copy::new();
        Means::of(&copy).write_scaled(2, None, factor);
        let run = copy.run(&["calibrate", "reduced", "--out", "out"]);
        let message = String::from_utf8(run.stderr).unwrap();
        assert_eq!(run.status.code(), Some(2), "{name}: {message}");
        assert!(message.contains("times the specific force (G0_22 = ") && message.contains(as_if), "{name}: {message}");
        assert!(!copy.out().join("out/result.json").exists());
    }
}

/// A window that ends before it begins, one of a session, and a report without a document.
#[test]
fn what_cannot_be_done_is_refused() {
    let copy = Copy::new();
    assert!(copy.calibrate(&["-q"]).status.success());
    let session = copy.session();
    let (session, record) = (session.to_str().unwrap(), session.join("records/m01.csv"));
    for (arguments, part) in [
        (&["noise", record.to_str().unwrap(), "--from", "5", "--to", "4"][..], "expected a beginning before the end"),
        (&["noise", session, "--plateau", "1:1", "--from", "5"], "expected one plateau of the session"),
        (&["report", "result.json"], "expected --html, --pdf, --dcc or --code"),
        (&["report", "result.json", "--html", "one", "--code", "one"], "expected two names"),
    ] {
        let run = copy.run(arguments);
        let message = String::from_utf8(run.stderr).unwrap();
        assert!(run.status.code() == Some(2) && message.contains(part), "{arguments:?}: {message}");
    }
}

/// One channel of one record in another unit: the fit shares the fault out among all scales, so that the mounting is asked. Whatever is refused by a
/// scale names the mounting and the newtonometer.
#[test]
fn one_channel_of_one_mounting_in_another_unit_is_named() {
    let copy = Copy::new();
    let means = Means::of(&copy);
    let mut named = 0;
    for (mounting, axis) in (1..=12).flat_map(|mounting| [1, 2, 3].map(|axis| (mounting, axis))) {
        means.write_scaled(axis, Some(mounting), 1.0 / 9.80665);
        let run = copy.run(&["calibrate", "reduced", "--out", "out", "--quiet"]);
        let message = String::from_utf8(run.stderr).unwrap();
        assert_ne!(run.status.code(), Some(0), "{mounting} {axis}");
        if message.contains("times the") {
            let expected = format!("found readings of newtonometer {axis} in mounting {mounting} of 0.1");
            assert!(message.contains(&expected) && message.contains("as if in g"), "{message}");
            named += 1;
        }
    }
    assert!(named > 5, "{named}");
}

/// Nanoseconds in a column of seconds make a record of centuries, whose slopes nobody can compute.
#[test]
fn a_time_in_another_unit_is_refused() {
    for file in ["records/m07.csv", "telemetry/m07.csv"] {
        let copy = Copy::new();
        copy.edit(file, |text| {
            let row = |line: &str| match line.split_once(',') {
                Some((t, readings)) => {
                    t.parse().map_or_else(|_| line.to_owned(), |t: f64| format!("{},{readings}", 1e9 * t))
                }
                None => line.to_owned(),
            };
            text.lines().map(row).collect::<Vec<_>>().join("\n")
        });
        refused(&copy, &[&format!("{file}: found readings over "), " years, expected time in s"]);
    }
    toml("angle = \"180 deg\"", "angle = 180", &["found 180.0", "a number alone is in rad"]);
}
