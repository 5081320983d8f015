//! What is wrong with a plan, an extension or a prior.

use std::path::Path;

use centrical_session::{Session, SettingsForm, read_plan, read_planning, subject, unwatched};

use crate::sample::{EXPERIMENT, Sample};
use crate::schemas::refuses_what_the_parser_refuses;

const PRESET: &str = include_str!("../../../../examples/plans/normalised.toml");
const OWN: &str = include_str!("../../../../examples/plans/four-positions.toml");

/// The message for a plan with the first `from` replaced by `to`.
fn message(plan: &str, from: &str, to: &str) -> String {
    assert!(plan.contains(from), "{from}");
    let sample = Sample::new("");
    let file = sample.file("plan.toml", plan.replacen(from, to, 1));
    sample.relative(&read_plan(&file).expect_err("the plan is wrong").to_string())
}

fn compare(plan: &str, cases: &[(&str, &str, &str)]) {
    for (from, to, expected) in cases {
        assert_eq!(message(plan, from, to), format!("plan.toml, {expected}"));
        refuses_what_the_parser_refuses(SettingsForm::Plan, &plan.replacen(from, to, 1), expected);
    }
}

#[test]
fn presets() {
    compare(
        PRESET,
        &[
            (
                "kozlov-2017-normalised",
                "kozlov",
                r#"[plan], preset: found "kozlov", expected "kozlov-2017-normalised""#,
            ),
            (
                "radii = [1, 0.5]",
                "radii = []",
                "[plan], radii: found 0 of them, expected 1 to 100 radii in units of R*, zero or more",
            ),
            ("[0, 1, 2, 3]", "[0, -1]", "[plan], levels: found -1, expected multiples of Omega*^2, zero or more"),
            (
                "rest_angles = [\"0 deg\", \"180 deg\"]",
                "rest_angles = [\"0 m\"]",
                "[plan], rest_angles: found \"0 m\", expected an angle such as \"180 deg\" or a number in rad (units: rad, mrad, urad, deg, arcmin, arcsec, rev)",
            ),
            ("\"up\" ", "\"east\" ", r#"[plan], axis_1: found "east", expected "up" or "down""#),
            (
                "20 ug/sqrt(Hz)",
                "20 ug",
                "[plan], noise: found \"20 ug\", expected a density such as \"20 ug/sqrt(Hz)\" or a number in m/s^2/sqrt(Hz) (units: m/s^2/sqrt(Hz), mg/sqrt(Hz), ug/sqrt(Hz))",
            ),
            ("\"60 s\"", "\"0 s\"", "[plan], duration: found \"0 s\", expected a duration from 1 ms to 1e7 s"),
            ("[0, 1, 2, 3]", "[nan]", "[plan], levels: found NaN, expected multiples of Omega*^2, zero or more"),
        ],
    );
}

#[test]
fn extensions_and_priors() {
    compare(
        OWN,
        &[
            (
                "arm-stretch-speed",
                "arm-stretch",
                "[model], extensions: found \"arm-stretch\", expected one of elastic-turn-speed, elastic-turn-load, arm-stretch-speed, arm-stretch-load, seat-stretch-speed, seat-stretch-load, radius-scale, speed-scale, speed-offset, earth-rate, gravity, arm-turn-speed, arm-turn-load, seat-radius, seat-lateral, position-shift, mounting-shift, mounting-turn, mounting-tilt, angle-tilt, mounting-bias, mounting-scale, rests-bias, rests-scale, rests-unit, rests-tilt, attitudes-tilt, spin-turn, proof-masses, spin-step, spin-speed, spin-square, spin-fourth, own-rate, yield, bias-drift, bias-wander, scale-drift, warm-up, warm-up-scale, heating-speed, heating-load, rise-fall, memory, hysteresis",
            ),
            (
                "[\"arm-stretch-speed\"]",
                "[\"radius-scale\", \"radius-scale\"]",
                "[model], extensions: found \"radius-scale\" a second time, expected every extension once",
            ),
            (
                "\"proof mass\" =",
                "\"proof masses\" =",
                "[prior], proof masses: found no such parameter or group, expected a name such as alpha_1, or the stem of several, dR",
            ),
            (
                "\"50 um\"",
                "\"50 urad\"",
                "[prior], proof mass: found \"50 urad\", expected a length such as \"0.5 m\" or a number in m (units: m, cm, mm, um, in)",
            ),
            (
                "\"50 um\"",
                "-5e-5",
                "[prior], proof mass: found a standard uncertainty of -0.00005, expected a positive number",
            ),
            (
                "\"proof mass\" = \"50 um\"",
                "G1 = \"5 ug/g\"",
                "[prior], G1: found \"5 ug/g\", expected a number in s^2/m or with a unit (units: s^2/m, ug/g^2)",
            ),
            (
                "\"proof mass\" =",
                "drho_22 = \"1 mm\"\n\"proof mass\" =",
                "[prior], proof mass: found a second prior on drho_22, expected one",
            ),
            (
                "duration = \"5 min\"",
                "duration = \"5 m\"",
                "[[mounting]] 1, plateaus 1 duration: found \"5 m\", expected a time such as \"10 ms\" or \"1 h 30 min\", or a number in s (units: s, ms, us, ns, min, h)",
            ),
        ],
    );
}

#[test]
fn planned_rests() {
    let plan = &format!("{OWN}\n[[tumble]]\nattitudes = [[0, 0, 1], [1, 0, 0]]\nduration = \"60 s\"\n");
    let list = "[[0, 0, 1], [1, 0, 0]]\nduration = \"60 s\"";
    compare(
        plan,
        &[
            (
                "attitudes =",
                "atitudes =",
                "line 76, column 1: found an unknown key `atitudes`, expected one of `rests`, `record`, `turning_radius`, `attitudes`, `duration`, `durations`, `attitude_uncertainty`, `bias_change`, `switch_on`, `noise_at_most`, `turning`",
            ),
            (
                "attitudes = [[0, 0, 1], [1, 0, 0]]\n",
                "",
                "[[tumble]] 1, rests: found no such key, expected a table of rests; or record, their record; or attitudes, of rests that are planned",
            ),
            (
                "[1, 0, 0]",
                "[0, 0.0, -0.0]",
                "[[tumble]] 1, attitudes: found [0.0, 0.0, -0.0], expected the direction of up",
            ),
            (
                "[1, 0, 0]",
                "[nan, 0, 1]",
                "[[tumble]] 1, attitudes: found [NaN, 0.0, 1.0], expected the direction of up",
            ),
            (
                "[[0, 0, 1], [1, 0, 0]]",
                "[]",
                "[[tumble]] 1, attitudes: found an empty list, expected a direction of up for each rest",
            ),
            (
                "[[0, 0, 1], [1, 0, 0]]",
                "1",
                "line 76, column 13: found integer `1`, expected \"cube\", the path of a table of attitudes, or a list of directions of up such as [0, 0, 1]",
            ),
            (
                list,
                "\"cube\"\nduration = \"0 s\"",
                "[[tumble]] 1, duration: found \"0 s\", expected a duration from 1 ms to 1e7 s",
            ),
            (
                list,
                "[[0, 0, 1], [1, 0, 0]]\ndurations = [\"60 s\"]",
                "[[tumble]] 1, durations: found 1 durations, expected one for each of the 2 attitudes",
            ),
            (
                list,
                "[[0, 0, 1], [1, 0, 0]]\nduration = \"60 s\"\ndurations = [\"60 s\", \"30 s\"]",
                "[[tumble]] 1, duration: found a duration, expected no such key beside durations",
            ),
            (
                list,
                "[[0, 0, 1], [1, 0, 0]]\ndurations = [\"60 s\", \"0 s\"]",
                "[[tumble]] 1, durations: found \"0 s\", expected a duration from 1 ms to 1e7 s",
            ),
            (
                list,
                "\"cube\"\nattitude_uncertainty = \"20 deg\"",
                "[[tumble]] 1, attitude_uncertainty: found \"20 deg\", expected a standard uncertainty of 1e-12 rad to 10 deg",
            ),
            (
                "attitudes = [[0, 0, 1], [1, 0, 0]]",
                "rests = \"rests.csv\"",
                "[[tumble]] 1, duration: found a duration, expected no such key beside rests, which have been measured",
            ),
            (
                list,
                "[[0, 0, 1]]\nbias_change = \"20 m/s^2\"",
                "[[tumble]] 1, bias_change: found \"20 m/s^2\", expected a standard uncertainty from 0 to 10 m/s^2",
            ),
            (
                "attitudes = [[0, 0, 1], [1, 0, 0]]\nduration = \"60 s\"",
                "record = \"tumble.csv\"",
                "[[tumble]] 1, record: found a record in a plan, expected rests, a table of them as `centrical tumble` writes it, or attitudes to be planned",
            ),
        ],
    );
}

/// Every prior in the unit it is written in.
#[test]
fn units_of_priors() {
    let sigma = |line: &str| {
        let sample = Sample::new("");
        let file = sample.file("plan.toml", OWN.replacen("\"proof mass\" = \"50 um\"", line, 1));
        let plan = read_plan(&file).unwrap().unwrap();
        plan.model.priors().iter().map(|p| (p.parameter, p.standard_uncertainty)).collect::<Vec<_>>()
    };
    let g = 9.80665;
    assert_eq!(sigma("G1_11 = \"2 ug/g^2\"")[0].1, 2.0 * (1e-6 / g));
    assert_eq!(sigma("G2 = \"2 ug/g^3\"").len(), 3);
    assert_eq!(sigma("G2 = \"2 s^4/m^2\"")[0].1, 2.0);
    assert_eq!(sigma("scale = \"20 ppm\"").len(), 3);
    assert_eq!(sigma("G0_21 = \"20 urad\"")[0].1, 20.0 * 1e-6);
    assert_eq!(sigma("delta = 1e-3").len(), 12);
    assert_eq!(sigma("df = \"2 mg\"")[1].1, 2.0 * (1e-3 * g));
    assert_eq!(sigma("stretch_speed = 1e-9")[0].1, 1e-9);
}

/// A file with records is a session, a folder too; without records, or with a plan, it is a plan.
#[test]
fn plans_and_sessions_are_told_apart() {
    let sample = Sample::new(EXPERIMENT);
    assert_eq!(read_plan(&sample.path()).unwrap(), None);
    assert_eq!(read_plan(&sample.path().join("experiment.toml")).unwrap(), None);
    let unmeasured = EXPERIMENT.lines().filter(|line| !line.starts_with("record =")).collect::<Vec<_>>().join("\n");
    let file = sample.file("plan.toml", unmeasured);
    assert_eq!(read_plan(&file).unwrap().unwrap().weights.len(), 4);
    let message = sample.relative(&subject(Path::new("no/such.toml"), &unwatched).unwrap_err().to_string());
    assert_eq!(
        message,
        "no/such.toml: found no such file, expected an experiment file, or the folder with its experiment.toml"
    );
}

/// A session keeps extensions and priors, and tells what is wrong with them before any record is read.
#[test]
fn sessions_have_them_too() {
    let with = EXPERIMENT.replacen("\"common\"", "\"common\"\nextensions = [\"speed-scale\"]", 1);
    let session = Session::read(&Sample::new(with.clone() + "\n[prior]\ndR = \"0.1 mm\"\n").path()).unwrap();
    let model = session.model().unwrap();
    assert!(model.parameters().find("speed_scale").is_some());
    assert_eq!(model.priors().len(), 2);
    let sample = Sample::new(with + "\n[prior]\ndR = \"0.1 deg\"\n");
    let message = sample.relative(&Session::read(&sample.path()).unwrap_err().to_string());
    assert!(message.starts_with("experiment.toml, [prior], dR: found \"0.1 deg\""), "{message}");
}

/// Noise by the duration of each plateau: `density^2 / (2 T) + floor^2`.
#[test]
fn weights_follow_durations() {
    let sample = Sample::new("");
    let plan = read_plan(&sample.file("plan.toml", OWN)).unwrap().unwrap();
    let ug: f64 = 1e-6 * 9.80665;
    for (weight, duration) in [(0, 300.0_f64), (1, 60.0), (3, 60.0), (5, 300.0)] {
        let expected = 400.0 * ug * ug / (2.0 * duration) + ug * ug;
        let found = plan.weights[weight].covariance;
        assert!((found[(1, 1)] / expected - 1.0).abs() < 1e-12);
        assert_eq!(found[(0, 1)], 0.0);
    }
}

const CANDIDATES: &str = include_str!("../../../../examples/plans/best.toml");

#[test]
fn candidates_costs_and_targets() {
    let cases = [
        (
            "radii = [\"0.5 m\", \"0.25 m\"]",
            "radii = []",
            "[candidates], radii: found none, expected at least one radius",
        ),
        (
            "radii = [\"0.5 m\", \"0.25 m\"]",
            "radii = [\"0.5 m\", \"500 mm\"]",
            "[candidates], radii: found 0.5 m twice, expected each radius once",
        ),
        (
            "repeats = 2",
            "speeds = [\"300 rpm\"]",
            "[candidates], loads: found loads beside speeds, expected one of them",
        ),
        (
            "count = 20",
            "count = 1",
            "[candidates], loads: found 1 from \"5 g\" to \"200 g\", expected two or more steps, rising",
        ),
        ("repeats = 2", "repeats = 0", "[candidates], repeats: found 0, expected 1 to 20 visits of a plateau"),
        (
            "durations = [\"30 s\", \"60 s\", \"120 s\"]",
            "durations = []",
            "[candidates], durations: found 0 of them, expected 1 to 10 durations of a plateau",
        ),
        (
            "repeats = 2",
            "positions = [\"7\"]",
            "[candidates], positions: found unknown position \"7\", expected some of 1, 2, 3, 4, 5, 6",
        ),
        (
            "seat = \"10 min\"",
            "seat = \"30 min\"",
            "[cost], seat: found 1800 s, expected at most the cost of a change of position, which contains one",
        ),
        ("ramp = \"20 s\"", "ramp = \"-1 s\"", "[cost], ramp: found \"-1 s\", expected a time from 0 to 1e7 s"),
        (
            "criterion = \"I\"",
            "criterion = \"E\"",
            "[target], criterion: found \"E\", expected \"I\", \"A\", \"D\" or \"worst\"",
        ),
        (
            "time = \"8 h\"",
            "",
            "[target], time: found neither time nor uncertainty, expected time = \"8 h\", or [target.uncertainty]",
        ),
        (
            "time = \"8 h\"",
            "[target.uncertainty]\ndR = \"1 um\"",
            "[target.uncertainty], dR: found dR_1[A] of the geometry, expected a parameter or group of the instrument, or \"reading\"",
        ),
        (
            "repeats = 2",
            "attitude_uncertainty = \"1 deg\"",
            "[candidates], attitudes: found no such key beside attitude_uncertainty, expected the attitudes that are this uncertain",
        ),
        (
            "repeats = 2",
            "attitudes = [[0, 0, 0]]",
            "[candidates], attitudes: found [0.0, 0.0, 0.0], expected the direction of up",
        ),
        (
            "repeats = 2",
            "attitudes = \"cube\"\nattitude_uncertainty = \"1 rad\"",
            "[candidates], attitude_uncertainty: found \"1 rad\", expected a standard uncertainty of 1e-12 rad to 10 deg",
        ),
        ("[target]", "table = \"-1 s\"\n\n[target]", "[cost], table: found \"-1 s\", expected a time from 0 to 1e7 s"),
        (
            "[site]",
            "[[tumble]]\nrests = \"rests.csv\"\n\n[site]",
            "[candidates], attitudes: found rests in [[tumble]], expected no [[tumble]]: the plan chooses rests from attitudes",
        ),
    ];
    for (from, to, expected) in cases {
        let sample = Sample::new("");
        assert!(CANDIDATES.contains(from), "{from}");
        let file = sample.file("plan.toml", CANDIDATES.replacen(from, to, 1));
        let message = sample.relative(&read_planning(&file, None).expect_err("the plan is wrong").to_string());
        assert_eq!(message, format!("plan.toml, {expected}"));
    }
}
