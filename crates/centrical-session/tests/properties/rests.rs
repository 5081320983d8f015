//! Rests in free attitudes in one session with a centrifuge.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use centrical::observability::cube_directions;
use centrical::{Experiment, History, MeasurementModel, Mounting, Position, SetPoint};
use centrical_session::{
    Axes, CalibrationResult, Method, PlateauRow, Session, TableFormat, calibrate, read_plan, reduce, unwatched,
    write_plateaus, write_reduced,
};
use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, Vector3};

use crate::random::Random;

/// Of a rest of a minute [m/s^2].
const NOISE: f64 = 2.5e-5;

/// The example session, reduced, in `folder`; and its result.
fn reduced_example(folder: &Path) -> CalibrationResult {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/ta-200");
    let session = Session::read(&example).unwrap();
    let (_, reduced) = reduce(&session, &unwatched).unwrap();
    write_reduced(&session, &reduced, None, TableFormat::Csv, folder, &unwatched).unwrap();
    calibrate(&Session::read(folder).unwrap(), &[], Method::Exact, &unwatched).unwrap()
}

/// Rests of the unit with these coefficients on the faces, edges and corners of a cube.
fn rests(session: &Session, result: &CalibrationResult, random: &mut Random) -> Vec<PlateauRow> {
    let steps = || [-1.0, 0.0, 1.0].into_iter();
    let all = steps().flat_map(|x| steps().flat_map(move |y| steps().map(move |z| Vector3::new(x, y, z))));
    let mut experiment = Experiment {
        positions: Vec::new(),
        mountings: Vec::new(),
        set_points: Vec::new(),
        ..session.experiment.clone()
    };
    for (n, direction) in all.filter(|direction| *direction != Vector3::zeros()).enumerate() {
        experiment.positions.push(Position::free(n.to_string(), &direction));
        experiment.mountings.push(Mounting { position: n, arm_y: Vector3::zeros() });
        experiment.set_points.push(SetPoint::at_rest(n, 0.0));
    }
    let model = MeasurementModel::new(experiment, session.error_model.clone(), &[]);
    let of_unit = |name: &str| result.parameter(name).and_then(|parameter| parameter.value);
    let tremble = |random: &mut Random| 0.02 * random.normal();
    let x: Vec<f64> = model.parameters().iter().map(|p| of_unit(&p.name).unwrap_or_else(|| tremble(random))).collect();
    let row = |(mounting, set_point): (usize, &SetPoint)| PlateauRow {
        mounting,
        speed: 0.0,
        speed_uncertainty: None,
        bend_z: None,
        angle: 0.0,
        mean: model.reading(set_point, &x) + Vector3::from_fn(|_, _| NOISE * random.normal()),
        covariance: Matrix3::identity() * NOISE * NOISE,
        samples: 6000,
    };
    model.experiment().set_points.iter().enumerate().map(row).collect()
}

/// The session with rests, and a change of bias of this uncertainty where one is stated.
fn with_rests(folder: &Path, bias_change: Option<&str>) {
    let file = folder.join("experiment.toml");
    let mut text = fs::read_to_string(&file).unwrap();
    if let Some(change) = bias_change {
        writeln!(text, "\n[uncertainty]\nbias_change = {change:?}").unwrap();
    }
    writeln!(text, "\n[[tumble]]\nrests = \"rests.csv\"").unwrap();
    fs::write(file, text).unwrap();
}

