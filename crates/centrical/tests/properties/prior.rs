//! Priors are rows like any other, and what rests on them is said.

use centrical::ThirdPosition::AxisOneUp;
use centrical::{
    Combination, ErrorModel, Extension, Extra, Law, MeasurementModel, PairRelation, PriorError, Study, Weight,
};

use crate::common::{Random, experiment, kozlov, observations, truth};

fn opposite() -> MeasurementModel {
    kozlov(experiment(AxisOneUp, PairRelation::Opposite, &[1.0, 0.5]))
}

fn index(model: &MeasurementModel, name: &str) -> usize {
    model.parameters().find(name).unwrap()
}

/// A prior on the lost dimensions restores the rank; the values that rest on it say so, and no others.
#[test]
fn what_rests_on_a_prior_is_said() {
    let mut random = Random::new(40);
    let model = opposite().with_prior("proof mass", 2e-5).unwrap();
    let mut x = truth(&model, 1.0, &mut random);
    // Two combinations of geometry come from the prior: the truth has the proof masses where the drawing has them.
    x[index(&model, "drho_22")] = 0.0;
    x[index(&model, "drho_33")] = 0.0;
    let fit = crate::common::exact(&model, &observations(&model, &x)).unwrap();
    assert_eq!(fit.observability().rank(), 49);
    let resting: Vec<&str> =
        (0..49).filter(|&j| fit.rests_on_prior(j)).map(|j| model.parameters()[j].name.as_str()).collect();
    assert_eq!(resting, ["dR_2[A]", "dR_1[B]", "dR_2[B]", "dR_1[C]", "drho_22", "drho_33"]);
    for j in 0..49 {
        let (share, name) = (fit.prior_share(j).unwrap(), &model.parameters()[j].name);
        assert!(if fit.rests_on_prior(j) { share > 0.5 } else { share < 0.5 }, "{name}: {share}");
        let error = (fit.value(j).unwrap() - x[j]).abs();
        assert!(error < 1e-6 * model.parameters()[j].typical, "{name}: {error:e}");
    }
    let uses = fit.prior_uses();
    assert_eq!(uses.len(), 2);
    assert!(uses.iter().all(|(_, ratio)| (0.5..=1.0).contains(ratio)), "{uses:?}");
    assert!(!fit.null_directions_held);
}

/// The covariance with a prior is that of the data corrected by it: `C - C e e^T C / (sigma^2 + C_jj)`. A prior far
/// above what the data give changes nothing, one far below takes over.
#[test]
fn a_prior_is_one_more_measurement() {
    let mut random = Random::new(41);
    let model = kozlov(experiment(AxisOneUp, PairRelation::Common, &[1.0, 0.5]));
    let x = truth(&model, 0.1, &mut random);
    let data = observations(&model, &x);
    let without = crate::common::linear(&model, &data).unwrap();
    let k = index(&model, "drho_22");
    let spread = without.standard_uncertainty(k).unwrap();
    for (sigma, share) in [(1e3 * spread, 0.0), (spread, 0.5), (1e-3 * spread, 1.0)] {
        let with = crate::common::linear(&model.clone().with_prior("drho_22", sigma).unwrap(), &data).unwrap();
        for i in 0..49 {
            for j in 0..49 {
                let c = |a: usize, b: usize| without.covariance(a, b).unwrap();
                let expected = c(i, j) - c(i, k) * c(j, k) / (sigma * sigma + c(k, k));
                let size = (c(i, i) * c(j, j)).sqrt();
                assert!((with.covariance(i, j).unwrap() - expected).abs() < 1e-6 * size);
            }
        }
        assert!((with.prior_share(k).unwrap() - share).abs() < 1e-5);
        assert!(!with.rests_on_prior(k), "the data alone determine it");
        let ratio = with.prior_uses()[0].1;
        assert!((ratio - 1.0 / (1.0 + (sigma / spread).powi(2)).sqrt()).abs() < 1e-6);
        assert_eq!(with.degrees_of_freedom, without.degrees_of_freedom + 1);
    }
}

