//! The history of a unit whose sessions had priors: what the data say of it, and nothing of what the priors say.

use std::fs;

use centrical::{Group, unwatched};
use centrical_session::{
    CalibrationResult, Depth, Method, Row, RowPrior, Selection, Session, Store, TermSummary, UnitHistoryReport,
    UnitHistoryRequest, calibrate, read_calibrations, unit_history,
};
use nalgebra::{DMatrix, DVector};
use tempfile::TempDir;

use crate::random::Random;

/// Parameters of the unit; the first two have priors.
const P: usize = 4;

/// Their names, and the newtonometers and components that they belong to.
const NAMES: [(&str, usize, usize); P] = [("G0_11", 1, 1), ("G0_21", 2, 1), ("G0_22", 2, 2), ("G0_31", 3, 1)];

/// Standard uncertainties of the priors, where the data by themselves give about 1.
const PRIORS: [f64; 2] = [0.5, 0.1];

/// What the data of one session say: information and estimate.
struct Measured {
    information: DMatrix<f64>,
    estimate: DVector<f64>,
}

/// A session whose data determine all parameters, or all but the second.
fn measured(truth: &DVector<f64>, determines_second: bool, random: &mut Random) -> Measured {
    let mut design = DMatrix::from_fn(12, P, |_, _| 0.5 * random.normal());
    if !determines_second {
        design.column_mut(1).fill(0.0);
    }
    let noise = DVector::from_fn(12, |_, _| random.normal());
    let information = design.transpose() * &design;
    let estimate = design.transpose() * (&design * truth + noise);
    // Of a session that determines them all the estimate; else the right side of its normal equations.
    let estimate = if determines_second { information.clone().cholesky().unwrap().solve(&estimate) } else { estimate };
    Measured { information, estimate }
}

fn term((name, axis, component): (&str, usize, usize)) -> TermSummary {
    let powers = [1, 2, 3].map(|j| u8::from(j == component));
    TermSummary { name: name.to_owned(), axis, powers, sign_of: None }
}

fn row(n: usize, values: &DVector<f64>, covariance: &DMatrix<f64>) -> Row {
    let triangle = (0..P).flat_map(|i| (0..=i).map(move |j| (i, j)));
    Row {
        key: format!("{n:064x}"),
        unit_model: "TA".to_owned(),
        unit_serial: "1".to_owned(),
        date: format!("{}-03-05", 2010 + n),
        acceptable: true,
        range: vec![9.8; 3],
        parameters: NAMES.map(|(name, ..)| name.to_owned()).to_vec(),
        units: vec!["1".to_owned(); P],
        groups: vec![Group::Scale; P],
        values: values.iter().copied().collect(),
        standard_uncertainties: (0..P).map(|j| covariance[(j, j)].sqrt()).collect(),
        covariance: triangle.map(|(i, j)| covariance[(i, j)]).collect(),
        terms: NAMES.map(term).to_vec(),
        shared_known: true,
        priors_known: true,
        ..Row::default()
    }
}

/// The same session estimated with the priors, which are off by `mean` from zero.
fn with_priors(n: usize, data: &Measured, right_side: &DVector<f64>, mean: [f64; 2]) -> Row {
    let weight = |j: usize| if j < 2 { PRIORS[j].powi(-2) } else { 0.0 };
    let information = &data.information + DMatrix::from_diagonal(&DVector::from_fn(P, |j, _| weight(j)));
    let covariance = information.try_inverse().unwrap();
    let pulled = right_side + DVector::from_fn(P, |j, _| if j < 2 { weight(j) * mean[j] } else { 0.0 });
    let priors = (0..2).map(|j| RowPrior {
        parameter: NAMES[j].0.to_owned(),
        mean: mean[j],
        standard_uncertainty: PRIORS[j],
        changes: (covariance.column(j) / PRIORS[j]).iter().copied().collect(),
    });
    Row { priors: priors.collect(), ..row(n, &(&covariance * pulled), &covariance) }
}