/// The rests sharpen bias, scale and misalignment, more on axes 2 and 3, and agree with the centrifuge; written reduced and read again
/// they give the same numbers.
#[test]
fn rests_and_centrifuge_are_one_fit() {
    let folder = tempfile::tempdir().unwrap();
    let alone = reduced_example(folder.path());
    let session = Session::read(folder.path()).unwrap();
    write_plateaus(&folder.path().join("rests.csv"), &rests(&session, &alone, &mut Random::new(2))).unwrap();
    with_rests(folder.path(), Some("0 mg"));
    let session = Session::read(folder.path()).unwrap();
    assert_eq!((session.rests().count(), session.mountings.len()), (26, 12));
    let together = calibrate(&session, &[], Method::Exact, &unwatched).unwrap();
    let gain = |name: &str| {
        let uncertainty = |result: &CalibrationResult| result.parameter(name).unwrap().standard_uncertainty.unwrap();
        uncertainty(&alone) / uncertainty(&together)
    };
    for name in ["df_1", "G0_11"] {
        assert!((1.3..4.0).contains(&gain(name)), "{name}: {}", gain(name));
    }
    for name in ["df_2", "df_3", "G0_22", "G0_33", "G0_32"] {
        assert!(gain(name) > 4.0, "{name}: {}", gain(name));
    }
    assert!(together.objections().is_empty(), "{:?}", together.objections());
    let recursive = calibrate(&session, &[], Method::Recursive, &unwatched).unwrap();
    for (one, other) in together.parameters.iter().zip(&recursive.parameters) {
        let (a, b, u) = (one.value.unwrap(), other.value.unwrap(), one.standard_uncertainty.unwrap());
        assert!((a - b).abs() < 1e-3 * u, "{}: {a} {b}", one.name);
    }
    let again = tempfile::tempdir().unwrap();
    write_reduced(&session, &reduce(&session, &unwatched).unwrap().1, None, TableFormat::Csv, again.path(), &unwatched)
        .unwrap();
    let reduced = calibrate(&Session::read(again.path()).unwrap(), &[], Method::Exact, &unwatched).unwrap();
    assert_eq!(reduced.parameters, together.parameters);
    // A table that has changed since it was read gives no result; one with another time and the same bytes does.
    let table = folder.path().join("rests.csv");
    let bytes = fs::read(&table).unwrap();
    let touched = || {
        let file = fs::File::options().write(true).open(&table).unwrap();
        file.set_modified(std::time::SystemTime::UNIX_EPOCH).unwrap();
        reduce(&session, &unwatched)
    };
    assert!(touched().is_ok());
    fs::write(&table, [&bytes[..], b"\n"].concat()).unwrap();
    let message = touched().unwrap_err().to_string();
    assert!(message.contains("rests.csv: found another file than was read before"), "{message}");
    // A watch knows the centrifuge alone.
    let on_arm = session.on_arm();
    assert_eq!((on_arm.rests().count(), on_arm.experiment.set_points.len()), (0, 108));
}

/// A unit that was switched off between the rests and the arm has another bias there. Unless the session states how far it may be, the
/// rests tell scale and misalignment alone, and the bias on the arm stays what the arm says.
#[test]
fn rests_after_a_switch_off_have_a_bias_of_their_own() {
    let change = Vector3::new(0.03, -0.02, 0.04);
    let calibrated = |bias_change: Option<&str>| {
        let folder = tempfile::tempdir().unwrap();
        let alone = reduced_example(folder.path());
        let session = Session::read(folder.path()).unwrap();
        let mut rests = rests(&session, &alone, &mut Random::new(4));
        for rest in &mut rests {
            rest.mean += change;
        }
        write_plateaus(&folder.path().join("rests.csv"), &rests).unwrap();
        with_rests(folder.path(), bias_change);
        let session = Session::read(folder.path()).unwrap();
        (alone, calibrate(&session, &[], Method::Exact, &unwatched).unwrap())
    };
    let estimate = |result: &CalibrationResult, name: &str| {
        let parameter = result.parameter(name).unwrap();
        (parameter.value.unwrap(), parameter.standard_uncertainty.unwrap())
    };
    for stated in [None, Some("5 mg")] {
        let (alone, together) = calibrated(stated);
        assert!(together.objections().is_empty(), "{stated:?}: {:?}", together.objections());
        for name in ["df_1", "df_2", "df_3", "G0_11", "G0_22", "G0_33"] {
            let ((before, u), (after, better)) = (estimate(&alone, name), estimate(&together, name));
            // The covariance of an estimate with a better one of the same data is that of the better one.
            let deviation = (after - before) / (u * u - better * better).sqrt();
            assert!(better < u && deviation.abs() < 4.0, "{stated:?} {name}: {deviation} {u} {better}");
        }
        for name in ["G0_22", "G0_33"] {
            assert!(estimate(&alone, name).1 / estimate(&together, name).1 > 2.0, "{stated:?} {name}");
        }
    }
    // Stated to be the same, it is not: the residuals say so.
    let (_, wrong) = calibrated(Some("0 mg"));
    assert!(!wrong.objections().is_empty());
}

