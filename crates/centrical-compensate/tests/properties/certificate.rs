use centrical_compensate::{Compensation, GAIN_CHANGE_LIMIT, Monomial, NotInvertible, Term, gain, reading};
use nalgebra::{Matrix3, Vector3};
use proptest::prelude::*;

use crate::models::{Model, everything, with_points};

fn matrix(rows: [[f64; 3]; 3]) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| rows[i][j])
}

/// Norm that belongs to `max_i |v_i|`: the largest sum of a row.
fn norm(m: &Matrix3<f64>) -> f64 {
    m.row_iter().map(|row| row.abs().sum()).fold(0.0, f64::max)
}

/// Change of the gain at `f`, relative to the gain of the affine part.
fn gain_change(compensation: &Compensation<&Vec<Term>>, model: &Model, f: [f64; 3]) -> f64 {
    norm(&(matrix(compensation.linear().inverse) * matrix(gain(&model.terms, f)) - Matrix3::identity()))
}

proptest! {
    /// The bound holds wherever one looks in twice the range.
    #[test]
    fn the_gain_stays_within_its_bound((model, points) in with_points(everything(), 200)) {
        let compensation = Compensation::new(&model.terms, model.range).unwrap();
        let bound = compensation.certificate().gain_change;
        for u in points {
            prop_assert!(gain_change(&compensation, &model, model.at(u.map(|u| 2.0 * u))) <= bound);
        }
    }

    /// The bound is tight: terms of one sign on one axis reach it at a corner.
    #[test]
    fn the_bound_is_reached(quadratic in 1e-7..1e-5_f64, cubic in 1e-10..1e-9_f64, h in 1.0..2000.0_f64) {
        let terms = vec![Term::power(1, 1, 2, quadratic), Term::power(1, 2, 3, cubic)];
        let model = Model { terms, range: h };
        let compensation = Compensation::new(&model.terms, model.range).unwrap();
        let bound = compensation.certificate().gain_change;
        let reached = gain_change(&compensation, &model, [2.0 * h; 3]);
        // The bound allows for the rounding of the inverse of the linear part.
        prop_assert!((0.0..1e-14).contains(&(bound - reached)), "{reached} of {bound}");
    }

    /// As many Newton steps as are said to be enough are enough, for every accuracy asked.
    #[test]
    fn newton_keeps_its_promise((model, points) in with_points(everything(), 50), digits in 0.5..14.0_f64) {
        let compensation = Compensation::new(&model.terms, model.range).unwrap();
        let accuracy = 10.0_f64.powf(-digits);
        let steps = compensation.certificate().newton_steps(accuracy);
        for u in points {
            let f = model.at(u);
            let after = newton(&compensation, &model.terms, reading(&model.terms, f), steps);
            let error = (0..3).map(|i| (after[i] - f[i]).abs() / model.range).fold(0.0, f64::max);
            // The reading itself is rounded.
            prop_assert!(error <= accuracy + 1e-14, "{error:e} after {steps} steps, {accuracy:e} promised");
        }
    }

    /// Fixed-point steps gain what they are said to gain.
    #[test]
    fn fixed_point_steps_keep_their_promise((model, points) in with_points(everything(), 50), steps in 0..10_usize) {
        let compensation = Compensation::new(&model.terms, model.range).unwrap();
        let bound = compensation.certificate().error_after(steps);
        for u in points {
            let f = model.at(u);
            let after = fixed_point(&compensation, &model.terms, reading(&model.terms, f), steps);
            let error = (0..3).map(|i| (after[i] - f[i]).abs() / model.range).fold(0.0, f64::max);
            prop_assert!(error <= bound + 1e-14, "{error:e} after {steps} steps, {bound:e} promised");
        }
    }

    /// `f + c f^2` turns back at `f = -1 / (2 c)`. The inverse is certain up to a sixth of that: twice the range,
    /// and a third of the gain.
    #[test]
    fn a_fold_is_refused(c in 1e-6..1e-3_f64, times in 1.01..100.0_f64) {
        let terms = [Term::power(0, 0, 2, c)];
        let certain = 1.0 / (12.0 * c);
        prop_assert!(Compensation::new(&terms, 0.999_999 * certain).is_ok());
        match Compensation::new(&terms, times * certain) {
            Err(NotInvertible::TooNonlinear { gain_change, limit: GAIN_CHANGE_LIMIT, factor, .. }) => {
                prop_assert!((gain_change / (times / 3.0) - 1.0).abs() < 1e-9);
                prop_assert!((factor * times - 1.0).abs() < 1e-9, "{factor} of {times}");
            }
            other => prop_assert!(false, "{other:?}"),
        }
    }

    /// The range that is said to be left is certain, and hardly more.
    #[test]
    fn the_margin_is_the_margin(model in everything()) {
        let margin = Compensation::new(&model.terms, model.range).unwrap().certificate().margin;
        let over = |factor: f64| Compensation::new(&model.terms, factor * margin * model.range);
        prop_assert!(over(0.999_999).is_ok());
        let refused = matches!(over(1.000_001), Err(NotInvertible::TooNonlinear { .. }));
        prop_assert!(refused);
    }
}