fn history(rows: Vec<Row>) -> UnitHistoryReport {
    let folder = TempDir::new().unwrap();
    Store::create(folder.path()).unwrap().add(rows).unwrap();
    let selection = Selection { depth: Depth::Whole, ..Selection::default() };
    let calibrations = read_calibrations(&[folder.path().to_owned()], &selection, &unwatched).unwrap().calibrations;
    let request = UnitHistoryRequest::default();
    unit_history(&calibrations, &[], request).unwrap()
}

#[track_caller]
fn assert_close(found: f64, expected: f64, size: f64) {
    assert!((found - expected).abs() < 1e-7 * size, "{found} {expected}");
}

/// Sessions with priors have the same history as the same data without: components between sessions, drifts, forecasts, the test of all
/// parameters together. With the priors in it the component of the second parameter would be a hundredth.
#[test]
fn priors_leave_no_trace_in_a_history() {
    let mut random = Random::new(11);
    let truth = DVector::from_vec(vec![0.3, -0.2, 1.0, 2.0]);
    let (mut without, mut with) = (Vec::new(), Vec::new());
    for n in 0..8 {
        let change = DVector::from_fn(P, |j, _| [3.0, 3.0, 3.0, 0.0][j] * random.normal());
        let data = measured(&(&truth + change), true, &mut random);
        without.push(row(n, &data.estimate, &data.information.clone().try_inverse().unwrap()));
        with.push(with_priors(n, &data, &(&data.information * &data.estimate), [0.2, -0.1]));
    }
    let stated = with.iter().map(|row| row.values[1]).fold(0.0_f64, |largest, value| largest.max(value.abs()));
    assert!(stated < 0.5, "the priors are strong: {stated}");
    let (without, with) = (history(without), history(with));
    assert!(without.parameters[1].between.unwrap() > 1.0);
    for (found, expected) in with.parameters.iter().zip(&without.parameters) {
        assert_close(found.between.unwrap(), expected.between.unwrap(), 1.0);
        assert_close(found.variance_ratio.unwrap(), expected.variance_ratio.unwrap(), 10.0);
        assert_close(found.slope_per_year.unwrap(), expected.slope_per_year.unwrap(), 1.0);
        assert_close(found.slope_uncertainty.unwrap(), expected.slope_uncertainty.unwrap(), 1.0);
        for end in 0..2 {
            assert_close(found.forecast.unwrap()[end], expected.forecast.unwrap()[end], 10.0);
        }
        assert_close(found.e_n_first, expected.e_n_first, 1.0);
    }
    assert_close(with.sameness.unwrap().chi_squared, without.sameness.unwrap().chi_squared, 1000.0);
    // The stated uncertainty stays that of the result.
    assert!(with.parameters[1].standard_uncertainties[0].unwrap() < 0.11);
}

