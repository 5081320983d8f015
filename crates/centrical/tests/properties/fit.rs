use centrical::ThirdPosition::{AxisOneDown, AxisOneUp};
use centrical::{Calibration, Data, FitError, PairRelation, STANDARD_GRAVITY, Termination};

use crate::common::{Random, experiment, kozlov, observations, truth};

/// Largest error of an estimable parameter over the typical size of its kind.
fn worst(model: &centrical::MeasurementModel, fit: &centrical::Fit, x: &[f64]) -> f64 {
    let errors = model.parameters().iter().zip(x).enumerate();
    errors.filter_map(|(j, (p, truth))| Some((fit.value(j)? - truth).abs() / p.typical)).fold(0.0, f64::max)
}

/// Noise-free exact means give every estimable parameter back, from a start at zero, whatever the pair relation,
/// the number of radii and `P_3`; the linear fit alone shows its second-order error.
#[test]
fn noise_free_means_are_recovered() {
    let mut random = Random::new(1);
    for (relation, rank, estimable) in [(PairRelation::Common, 49, 49), (PairRelation::Opposite, 47, 43)] {
        for third in [AxisOneUp, AxisOneDown] {
            for radii in [&[1.0, 0.5][..], &[1.0, 0.75, 0.5][..]] {
                let model = kozlov(experiment(third, relation, radii));
                let x = truth(&model, 1.0, &mut random);
                let data = observations(&model, &x);
                let exact = crate::common::exact(&model, &data).unwrap();
                assert_eq!(exact.termination, Termination::Converged);
                assert_eq!(exact.observability().rank(), rank);
                assert_eq!((0..49).filter(|&j| exact.value(j).is_some()).count(), estimable);
                assert!((28..49).all(|j| exact.value(j).is_some()), "all 21 of the instrument");
                assert!(!exact.null_directions_held);
                let error = worst(&model, &exact, &x);
                assert!(error < 1e-10, "{relation:?} {third:?} {radii:?}: {error:e}");
                let linear = worst(&model, &crate::common::linear(&model, &data).unwrap(), &x);
                assert!(linear > 1e-3, "the linear fit should be off to second order, found {linear:e}");
            }
        }
    }
}

/// The second-order error of the linear fit has the size that docs/source-and-findings.md states: with parameters
/// up to about 1e-3 rad, 0.5 mm, 1e-3, 1e-5 /g, 1e-7 /g^2 (drawn with half of that) residuals of about 20 ug RMS.
#[test]
fn linear_fit_shows_the_second_order_error() {
    let mut random = Random::new(3);
    let mut experiment = experiment(AxisOneUp, PairRelation::Common, &[1.0, 0.5]);
    experiment.centrifuge.speed_uncertainty = 0.0;
    let model = kozlov(experiment);
    let x = truth(&model, 0.5, &mut random);
    let linear = crate::common::linear(&model, &observations(&model, &x)).unwrap();
    let squares: f64 = linear.residuals.iter().map(nalgebra::Matrix::norm_squared).sum();
    let rms = (squares / (3 * linear.residuals.len()) as f64).sqrt() / (1e-6 * STANDARD_GRAVITY);
    assert!((5.0..80.0).contains(&rms), "{rms} ug");
}

/// Parameters of zero leave the lost combinations without a trace: they are held, and the fit still ends well.
#[test]
fn a_perfect_unit_is_no_trouble() {
    let model = kozlov(experiment(AxisOneUp, PairRelation::Opposite, &[1.0, 0.5]));
    let fit = crate::common::exact(&model, &observations(&model, &[0.0; 49])).unwrap();
    assert_eq!(fit.termination, Termination::Converged);
    assert!(fit.null_directions_held);
    assert!(worst(&model, &fit, &[0.0; 49]) < 1e-12);
}

/// The uncertainties after the last plateau are those of the fit, and no plateau makes one larger.
#[test]
fn uncertainties_converge_to_those_of_the_fit() {
    let mut random = Random::new(5);
    let model = kozlov(experiment(AxisOneUp, PairRelation::Common, &[1.0, 0.5]));
    let data = observations(&model, &truth(&model, 1.0, &mut random));
    let data = Data::new(&model, data).unwrap();
    let calibration = Calibration::exact(&data).unwrap();
    let (fit, stages) = (calibration.fit(), calibration.convergence(30).unwrap());
    assert!(stages.len() <= 30 && stages.last().unwrap().plateaus == data.observations().len());
    for pair in stages.windows(2) {
        for (before, after) in pair[0].standard_uncertainty.iter().zip(&pair[1].standard_uncertainty) {
            let (before, after) = (before.unwrap(), after.unwrap());
            assert!(after <= before * (1.0 + 1e-9), "{before} {after}");
        }
    }
    // What the start knows, ten typical magnitudes, is many thousand times less than what the data say.
    for (j, sigma) in stages.last().unwrap().standard_uncertainty.iter().enumerate() {
        let of_fit = fit.standard_uncertainty(j).unwrap();
        let sigma = sigma.unwrap();
        assert!((sigma / of_fit - 1.0).abs() < 1e-4, "{j}: {sigma} {of_fit}");
    }
}

/// Bad observations are refused with the plateau named, never fitted.
#[test]
fn bad_observations_are_refused() {
    let model = kozlov(experiment(AxisOneUp, PairRelation::Common, &[1.0, 0.5]));
    let good = observations(&model, &[0.0; 49]);
    assert_eq!(crate::common::exact(&model, &[]), Err(FitError::Empty));
    let mut bad = good.clone();
    bad[7].mean[1] = f64::NAN;
    assert_eq!(crate::common::exact(&model, &bad), Err(FitError::NotFinite { set_point: 7 }));
    let mut bad = good.clone();
    bad[5].covariance[(0, 0)] = -1e-8;
    assert!(matches!(crate::common::exact(&model, &bad), Err(FitError::Covariance { set_point: 5, .. })));
    let mut bad = good;
    bad[0].set_point = 1000;
    assert_eq!(crate::common::linear(&model, &bad), Err(FitError::Unknown { set_point: 1000, count: 108 }));
}
