//! Examples H.1 and H.3 and table G.2 of the GUM (JCGM 100:2008): every number printed, to every digit printed.

use centrical::uncertainty::Degrees;
use nalgebra::{DMatrix, DVector};

use crate::common::Regression;

/// `found` rounds to `printed`, which has `decimals` decimal places.
fn assert_printed(what: &str, found: f64, printed: f64, decimals: i32) {
    let half_digit = 0.5 * 10.0_f64.powi(-decimals);
    assert!((found - printed).abs() <= half_digit * (1.0 + 1e-9), "{what}: found {found}, printed {printed}");
}

/// `found` cut off after `decimals` places gives `printed`: how the GUM prints three of its numbers.
fn assert_cut_off(what: &str, found: f64, printed: f64, decimals: i32) {
    let digit = 10.0_f64.powi(-decimals);
    assert!(((found - printed) / digit).floor() == 0.0, "{what}: found {found}, printed {printed}");
}

/// Root of the sum of squares.
fn combined(components: &[f64]) -> f64 {
    components.iter().map(|u| u * u).sum::<f64>().sqrt()
}

/// H.1, end gauge, table H.1: 50.000838 mm, u_c 32 nm, nu_eff 16, U_99 93 nm, and 34 nm with second-order terms.
#[test]
fn h_1_end_gauge() {
    let (l_s, alpha_s, theta) = (50.000_623e6, 11.5e-6, -0.1);
    let d = [(5.8, Degrees::Finite(24.0)), (3.9, Degrees::Finite(5.0)), (6.7, Degrees::Finite(8.0))];
    let u_d = combined(&d.map(|(u, _)| u));
    assert_printed("u(d)", u_d, 9.7, 1);
    let Degrees::Finite(nu_d) = Degrees::effective(&d) else { panic!("finite") };
    // The GUM goes on from the printed 9.7 nm.
    assert_printed("nu(d)", nu_d * (9.7 / u_d).powi(4), 25.6, 1);

    let (u_difference_alpha, u_difference_theta) = (1e-6 / 3.0_f64.sqrt(), 0.05 / 3.0_f64.sqrt());
    assert_printed("u(delta alpha) in 1e-6", u_difference_alpha * 1e6, 0.58, 2);
    assert_printed("u(delta theta)", u_difference_theta, 0.029, 3);
    let by_alpha = l_s * theta * u_difference_alpha;
    let by_theta = l_s * alpha_s * u_difference_theta;
    assert_printed("component of delta alpha", by_alpha.abs(), 2.9, 1);
    assert_printed("component of delta theta", by_theta, 16.6, 1);

    let components = [25.0, u_d, by_alpha, by_theta];
    let u_c = combined(&components);
    assert_printed("u_c", u_c, 32.0, 0);
    let degrees = [Degrees::Finite(18.0), Degrees::Finite(25.6), Degrees::Finite(50.0), Degrees::Finite(2.0)];
    // The GUM goes on from the printed components.
    let printed = [25.0, 9.7, 2.9, 16.6];
    assert_cut_off("u_c^2", combined(&components).powi(2), 1002.0, 0);
    let contributions: Vec<(f64, Degrees)> = printed.into_iter().zip(degrees).collect();
    let Degrees::Finite(nu) = Degrees::effective(&contributions) else { panic!("finite") };
    assert_cut_off("nu_eff", nu, 16.7, 1);
    let k = Degrees::Finite(nu.floor()).coverage_factor(0.99);
    assert_printed("t_99(16)", k, 2.92, 2);
    assert_printed("U_99", k * 32.0, 93.0, 0);
    assert_printed("l in mm", (l_s + 215.0) * 1e-6, 50.000_838, 6);

    // H.1.7, second-order terms: l_s u(delta alpha) u(theta) and l_s u(alpha_s) u(delta theta).
    let u_theta = combined(&[0.2, 0.5 / 2.0_f64.sqrt()]);
    assert_printed("u(theta)", u_theta, 0.41, 2);
    let u_alpha_s = 2e-6 / 3.0_f64.sqrt();
    assert_printed("u(alpha_s) in 1e-6", u_alpha_s * 1e6, 1.2, 1);
    let second = [l_s * u_difference_alpha * u_theta, l_s * u_alpha_s * u_difference_theta];
    assert_printed("second-order term of theta", second[0], 11.7, 1);
    assert_printed("second-order term of alpha_s", second[1], 1.7, 1);
    assert_printed("u_c with second-order terms", combined(&[u_c, second[0], second[1]]), 34.0, 0);
}

/// Table H.6: thermometer reading, observed correction, predicted correction, difference.
const H_3: [[f64; 4]; 11] = [
    [21.521, -0.171, -0.1679, -0.0031],
    [22.012, -0.169, -0.1668, -0.0022],
    [22.512, -0.166, -0.1657, -0.0003],
    [23.003, -0.159, -0.1646, 0.0056],
    [23.507, -0.164, -0.1635, -0.0005],
    [23.999, -0.165, -0.1625, -0.0025],
    [24.513, -0.156, -0.1614, 0.0054],
    [25.002, -0.157, -0.1603, 0.0033],
    [25.503, -0.159, -0.1592, 0.0002],
    [26.010, -0.161, -0.1581, -0.0029],
    [26.511, -0.160, -0.1570, -0.0030],
];

