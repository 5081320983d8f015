//! `centrical tumble` on records made here, of a unit with known errors, with what laboratories and sensors do to them.

use std::f64::consts::TAU;
use std::fs;

use serde_json::Value;

use crate::session::Copy;

const GRAVITY: f64 = 9.81523;
const RESTS: usize = 24;

/// A rest and the turn behind it [s].
const REST: u32 = 4;
const TURN: u32 = 1;

/// Scale errors and biases [m/s^2] of the unit.
const SCALE: [f64; 3] = [2e-3, -1e-3, 3e-3];
const BIAS: [f64; 3] = [0.05, 0.02, -0.03];

/// A sample as the unit reads it without noise.
struct Sample {
    /// Number of the sample, and time since its rest began [s].
    n: usize,
    since: f64,
    reading: [f64; 3],
    /// Change of the force from the rest before [m/s^2].
    change: [f64; 3],
}

/// Directions that cover the sphere, far from their neighbours in turn.
fn up(rest: usize) -> [f64; 3] {
    let rest = (7 * rest) % RESTS;
    let (height, angle) = (1.0 - (2.0 * rest as f64 + 1.0) / RESTS as f64, 2.399_963 * rest as f64);
    let around = (1.0 - height * height).sqrt();
    [around * angle.cos(), around * angle.sin(), height]
}

/// Normal deviates: sums of twelve uniform ones.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        let mut uniform = || {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }
}

/// Rows of a record at `rate` [Hz] with white noise [m/s^2]; `effect` is what a sample reads beside it.
fn rows(rate: u32, white: f64, seed: u64, effect: impl Fn(&Sample) -> [f64; 3]) -> Vec<String> {
    let ups: Vec<[f64; 3]> = (0..RESTS).map(up).collect();
    rows_of(&ups, rate, white, seed, effect)
}

/// The same of rests in these attitudes, directions of length 1.
fn rows_of(ups: &[[f64; 3]], rate: u32, white: f64, seed: u64, effect: impl Fn(&Sample) -> [f64; 3]) -> Vec<String> {
    let mut noise = Noise(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15));
    let each = (REST + TURN) as usize * rate as usize;
    let at = |n: usize| n as f64 / f64::from(rate);
    let sample = |n: usize| {
        let (rest, since) = (n / each, at(n % each));
        let turned = ((since - f64::from(REST)) / f64::from(TURN)).max(0.0);
        let (here, next, before) = (ups[rest], ups[(rest + 1) % ups.len()], ups[rest.saturating_sub(1)]);
        let way = [0, 1, 2].map(|axis| here[axis] + turned * (next[axis] - here[axis]));
        let size = way.iter().map(|part| part * part).sum::<f64>().sqrt();
        let reading = [0, 1, 2].map(|axis| (1.0 + SCALE[axis]) * GRAVITY * way[axis] / size + BIAS[axis]);
        Sample { n, since, reading, change: [0, 1, 2].map(|axis| GRAVITY * (here[axis] - before[axis])) }
    };
    let row = |n: usize| {
        let [x, y, z] = effect(&sample(n)).map(|reading| reading + white * noise.next());
        format!("{:.4},{x:.6},{y:.6},{z:.6}\n", at(n))
    };
    (0..ups.len() * each).map(row).collect()
}

fn write(copy: &Copy, name: &str, rows: &[String]) {
    fs::write(copy.out().join(name), format!("t,f1,f2,f3\n{}", rows.concat())).unwrap();
}

/// Exit code, what is said, and the result if there is one.
fn tumble(copy: &Copy, arguments: &[&str]) -> (i32, String, Option<Value>) {
    let output = copy.run(&[&["tumble"], arguments, &["--gravity", "9.81523", "--out", "out"]].concat());
    let said = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap()).concat();
    let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
    let result = fs::read(copy.out().join("out/result.json")).ok();
    (output.status.code().unwrap(), said, result.map(|bytes| serde_json::from_slice(&bytes).unwrap()))
}

/// Mean of the squared errors of biases and scales over their variances.
fn squared_error(result: &Value) -> f64 {
    let squares = (0..3).flat_map(|axis| {
        let of = |name: String, truth: f64| {
            let all = result["parameters"].as_array().unwrap();
            let parameter = all.iter().find(|parameter| parameter["name"] == name.as_str()).unwrap();
            let [value, u] = ["value", "standard_uncertainty"].map(|key| parameter[key].as_f64().unwrap());
            ((value - truth) / u).powi(2)
        };
        [of(format!("df_{}", axis + 1), BIAS[axis]), of(format!("G0_{0}{0}", axis + 1), SCALE[axis])]
    });
    squares.sum::<f64>() / 6.0
}

