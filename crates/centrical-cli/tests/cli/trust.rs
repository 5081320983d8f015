//! The commands that say how far a calibration can be trusted, on the example.

use std::process::{Command, Output};

use crate::session::example;

fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_centrical")).args(arguments).output().unwrap()
}

fn text(run: &Output) -> String {
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    String::from_utf8(run.stdout.clone()).unwrap()
}

#[test]
fn assess_tells_budget_validity_and_prediction() {
    let folder = example();
    let told = text(&run(&["assess", folder.to_str().unwrap(), "--without-outliers"]));
    for part in ["OUTLIERS", "UNCERTAINTY BUDGET", "noise", "speed of each plateau", "VALIDITY", "PREDICTION", "G2_33"]
    {
        assert!(told.contains(part), "{part} is not in\n{told}");
    }
}

/// The same seed gives the same bytes on one thread and on three.
#[test]
fn montecarlo_repeats_itself() {
    let folder = example();
    let with = |threads: &str| {
        let arguments = ["montecarlo", folder.to_str().unwrap(), "--runs", "40", "--seed", "7"];
        Command::new(env!("CARGO_BIN_EXE_centrical"))
            .args(arguments)
            .env("RAYON_NUM_THREADS", threads)
            .output()
            .unwrap()
    };
    let one = text(&with("1"));
    assert!(one.contains("MONTE CARLO  40 calibrations, 0 did not converge"), "{one}");
    assert_eq!(one, text(&with("3")));
}

#[test]
fn models_recommends_what_the_example_was_made_with() {
    let told = text(&run(&["models", example().to_str().unwrap()]));
    assert!(told.contains("recommended: \"as stated\""), "{told}");
}
