//! Every parser of the crate: what it begins with and how it is called.

use std::fs;
use std::path::{Path, PathBuf};

use centrical_session::{CalibrationResult, Folder, Laboratory, Session, Truth, WatchState, read_plan};

use crate::fuzz::{Parser, outcome};

/// All of them.
pub fn parsers() -> Vec<Parser> {
    let example = |name: &str| vec![examples().join("ta-200").join(name)];
    let plans = ["four-positions.toml", "normalised.toml"].map(|name| examples().join("plans").join(name));
    vec![
        Parser { name: "experiment", file: "experiment.toml", seeds: experiments(), read: session },
        Parser { name: "laboratory", file: "laboratory.toml", seeds: example("laboratory.toml"), read: laboratory },
        Parser { name: "plan", file: "plan.toml", seeds: plans.into(), read: plan },
        Parser { name: "truth", file: "truth.toml", seeds: seeds("truth.toml"), read: truth },
        Parser { name: "result", file: "result.json", seeds: seeds("result.json"), read: result },
        Parser { name: "plateaus", file: "plateaus.csv", seeds: seeds("plateaus.csv"), read: plateaus },
        Parser { name: "watch", file: "state.json", seeds: seeds("state.json"), read: watch },
    ]
}

fn manifest() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn examples() -> PathBuf {
    manifest().join("../../examples")
}

fn seeds(name: &str) -> Vec<PathBuf> {
    vec![manifest().join("tests/fuzz/seeds").join(name)]
}

fn experiments() -> Vec<PathBuf> {
    vec![manifest().join("tests/fuzz/seeds/experiment.toml"), examples().join("ta-200/experiment.toml")]
}

fn session(file: &Path) -> String {
    [outcome(Session::read(file)), outcome(read_plan(file))].join("; ")
}

fn plan(file: &Path) -> String {
    outcome(read_plan(file))
}

fn laboratory(file: &Path) -> String {
    outcome(Laboratory::read(file))
}

fn truth(file: &Path) -> String {
    outcome(Truth::read(file, &Session::read(&experiments()[1]).unwrap(), 1))
}

fn result(file: &Path) -> String {
    let result = CalibrationResult::read(file);
    if let Ok(result) = &result {
        let _ = result.error_terms();
    }
    outcome(result)
}

fn plateaus(file: &Path) -> String {
    let text = fs::read_to_string(&experiments()[1]).unwrap();
    outcome(Session::parse_file(
        &format!("plateaus = '{}'\n{text}", file.display()),
        &experiments()[1],
        Folder::default(),
    ))
}

fn watch(file: &Path) -> String {
    let session = Session::read(&experiments()[1]).unwrap();
    outcome(WatchState::resume(&session, session.model().unwrap().parameters().len(), file))
}
