//! What is said of files as recorders write them, where they and the session disagree.

use centrical_session::Session;
use centrical_table::Extent;

use crate::sample::{EXPERIMENT, Sample};

/// What becomes of the record of the first mounting, with further lines under `[columns]`.
fn outcome(columns: &str, record: impl AsRef<[u8]>) -> String {
    let sample = Sample::new(EXPERIMENT.replace("[columns]\n", &format!("[columns]\n{columns}\n")));
    sample.file("records/m01.csv", record);
    match Session::read(&sample.path()).and_then(|session| session.record(0)) {
        Ok(record) => format!("{} samples from {}", record.t.len(), record.t[0]),
        Err(error) => sample.relative(&error.to_string()),
    }
}

#[test]
fn units_that_contradict_the_session() {
    let cases = [
        ("", "t;f1;f2;f3\ns;m/s^2;m/s2;м/с²\n0;1;2;3\n1;1;2;3\n", "2 samples from 0"),
        ("", "t;f1;f2;f3\n;[m/s^2];-;\n0;1;2;3\n1;1;2;3\n", "2 samples from 0"),
        (
            "",
            "t;f1;f2;f3\ns;g;g;g\n0;1;2;3\n",
            "records/m01.csv, line 2, f1: found the unit g, expected m/s^2, as the session says (output_unit in [unit], or a \
             unit in [columns])",
        ),
        (
            "",
            "t [ms],f1,f2,f3\n0,1,2,3\n",
            "records/m01.csv, line 1, t: found the unit ms, expected s, as the session says ([columns]: time = { column = \
             ..., unit = \"ms\" })",
        ),
        ("time = { column = \"t\", unit = \"ms\" }", "t [ms],f1,f2,f3\n500,1,2,3\n", "1 samples from 0.5"),
        (
            "time = { column = \"t\", rate = \"1 kHz\" }",
            "t,f1,f2,f3\ns,,,g\n500,1,2,3\n",
            "records/m01.csv, line 2, t: found the unit s, expected samples, as the session says ([columns]: time = { column \
             = ..., unit = \"s\" })",
        ),
    ];
    for (columns, record, expected) in cases {
        assert_eq!(outcome(columns, record), expected, "{record}");
    }
}

#[test]
fn lines_that_the_session_names() {
    let record = "t;f1;f2;f3\n7;7;7;7\nt;f1;f2;f3\nany words;of;the;recorder\n0;1;2;3\n1;1;2;3\n";
    let cases = [
        ("header_line = 3\nfirst_row = 5", "2 samples from 0"),
        ("header_line = 3", "records/m01.csv, line 4, t: found \"any words\", expected a number in s"),
        (
            "header_line = 2",
            "records/m01.csv, line 2: found \"7;7;7;7\", expected the names of the columns (for a file without them give \
             [columns] by number)",
        ),
        (
            "header_line = 30",
            "records/m01.csv, line 1: found no line 30 with text in it among the first 1000, expected the line that \
             header_line or first_row of [columns] names",
        ),
        (
            "header_line = 0",
            "experiment.toml, [columns], header_line: found 0, expected a line of the file, counted from 1",
        ),
        (
            "header_line = 3\nfirst_row = 2",
            "experiment.toml, [columns], first_row: found 2, expected a line below header_line = 3",
        ),
        ("time = 1\nf = [2, 3, 4]\nfirst_row = 5", "2 samples from 0"),
        (
            "time = 1\nf = [2, 3, 4]\nfirst_row = 2",
            "records/m01.csv, line 3, column 1: found \"t\", expected a number in s",
        ),
    ];
    for (columns, expected) in cases {
        assert_eq!(outcome(columns, record), expected, "{columns}");
    }
}

#[test]
fn lines_above_a_table_without_names() {
    let by_number = "time = 1\nf = [2, 3, 4]";
    let cases = [
        ("Date;05.10.2026\nn;a;b;c\ns;g;g;g\n0;1;2;3\n1;1;2;3\n", "2 samples from 0"),
        ("05.10.2026 09:10:00,0100;1,5;2;3\n", "1 samples from 1791191400.01"),
        // What could be a row is not skipped.
        ("0;1;-;3\n1;1;2;3\n", "records/m01.csv, line 1, column 3: found \"-\", expected a number in m/s^2"),
        ("-;1;2;3\n1;1;2;3\n", "records/m01.csv, line 1, column 1: found \"-\", expected a number in s"),
    ];
    for (record, expected) in cases {
        assert_eq!(outcome(by_number, record), expected, "{record}");
    }
}