/// `f <- C (f' - b) - C N(f)`.
fn fixed_point(compensation: &Compensation<&Vec<Term>>, terms: &[Term], read: [f64; 3], steps: usize) -> [f64; 3] {
    let linear = compensation.linear();
    let (inverse, affine_gain) = (matrix(linear.inverse), matrix(linear.gain));
    let mut f = inverse * (Vector3::from(read) - Vector3::from(linear.bias));
    let start = f;
    for _ in 0..steps {
        let affine = affine_gain * f + Vector3::from(linear.bias);
        f = start - inverse * (Vector3::from(reading(terms, f.into())) - affine);
    }
    f.into()
}

/// Newton's iteration on `f` itself.
fn newton(compensation: &Compensation<&Vec<Term>>, terms: &[Term], read: [f64; 3], steps: usize) -> [f64; 3] {
    let linear = compensation.linear();
    let mut f = matrix(linear.inverse) * (Vector3::from(read) - Vector3::from(linear.bias));
    for _ in 0..steps {
        let misfit = Vector3::from(read) - Vector3::from(reading(terms, f.into()));
        f += matrix(gain(terms, f.into())).lu().solve(&misfit).unwrap();
    }
    f.into()
}

#[test]
fn a_linear_model_has_no_limit() {
    let terms = [Term::power(0, 0, 1, -0.4), Term::power(2, 0, 1, 3.0), Term::power(1, 1, 0, 7.0)];
    let certificate = *Compensation::new(&terms, 1e6).unwrap().certificate();
    assert_eq!(certificate.margin, f64::INFINITY);
    assert!(certificate.gain_change < 1e-13);
    assert_eq!(certificate.newton_steps(0.0_f64.max(f64::EPSILON)), 1);
}

#[test]
fn what_makes_no_sense_is_refused() {
    let refused = |term: Term, range: f64| Compensation::new(&[Term::power(0, 0, 0, 0.0), term], range).err();
    let good = Term::power(0, 0, 1, 1e-3);
    let signed = |axis| Term { monomial: Monomial { sign_of: Some(axis), ..good.monomial }, ..good };
    assert_eq!(refused(good, 1.0), None);
    assert_eq!(refused(Term { axis: 3, ..good }, 1.0), Some(NotInvertible::Axis { term: 1, axis: 3 }));
    assert_eq!(refused(signed(4), 1.0), Some(NotInvertible::Axis { term: 1, axis: 4 }));
    assert_eq!(refused(signed(2), 1.0), Some(NotInvertible::Jump { term: 1, axis: 2 }));
    assert_eq!(refused(Term { coefficient: -1.0, ..good }, 1.0), Some(NotInvertible::Singular));
    assert_eq!(refused(good, 0.0), Some(NotInvertible::Range { range: 0.0 }));
    assert!(matches!(refused(good, f64::NAN), Some(NotInvertible::Range { .. })));
    assert!(matches!(refused(Term { coefficient: f64::NAN, ..good }, 1.0), Some(NotInvertible::Coefficient { .. })));
    // A kink of a tenth of the gain is fine at any range; one of a fifth at none.
    let kink = |c| Term { coefficient: c, ..signed(0) };
    assert_eq!(refused(kink(0.1), 1e6), None);
    assert!(matches!(refused(kink(0.2), 1e-6), Some(NotInvertible::TooNonlinear { factor: 0.0, .. })));
}