/// A study predicts the covariance that the fit then has.
#[test]
fn study_predicts_the_fit() {
    let model = opposite().with_prior("drho", 1e-4).unwrap();
    let zero = vec![0.0; 49];
    let data = observations(&model, &zero);
    let fit = crate::common::linear(&model, &data).unwrap();
    let study = Study::at_zero(model.clone(), data.iter().map(Weight::from).collect()).unwrap();
    for j in 0..49 {
        let (predicted, found) = (study.standard_uncertainty(j).unwrap(), fit.standard_uncertainty(j).unwrap());
        assert!((predicted / found - 1.0).abs() < 1e-6);
        assert!((study.prior_share(j).unwrap() - fit.prior_share(j).unwrap()).abs() < 1e-6);
        assert_eq!(study.rests_on_prior(j), fit.rests_on_prior(j));
    }
    let seen = Combination::parse("dR_2[A] + drho_22", model.parameters()).unwrap();
    let alone = study.standard_uncertainty(index(&model, "drho_22")).unwrap();
    assert!(study.observability().standard_uncertainty(&seen).unwrap() < 0.1 * alone);
}

#[test]
fn priors_that_cannot_be_are_refused() {
    let refused = |name: &str, sigma: f64| opposite().with_prior(name, sigma).unwrap_err();
    assert!(matches!(refused("dR_3[A]", 1e-4), PriorError::Unknown { .. }));
    assert!(matches!(refused("", 1e-4), PriorError::Unknown { .. }));
    for sigma in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(refused("drho", sigma), PriorError::NotPositive { .. }));
    }
    let twice = opposite().with_prior("drho_22", 1e-4).unwrap().with_prior("proof mass", 1e-4);
    assert!(matches!(twice, Err(PriorError::Duplicate { .. })));
    let both_laws = [Extension::ElasticTurn(Law::Speed), Extension::ElasticTurn(Law::Load)];
    let mixed = MeasurementModel::new(
        experiment(AxisOneUp, PairRelation::Common, &[1.0, 0.5]),
        ErrorModel::kozlov_2017(),
        &both_laws,
    );
    assert!(matches!(mixed.with_prior("elastic turn", 1e-6), Err(PriorError::MixedUnits { .. })));
}

/// Every optional group is fitted by the exact model: noise-free means give all its parameters back.
#[test]
fn optional_groups_are_recovered() {
    let mut random = Random::new(42);
    let kozlov = ErrorModel::kozlov_2017;
    let mut cases: Vec<(ErrorModel, Vec<Extension>)> =
        Extension::NAMED.iter().map(|(_, extension)| (kozlov(), vec![*extension])).collect();
    cases.push((kozlov().with(Extra::OddQuadratic), vec![]));
    cases.push((kozlov().with(Extra::CrossProducts), vec![]));
    cases.push((kozlov(), vec![Extension::ArmStretch(Law::Speed), Extension::ArmStretch(Law::Load)]));
    // Of these some direction is lost: ranks are tested in `rank_table.rs`.
    let mut lossy = Vec::new();
    for (error_model, extensions) in cases {
        let experiment = experiment(AxisOneUp, PairRelation::Common, &[1.0, 0.5]);
        let model = MeasurementModel::new(experiment, error_model, &extensions);
        // Null space and estimability are tested elsewhere: here every estimable parameter must come back.
        let x = truth(&model, 0.5, &mut random);
        let fit = crate::common::exact(&model, &observations(&model, &x)).unwrap();
        if fit.observability().lost() > 0 {
            lossy.push(extensions);
            continue;
        }
        for (j, parameter) in model.parameters().iter().enumerate() {
            if let Some(value) = fit.value(j) {
                // What is known to many typical magnitudes only is estimated where the model was linearised.
                let size = parameter.typical.max(fit.standard_uncertainty(j).unwrap());
                let error = (value - x[j]).abs() / size;
                assert!(error < 1e-5, "{extensions:?} {}: {error:e}", parameter.name);
            }
        }
    }
    let expected = [
        Extension::SeatLateral,
        Extension::PositionShift,
        Extension::MountingShift,
        Extension::MountingTurn,
        Extension::MountingBias,
        Extension::MountingScale,
        Extension::SpinTurn,
        // A shift of the unit is one of all proof masses.
        Extension::ProofMasses,
    ];
    assert_eq!(lossy, expected.map(|extension| vec![extension]));
}
