//! What a laboratory states takes part in the fit: its checks hold where the stated deviations are there, and data that know
//! better sharpen it.

use centrical::ThirdPosition::AxisOneUp;
use centrical::uncertainty::{Level, MonteCarlo, Settings, Test};
use centrical::{
    Calibration, Data, Extension, Law, MeasurementModel, PairRelation, Rival, SetPoint, Source, TypeB, unwatched,
};

use crate::common::{Random, experiment, kozlov, observations, truth};
use crate::uncertainty::STATED;

const RUNS: usize = 400;

fn model() -> MeasurementModel {
    kozlov(experiment(AxisOneUp, PairRelation::Common, &[1.0, 0.5]))
}

fn repeated(model: &MeasurementModel, stated: &TypeB) -> MonteCarlo {
    let model = model.clone().with_stated(*stated);
    let x = truth(&model, 0.5, &mut Random::new(3));
    let data = Data::new(&model, observations(&model, &x)).unwrap();
    let settings = Settings { runs: RUNS, seed: 4, coverage: 0.95, is_linear: false };
    MonteCarlo::of(&data, &x, &settings, &unwatched).unwrap()
}

fn bounded(name: &str, u: f64) -> TypeB {
    let mut stated = TypeB::default();
    let place = Rival::COMMON.iter().position(|rival| rival.name() == name).unwrap();
    stated.effects[place] = u;
    stated
}

/// Deviations of all kinds, each drawn from its statement and far above the noise: the squared error has the mean that its
/// covariance states, chi^2 its distribution, and no session is refused.
#[test]
fn sessions_with_stated_deviations_are_accepted() {
    let cases = [
        ("rest angle 2 deg", TypeB { rest_angle: 2.0_f64.to_radians(), ..TypeB::default() }),
        ("radius 20 um, seats apart", TypeB { radius: 20e-6, ..TypeB::default() }),
        ("proof masses 50 um", TypeB { proof_masses: 50e-6, ..TypeB::default() }),
        ("bias of each mounting 30 ug", TypeB { mounting_bias: 3e-4, ..TypeB::default() }),
        ("scale of each mounting 20 ppm", TypeB { mounting_scale: 2e-5, ..TypeB::default() }),
        ("resolution 20 ug", TypeB { resolution: 2e-4, ..TypeB::default() }),
        ("gravity and latitude", TypeB { gravity: 1e-4, latitude: 1e-2, ..TypeB::default() }),
        ("arm turn 1 urad at 100 g", bounded("arm-turn-load", 1e-6 / 980.665)),
        ("spin step 100 ug", bounded("spin-step", 1e-3)),
        ("odd square", bounded("odd-quadratic", 1e-8)),
        ("a good laboratory", STATED),
    ];
    for (name, stated) in cases {
        let shown = repeated(&model(), &stated);
        assert_eq!(shown.failures, 0, "{name}");
        let square = shown.weighted_square.mean / shown.weighted_square.degrees_of_freedom as f64;
        // Five standard deviations of the mean of `RUNS` chi^2 of 49 degrees of freedom.
        assert!((square - 1.0).abs() < 5.0 * (2.0 / 49.0 / RUNS as f64).sqrt(), "{name}: squared error {square}");
        let nu = shown.chi_squared.degrees_of_freedom;
        let refused = shown
            .chi_squared
            .sorted
            .iter()
            .filter(|chi_squared| Level::Objection.is_passed_by(Test::chi_squared(**chi_squared, nu).probability));
        assert_eq!(refused.count(), 0, "{name}");
        let distance = shown.chi_squared.distance_from_chi_squared();
        // One time in a thousand by chance (Kolmogorov). Rounding is rectangular, and one term of many.
        assert!(distance < 1.95 / (RUNS as f64).sqrt(), "{name}: {distance}");
    }
}

