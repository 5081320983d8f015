use centrical::ThirdPosition::{AxisOneDown, AxisOneUp};
use centrical::{Experiment, Group, Linearisation, MeasurementModel, Monomial, PairRelation, ReferencePoint, SetPoint};
use nalgebra::{DMatrix, Vector3};

use crate::common::{Random, everything, experiment, kozlov, truth};

const RELATIONS: [PairRelation; 3] = [PairRelation::Common, PairRelation::Opposite, PairRelation::Free];

fn dense(linearisation: &Linearisation, columns: usize) -> DMatrix<f64> {
    let mut dense = DMatrix::zeros(3, columns);
    for (column, derivative) in &linearisation.columns {
        let mut target = dense.column_mut(*column);
        target += derivative;
    }
    dense
}

/// The same seats off the middle of the arm and of its height, turning the other way.
fn offset(mut experiment: Experiment) -> Experiment {
    experiment.mountings.iter_mut().for_each(|m| m.arm_y += Vector3::new(0.0, 0.03, -0.02));
    experiment.set_points.iter_mut().for_each(|s| s.omega = -s.omega);
    experiment
}

/// The experiment with a speed uncertainty of one, so that a speed error is the derivative by the logarithm of the speed.
fn unit_speed_error(mut experiment: Experiment) -> Experiment {
    experiment.centrifuge.speed_uncertainty = 1.0;
    experiment
}

/// [K5.3] is the exact model's Jacobian at zero, to rounding, for both P_3, every pair relation and extension.
#[test]
fn h_is_the_jacobian_at_zero() {
    for third in [AxisOneUp, AxisOneDown] {
        for relation in RELATIONS {
            for model in [
                kozlov(unit_speed_error(experiment(third, relation, &[1.0, 0.5]))),
                everything(offset(unit_speed_error(experiment(third, relation, &[1.0, 0.7, 0.5])))),
            ] {
                let p = model.parameters().len();
                let zero = vec![0.0; p];
                for set_point in &model.experiment().set_points {
                    let h = model.linearise_at_zero(set_point);
                    let exact = model.linearise(set_point, &zero);
                    let (h_rows, exact_rows) = (dense(&h, p), dense(&exact, p));
                    // By column: the entries run over twelve decades.
                    for column in 0..p {
                        let size = h_rows.column(column).amax().max(model.experiment().site.gravity);
                        let error = (h_rows.column(column) - exact_rows.column(column)).amax();
                        assert!(error <= 1e-14 * size, "{}: {error:e} of {size:e}", model.parameters()[column].name);
                    }
                    assert!((h.reading - exact.reading).amax() <= 1e-14 * h.reading.amax());
                    assert!((h.setting_error - exact.setting_error).amax() <= 1e-13 * (1.0 + h.setting_error.amax()));
                }
            }
        }
    }
}

/// The two conventions of `rho0` are two descriptions of one unit: moving the reference point within it and the seat
/// with it leaves every reading as it was, and takes `drho` out of the unknowns.
#[test]
fn both_conventions_of_the_reference_point() {
    let first = experiment(AxisOneUp, PairRelation::Common, &[1.0, 0.5]);
    let mut own = first.clone();
    // The point whose coordinate i is that of proof mass i: seen from it the diagonal of rho0 is zero.
    let shift_z = first.unit.rho_z.diagonal();
    own.unit.reference = ReferencePoint::OwnAxes;
    own.unit.rho_z.column_iter_mut().for_each(|mut point| point -= shift_z);
    for mounting in &mut own.mountings {
        mounting.arm_y += first.positions[mounting.position].p_zy.transpose() * shift_z;
    }
    assert_eq!(own.unit.rho_z.diagonal(), Vector3::zeros());
    let (first, own) = (kozlov(first), kozlov(own));
    assert_eq!((first.parameters().len(), own.parameters().len()), (49, 47));
    for (a, b) in first.experiment().set_points.iter().zip(&own.experiment().set_points) {
        let (a, b) = (first.reading(a, &[0.0; 49]), own.reading(b, &[0.0; 47]));
        assert!((a - b).amax() <= 1e-15 * a.amax() * 4.0, "{a} {b}");
    }
}

/// Fourth-order central difference of the reading along unknown `j`.
fn difference(model: &MeasurementModel, set_point: &SetPoint, x: &[f64], j: usize, h: f64) -> Vector3<f64> {
    let at = |steps: f64| {
        let mut moved = x.to_vec();
        moved[j] += steps * h;
        model.reading(set_point, &moved)
    };
    (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * h)
}

