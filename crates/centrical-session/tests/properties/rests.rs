//! Rests in free attitudes in one session with a centrifuge.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use centrical::{Experiment, MeasurementModel, Mounting, Position, SetPoint};
use centrical_session::{
    CalibrationResult, Method, PlateauMean, Session, TableFormat, calibrate, reduce, unwatched, write_plateaus,
    write_reduced,
};
use nalgebra::{Matrix3, Vector3};

use crate::random::Random;

/// Of a rest of a minute [m/s^2].
const NOISE: f64 = 2.5e-5;

/// The example session, reduced, in `folder`; and its result.
fn reduced_example(folder: &Path) -> CalibrationResult {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/ta-200");
    let session = Session::read(&example).unwrap();
    let reduced = reduce(&session, &unwatched).unwrap();
    write_reduced(&session, &reduced, TableFormat::Csv, folder).unwrap();
    calibrate(&Session::read(folder).unwrap(), Method::Exact, &unwatched).unwrap()
}

/// Rests of the unit with these coefficients on the faces, edges and corners of a cube.
fn rests(session: &Session, result: &CalibrationResult, random: &mut Random) -> Vec<PlateauMean> {
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
    let row = |(mounting, set_point): (usize, &SetPoint)| PlateauMean {
        mounting,
        speed: 0.0,
        speed_uncertainty: None,
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
    let together = calibrate(&session, Method::Exact, &unwatched).unwrap();
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
    let recursive = calibrate(&session, Method::Recursive, &unwatched).unwrap();
    for (one, other) in together.parameters.iter().zip(&recursive.parameters) {
        let (a, b, u) = (one.value.unwrap(), other.value.unwrap(), one.standard_uncertainty.unwrap());
        assert!((a - b).abs() < 1e-3 * u, "{}: {a} {b}", one.name);
    }
    let again = tempfile::tempdir().unwrap();
    write_reduced(&session, &reduce(&session, &unwatched).unwrap(), TableFormat::Csv, again.path()).unwrap();
    let reduced = calibrate(&Session::read(again.path()).unwrap(), Method::Exact, &unwatched).unwrap();
    assert_eq!(reduced.parameters, together.parameters);
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
        (alone, calibrate(&session, Method::Exact, &unwatched).unwrap())
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