/// H.3, calibration of a thermometer by a straight line, table H.6 and the prediction at 30 degrees.
#[test]
fn h_3_thermometer() {
    let a = DMatrix::from_fn(11, 2, |k, power| (H_3[k][0] - 20.0).powi(i32::try_from(power).unwrap()));
    let b = DVector::from_fn(11, |k, _| H_3[k][1]);
    let Regression { x, covariance, variance, .. } = Regression::of(&a, &b);
    let u = [covariance[(0, 0)].sqrt(), covariance[(1, 1)].sqrt()];
    assert_printed("y_1", x[0], -0.1712, 4);
    assert_printed("s(y_1)", u[0], 0.0029, 4);
    assert_printed("y_2", x[1], 0.002_18, 5);
    assert_printed("s(y_2)", u[1], 0.000_67, 5);
    assert_printed("r(y_1, y_2)", covariance[(0, 1)] / (u[0] * u[1]), -0.930, 3);
    assert_printed("s", variance.sqrt(), 0.0035, 4);
    let predicted = &a * &x;
    for (k, row) in H_3.iter().enumerate() {
        assert_printed("predicted correction", predicted[k], row[2], 4);
        assert_printed("difference", row[1] - predicted[k], row[3], 4);
    }
    let at_30 = DVector::from_column_slice(&[1.0, 10.0]);
    assert_printed("b(30)", x.dot(&at_30), -0.1494, 4);
    assert_printed("u(b(30))", at_30.dot(&(covariance * &at_30)).sqrt(), 0.0041, 4);
}

/// Table G.2, all rows: `t_p(nu)` for p = 90, 95, 99 % and those of 1, 2, 3 standard deviations, printed as 68.27,
/// 95.45, 99.73 %.
#[test]
fn table_g_2() {
    let columns = [0.682_689_492_1, 0.90, 0.95, 0.954_499_736_1, 0.99, 0.997_300_203_9];
    let rows: [(f64, [f64; 6]); 27] = [
        (1.0, [1.84, 6.31, 12.71, 13.97, 63.66, 235.80]),
        (2.0, [1.32, 2.92, 4.30, 4.53, 9.92, 19.21]),
        (3.0, [1.20, 2.35, 3.18, 3.31, 5.84, 9.22]),
        (4.0, [1.14, 2.13, 2.78, 2.87, 4.60, 6.62]),
        (5.0, [1.11, 2.02, 2.57, 2.65, 4.03, 5.51]),
        (6.0, [1.09, 1.94, 2.45, 2.52, 3.71, 4.90]),
        (7.0, [1.08, 1.89, 2.36, 2.43, 3.50, 4.53]),
        (8.0, [1.07, 1.86, 2.31, 2.37, 3.36, 4.28]),
        (9.0, [1.06, 1.83, 2.26, 2.32, 3.25, 4.09]),
        (10.0, [1.05, 1.81, 2.23, 2.28, 3.17, 3.96]),
        (11.0, [1.05, 1.80, 2.20, 2.25, 3.11, 3.85]),
        (12.0, [1.04, 1.78, 2.18, 2.23, 3.05, 3.76]),
        (13.0, [1.04, 1.77, 2.16, 2.21, 3.01, 3.69]),
        (14.0, [1.04, 1.76, 2.14, 2.20, 2.98, 3.64]),
        (15.0, [1.03, 1.75, 2.13, 2.18, 2.95, 3.59]),
        (16.0, [1.03, 1.75, 2.12, 2.17, 2.92, 3.54]),
        (17.0, [1.03, 1.74, 2.11, 2.16, 2.90, 3.51]),
        (18.0, [1.03, 1.73, 2.10, 2.15, 2.88, 3.48]),
        (19.0, [1.03, 1.73, 2.09, 2.14, 2.86, 3.45]),
        (20.0, [1.03, 1.72, 2.09, 2.13, 2.85, 3.42]),
        (25.0, [1.02, 1.71, 2.06, 2.11, 2.79, 3.33]),
        (30.0, [1.02, 1.70, 2.04, 2.09, 2.75, 3.27]),
        (35.0, [1.01, 1.70, 2.03, 2.07, 2.72, 3.23]),
        (40.0, [1.01, 1.68, 2.02, 2.06, 2.70, 3.20]),
        (45.0, [1.01, 1.68, 2.01, 2.06, 2.69, 3.18]),
        (50.0, [1.01, 1.68, 2.01, 2.05, 2.68, 3.16]),
        (100.0, [1.005, 1.660, 1.984, 2.025, 2.626, 3.077]),
    ];
    for (nu, printed) in rows {
        for (p, printed) in columns.into_iter().zip(printed) {
            let decimals = if nu == 100.0 { 3 } else { 2 };
            // t_90(35) is 1.6896: a misprint that NIST TN 1297, table B.1, shares.
            let printed = if (nu, printed) == (35.0, 1.70) { 1.69 } else { printed };
            assert_printed(&format!("t_{p}({nu})"), Degrees::Finite(nu).coverage_factor(p), printed, decimals);
        }
    }
    for (p, printed) in columns.into_iter().zip([1.0, 1.645, 1.960, 2.0, 2.576, 3.0]) {
        assert_printed(&format!("t_{p}(infinity)"), Degrees::Infinite.coverage_factor(p), printed, 3);
    }
}
