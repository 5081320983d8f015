//! What is wrong with the files of a session, and with a table of plateaus.

use std::fs;

use centrical_session::Session;
use centrical_table::Extent;

use crate::sample::{EXPERIMENT, Sample};

#[test]
fn what_is_no_file() {
    let sample = Sample::new(EXPERIMENT);
    let mut session = Session::read(&sample.path()).unwrap();
    let missing = session.record(1).unwrap_err();
    assert_eq!(sample.relative(&missing.to_string()), "records/m02.csv: found no such file, expected a record");
    fs::create_dir_all(sample.path().join("records/m01.csv")).unwrap();
    let folder = session.record(0).unwrap_err();
    assert_eq!(sample.relative(&folder.to_string()), "records/m01.csv: found a folder, expected a record");
    session.mountings[0].telemetry = Some(sample.file("telemetry.csv", "t,rpm\n0,0\n"));
    let telemetry = session.telemetry(0, Extent::Whole).unwrap_err();
    assert_eq!(
        sample.relative(&telemetry.to_string()),
        "telemetry.csv, line 1, omega: found columns \"t, rpm\", expected a column of this name"
    );
    let without = Sample::new(EXPERIMENT.replace("record = \"records/m01.csv\"\n", ""));
    let none = Session::read(&without.path()).unwrap().record(0).unwrap_err();
    assert_eq!(
        without.relative(&none.to_string()),
        "experiment.toml, [[mounting]] 1, record: found no record, expected the path of one"
    );
}

#[test]
fn tables_of_plateaus() {
    const HEADER: &str =
        "mounting,speed,angle,mean_1,mean_2,mean_3,cov_11,cov_12,cov_13,cov_22,cov_23,cov_33,samples\n";
    let cases = [
        (
            "1,0,0,0,0,9.8,1e-8,0,0,1e-8,0,1e-8,100\n3,0,0,0,0,9.8,1e-8,0,0,1e-8,0,1e-8,100\n",
            ", row 2, mounting: found 3, expected the number of a mounting, 1 to 2",
        ),
        (
            "1.5,0,0,0,0,9.8,1e-8,0,0,1e-8,0,1e-8,100\n",
            ", row 1, mounting: found 1.5, expected the number of a mounting, 1 to 2",
        ),
        (
            "1,-2e5,,0,0,9.8,1e-8,0,0,1e-8,0,1e-8,100\n",
            ", row 1, speed: found -200000, expected a speed in rad/s from -1e6 to 1e6 rpm",
        ),
        (
            "1,0,,0,0,9.8,1e-8,0,0,1e-8,0,1e-8,100\n",
            ", row 1, angle: found an empty field, expected the carousel angle of a plateau at rest",
        ),
        ("1,2,0,0,0,9.8,1e-8,0,0,1e-8,0,1e-8,100\n", ", row 1, angle: found 0, expected no angle while spinning"),
        (
            "1,2,,0,0,9.8,1e-8,2e-8,0,1e-8,0,1e-8,100\n",
            ", row 1, cov_11: found 0.00000001, expected a positive definite covariance",
        ),
        ("1,2,,0,0,9.8,1e-8,0,0,1e-8,0,1e-8,0\n", ", row 1, samples: found 0, expected how many samples were averaged"),
        (
            "1,2,,0,0,9.8,1e-8,0,0,1e-8,0,1e-8,9\n1,2,,0,0,9.7,1e-8,0,0,1e-8,0,1e-8,9\n1,2,,0,0,9.8,1e-8,0,0,1e-8,0,1e-8,9\n",
            ", row 3, mean_1: found every number of row 1 again, expected readings of its own for each plateau",
        ),
        ("1,2,,0,,9.8,1e-8,0,0,1e-8,0,1e-8,0\n", ", line 2, mean_2: found \"\", expected a mean in m/s^2"),
    ];
    let sample = Sample::new(format!("plateaus = \"plateaus.csv\"\n{EXPERIMENT}"));
    for (rows, expected) in cases {
        sample.file("plateaus.csv", format!("{HEADER}{rows}"));
        let error = Session::read(&sample.path()).unwrap_err();
        assert_eq!(sample.relative(&error.to_string()), format!("plateaus.csv{expected}"));
    }
}