#[test]
fn creep_after_a_turn_is_objected_to() {
    let copy = Copy::new();
    let creep = |part: f64| {
        move |s: &Sample| [0, 1, 2].map(|axis| s.reading[axis] - part * s.change[axis] * (-s.since / 3.0).exp())
    };
    write(&copy, "a.csv", &rows(100, 2e-3, 1, creep(2e-4)));
    let (code, said, result) = tumble(&copy, &["a.csv"]);
    assert_eq!(code, 1, "{said}");
    assert!(said.contains("readings creep after each turn, and rests are too short for that"), "{said}");
    assert!(said.contains("creep after each turn: "), "{said}");
    assert!(result.unwrap()["drift"]["creep"]["rate"].as_f64().unwrap() > 0.0);
    for seed in 2..6 {
        write(&copy, "a.csv", &rows(100, 2e-3, seed, creep(0.0)));
        let (code, said, result) = tumble(&copy, &["a.csv"]);
        assert_eq!(code, 0, "{said}");
        assert!(!said.contains("creep after each turn"), "{said}");
        let error = squared_error(&result.unwrap());
        assert!(error < 4.0, "{error}");
    }
}

#[test]
fn hysteresis_is_named() {
    let copy = Copy::new();
    let loops = |s: &Sample| [0, 1, 2].map(|axis| s.reading[axis] + 5e-4 * s.change[axis].signum());
    write(&copy, "a.csv", &rows(100, 1e-3, 1, loops));
    let (code, said, _) = tumble(&copy, &["a.csv"]);
    assert_eq!(code, 1, "{said}");
    assert!(said.contains("hysteresis: a bias by the sense of the last change of the force"), "{said}");
}

/// A line at half the sampling rate has two levels, at a third two of three are one: none of them is the mean.
#[test]
fn a_line_at_half_or_a_third_of_the_sampling_rate() {
    let copy = Copy::new();
    for part in [2, 3] {
        let line = |s: &Sample| s.reading.map(|reading| reading + 0.1 * (TAU * s.n as f64 / f64::from(part)).cos());
        write(&copy, "a.csv", &rows(100, 2e-3, 1, line));
        let (code, said, result) = tumble(&copy, &["a.csv"]);
        assert_eq!(code, 0, "{said}");
        assert!(!said.contains("samples not used"), "{said}");
        let error = squared_error(&result.unwrap());
        assert!(error < 4.0, "a {part}th of the rate: {error}");
    }
}

/// A sensor of 100 Hz logged at 1 kHz gives each reading ten times; the end of a rest may cut such a run.
#[test]
fn readings_that_are_held_do_not_pile_up() {
    let copy = Copy::new();
    for seed in 0..3 {
        let slow = rows(100, 3e-3, seed, |s| s.reading);
        let held = slow.iter().enumerate().flat_map(|(n, row)| {
            let reading = row.split_once(',').unwrap().1;
            (0..10).map(move |k| format!("{:.4},{reading}", (10 * n + k) as f64 / 1000.0))
        });
        write(&copy, "a.csv", &held.collect::<Vec<_>>());
        let (code, said, _) = tumble(&copy, &["a.csv"]);
        assert_eq!(code, 0, "{said}");
    }
}

#[test]
fn files_that_overlap_are_refused() {
    let copy = Copy::new();
    let all = rows(100, 2e-3, 1, |s| s.reading);
    // Sixteen rests each, eight of them in both; the second file begins at any sample.
    for shift in [0, 60, 150] {
        write(&copy, "a.csv", &all[..8000]);
        write(&copy, "b.csv", &all[4000 - shift..]);
        let (code, said, _) = tumble(&copy, &["a.csv", "b.csv"]);
        assert_eq!(code, 2, "{shift}: {said}");
        assert!(said.contains("expected readings of its own for each rest: a record counts once"), "{said}");
    }
}

/// A table of attitudes has no symmetry that hides an exchange of columns or a sign.
#[test]
fn other_columns_are_named_by_the_table_of_attitudes() {
    let copy = Copy::new();
    let table: String = (0..RESTS).map(|rest| up(rest).map(|part| part.to_string()).join(",") + "\n").collect();
    fs::write(copy.out().join("attitudes.csv"), format!("up_1,up_2,up_3\n{table}")).unwrap();
    let known = ["a.csv", "--attitudes", "attitudes.csv", "--attitude-uncertainty", "1 mrad"];
    write(&copy, "a.csv", &rows(100, 2e-3, 1, |s| s.reading));
    let (code, said, _) = tumble(&copy, &known);
    assert_eq!(code, 0, "{said}");
    write(&copy, "a.csv", &rows(100, 2e-3, 1, |Sample { reading: [x, y, z], .. }| [*y, *x, *z]));
    let (code, said, _) = tumble(&copy, &known);
    assert_eq!(code, 2, "{said}");
    assert!(
        said.contains("attitudes.csv: found ") && said.contains("and 24 of 24 with axes 1 and 2 exchanged"),
        "{said}"
    );
    write(&copy, "a.csv", &rows(100, 2e-3, 1, |Sample { reading: [x, y, z], .. }| [*x, *y, -*z]));
    let (code, said, _) = tumble(&copy, &known);
    assert_eq!(code, 2, "{said}");
    assert!(said.contains("and 24 of 24 with f3 with the sign reversed"), "{said}");
}