#[test]
fn units_of_telemetry_and_plateaus() {
    let sample = Sample::new(EXPERIMENT);
    let mut session = Session::read(&sample.path()).unwrap();
    session.mountings[0].telemetry = Some(sample.file("telemetry.csv", "t;omega\nс;рад/с\n0;1\n"));
    assert_eq!(
        sample.relative(&session.telemetry(0, Extent::Whole).unwrap_err().to_string()),
        "telemetry.csv, line 2, omega: found the unit rad/s, expected rpm, as the session says (speed_unit in [columns])"
    );
    let plateaus = "mounting,speed,angle,mean_1,mean_2,mean_3,cov_11,cov_12,cov_13,cov_22,cov_23,cov_33,samples\n\
                    ,rad/s,rad,g,g,g,,,,,,,\n1,0,0,0,0,9.8,1e-8,0,0,1e-8,0,1e-8,100\n";
    let sample = Sample::new(format!("plateaus = \"plateaus.csv\"\n{EXPERIMENT}"));
    sample.file("plateaus.csv", plateaus);
    assert_eq!(
        sample.relative(&Session::read(&sample.path()).unwrap_err().to_string()),
        "plateaus.csv, line 2, mean_1: found the unit g, expected m/s^2, as the session says (output_unit in [unit], or a unit \
         in [columns])"
    );
}

#[test]
fn volts_have_a_scale_and_a_bias() {
    let with = |lines: &str| EXPERIMENT.replace("output_unit = \"m/s^2\"", lines);
    let outcome = |lines: &str, record: &str| {
        let sample = Sample::new(with(lines));
        sample.file("records/m01.csv", record);
        match Session::read(&sample.path()).and_then(|session| session.record(0)) {
            Ok(record) => format!("{:?}", record.f_z.map(|f| f[0])),
            Err(error) => sample.relative(&error.to_string()),
        }
    };
    let volts = "output_unit = \"V\"\nvolts = { scale = [0.5, 0.25, -0.5], bias = [2.5, 0, 1] }";
    let cases = [
        (volts, "t;f1;f2;f3\ns;V;[Volts];В\n0;3;1;0\n", "[1.0, 4.0, 2.0]"),
        (
            volts,
            "t;f1;f2;f3\ns;V;V;mV\n0;3;1;0\n",
            "records/m01.csv, line 2, f3: found the unit mV, expected V, as the session says (output_unit in [unit], or a unit \
             in [columns])",
        ),
        (
            "output_unit = \"V\"",
            "",
            "experiment.toml, [unit], volts: found no such key, expected volts = { scale = [...], bias = [...] }: volts per \
             m/s^2 and volts at none",
        ),
        (
            "output_unit = \"g\"\nvolts = { scale = [1, 1, 1], bias = [0, 0, 0] }",
            "",
            "experiment.toml, [unit], volts: found volts and output_unit = \"g\", expected no volts, or output_unit = \"V\"",
        ),
        (
            "output_unit = \"V\"\nvolts = { scale = [1, 0, 1], bias = [0, 0, 0] }",
            "",
            "experiment.toml, [unit.volts], scale: found 0.0, expected volts per m/s^2, not zero",
        ),
    ];
    for (lines, record, expected) in cases {
        assert_eq!(outcome(lines, record), expected, "{lines}");
    }
}

#[test]
fn records_in_several_files() {
    let entry = |entry: &str| {
        let sample = Sample::new(EXPERIMENT.replace("record = \"records/m01.csv\"", &format!("record = {entry}")));
        Session::read(&sample.path()).map_or_else(|error| sample.relative(&error.to_string()), |_| "read".to_owned())
    };
    assert_eq!(entry("[\"x.csv\", \"y.csv\", \"z.csv\"]"), "read");
    assert_eq!(
        entry("[\"x.csv\", \"y.csv\"]"),
        "experiment.toml, line 37, column 10: found a length of 2, expected the path of a record, or three paths, one for each \
         newtonometer"
    );
    assert_eq!(
        entry("3"),
        "experiment.toml, line 37, column 10: found integer `3`, expected the path of a record, or three paths, one for each \
         newtonometer"
    );
}