/// Sessions say nothing of a parameter that priors alone determine, and of the others what they say without it.
#[test]
fn what_rests_on_priors_has_no_component() {
    let mut random = Random::new(12);
    let truth = DVector::from_vec(vec![0.3, 0.05, 1.0, 2.0]);
    let (mut with, mut known) = (Vec::new(), Vec::new());
    for n in 0..6 {
        let change = DVector::from_fn(P, |j, _| if j == 2 { 4.0 * random.normal() } else { 0.0 });
        let data = measured(&(&truth + change), false, &mut random);
        with.push(with_priors(n, &data, &data.estimate, [0.0, 0.0]));
        let others = [0, 2, 3];
        let information = DMatrix::from_fn(3, 3, |i, j| data.information[(others[i], others[j])]);
        let covariance = information.try_inverse().unwrap();
        let values = &covariance * DVector::from_fn(3, |i, _| data.estimate[others[i]]);
        let place = |j: usize| others.iter().position(|other| *other == j);
        let all = DMatrix::from_fn(P, P, |i, j| place(i).zip(place(j)).map_or(f64::NAN, |at| covariance[at]));
        known.push(row(n, &DVector::from_fn(P, |j, _| place(j).map_or(f64::NAN, |at| values[at])), &all));
    }
    let (with, known) = (history(with), history(known));
    let named = |report: &UnitHistoryReport, name: &str| report.parameters.iter().find(|p| p.name == name).cloned();
    let lost = named(&with, "G0_21").unwrap();
    assert!(lost.between.is_none() && lost.slope_per_year.is_none() && lost.forecast.is_none());
    assert!(lost.values.iter().all(|value| value.unwrap().abs() < 1e-9) && named(&known, "G0_21").is_none());
    for name in ["G0_11", "G0_22", "G0_31"] {
        let (found, expected) = (named(&with, name).unwrap(), named(&known, name).unwrap());
        assert_close(found.between.unwrap(), expected.between.unwrap(), 1.0);
        assert_close(found.slope_uncertainty.unwrap(), expected.slope_uncertainty.unwrap(), 1.0);
    }
    assert_close(with.sameness.unwrap().chi_squared, known.sameness.unwrap().chi_squared, 100.0);
}

/// Priors of a real session, which the fit weighs beside its readings: taken out again they leave what the readings say without them.
#[test]
fn priors_of_a_session_are_taken_out_of_its_row() {
    let example = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/ta-200");
    let plain = Session::read(example.as_ref()).unwrap();
    let folder = TempDir::new().unwrap();
    let text = fs::read_to_string(format!("{example}/experiment.toml")).unwrap();
    let text = text
        .replace("records/", &format!("{example}/records/"))
        .replace("telemetry/", &format!("{example}/telemetry/"));
    let prior = "\n[prior]\nG1_33 = { mean = \"-0.9 ug/g^2\", standard_uncertainty = \"0.03 ug/g^2\" }\nG0_22 = { mean = \"1085 ppm\", standard_uncertainty = \"8 ppm\" }\nalpha_1 = \"1 mrad\"\n";
    fs::write(folder.path().join("experiment.toml"), text + prior).unwrap();
    let drawn = Session::read(folder.path()).unwrap();
    let results = [plain, drawn].map(|session| calibrate(&session, &[], Method::Exact, &unwatched).unwrap());
    let rows = results.each_ref().map(|result: &CalibrationResult| result.row(result.to_json().unwrap().as_bytes()));
    // That of the machine is a part of the session.
    let names: Vec<&str> = rows[1].priors.iter().map(|prior| prior.parameter.as_str()).collect();
    assert_eq!((rows[0].priors.len(), names), (0, vec!["G0_22", "G1_33"]));
    let [place, other] = ["G1_33", "G0_22"].map(|name| rows[0].index(name).unwrap());
    let u = |row: &Row, j: usize| row.standard_uncertainties[j];
    assert!(u(&rows[1], place) < 0.8 * u(&rows[0], place) && u(&rows[1], other) < 0.8 * u(&rows[0], other));
    // Two sessions of the same readings: without priors, and with priors that are taken out. They differ by the curvature of the model, and by
    // what the prior of the machine says, a hundred times weaker than the readings.
    let [mut first, mut second] = rows;
    (first.date, second.date) = ("2026-01-01".to_owned(), "2027-01-01".to_owned());
    let (shift, size) = (second.values[place] - first.values[place], u(&first, place));
    let report = history(vec![first, second]);
    let found = report.parameters.iter().find(|p| p.name == "G1_33").unwrap();
    assert!((found.values[1].unwrap() - found.values[0].unwrap() - shift).abs() < 1e-12 * size);
    // `E_n` is of the data: the difference over twice the root of the sum of both variances.
    assert!(found.e_n_first.abs() < 1e-3, "{} of {}", found.e_n_first, shift / size);
}