/// Bias and scale matrix in axes of the case against their covariance, by many made tumbles on a table of attitudes. The readings come
/// from the equation itself: bias + scale matrix x specific force in the axes of the case.
#[test]
fn errors_in_axes_of_the_case_are_as_large_as_stated() {
    const RUNS: usize = 100;
    const UNCERTAINTY: f64 = 1e-3;
    const NAMES: [&str; 12] = [
        "df_1", "df_2", "df_3", "scale_11", "scale_12", "scale_13", "scale_21", "scale_22", "scale_23", "scale_31",
        "scale_32", "scale_33",
    ];
    let mut random = Random::new(12);
    let mut sum = 0.0;
    let folder = tempfile::tempdir().unwrap();
    let session = alone(&format!(
        "rests = \"rests.csv\"\nattitudes = \"attitudes.csv\"\nattitude_uncertainty = \"{UNCERTAINTY} rad\"\n"
    ));
    fs::write(folder.path().join("experiment.toml"), session).unwrap();
    for run in 0..RUNS {
        let mut normal = |size: f64| Vector3::from_fn(|_, _| size * random.normal());
        let bias = normal(0.2);
        let turn = Rotation3::from_scaled_axis(normal(0.02));
        let mut scale = Matrix3::zeros();
        for j in 0..3 {
            let column = normal(5e-3);
            (j..3).for_each(|i| scale[(i, j)] = column[i]);
        }
        let scale = (Matrix3::identity() + scale) * turn.matrix();
        let mut attitudes = "up_1,up_2,up_3\n".to_owned();
        let mut rests = Vec::new();
        for mounting in 0..12 + run % 12 {
            let stated = normal(1.0).normalize();
            writeln!(attitudes, "{},{},{}", stated[0], stated[1], stated[2]).unwrap();
            let tilt = normal(UNCERTAINTY);
            let up = Rotation3::from_scaled_axis(tilt - stated * stated.dot(&tilt)) * stated;
            rests.push(PlateauRow {
                mounting,
                speed: 0.0,
                speed_uncertainty: None,
                bend_z: None,
                angle: 0.0,
                mean: bias + scale * up * GRAVITY + normal(NOISE),
                covariance: Matrix3::identity() * NOISE * NOISE,
                samples: 6000,
            });
        }
        fs::write(folder.path().join("attitudes.csv"), attitudes).unwrap();
        write_plateaus(&folder.path().join("rests.csv"), &rests).unwrap();
        let session = Session::read(folder.path()).unwrap();
        let result = calibrate(&session, &[], Method::Exact, &unwatched).unwrap();
        let axes = Axes::Case.of(result, Path::new("result.json")).unwrap().axes.unwrap();
        let places = NAMES.map(|name| axes.parameters.iter().position(|p| p.name == name).unwrap());
        let truth: Vec<f64> = bias.iter().chain(scale.transpose().iter()).copied().collect();
        let error = DVector::from_fn(NAMES.len(), |a, _| axes.parameters[places[a]].value - truth[a]);
        let covariance = DMatrix::from_fn(NAMES.len(), NAMES.len(), |a, b| axes.covariance[places[a]][places[b]]);
        sum += error.dot(&covariance.cholesky().unwrap().solve(&error));
    }
    let count = (RUNS * NAMES.len()) as f64;
    let ratio = sum / count;
    // Four standard deviations of a mean of squares.
    assert!((ratio - 1.0).abs() < 4.0 * (2.0 / count).sqrt(), "{ratio}");
}

/// A plan of rests on the faces, edges and corners of a cube is the plan of rests that are measured there with the planned noise.
#[test]
fn planned_rests_are_those_that_will_be_measured() {
    const PLAN: &str = include_str!("../../../../examples/plans/four-positions.toml");
    let folder = tempfile::tempdir().unwrap();
    let plan = |tumble: &str| {
        let file = folder.path().join("plan.toml");
        fs::write(&file, format!("{PLAN}\n{tumble}")).unwrap();
        read_plan(&file).unwrap().unwrap()
    };
    let alone = plan("");
    for (durations, seconds) in [("", 60.0), ("duration = \"10 s\"", 10.0)] {
        let planned = plan(&format!("[[tumble]]\nattitudes = \"cube\"\n{durations}"));
        let weight = planned.noise.weight(0, seconds);
        let rows = cube_directions().into_iter().enumerate().map(|(mounting, up_b)| PlateauRow {
            mounting,
            speed: 0.0,
            speed_uncertainty: None,
            bend_z: None,
            angle: 0.0,
            mean: up_b * 9.81523,
            covariance: weight.covariance,
            samples: 600,
        });
        write_plateaus(&folder.path().join("rests.csv"), &rows.collect::<Vec<_>>()).unwrap();
        let measured = plan("[[tumble]]\nrests = \"rests.csv\"");
        assert_eq!(planned.weights.len(), alone.weights.len() + 26);
        assert_eq!(planned.weights, measured.weights);
        assert_eq!(planned.weights[..alone.weights.len()], alone.weights);
        let [a, b] = [&planned, &measured].map(|plan| plan.model.experiment());
        assert_eq!(a.set_points.len(), b.set_points.len());
        for (a, b) in a.set_points.iter().zip(&b.set_points) {
            let history = History { memory: b.history.memory, ..a.history };
            assert_eq!(SetPoint { history, ..*a }, *b);
            // Sums of forces up to 400 m/s^2, with the roundings below.
            assert!((a.history.memory - b.history.memory).amax() < 400.0 * 4.0 * f64::EPSILON);
        }
        for (a, b) in a.positions.iter().zip(&b.positions) {
            // The mean is the direction times gravity: a rounding of each component.
            assert!((a.p_zy - b.p_zy).amax() < 4.0 * f64::EPSILON, "{}", a.id);
        }
    }
    // Known attitudes are not free, and have the turn against the case.
    let known = plan("[[tumble]]\nattitudes = [[0, 0, 1], [0, 2, 0]]\nattitude_uncertainty = \"1 mrad\"");
    assert!(known.model.parameters().find("case_turn_1").is_some());
    let positions = &known.model.experiment().positions;
    assert_eq!(positions.last().unwrap(), &Position::known("r2", &Vector3::y(), 1e-3));
}