/// The analytic Jacobian against differences at random points, near zero and hundreds of times farther out.
#[test]
fn jacobian_equals_differences() {
    let mut random = Random::new(7);
    for (size, relation) in [(1.0, PairRelation::Common), (30.0, PairRelation::Opposite), (300.0, PairRelation::Free)] {
        let model = everything(experiment(AxisOneDown, relation, &[1.0, 0.5]));
        let x = without_kinks(&model, truth(&model, size, &mut random));
        for set_point in model.experiment().set_points.iter().step_by(5) {
            let linearisation = model.linearise(set_point, &x);
            let analytic = dense(&linearisation, x.len());
            let reading = linearisation.reading.amax();
            assert!((linearisation.reading - model.reading(set_point, &x)).amax() <= 1e-14 * reading);
            for j in 0..x.len() {
                let h = model.parameters()[j].typical;
                let numeric = difference(&model, set_point, &x, j, h);
                // Rounding of a dozen operations on the reading, and the truncation (h f)^4 of a relative step of 1e-3.
                let bound = 1e-14 * reading + 1e-11 * h * analytic.column(j).amax();
                let error = (numeric - analytic.column(j)).amax() * h;
                assert!(error <= bound, "{} at {size}: {error:e} of {bound:e}", model.parameters()[j].name);
            }
        }
    }
}

/// Transverse axes stand near zero, where `|f| f` has a jump in its second derivative that no difference should
/// straddle: the coefficients of odd terms are set to zero. Their columns stay tested here, and their gradients
/// in the tests of `centrical-compensate`.
fn without_kinks(model: &MeasurementModel, mut x: Vec<f64>) -> Vec<f64> {
    for (value, parameter) in x.iter_mut().zip(model.parameters()) {
        if parameter.name.starts_with("odd") {
            *value = 0.0;
        }
    }
    x
}

/// `d f' / d ln Omega` of the full model against differences of the speed.
#[test]
fn speed_direction_equals_differences() {
    let mut random = Random::new(8);
    let model = everything(unit_speed_error(experiment(AxisOneUp, PairRelation::Common, &[1.0, 0.5])));
    let x = truth(&model, 10.0, &mut random);
    let at = |set_point: &SetPoint, factor: f64| {
        model.reading(&SetPoint { omega: set_point.omega * factor, ..*set_point }, &x)
    };
    for set_point in &model.experiment().set_points {
        let speed = model.linearise(set_point, &x).setting_error;
        let h = 1e-4;
        let numeric = (8.0 * (at(set_point, 1.0 + h) - at(set_point, 1.0 - h))
            - (at(set_point, 1.0 + 2.0 * h) - at(set_point, 1.0 - 2.0 * h)))
            / (12.0 * h);
        assert!((numeric - speed).amax() <= 1e-9 * (1.0 + speed.amax()));
    }
}

/// The mean over a revolution by a few equal steps is the mean by very many.
#[test]
fn mean_over_a_revolution_is_exact() {
    let mut random = Random::new(9);
    let model = kozlov(experiment(AxisOneUp, PairRelation::Common, &[1.0]));
    let x = truth(&model, 100.0, &mut random);
    // A tilt of 0.1 rad, so that the second harmonic of the quadratic terms is not lost below rounding.
    let mut finer = centrical::ErrorModel::kozlov_2017();
    finer.terms.push(centrical::Term {
        name: "none".to_owned(),
        group: Group::HigherOrder,
        axis: 0,
        monomial: Monomial { powers: [60, 0, 0], sign_of: None },
    });
    let fine = MeasurementModel::new(model.experiment().clone(), finer, &[]);
    let mut x_fine = x.clone();
    x_fine.push(0.0);
    for set_point in model.experiment().set_points.iter().filter(|s| !s.is_rest()) {
        let (coarse, fine) = (model.reading(set_point, &x), fine.reading(set_point, &x_fine));
        assert!((coarse - fine).amax() <= 1e-14 * coarse.amax());
    }
}

/// A plateau with a speed uncertainty of its own has the speed error of a centrifuge as uncertain, in both models.
#[test]
fn own_speed_uncertainty_stands_for_that_of_the_centrifuge() {
    let mut uncertain = experiment(AxisOneUp, PairRelation::Common, &[1.0, 0.5]);
    uncertain.centrifuge.speed_uncertainty = 3e-6;
    let mut measured = experiment(AxisOneUp, PairRelation::Common, &[1.0, 0.5]);
    measured.centrifuge.speed_uncertainty = 1e-4;
    measured.set_points.iter_mut().for_each(|s| s.speed_uncertainty = Some(3e-6));
    let (uncertain, measured) = (everything(uncertain), everything(measured));
    let x = truth(&measured, 10.0, &mut Random::new(10));
    for (a, b) in uncertain.experiment().set_points.iter().zip(&measured.experiment().set_points) {
        assert_eq!(uncertain.linearise(a, &x), measured.linearise(b, &x));
        assert_eq!(uncertain.linearise_at_zero(a), measured.linearise_at_zero(b));
    }
    assert!(measured.linearise(&measured.experiment().set_points[3], &x).setting_error.norm() > 0.0);
}
