//! Calibrations with rests in attitudes of their own, repeated: each run draws the attitudes, the change of the bias and gravity anew.

use centrical::ThirdPosition::AxisOneUp;
use centrical::observability::cube_directions;
use centrical::uncertainty::{MonteCarlo, Settings};
use centrical::{
    Data, Effect, Experiment, MeasurementModel, Mounting, PairRelation, Position, SetPoint, SwitchOn, TypeB, unwatched,
};
use nalgebra::Vector3;

use crate::common::{Random, experiment, kozlov, observations, truth};

const RUNS: usize = 80;

/// The usual arm, or none, with rests of a cube in this many switch-ons; attitudes are known to `uncertainty` [rad] or free.
fn with_cube(has_arm: bool, uncertainty: Option<f64>, switch_ons: usize) -> Experiment {
    let mut experiment = experiment(AxisOneUp, PairRelation::Common, &[1.0, 0.5]);
    if !has_arm {
        experiment.positions.clear();
        experiment.mountings.clear();
        experiment.set_points.clear();
    }
    for (n, up) in cube_directions().iter().enumerate() {
        let id = format!("r{}", n + 1);
        experiment.set_points.push(SetPoint::at_rest(experiment.mountings.len(), 0.0));
        experiment.mountings.push(Mounting { position: experiment.positions.len(), arm_y: Vector3::zeros() });
        let position = match uncertainty {
            Some(uncertainty) => Position::known(id, up, uncertainty),
            None => Position::free(id, up),
        };
        let number = 1 + n % switch_ons;
        let bias_change = (number == 2).then_some(5e-4);
        experiment.positions.push(position.in_switch_on(SwitchOn { number, bias_change, from_axes: 0.0 }));
    }
    experiment
}

fn repeated(model: &MeasurementModel) -> MonteCarlo {
    let x = truth(model, 1.0, &mut Random::new(5));
    let data = Data::new(model, observations(model, &x)).unwrap();
    let settings = Settings { runs: RUNS, seed: 8, coverage: 0.95, is_linear: false };
    MonteCarlo::of(&data, &x, &settings, &unwatched).unwrap()
}

/// Each switch-on but that of the arm, or the first, has a change of bias of its own.
#[test]
fn changes_of_bias_are_those_of_other_switch_ons() {
    let changes = |has_arm: bool, switch_ons: usize| -> Vec<(Effect, f64)> {
        let stated = TypeB { bias_change: 2e-3, ..TypeB::default() };
        let model = kozlov(with_cube(has_arm, None, switch_ons)).with_stated(stated);
        model.influences().iter().map(|influence| (influence.effect, influence.standard_uncertainty)).collect()
    };
    let of = |switch_on: usize, u: f64| (0..3).map(move |axis| (Effect::change_of_bias(axis, switch_on), u));
    assert_eq!(changes(false, 1), []);
    assert_eq!(changes(true, 1), of(1, 2e-3).collect::<Vec<_>>());
    assert_eq!(changes(false, 3), of(2, 5e-4).chain(of(3, 2e-3)).collect::<Vec<_>>());
    assert_eq!(changes(true, 3), of(1, 2e-3).chain(of(2, 5e-4)).chain(of(3, 2e-3)).collect::<Vec<_>>());
}

/// The squared error over the covariance is that of the number of unknowns, and so is chi^2, each within its sampling error: free
/// attitudes and known ones, with an arm after a switch-off and alone, all in one switch-on or in three.
#[test]
fn errors_of_repeated_rests_are_as_large_as_stated() {
    for (has_arm, switch_ons) in [(false, 1), (false, 3), (true, 1), (true, 3)] {
        for uncertainty in [None, Some(1e-3)] {
            let stated = TypeB { gravity: 1e-4, bias_change: 2e-3, ..TypeB::default() };
            let mut model = kozlov(with_cube(has_arm, uncertainty, switch_ons));
            if !has_arm {
                // Of rests alone squares of the reading look like biases.
                let mut error_model = model.error_model().clone();
                error_model.terms.retain(|term| term.monomial.degree() < 2);
                model = MeasurementModel::new(model.experiment().clone(), error_model, &[]);
            }
            let case = format!("arm {has_arm}, {switch_ons} switch-ons, attitudes {uncertainty:?}");
            let monte_carlo = repeated(&model.with_stated(stated));
            assert_eq!((monte_carlo.runs, monte_carlo.failures), (RUNS, 0), "{case}");
            for square in [&monte_carlo.weighted_square, &monte_carlo.chi_squared] {
                let degrees = square.degrees_of_freedom as f64;
                let error = (square.mean - degrees) / (2.0 * degrees / RUNS as f64).sqrt();
                // Sixteen figures: beyond 4.5 standard deviations once in ten thousand; Kolmogorov's distance the same.
                assert!(error.abs() < 4.5, "{case}: {} of {degrees}", square.mean);
                let distance = square.distance_from_chi_squared();
                assert!(distance < 2.3 / (RUNS as f64).sqrt(), "{case}: {distance} from chi^2");
            }
        }
    }
}
