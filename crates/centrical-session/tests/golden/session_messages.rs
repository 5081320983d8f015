//! What is wrong with an experiment file.

use centrical_session::{Session, SettingsForm};

use crate::sample::{EXPERIMENT, Sample};
use crate::schemas::refuses_what_the_parser_refuses;

/// The message for an experiment file.
fn message(experiment: impl AsRef<[u8]>) -> String {
    let sample = Sample::new(experiment);
    let error = Session::read(&sample.path()).expect_err("the file is wrong");
    sample.relative(&error.to_string())
}

/// The right file with the first `from` replaced by `to`.
fn spoiled(from: &str, to: &str) -> String {
    assert!(EXPERIMENT.contains(from), "{from}");
    EXPERIMENT.replacen(from, to, 1)
}

/// Rows of `(from, to, message)`: all are compared.
fn compare(cases: &[(&str, &str, &str)]) {
    for (from, to, expected) in cases {
        assert_eq!(message(spoiled(from, to)), format!("experiment.toml, {expected}"));
        refuses_what_the_parser_refuses(SettingsForm::Experiment, &spoiled(from, to), expected);
    }
}

#[test]
fn the_form_is_kept() {
    compare(&[
        ("gravity =", "gravty =", r"line 6, column 1: found an unknown key `gravty`, expected `gravity` or `latitude`"),
        (
            "title =",
            "titel =",
            r"line 2, column 1: found an unknown key `titel`, expected one of `title`, `date`, `text`",
        ),
        ("latitude =", "lat =", r"line 7, column 1: found an unknown key `lat`, expected `gravity` or `latitude`"),
        (
            "output_unit =",
            "outputunit =",
            r"line 10, column 1: found an unknown key `outputunit`, expected one of `model`, `serial`, `output_unit`, `counts`, `volts`, `proof_masses`, `reference`",
        ),
        (
            "rotation =",
            "rot =",
            r"line 15, column 1: found an unknown key `rot`, expected one of `speed_uncertainty`, `rotation`, `station`, `tachometer_uncertainty`, `measured`",
        ),
        (
            "pair_relation =",
            "relation =",
            r"line 19, column 1: found an unknown key `relation`, expected one of `error_model`, `pair_relation`, `extensions`",
        ),
        (
            "speed_unit =",
            "speed_units =",
            r"line 22, column 1: found an unknown key `speed_units`, expected one of `time`, `f`, `telemetry_time`, `pulse`, `speed`, `speed_unit`, `header_line`, `first_row`, `telemetry_header_line`, `telemetry_first_row`, `missing_readings`",
        ),
        (
            "pair =",
            "pairs =",
            r"line 27, column 1: found an unknown key `pairs`, expected one of `id`, `axes`, `matrix`, `pair`",
        ),
        (
            "record =",
            "recrod =",
            r"line 37, column 1: found an unknown key `recrod`, expected one of `position`, `arm`, `record`, `telemetry`, `pulses`, `plateaus`",
        ),
        (
            "angle =",
            "angel =",
            r"line 38, column 26: found an unknown key `angel`, expected one of `speed`, `speed_uncertainty`, `angle`, `duration`",
        ),
        (
            "[site]",
            "[sites]",
            r"line 5, column 2: found an unknown key `sites`, expected one of `plateaus`, `record_findings`, `plan`, `candidates`, `cost`, `target`, `robust`, `session`, `site`, `unit`, `centrifuge`, `model`, `uncertainty`, `columns`, `position`, `schedule`, `mounting`, `tumble`, `prior`",
        ),
        ("gravity = \"9.81523 m/s^2\"\n", "", r"line 5, column 1: found no key `gravity`, expected one"),
        (r#""9.81523 m/s^2""#, r#""9.81523 m/s^2"#, r#"line 6, column 25: found invalid basic string, expected `"`"#),
        (
            r#""9.81523 m/s^2""#,
            "true",
            r#"line 6, column 11: found boolean `true`, expected a number in SI or a string with a unit such as "133.7 rpm""#,
        ),
        (
            r#""9.81523 m/s^2""#,
            "[1]",
            r#"line 6, column 11: found a list of values, expected a number in SI or a string with a unit such as "133.7 rpm""#,
        ),
        (
            "\"m/s^2\"\n",
            "\"counts\"\ncounts = {scale = [1,1], bias = [0,0,0]}\n",
            r"line 11, column 19: found a length of 2, expected an array of length 3",
        ),
        (
            r#""kozlov-2017""#,
            "3",
            r#"line 18, column 15: found integer `3`, expected "kozlov-2017" or a list of terms such as { axis = 1, term = "f1*f2" }"#,
        ),
        (
            r#""kozlov-2017""#,
            r#"[{ axis = 1, trem = "f1" }]"#,
            r"line 18, column 28: found an unknown key `trem`, expected `axis` or `term`",
        ),
        (
            r#""kozlov-2017""#,
            "[3]",
            r#"line 18, column 16: found integer `3`, expected "kozlov-2017", the name of one of its terms, or { axis = 1, term = "f1*f2" }"#,
        ),
        ("[[-1, 0, 0]", "[[0]", r"line 31, column 11: found a length of 1, expected an array of length 3"),
        (
            "arm = [0.5, 0, 0]",
            "arm = [0.5, 0]",
            r"line 36, column 7: found a length of 2, expected an array of length 3",
        ),
    ]);
}

#[test]
fn site() {
    compare(&[
        (
            r#""9.81523 m/s^2""#,
            r#""9.81523 ft/s^2""#,
            r#"[site], gravity: found "9.81523 ft/s^2", expected an acceleration such as "9.81523 m/s^2" or a number in m/s^2 (units: m/s^2, m/s2, mm/s^2, g, mg, ug, Gal, mGal)"#,
        ),
        (
            r#""9.81523 m/s^2""#,
            r#""abc""#,
            r#"[site], gravity: found "abc", expected an acceleration such as "9.81523 m/s^2" or a number in m/s^2 (units: m/s^2, m/s2, mm/s^2, g, mg, ug, Gal, mGal)"#,
        ),
        (
            r#""9.81523 m/s^2""#,
            "0",
            r#"[site], gravity: found 0.0, expected gravity on Earth, 9.7 to 9.9 m/s^2, such as "9.81523 m/s^2""#,
        ),
        (
            r#""9.81523 m/s^2""#,
            "-9.81",
            r#"[site], gravity: found -9.81, expected gravity on Earth, 9.7 to 9.9 m/s^2, such as "9.81523 m/s^2""#,
        ),
        (r#""9.81523 m/s^2""#, "nan", r"[site], gravity: found NaN, expected a finite number"),
        (r#""9.81523 m/s^2""#, r#""inf g""#, r#"[site], gravity: found "inf g", expected a finite number"#),
        (r#""55.7 deg""#, "90.5", r"[site], latitude: found 90.5, expected a latitude from -90 deg to 90 deg"),
        (
            r#""55.7 deg""#,
            r#""90.5 deg""#,
            r#"[site], latitude: found "90.5 deg", expected a latitude from -90 deg to 90 deg"#,
        ),
    ]);
}

#[test]
fn unit() {
    compare(&[
        (
            "\"m/s^2\"\n",
            "\"furlong\"\n",
            r#"[unit], output_unit: found "furlong", expected "counts", "V" or one of m/s^2, m/s2, mm/s^2, g, mg, ug, Gal, mGal"#,
        ),
        (
            "\"m/s^2\"\n",
            "\"counts\"\n",
            r"[unit], counts: found no such key, expected counts = { scale = [...], bias = [...] }: counts per m/s^2 and counts at none",
        ),
        (
            "\"m/s^2\"\n",
            "\"counts\"\ncounts = {scale = [1,0,1], bias = [0,0,0]}\n",
            r"[unit.counts], scale: found 0.0, expected counts per m/s^2, not zero",
        ),
        (
            "\"m/s^2\"\n",
            "\"g\"\ncounts = {scale = [1,1,1], bias = [0,0,0]}\n",
            r#"[unit], counts: found counts and output_unit = "g", expected no counts, or output_unit = "counts""#,
        ),
        (
            "[0, 0, 0], [0.021",
            "[0, 1e-3, 0], [0.021",
            r#"[unit], proof_masses: found [[0.0, 0.001, 0.0], [0.021, 0.012, 0.0105], [0.015, -0.01, -0.014]], expected the first point at zero (reference = "first-proof-mass"), or reference = "own-axes""#,
        ),
        (
            "[0, 0, 0], [0.021",
            r#"[0, "1 s", 0], [0.021"#,
            r#"[unit], proof_masses: found "1 s", expected a length such as "0.5 m" or a number in m (units: m, cm, mm, um, in)"#,
        ),
        (
            "[0, 0, 0], [0.021",
            "[0, 0, 0], [21",
            "[unit], proof_masses: found 21.0, expected coordinates within 1 m (a number without a unit is in m)",
        ),
        (
            "output_unit",
            "reference = \"own-axes\"\noutput_unit",
            r#"[unit], proof_masses: found [[0.0, 0.0, 0.0], [0.021, 0.012, 0.0105], [0.015, -0.01, -0.014]], expected coordinate j of point j at zero (reference = "own-axes"), or reference = "first-proof-mass""#,
        ),
        (
            "output_unit",
            "reference = \"centre\"\noutput_unit",
            r#"[unit], reference: found "centre", expected "first-proof-mass" or "own-axes""#,
        ),
    ]);
}

#[test]
fn centrifuge_and_columns() {
    compare(&[
        (
            "1e-5",
            "-1e-5",
            r"[centrifuge], speed_uncertainty: found -1e-5, expected a relative standard uncertainty, zero or more and below 1",
        ),
        ("1e-5", "inf", r"[centrifuge], speed_uncertainty: found inf, expected a finite number"),
        (r#""+3""#, r#""3""#, r#"[centrifuge], rotation: found "3", expected "+3" or "-3""#),
        (
            r#""rpm""#,
            r#""km/h""#,
            r#"[columns], speed_unit: found "km/h", expected one of rad/s, rpm, rev/min, rev/s, Hz, deg/s"#,
        ),
    ]);
}

#[test]
fn error_model_and_pair_relation() {
    compare(&[
        (
            r#""kozlov-2017""#,
            r#""kozlov""#,
            r#"[model], error_model: found "kozlov", expected "kozlov-2017", one of its terms such as "G0_11", "cross-products", "cross-cubes", "cubic-products", "own-squares", "cross-squares", "own-cubes", "odd-quadratic", "asymmetry", "fourth-power", "fifth-power", "jump", or { axis = 1, term = "f1*f2" }"#,
        ),
        (
            r#""kozlov-2017""#,
            r#"["kozlov-2017", { axis = 1, term = "f1^3" }]"#,
            r"[model], error_model: found G2_11 a second time, expected every term once",
        ),
        (
            r#""kozlov-2017""#,
            r#"[{ axis = 4, term = "f1^3" }]"#,
            r"[model], error_model: found axis = 4, expected axis = 1, 2 or 3",
        ),
        (
            r#""kozlov-2017""#,
            r#"[{ axis = 1, term = "f1+f2" }]"#,
            r#"[model], error_model: found term = "f1+f2", expected a product of powers of f1, f2, f3 and at most one of |f1|, |f2|, |f3|, of degree 9 at most, such as f1*f2, f2*|f2|, f1^3 or 1"#,
        ),
        (
            r#""kozlov-2017""#,
            r#"[{ axis = 1, term = "f1^10" }]"#,
            r#"[model], error_model: found term = "f1^10", expected a product of powers of f1, f2, f3 and at most one of |f1|, |f2|, |f3|, of degree 9 at most, such as f1*f2, f2*|f2|, f1^3 or 1"#,
        ),
        (
            r#""common""#,
            r#""same""#,
            r#"[model], pair_relation: found "same", expected "common", "opposite" or "free""#,
        ),
    ]);
}

#[test]
fn positions() {
    compare(&[
        (r#"id = "2""#, r#"id = "1""#, r#"[[position]] 2, id: found "1" a second time, expected an id of its own"#),
        (
            r#""+1 +2 +3""#,
            r#""+1 +1 +3""#,
            r#"[[position]] 1, axes: found "+1 +1 +3", expected a signed arm axis for each instrument axis such as "+2 -3 -1" with every arm axis once"#,
        ),
        (
            r#""+1 +2 +3""#,
            r#""+1 +2 -3""#,
            r#"[[position]] 1, axes: found "+1 +2 -3", expected a signed arm axis for each instrument axis such as "+2 -3 -1" that is right-handed (this one is left-handed)"#,
        ),
        (
            r#""+1 +2 +3""#,
            r#""+1 +2""#,
            r#"[[position]] 1, axes: found "+1 +2", expected a signed arm axis for each instrument axis such as "+2 -3 -1""#,
        ),
        (
            r#""+1 +2 +3""#,
            r#""x y z""#,
            r#"[[position]] 1, axes: found "x y z", expected a signed arm axis for each instrument axis such as "+2 -3 -1""#,
        ),
        ("axes = \"+1 +2 +3\"\n", "", r"[[position]] 1, axes: found neither axes nor matrix, expected one of them"),
        (
            "[[-1, 0, 0]",
            "[[1, 0, 0]",
            r"[[position]] 2, matrix: found [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]], expected a right-handed rotation, its rows orthonormal to nine digits (this one is left-handed)",
        ),
        (
            "[[-1, 0, 0]",
            "[[-1.01, 0, 0]",
            r"[[position]] 2, matrix: found [[-1.01, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]], expected a right-handed rotation, its rows orthonormal to nine digits",
        ),
        (
            "[[-1, 0, 0]",
            "[[nan, 0, 0]",
            r"[[position]] 2, matrix: found [[NaN, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]], expected a right-handed rotation, its rows orthonormal to nine digits",
        ),
        (r#"id = "2""#, r#"id = "[2]""#, r#"[[position]] 2, id: found "[2]", expected a name without brackets"#),
        (
            r#"id = "2""#,
            r#"id = "2\u202E""#,
            r#"[[position]] 2, id: found "2\u{202e}", expected a name of characters that are shown"#,
        ),
        (
            r#"position = "2""#,
            r#"position = "1""#,
            r#"[[position]] 2, id: found position "2" without a mounting, expected a [[mounting]] for every position"#,
        ),
    ]);
}

#[test]
fn mountings() {
    compare(&[
        (r#"id = "2""#, "id = 3", r#"[[mounting]] 2, position: found unknown position "2", expected one of 1, 3"#),
        (
            "arm = [0.5, 0, 0]",
            "arm = [-0.5, 0, 0]",
            r"[[mounting]] 1, arm: found [-0.5, 0.0, 0.0], expected a radius arm[0] of zero or more (turn the unit with another position instead)",
        ),
        ("arm = [0.5, 0, 0]", "arm = [nan, 0, 0]", r"[[mounting]] 1, arm: found NaN, expected a finite number"),
        (
            "arm = [0.5, 0, 0]",
            "arm = [1e300, 0, 0]",
            r"[[mounting]] 1, arm: found 1e300, expected coordinates within 50 m (a number without a unit is in m)",
        ),
        (
            "arm = [0.5, 0, 0]",
            r#"arm = ["0.5 kg", 0, 0]"#,
            r#"[[mounting]] 1, arm: found "0.5 kg", expected a length such as "0.5 m" or a number in m (units: m, cm, mm, um, in)"#,
        ),
        (
            r#"plateaus = [{ speed = 0, angle = 0 }, { speed = "133.8 rpm" }]"#,
            "plateaus = []",
            r"[[mounting]] 1, plateaus: found an empty schedule, expected at least one plateau",
        ),
        (
            r#"{ speed = "133.8 rpm" }]"#,
            r#"{ speed = "-2e6 rpm" }]"#,
            r#"[[mounting]] 1, plateaus 2 speed: found "-2e6 rpm", expected a speed from -1e6 to 1e6 rpm, positive in the direction of `rotation` in [centrifuge]"#,
        ),
        (
            r#"{ speed = "133.8 rpm" }]"#,
            r#"{ speed = "133.8 rpm", angle = 1 }]"#,
            r"[[mounting]] 1, plateaus 2 angle: found 1.0, expected no angle while spinning: the readings do not depend on it",
        ),
        (
            r#"{ speed = "133.8 rpm" }]"#,
            "{ speed = 0 }]",
            r"[[mounting]] 1, plateaus 2 angle: found no angle, expected the carousel angle of a plateau at rest",
        ),
        (
            r#"{ speed = "133.8 rpm" }]"#,
            "{ speed = 1e9 }]",
            r"[[mounting]] 1, plateaus 2 speed: found 1000000000.0, expected a speed from -1e6 to 1e6 rpm, positive in the direction of `rotation` in [centrifuge]",
        ),
    ]);
}

#[test]
fn measured_speeds() {
    const CENTRIFUGE: &str = "rotation = \"+3\"";
    let measured = |table: &str| format!("{CENTRIFUGE}\nmeasured = {{ {table} }}");
    let cases = [
        (
            r#"from = "tachometer", uncertainty = "1 ppm""#,
            r#"measured.from: found "tachometer", expected one of "telemetry", "pulses", "plateaus""#,
        ),
        (
            r#"from = "telemetry", uncertainty = -1e-6"#,
            "measured.uncertainty: found -1e-6, expected a relative standard uncertainty, zero or more and below 1",
        ),
        (
            r#"from = "pulses", uncertainty = 1e-6, pulses_per_revolution = 0.5"#,
            "measured.pulses_per_revolution: found 0.5, expected a whole number of pulses, 1 to 1e7",
        ),
    ];
    for (table, expected) in cases {
        let message = message(spoiled(CENTRIFUGE, &measured(table)));
        assert_eq!(message, format!("experiment.toml, [centrifuge], {expected}"));
    }
    let scales =
        "measured = { from = \"telemetry\", uncertainty = 1e-6, scale = 2e-6 }\n\n[uncertainty]\nspeed_scale = 3e-6";
    assert_eq!(
        message(spoiled(CENTRIFUGE, &format!("{CENTRIFUGE}\n{scales}"))),
        "experiment.toml, [uncertainty], speed_scale: found 0.000003, expected 0.000002, the scale of measured speeds in \
         [centrifuge], or nothing"
    );
}

/// Half a metre beside an arm of half a metre: millimetres without a unit.
#[test]
fn an_uncertainty_beyond_reason() {
    assert_eq!(
        message(spoiled("rotation = \"+3\"", "rotation = \"+3\"\n\n[uncertainty]\nradius = 0.5")),
        "experiment.toml, [uncertainty], radius: found 0.5, expected a standard uncertainty, zero or more and not beyond reason"
    );
}

/// It bounds nothing between mountings.
#[test]
fn a_change_of_bias_needs_rests() {
    assert_eq!(
        message(spoiled("rotation = \"+3\"", "rotation = \"+3\"\n\n[uncertainty]\nbias_change = \"50 ug\"")),
        "experiment.toml, [uncertainty], bias_change: found \"50 ug\", expected [[tumble]] rests, whose biases may \
         differ by it from those on the arm"
    );
}

/// Two mountings with one speed and four plateaus.
#[test]
fn an_extension_needs_what_it_is_of() {
    for (name, first, last) in [
        ("bias-step[5]", 2, 4),
        ("bias-step[1]", 2, 4),
        ("one-speed[2]", 1, 1),
        ("resonance[2]", 1, 1),
        ("other-unit[3]", 1, 2),
        ("one-mounting-turn[99]", 1, 2),
    ] {
        let with = format!("pair_relation = \"common\"\nextensions = [\"{name}\"]");
        assert_eq!(
            message(spoiled("pair_relation = \"common\"", &with)),
            format!(
                "experiment.toml, [model], extensions: found \"{name}\", expected a number from {first} to {last}, as the session has them"
            )
        );
    }
}

/// Of what is not there nothing is uncertain.
#[test]
fn an_uncertainty_needs_what_it_is_of() {
    let refused = |from: &str, to: &str, stated: &str, expected: &str| {
        let (key, found) = stated.split_once(" = ").unwrap();
        let table = format!("rotation = \"+3\"\n\n[uncertainty]\n{stated}");
        let text = spoiled(from, to).replacen("rotation = \"+3\"", &table, 1);
        assert_eq!(message(text), format!("experiment.toml, [uncertainty], {key}: found {found}, expected {expected}"));
    };
    let bound = "no such bound: the model has the effect, or the experiment has nothing that it could act on";
    refused("angle = \"180 deg\"", "angle = 0", "angle_tilt = \"1 mrad\"", bound);
    refused("title", "title", "rests_scale = \"20 ppm\"", bound);
    let latitude = "no such key without a latitude in [site]";
    refused("latitude = \"55.7 deg\"", "", "latitude = \"1 mrad\"", latitude);
    let tumbled = "\"2\"\nmatrix";
    refused(tumbled, tumbled, "doubt = \"200 %\"", "a standard uncertainty, zero or more and not beyond reason");
}

#[test]
fn positions_of_a_pair() {
    let collision = spoiled("pair = \"A\"\n", "").replace("pair = \"A\"", "pair = \"1\"");
    assert_eq!(
        message(collision),
        "experiment.toml, [[position]] 1, pair: found no pair, and another pair named \"1\" as this position, \
         expected a name for this position's pair"
    );
    let third = "[[position]]\nid = \"3\"\naxes = \"+3 +1 +2\"\npair = \"A\"\n\n[[mounting]]";
    assert_eq!(
        message(spoiled("[[mounting]]", third).replace("common", "opposite")),
        "experiment.toml, [[position]] 3, pair: found a third position in pair \"A\", \
         expected two at most with pair_relation = \"opposite\""
    );
}

/// A table is not an array, read by the order of its keys, and nothing of an array goes unread.
#[test]
fn tables_and_arrays_are_what_they_are() {
    compare(&[
        (
            "[site]\ngravity = \"9.81523 m/s^2\"\nlatitude = \"55.7 deg\"\n",
            "[[site]]\n",
            "line 5, column 1: found an array, expected a table",
        ),
        (
            "arm = [0.5, 0, 0]",
            "arm = [0.5, 0, 0, 9]",
            "line 36, column 7: found a length of 4, expected an array of length 3",
        ),
        (
            "[0.021, 0.012, \"10.5 mm\"]",
            "[0.021, 0.012, \"10.5 mm\", 5]",
            "line 11, column 28: found a length of 4, expected an array of length 3",
        ),
        (
            "[0, 0, 1]]",
            "[0, 0, 1], [7, 7, 7]]",
            "line 31, column 10: found a length of 4, expected an array of length 3",
        ),
        ("{ speed = 0, angle = 0 }", "[0, 0]", "line 38, column 13: found an array, expected a table"),
    ]);
}

#[test]
fn nothing_to_do() {
    let at_rest = EXPERIMENT.replace("{ speed = \"133.8 rpm\" }", "{ speed = 0, angle = 1 }");
    assert_eq!(
        message(at_rest),
        "experiment.toml, [[mounting]] 1, plateaus: found all plateaus at rest, \
         expected at least one plateau with a speed"
    );
    let no_mounting = &EXPERIMENT[..EXPERIMENT.find("[[mounting]]").unwrap()];
    assert_eq!(
        message(no_mounting),
        "experiment.toml, [[position]] 1, id: found position \"1\" without a mounting, \
         expected a [[mounting]] for every position"
    );
    let no_position = &EXPERIMENT[..EXPERIMENT.find("[[position]]").unwrap()];
    assert_eq!(
        message(no_position),
        "experiment.toml, [[position]] 1, id: found no [[position]], expected at least one position"
    );
    assert_eq!(message(""), "experiment.toml, line 1, column 1: found no key `site`, expected one");
}

#[test]
fn what_is_no_text() {
    let mut latin = EXPERIMENT.replace("Two positions", "Zwei Lagen, 20 C").into_bytes();
    let degree = latin.iter().position(|byte| *byte == b'C').unwrap();
    latin[degree] = 0xb0;
    assert_eq!(message(latin), "experiment.toml, line 2: found byte 0xb0, expected text in UTF-8");
    assert_eq!(
        message("[site]\ngravity = 9.81\ngravity = 9.82\n"),
        "experiment.toml, line 3, column 1: found text with a fault (duplicate key), expected TOML as the form of this file says"
    );
    let deep = format!("plateaus = {}1{}", "[".repeat(100_000), "]".repeat(100_000));
    assert_eq!(
        message(deep),
        "experiment.toml, line 1, column 92: found text with a fault (cannot recurse further; max recursion depth met), expected TOML \
         as the form of this file says"
    );
}

#[test]
fn where_the_session_is() {
    let sample = Sample::new(EXPERIMENT);
    assert!(Session::read(&sample.path()).is_ok(), "the folder");
    assert!(Session::read(&sample.path().join("experiment.toml")).is_ok(), "the file");
    let missing = Session::read(&sample.path().join("nowhere")).unwrap_err();
    assert_eq!(
        sample.relative(&missing.to_string()),
        "nowhere: found no such file, expected an experiment file, or the folder with its experiment.toml"
    );
    std::fs::create_dir(sample.path().join("empty")).unwrap();
    let empty = Session::read(&sample.path().join("empty")).unwrap_err();
    assert_eq!(
        sample.relative(&empty.to_string()),
        "empty/experiment.toml: found no such file, expected an experiment file, or the folder with its experiment.toml"
    );
}
