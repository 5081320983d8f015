//! `centrical noise` on records of known noise and on the example session.

use std::fmt::Write;
use std::fs;
use std::process::Output;

use crate::random::Random;
use crate::session::Copy;

fn text(output: &Output) -> String {
    [&output.stdout, &output.stderr].map(|part| String::from_utf8_lossy(part).into_owned()).concat()
}

/// A record of 20,000 samples at 100 Hz: white noise of 1e-3 m/s^2 on f1, the same with a sine on f2.
fn record(copy: &Copy) -> String {
    let (mut one, mut two) = (Random::new(1), Random::new(2));
    let mut rows = "t,f1,f2\n".to_owned();
    for k in 0..20_000 {
        let t = f64::from(k) / 100.0;
        let (f1, f2) = (9.8 + 1e-3 * one.normal(), 1e-3 * two.normal() + 3e-3 * (t * 20.0).sin());
        let spike = if k % 4000 == 1234 { 5.0 } else { 0.0 };
        writeln!(rows, "{t},{},{f2}", f1 + spike).unwrap();
    }
    let file = copy.out().join("record.csv");
    fs::write(&file, rows).unwrap();
    file.to_str().unwrap().to_owned()
}

#[test]
fn white_noise_is_quoted_and_a_line_is_not() {
    let copy = Copy::new();
    let record = record(&copy);
    let output = copy.run(&["noise", &record, "--readings", "f1,f2", "--out", "noise"]);
    let said = text(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(
        said.contains("f1  19995 readings every 0.010000 s; missing: 5, the longest run 1; left out as spikes: 5"),
        "{said}"
    );
    // 1e-3 m/s^2 at 100 Hz: 1e-4 m/s^2/sqrt(Hz), 10.197 ug/sqrt(Hz).
    let row = said.lines().find(|line| line.contains("N  white noise")).expect("the coefficient of f1");
    let value: f64 = row.split_whitespace().nth(3).unwrap().parse().unwrap();
    assert!((value / 10.197 - 1.0).abs() < 0.04, "{row}");
    assert_eq!(said.matches("N  white noise").count(), 1, "{said}");
    assert!(said.contains("NOT ACCEPTABLE  f2: no sum of quantisation"), "{said}");
    assert!(said.contains("line at 3.1"), "{said}");
    for plot in ["deviation-f1.svg", "deviation-f2.svg", "spectrum.svg"] {
        let svg = fs::read_to_string(copy.out().join("noise").join(plot)).unwrap();
        assert!(svg.starts_with("<svg") && svg.contains("</svg>"), "{plot}");
    }
    let drawn =
        |plot: &str, what: &str| fs::read_to_string(copy.out().join("noise").join(plot)).unwrap().contains(what);
    assert!(drawn("deviation-f1.svg", "N white noise") && !drawn("deviation-f2.svg", "white noise"));
}

#[test]
fn json_holds_every_estimator_and_null_for_what_is_not_quoted() {
    let copy = Copy::new();
    let record = record(&copy);
    let arguments = ["noise", &record, "--readings", "2,f2", "--to", "20 s", "--estimators", "all", "--json"];
    let output = copy.run(&arguments);
    let json: serde_json::Value =
        serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{}", text(&output)));
    assert_eq!(json["schema"], "centrical-noise/1");
    assert_eq!(json["readings"][0]["deviations"].as_array().unwrap().len(), 10);
    let [one, two] = [0, 1].map(|k| &json["readings"][k]["terms"]);
    assert!(one["coefficients"].is_array() && two["coefficients"].is_null());
    assert_eq!(two["is_consistent"], false);
    let first = &json["readings"][0]["deviations"][1]["deviations"][0];
    let [value, lower, upper] = ["value", "lower", "upper"].map(|key| first[key].as_f64().unwrap());
    assert!(lower < value && value < upper && (value / 1e-3 - 1.0).abs() < 0.1);
    assert_eq!(copy.run(&arguments).stdout, output.stdout, "the same bytes");
}

#[test]
fn a_plateau_of_a_session_is_analysed() {
    let copy = Copy::new();
    let session = copy.session();
    let output = copy.run(&["noise", session.to_str().unwrap(), "--plateau", "2:1"]);
    let said = text(&output);
    assert!(said.starts_with("Plateau 2:1 of m02.csv"), "{said}");
    assert!(said.contains("overlapping-allan, ug"), "{said}");
}

#[test]
fn what_is_no_record_is_refused() {
    let copy = Copy::new();
    let record = record(&copy);
    let refused = |arguments: &[&str], said: &str| {
        let output = copy.run(arguments);
        assert_eq!(output.status.code(), Some(2), "{}", text(&output));
        assert!(text(&output).contains(said), "{}", text(&output));
    };
    refused(&["noise", &record], "f3");
    refused(
        &["noise", &record, "--readings", "f1", "--from", "1e6"],
        "expected a stretch of the record, which runs from 0 s to 199.99 s",
    );
    refused(
        &["noise", &record, "--readings", "f1", "--estimators", "best"],
        "expected \"all\" or some of allan, overlapping-allan",
    );
    refused(&["noise", "nothing.csv"], "no such file");
    fs::write(
        copy.out().join("still.csv"),
        (0..600).fold("t,f1\n".to_owned(), |rows, k| rows + &k.to_string() + ",1\n"),
    )
    .unwrap();
    let output = copy.run(&["noise", "still.csv", "--readings", "f1"]);
    assert!(text(&output).contains("it holds no noise to analyse"), "{}", text(&output));
}

/// A whole record of a session is not noise: the message says so and what to do.
#[test]
fn a_record_with_ramps_is_named() {
    let copy = Copy::new();
    let record = copy.session().join("records/m01.csv");
    let output = copy.run(&["noise", record.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output).contains("f1: the record stands still 9 times, from"), "{}", text(&output));
    assert!(text(&output).contains("choose one stretch with --from and --to, or a plateau"), "{}", text(&output));
}

/// An error code once in a half second of the beginning, or in a twentieth of the readings: no stretches, and what it is.
#[test]
fn error_codes_are_no_staircase() {
    let copy = Copy::new();
    let said = |is_coded: &dyn Fn(usize) -> bool| {
        let mut random = Random::new(4);
        let reading = |k: usize, noise: f64| if is_coded(k) { 99.0 } else { 9.8 + 1e-3 * noise };
        let row = |k: usize| format!("{},{}\n", k as f64 / 100.0, reading(k, random.normal()));
        fs::write(copy.out().join("coded.csv"), "t,f1\n".to_owned() + &(0..20_000).map(row).collect::<String>())
            .unwrap();
        let output = copy.run(&["noise", "coded.csv", "--readings", "f1"]);
        (output.status.code(), text(&output))
    };
    let (code, few) = said(&|k| k < 1000 && k % 50 == 25);
    assert_eq!(code, Some(0), "{few}");
    assert!(few.contains("left out as spikes: 20"), "{few}");
    let (code, many) = said(&|k| k % 20 == 5);
    assert_eq!(code, Some(1), "{many}");
    assert!(
        many.contains("f1: no noise terms: found 1000 of 20000 readings at 99.0, far from all others: an error code"),
        "{many}"
    );
}

/// A jump of the bias has its time on the clock of the record, and its size.
#[test]
fn a_jump_of_the_bias_is_named() {
    let copy = Copy::new();
    let mut random = Random::new(5);
    let jump = |k: u32| if k < 12_000 { 0.0 } else { -2e-3 };
    let row = |k: u32| format!("{},{}\n", 50.0 + f64::from(k) / 100.0, 9.8 + jump(k) + 1e-3 * random.normal());
    fs::write(copy.out().join("jump.csv"), "t,f1\n".to_owned() + &(0..20_000).map(row).collect::<String>()).unwrap();
    let output = copy.run(&["noise", "jump.csv", "--readings", "f1"]);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output));
    let named = "f1: no noise terms: found a jump by -2.16e-3 at 169.98 s";
    assert!(text(&output).contains(named), "{}", text(&output));
}