/// What is planned is not measured: a session with records or plateaus does not take it.
#[test]
fn planned_rests_are_no_measurement() {
    let folder = tempfile::tempdir().unwrap();
    reduced_example(folder.path());
    let file = folder.path().join("experiment.toml");
    let text = fs::read_to_string(&file).unwrap();
    fs::write(&file, format!("{text}\n[[tumble]]\nattitudes = \"cube\"\n")).unwrap();
    let session = Session::read(folder.path()).unwrap();
    let message = calibrate(&session, &[], Method::Exact, &unwatched).unwrap_err().to_string();
    let expected =
        "[[tumble]] 1, rests: found rests that are planned, expected a table of rests, in a session that is measured";
    assert!(message.ends_with(expected), "{message}");
}

/// Rests that are read, and rests that are still to be read or found, may have a bound of their own.
#[test]
fn a_bound_of_rests_needs_rests() {
    let folder = tempfile::tempdir().unwrap();
    let record = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/tumble/record.csv");
    let file = folder.path().join("experiment.toml");
    let tumble = format!("record = \"{}\"\n[[tumble]]\nrecord = \"{0}\"\nswitch_on = \"later\"", record.display());
    let stated = |bound: &str| alone(&tumble).replace("[unit]", &format!("{bound} = \"20 ppm\"\n[unit]"));
    fs::write(&file, stated("rests_scale")).unwrap();
    assert!(Session::read(folder.path()).is_ok(), "{:?}", Session::read(folder.path()).err());
    assert!(Session::read_before_rests(folder.path()).is_ok());
    fs::write(&file, stated("radius").replace("20 ppm", "20 um")).unwrap();
    // A laboratory may state the same quantities of all its sessions.
    assert!(Session::read(folder.path()).is_ok(), "{:?}", Session::read(folder.path()).err());
    fs::write(&file, stated("angle_tilt").replace("20 ppm", "20 urad")).unwrap();
    let message = Session::read(folder.path()).unwrap_err().to_string();
    assert!(message.contains("angle_tilt: found \"20 urad\", expected no such bound"), "{message}");
}

#[test]
fn what_is_no_table_of_rests_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    reduced_example(folder.path());
    with_rests(folder.path(), Some("0 mg"));
    let message = || Session::read(folder.path()).unwrap_err().to_string().replace('\\', "/");
    assert!(message().contains("rests.csv"), "{}", message());
    let file: PathBuf = folder.path().join("rests.csv");
    fs::copy(folder.path().join("plateaus.csv"), &file).unwrap();
    assert!(message().ends_with("expected 0 in a table of rests"), "{}", message());
}

/// Gravity at the place of rests [m/s^2].
const GRAVITY: f64 = 9.81523;

/// A session of rests alone, linear in the force, with these lines under `[[tumble]]`.
pub fn alone(tumble: &str) -> String {
    format!(
        r#"
[session]
title = "made"
date = ""
[site]
gravity = "{GRAVITY} m/s^2"
[uncertainty]
gravity = "0 m/s^2"
[unit]
serial = ""
output_unit = "m/s^2"
[model]
error_model = ["df_1", "df_2", "df_3", "G0_11", "G0_21", "G0_22", "G0_31", "G0_32", "G0_33"]
[[tumble]]
{tumble}"#
    )
}
