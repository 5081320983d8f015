//! The two measurements that the source prints in full (its section 5), term by term: `z^(1)` at rest and `z^(6)` while
//! spinning, against the columns of `H`. Each printed coefficient is written here as it stands there.

use centrical::Position;
use centrical::ThirdPosition::AxisOneUp;
use centrical::{ErrorModel, MeasurementModel, Monomial, PairRelation, SetPoint};
use nalgebra::{Matrix3, Vector3};

use crate::common::{experiment, kozlov};

/// A model with distances on both horizontal axes, so that no printed term is multiplied by zero.
fn model() -> MeasurementModel {
    let mut experiment = experiment(AxisOneUp, PairRelation::Free, &[1.0]);
    experiment.site.latitude = None;
    for mounting in &mut experiment.mountings {
        mounting.arm_y = Vector3::new(0.47, 0.03, 0.011);
    }
    kozlov(experiment)
}

/// `z` per unit of a parameter: a column of `H`.
fn column(model: &MeasurementModel, set_point: &SetPoint, name: &str) -> Vector3<f64> {
    let j = model.parameters().find(name).unwrap();
    let linearisation = model.linearise_at_zero(set_point);
    let found = linearisation.columns.iter().find(|(column, _)| *column == j);
    found.map_or_else(Vector3::zeros, |(_, derivative)| derivative / model.experiment().site.gravity)
}

/// Compares every geometric column with what is printed; columns that are not named are printed nowhere, so zero.
fn compare(model: &MeasurementModel, set_point: &SetPoint, printed: &[(&str, [f64; 3])]) {
    for parameter in model.parameters().iter().filter(|p| !p.is_of_instrument()) {
        let found = column(model, set_point, &parameter.name);
        let expected = printed.iter().find(|(name, _)| *name == parameter.name).map_or([0.0; 3], |(_, z)| *z);
        let error = (found - Vector3::from(expected)).amax();
        assert!(error <= 1e-14 * found.amax(), "{}: {found:?}, printed {expected:?}", parameter.name);
    }
}

#[test]
fn z1_at_rest_as_printed() {
    let model = model();
    for alpha_3 in [0.0, 0.7, std::f64::consts::PI] {
        let (s, c) = alpha_3.sin_cos();
        compare(
            &model,
            &SetPoint::at_rest(0, alpha_3),
            &[
                ("alpha_1", [s, c, 0.0]),
                ("alpha_2", [-c, s, 0.0]),
                ("delta_1[1]", [0.0, 1.0, 0.0]),
                ("delta_2[1]", [-1.0, 0.0, 0.0]),
            ],
        );
    }
}

/// The first line prints `R0_26` alone, an a-priori distance among unknowns. The derivation gives `dR_26` there: with it
/// every term of the three lines agrees, and `R0_26` by itself is part of the nominal reading that `z` has subtracted.
#[test]
fn z6_as_printed() {
    let model = model();
    let experiment = model.experiment();
    let set_point = SetPoint::spinning(5, 31.0);
    let w = set_point.omega * set_point.omega / experiment.site.gravity;
    let arm = experiment.mountings[5].arm_y;
    let (r_16, r_26) = (arm.x, arm.y);
    let rho = &experiment.unit.rho_z;
    let (rho_12, rho_23, rho_32) = (rho[(0, 1)], rho[(1, 2)], rho[(2, 1)]);
    compare(
        &model,
        &set_point,
        &[
            ("dR_2[6]", [-w, 0.0, 0.0]),
            ("delta_2[6]", [-w * r_16, 0.0, -w * r_26]),
            ("delta_3[6]", [-1.0, w * (r_26 + rho_12), 0.0]),
            ("delta_1[6]", [0.0, w * (r_16 - rho_32), -w * rho_23 + 1.0]),
            ("drho_33", [0.0, 0.0, -w]),
            ("dR_1[6]", [0.0, 0.0, w]),
        ],
    );
    // No unknowns, no small measurement: there is no constant -w R0_26 in the exact model's reading either.
    let z = (model.reading(&set_point, &[0.0; 55]) - experiment.nominal(&set_point)) / experiment.site.gravity;
    assert!(z.amax() < 1e-13 && w * r_26 > 1.0, "{z:?}");
}

/// P_1, P_2 as printed; P_6 is the only rotation under which the printed `z^(6)` holds (the test above). Pairs are turned
/// by 180 deg about the vertical. In 3 and 4 axis 2 lies along the arm both ways and axis 1 is vertical.
#[test]
fn positions_of_the_text() {
    let p: Vec<Matrix3<f64>> = Position::kozlov_2017(AxisOneUp).into_iter().map(|position| position.p_zy).collect();
    assert_eq!(p[0], Matrix3::identity());
    assert_eq!(p[1], Matrix3::from_diagonal(&Vector3::new(-1.0, -1.0, 1.0)));
    assert_eq!(p[5], Matrix3::new(0.0, 1.0, 0.0, 0.0, 0.0, -1.0, -1.0, 0.0, 0.0));
    for pair in [0, 2, 4] {
        assert_eq!(p[pair] * p[1], p[pair + 1]);
    }
    assert_eq!((p[2][(1, 0)], p[3][(1, 0)]), (1.0, -1.0));
    assert_eq!((p[2][(0, 2)].abs(), p[3][(0, 2)].abs()), (1.0, 1.0));
}

/// The source prints `Gamma_12` in row 2 of `Gamma^(0)`; `Gamma_21` is meant: the upper part is zero by the choice of the
/// instrument frame.
#[test]
fn g0_is_lower_triangular() {
    let model = ErrorModel::kozlov_2017();
    let linear: Vec<(&str, usize, usize)> = (model.terms.iter())
        .filter(|term| term.monomial.degree() == 1)
        .map(|term| {
            let column = (0..3).find(|&j| term.monomial == Monomial::power(j, 1)).unwrap();
            (term.name.as_str(), term.axis, column)
        })
        .collect();
    let expected =
        [("G0_11", 0, 0), ("G0_21", 1, 0), ("G0_22", 1, 1), ("G0_31", 2, 0), ("G0_32", 2, 1), ("G0_33", 2, 2)];
    assert_eq!(linear, expected);
}

/// [K4.2] row by row: 21 coefficients on the constant, `f_j`, `f_j^2`, `f_i^3`.
#[test]
fn error_model_as_printed() {
    let model = ErrorModel::kozlov_2017();
    let f = Vector3::new(2.0, -3.0, 5.0);
    let mut expected: Vec<(String, usize, f64)> = (0..3).map(|i| (format!("df_{}", i + 1), i, 1.0)).collect();
    for i in 0..3 {
        expected.extend((0..=i).map(|j| (format!("G0_{}{}", i + 1, j + 1), i, f[j])));
    }
    for i in 0..3 {
        expected.extend((0..3).map(|j| (format!("G1_{}{}", i + 1, j + 1), i, f[j].powi(2))));
    }
    expected.extend((0..3).map(|i| (format!("G2_{0}{0}", i + 1), i, f[i].powi(3))));
    let found: Vec<(String, usize, f64)> =
        model.terms.iter().map(|t| (t.name.clone(), t.axis, t.monomial.value(f.into()))).collect();
    assert_eq!(found, expected);
}