/// The data know the difference of the radii better than a loose statement. The budget says so: the contribution of the source
/// is far below that of a fixed radius, and all sources add up to the covariance of the fit.
#[test]
fn data_sharpen_a_loose_statement() {
    let stated = TypeB { radius: 200e-6, ..TypeB::default() };
    let model = model().with_stated(stated);
    let x = truth(&model, 0.5, &mut Random::new(5));
    let data = Data::new(&model, observations(&model, &x)).unwrap();
    let calibration = Calibration::exact(&data).unwrap();
    let (fit, budget) = (calibration.fit(), calibration.budget().unwrap());
    for j in 0..model.parameters().len() {
        let ratio = budget.standard_uncertainty(j).unwrap() / fit.standard_uncertainty(j).unwrap();
        assert!((ratio - 1.0).abs() < 1e-6, "{j}: {ratio}");
    }
    // Two seats: their mean cannot be separated from dR_1, their difference can.
    let known = |deviations: &[(f64, f64)]| deviations.iter().map(|(_, u)| *u).fold(1.0_f64, f64::min);
    assert_eq!(fit.deviations().len(), 2);
    let sharpened = known(&fit.deviations());
    assert!(sharpened < 0.75, "{sharpened}");
    let scale = model.parameters().find("G2_33").unwrap();
    let radius = budget.contributions().iter().find(|c| c.source == Source::Radius).unwrap();
    assert!(radius.standard_uncertainty(scale) < 0.5 * budget.standard_uncertainty(scale).unwrap());
}

/// An influence comes to the same as an unknown of the model with a prior of that standard uncertainty.
#[test]
fn a_bound_is_a_prior() {
    let u = 1e-6 / 980.665;
    let stating = model().with_stated(bounded("arm-turn-load", u));
    let extension = Extension::ArmTurn(Law::Load);
    let unknown = model().with_rivals(&[Rival::Effect(extension)]).with_prior("turn of the arm's end", u).unwrap();
    let x = truth(&model(), 0.5, &mut Random::new(6));
    let readings = observations(&model(), &x);
    let (a, b) = (Data::new(&stating, readings.clone()).unwrap(), Data::new(&unknown, readings).unwrap());
    let (a, b) = (Calibration::exact(&a).unwrap().into_fit(), Calibration::exact(&b).unwrap().into_fit());
    for j in 0..49 {
        let (one, other) = (a.standard_uncertainty(j).unwrap(), b.standard_uncertainty(j).unwrap());
        assert!((one / other - 1.0).abs() < 1e-6, "{j}: {one} {other}");
        assert!((a.value(j).unwrap() - b.value(j).unwrap()).abs() < 1e-3 * one, "{j}");
    }
    assert!((a.chi_squared - b.chi_squared).abs() < 1e-6 * (1.0 + a.chi_squared));
    assert_eq!(a.degrees_of_freedom, b.degrees_of_freedom);
}

/// The recursive fit takes what is stated as the batch does.
#[test]
fn the_filter_knows_what_is_stated() {
    let model = model().with_stated(STATED);
    let x = truth(&model, 0.5, &mut Random::new(7));
    let data = Data::new(&model, crate::validity::session(&model, &x, &mut Random::new(8))).unwrap();
    let (batch, recursive) = (Calibration::exact(&data).unwrap(), Calibration::recursive(&data).unwrap());
    let (batch, recursive) = (batch.fit(), recursive.fit());
    for j in 0..49 {
        let u = batch.standard_uncertainty(j).unwrap();
        assert!((batch.value(j).unwrap() - recursive.value(j).unwrap()).abs() < 1e-6 * u, "{j}");
        assert!((recursive.standard_uncertainty(j).unwrap() / u - 1.0).abs() < 1e-8, "{j}");
    }
    assert!((batch.chi_squared - recursive.chi_squared).abs() < 1e-6 * batch.chi_squared);
}

/// Rests that are repeated round alike: the same error, which their mean does not lessen.
#[test]
fn repeated_rests_round_alike() {
    let stated = TypeB { resolution: 1e-3, ..TypeB::default() };
    let mut experiment = model().experiment().clone();
    let rest = experiment.set_points[0];
    assert!(rest.is_rest());
    experiment.set_points.insert(1, SetPoint::at_rest(rest.mounting, rest.angle));
    let repeated = kozlov(experiment).with_stated(stated);
    let once = model().with_stated(stated);
    assert_eq!(once.influences().len(), 0);
    assert_eq!(repeated.influences().len(), 3);
    let bias = |model: &MeasurementModel| {
        let data = Data::new(model, observations(model, &vec![0.0; 49])).unwrap();
        Calibration::exact(&data).unwrap().fit().standard_uncertainty(28).unwrap()
    };
    let (one, two) = (bias(&once), bias(&repeated));
    assert!(two <= one * (1.0 + 1e-9) && two > 0.97 * one, "{one} {two}");
}
