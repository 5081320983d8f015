use centrical::ErrorModel;
use centrical::uncertainty::{Comparison, Compensated, Estimates, Test};
use centrical_compensate::gain;
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use crate::common::{Random, truth};
use crate::validity::{session, source_model};

const INSTRUMENT: std::ops::Range<usize> = 28..49;

fn calibrate(x: &[f64], random: &mut Random) -> Estimates {
    let model = source_model();
    let fit = crate::common::exact(&model, &session(&model, x, random)).unwrap();
    let covariance = DMatrix::from_fn(21, 21, |i, j| fit.covariance(28 + i, 28 + j).unwrap());
    Estimates { values: DVector::from_iterator(21, INSTRUMENT.map(|j| fit.value(j).unwrap())), covariance }
}

fn compare(first: &Estimates, second: &Estimates) -> Comparison {
    let names: Vec<String> = (1..=first.values.len()).map(|n| n.to_string()).collect();
    Comparison::of(&names, [first, second])
}

/// Calibrations of an unchanged unit agree as often as they say. Joint chi^2 has mean 21, and `|E_n| > 1` is as seldom as two
/// standard uncertainties, which is in every other pair. On average 0.4 of 40 pairs are said to disagree, more than 3 in one
/// case of a thousand. A bias that has moved by eight is found, by its own `E_n` and by the joint test.
#[test]
fn unchanged_units_agree_and_changes_show() {
    const PAIRS: usize = 40;
    let (model, mut random) = (source_model(), Random::new(31));
    let x = truth(&model, 1.0, &mut random);
    let (mut sum, mut beyond, mut disagree, mut pairs_beyond) = (0.0, 0, 0, 0);
    for _ in 0..PAIRS {
        let comparison = compare(&calibrate(&x, &mut random), &calibrate(&x, &mut random));
        assert_eq!(comparison.differences.len(), 21);
        sum += comparison.chi_squared.unwrap();
        let beyond_of_pair = comparison.differences.iter().filter(|d| d.e_n.abs() > 1.0).count();
        beyond += beyond_of_pair;
        pairs_beyond += usize::from(beyond_of_pair > 0);
        disagree += usize::from(!comparison.agrees());
    }
    assert!(disagree <= 3 && pairs_beyond > 10, "{disagree} disagree; {pairs_beyond} have E_n beyond 1");
    // Four standard deviations of chance; correlated parameters widen the second by no more than their number.
    let mean = sum / PAIRS as f64;
    assert!((mean - 21.0).abs() < 4.0 * (42.0 / PAIRS as f64).sqrt(), "{mean}");
    assert!(beyond < 90, "{beyond} of 840, 38 expected");

    let before = calibrate(&x, &mut random);
    let mut moved = x.clone();
    moved[28] += 8.0 * (2.0 * before.covariance[(0, 0)]).sqrt();
    let comparison = compare(&before, &calibrate(&moved, &mut random));
    assert!(comparison.differences[0].e_n > 1.0 && comparison.differences[0].is_real() && !comparison.agrees());
    assert!(comparison.probability.unwrap() < 1e-4);
}

/// Differences, `E_n` and probabilities of values without correlation.
#[test]
fn differences_are_over_their_uncertainties() {
    let of =
        |values: [f64; 2]| Estimates { values: DVector::from_row_slice(&values), covariance: DMatrix::identity(2, 2) };
    let comparison = compare(&of([1.0, 3.0]), &of([1.0, 5.0]));
    let found: Vec<(&str, f64)> = comparison.differences.iter().map(|d| (d.name.as_str(), d.difference)).collect();
    assert_eq!(found, [("1", 0.0), ("2", 2.0)]);
    assert!((comparison.differences[1].e_n - 0.5 * 2.0_f64.sqrt()).abs() < 1e-15);
    assert!((comparison.chi_squared.unwrap() - 2.0).abs() < 1e-12);
    // Normal law, two-sided at sqrt(2): 0.157299; of two parameters.
    assert!((comparison.differences[1].probability - 2.0 * 0.157_299).abs() < 1e-6);
}

/// A calibration against itself: nothing has changed, for certain. The ends of chi^2 are probabilities too.
#[test]
fn a_calibration_agrees_with_itself() {
    let own = calibrate(&truth(&source_model(), 1.0, &mut Random::new(32)), &mut Random::new(34));
    let comparison = compare(&own, &own);
    assert_eq!((comparison.chi_squared, comparison.probability), (Some(0.0), Some(1.0)));
    assert!(comparison.agrees() && comparison.differences.iter().all(|d| d.probability == 1.0));
    let nothing = Estimates { values: DVector::zeros(0), covariance: DMatrix::zeros(0, 0) };
    assert!(!compare(&nothing, &nothing).agrees(), "nothing in common");
    for (chi_squared, probability) in [(0.0, 1.0), (-1e-9, 1.0), (f64::INFINITY, 0.0), (f64::NAN, 0.0)] {
        assert_eq!(Test::chi_squared(chi_squared, 21).probability, probability);
    }
    assert_eq!(Test::chi_squared(1e9, 21).probability, 0.0);
}

/// The uncertainty of a compensated reading against the scatter of readings compensated with drawn coefficients.
#[test]
fn compensated_readings_scatter_as_stated() {
    const DRAWS: usize = 4000;
    let (model, mut random) = (source_model(), Random::new(33));
    let x = truth(&model, 1.0, &mut random);
    let calibration = calibrate(&x, &mut random);
    let error_model = ErrorModel::kozlov_2017();
    let compensated =
        Compensated::new(error_model.with_coefficients(calibration.values.as_slice()), calibration.covariance.clone())
            .unwrap();
    let factor = calibration.covariance.clone().cholesky().unwrap().l();
    for f in [Vector3::new(0.0, 0.0, 9.8), Vector3::new(900.0, -300.0, 500.0), Vector3::new(-1900.0, 50.0, 100.0)] {
        let reading = error_model.reading(calibration.values.as_slice(), &f);
        let mut squares = Vector3::zeros();
        for _ in 0..DRAWS {
            let step = &factor * DVector::from_fn(21, |_, _| random.normal());
            let drawn: Vec<f64> = calibration.values.iter().zip(step.iter()).map(|(c, d)| c + d).collect();
            let mut solved = f;
            for _ in 0..3 {
                let gain = Matrix3::from(gain(&error_model.with_coefficients(&drawn), solved.into())).transpose();
                solved -= gain.lu().solve(&(error_model.reading(&drawn, &solved) - reading)).unwrap();
            }
            squares += (solved - f).map(|e| e * e);
        }
        let stated = compensated.covariance(&f).unwrap();
        for i in 0..3 {
            let ratio = (squares[i] / DRAWS as f64 / stated[(i, i)]).sqrt();
            // Four standard deviations of chance.
            assert!((ratio - 1.0).abs() < 4.0 / (2.0 * DRAWS as f64).sqrt(), "axis {i} at {f:?}: {ratio}");
        }
    }
    let curve = compensated.curve(&Vector3::x(), 2000.0, 41);
    assert_eq!((curve.len(), curve[20].force), (41, 0.0));
    let bias = calibration.covariance[(0, 0)].sqrt();
    assert!((curve[20].along / bias - 1.0).abs() < 0.01, "without force only the bias is left");
}
