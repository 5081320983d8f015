//! Files that nothing restores: an output over a file of a session with records is refused, and a file that changes while it is read.

use std::fs;
use std::path::PathBuf;

use crate::session::Copy;

fn examples() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../examples")
}

#[test]
fn outputs_over_the_files_of_a_session_are_refused() {
    let copy = Copy::new();
    assert!(copy.calibrate(&["--out", ".", "-q"]).status.success());
    let plan = examples().join("plans/best.toml");
    let [experiment, record] =
        ["experiment.toml", "records/m03.csv"].map(|name| copy.session().join(name).display().to_string());
    let input = copy.session().join("records/m01.csv").display().to_string();
    let commands: [&[&str]; 6] = [
        &["plan", plan.to_str().unwrap(), "--out", &experiment],
        &["schema", "experiment", "--out", &experiment],
        &["compensate", "result.json", &input, "--out", &record],
        &["report", "result.json", "--html", &record],
        &["compare", "result.json", "result.json", "--svg", &experiment],
        &["compensate", "result.json", &input, "--out", &input],
    ];
    let files =
        [experiment.as_str(), record.as_str(), input.as_str()].map(|file| (file.to_owned(), fs::read(file).unwrap()));
    for command in commands {
        let run = copy.run(command);
        let message = String::from_utf8_lossy(&run.stderr).into_owned();
        assert_eq!(run.status.code(), Some(2), "{command:?}: {message}");
        assert!(message.contains("expected another file for the output"), "{message}");
        assert!(files.iter().all(|(file, bytes)| fs::read(file).unwrap() == *bytes), "{command:?}");
    }
    // A planned session without records is written again.
    for _ in 0..2 {
        let run = copy.run(&["plan", plan.to_str().unwrap(), "--out", "planned.toml", "-q"]);
        assert!(run.status.code() != Some(2), "{run:?}");
    }
}

/// A store in the folder of a session would have its rows among the records.
#[test]
fn a_store_has_a_folder_of_its_own() {
    let copy = Copy::new();
    assert!(copy.calibrate(&["--out", ".", "-q"]).status.success());
    let session = copy.session().display().to_string();
    let run = copy.run(&["history", "add", &session, "result.json"]);
    let message = String::from_utf8_lossy(&run.stderr).into_owned();
    assert_eq!(run.status.code(), Some(2), "{message}");
    assert!(message.contains("found the folder of a session, expected a folder of its own for the store"), "{message}");
    assert!(!copy.session().join("rows").exists());
}

/// The certificate of an earlier result beside a new one is remarked.
#[test]
fn an_old_certificate_is_remarked() {
    let copy = Copy::new();
    let laboratory = examples().join("ta-200/laboratory.toml");
    let first = copy.calibrate(&["--out", ".", "--laboratory", laboratory.to_str().unwrap(), "-q"]);
    assert!(first.status.success() && !String::from_utf8_lossy(&first.stderr).contains("OLD CERTIFICATE"), "{first:?}");
    let second = copy.calibrate(&["--out", ".", "-q"]);
    let message = String::from_utf8_lossy(&second.stderr).into_owned();
    assert!(second.status.success() && message.matches("OLD CERTIFICATE").count() == 2, "{message}");
}