#[test]
fn few_samples_a_second_need_longer_rests() {
    let copy = Copy::new();
    write(&copy, "a.csv", &rows(8, 2e-3, 1, |s| s.reading));
    let (_, said, _) = tumble(&copy, &["a.csv"]);
    assert!(said.contains("at this sampling rate a rest below 4."), "{said}");
    write(&copy, "a.csv", &rows(100, 2e-3, 1, |s| s.reading));
    let (_, said, _) = tumble(&copy, &["a.csv"]);
    assert!(!said.contains("may be taken for motion"), "{said}");
}

/// The faces of a cube in an order without opposite neighbours, each turned by `askew` of its number about two axes [rad].
fn faces(visits: usize, askew: impl Fn(usize) -> [f64; 2]) -> Vec<[f64; 3]> {
    let of_face = |face: usize| {
        let (axis, sign) = (face % 3, if face < 3 { 1.0 } else { -1.0 });
        let [a, b] = askew(face);
        let mut up = [0.0; 3];
        (up[axis], up[(axis + 1) % 3], up[(axis + 2) % 3]) = (sign * (1.0 - a * a - b * b).sqrt(), a, b);
        up
    };
    (0..6 * visits).map(|rest| of_face(rest % 6)).collect()
}

/// Faces do not show misalignment, which is scale where the case is askew on them: left out of the terms it has a prior.
#[test]
fn misalignment_that_is_not_asked_for_has_a_prior() {
    let copy = Copy::new();
    let askew = |face: usize| [5e-3, -4e-3].map(|angle| if face < 3 { angle } else { -angle });
    let force = |s: &Sample, axis: usize| (s.reading[axis] - BIAS[axis]) / (1.0 + SCALE[axis]);
    let misaligned = |s: &Sample| [s.reading[0], s.reading[1] + 4e-3 * force(s, 0), s.reading[2] - 4e-3 * force(s, 1)];
    write(&copy, "faces.csv", &rows_of(&faces(2, askew), 100, 1e-3, 5, misaligned));
    let (code, said, result) = tumble(&copy, &["faces.csv", "--terms", "df_1,df_2,df_3,G0_11,G0_22,G0_33"]);
    assert_eq!(code, 0, "{said}");
    let squared = squared_error(&result.unwrap());
    assert!(squared < 3.0, "{squared}");
    assert!(said.contains("PRIORS standard uncertainty after the data over that before G0_21 1.000"), "{said}");
    let session = fs::read_to_string(copy.out().join("out/experiment.toml")).unwrap();
    assert!(session.contains("[prior]\nG0_21 = \"10 mrad\"\nG0_31"), "{session}");
}

/// Faces of a cube that are off are off in each of four visits: their rests share what is stated, where independent ones would halve it.
#[test]
fn repeated_rests_on_a_face_share_its_error() {
    let copy = Copy::new();
    let off =
        |face: usize| [1.3e-3, -0.9e-3, 0.4e-3, -1.2e-3, 1.0e-3, 0.2e-3, -0.8e-3][face..face + 2].try_into().unwrap();
    write(&copy, "faces.csv", &rows_of(&faces(4, off), 100, 1e-3, 6, |s| s.reading));
    let known = ["faces.csv", "--attitudes", "cube", "--attitude-uncertainty", "1 mrad"];
    let (code, said, result) = tumble(&copy, &known);
    assert_eq!(code, 0, "{said}");
    let result = result.unwrap();
    let shared = result["model"]["positions"][0]["attitude_uncertainty"].as_f64().unwrap();
    assert!((shared - 2e-3).abs() < 1e-5, "{shared}");
    // With one visit to each face the uncertainty is the same: the error of the cube.
    write(&copy, "faces.csv", &rows_of(&faces(1, off), 100, 1e-3, 6, |s| s.reading));
    let single = tumble(&copy, &known).2.unwrap();
    let u = |result: &Value| {
        let all = result["parameters"].as_array().unwrap();
        all.iter().find(|p| p["name"] == "G0_21").unwrap()["standard_uncertainty"].as_f64().unwrap()
    };
    assert!((u(&result) / u(&single) - 1.0).abs() < 0.02, "{} {}", u(&result), u(&single));
}
