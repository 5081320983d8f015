//! A calibrated error model in other axes: the same readings, the form asked for, and the covariance by differences.

use centrical::uncertainty::{ModelInAxes, ScaleForm};
use centrical::{Monomial, rotation};
use centrical_compensate::{Term, reading};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use proptest::prelude::*;

const FORMS: [ScaleForm; 3] = [ScaleForm::LowerTriangular, ScaleForm::UpperTriangular, ScaleForm::Symmetric];

/// Bias, the whole scale matrix, a square and a product, of size 1 or smaller by `size`.
fn terms(coefficients: &[f64; 14], size: f64) -> Vec<Term> {
    let term = |axis: usize, powers: [u8; 3], coefficient: f64| Term {
        axis,
        monomial: Monomial { powers, sign_of: None },
        coefficient,
    };
    let linear = |k: usize| {
        let powers = [0, 1, 2].map(|j| u8::from(j == k % 3));
        term(k / 3, powers, size * coefficients[3 + k])
    };
    let bias = (0..3).map(|i| term(i, [0; 3], 0.1 * coefficients[i]));
    let others = [term(0, [2, 0, 0], 1e-4 * coefficients[12]), term(2, [1, 1, 0], 1e-4 * coefficients[13])];
    bias.chain((0..9).map(linear)).chain(others).collect()
}

fn coefficients() -> impl Strategy<Value = [f64; 14]> {
    prop::array::uniform14(-1.0..1.0_f64)
}

/// Bias, scale matrix by rows, other terms and turn from `c_zb`, as a vector.
fn stated(model: &ModelInAxes, c_zb: &Matrix3<f64>) -> DVector<f64> {
    let turned = c_zb.transpose() * model.c_zb();
    // The small turn w of c_zb (E + hat(w)).
    let turn = [turned[(1, 2)], turned[(2, 0)], turned[(0, 1)]];
    let scale = model.scale().transpose();
    let others = model.others().map(|term| term.coefficient);
    DVector::from_iterator(17, model.bias().iter().copied().chain(scale.iter().copied()).chain(others).chain(turn))
}

fn in_form(form: ScaleForm, terms: Vec<Term>) -> ModelInAxes {
    let c_zb = form.attitude(&terms).expect("near-orthogonal newtonometers");
    let size = terms.len() + 3;
    ModelInAxes::new(terms, c_zb, DMatrix::zeros(size, size)).expect("of this size")
}

/// A covariance of the coefficients of `terms` and of the turn that follows them.
fn joint(form: ScaleForm, terms: &[Term], root: &DMatrix<f64>) -> DMatrix<f64> {
    let c_zb = form.attitude(terms).unwrap();
    let by_coefficient = form.turn_by_coefficient(terms, &c_zb).unwrap();
    let count = terms.len();
    let mut by = DMatrix::zeros(count + 3, count);
    by.view_mut((0, 0), (count, count)).fill_with_identity();
    by.view_mut((count, 0), (3, count)).copy_from(&by_coefficient);
    &by * root * root.transpose() * by.transpose()
}

proptest! {
    #[test]
    fn readings_are_the_same_and_the_gain_has_its_form(c in coefficients(), f in prop::array::uniform3(-200.0..200.0_f64)) {
        let terms = terms(&c, 0.1);
        for form in FORMS {
            let model = in_form(form, terms.clone());
            let f_b = Vector3::from(f);
            let f_z: [f64; 3] = (model.c_zb() * f_b).into();
            let mut found = model.bias() + model.scale() * f_b;
            for term in model.others() {
                found[term.axis] += term.coefficient * term.monomial.value(f_z);
            }
            prop_assert!((found - Vector3::from(reading(&terms, f_z))).amax() < 1e-10);
            let t = model.scale();
            let zero = match form {
                ScaleForm::LowerTriangular => [t[(0, 1)], t[(0, 2)], t[(1, 2)]],
                ScaleForm::UpperTriangular => [t[(1, 0)], t[(2, 0)], t[(2, 1)]],
                ScaleForm::Symmetric => [t[(0, 1)] - t[(1, 0)], t[(0, 2)] - t[(2, 0)], t[(1, 2)] - t[(2, 1)]],
            };
            prop_assert!(zero.iter().all(|x| x.abs() < 1e-13), "{form:?}: {zero:?}");
        }
    }

    /// A change of each coefficient, the axes found anew: what the covariance is made of.
    #[test]
    fn covariance_is_that_of_differences(c in coefficients(), seed in prop::array::uniform14(-1.0..1.0_f64)) {
        let size = 0.1;
        let base = terms(&c, size);
        for form in FORMS {
            let model = in_form(form, base.clone());
            let h = 1e-6;
            let moved = |k: usize, h: f64| {
                let mut terms = base.clone();
                terms[k].coefficient += h;
                stated(&in_form(form, terms), model.c_zb())
            };
            let columns: Vec<_> = (0..14).map(|k| (moved(k, h) - moved(k, -h)) / (2.0 * h)).collect();
            let by = DMatrix::from_columns(&columns);
            let root = DMatrix::from_fn(14, 14, |i, j| if i == j { 1.0 + seed[i].abs() } else { 0.3 * seed[i] * seed[j] });
            let covariance = joint(form, &base, &root);
            let exact = ModelInAxes::new(base.clone(), *model.c_zb(), covariance).unwrap();
            let expected = &by * &root * root.transpose() * by.transpose();
            prop_assert!((exact.covariance() - &expected).amax() < 1e-7 * expected.amax());
        }
    }

    /// What is stated holds all: the uncertainty of a compensated reading is the same from it.
    #[test]
    fn the_stated_covariance_gives_that_of_readings(c in coefficients(), f in prop::array::uniform3(-100.0..100.0_f64)) {
        let base = terms(&c, 0.1);
        let root = DMatrix::from_fn(14, 14, |i, j| if i == j { 1e-3 } else { 1e-4 * c[i] * c[j] });
        for form in FORMS {
            let model = in_form(form, base.clone());
            let model = ModelInAxes::new(base.clone(), *model.c_zb(), joint(form, &base, &root)).unwrap();
            let again = ModelInAxes::with_covariance(base.clone(), *model.c_zb(), &model.covariance()).unwrap();
            let f_b = Vector3::from(f);
            let (one, other) = (model.covariance_at(&f_b).unwrap(), again.covariance_at(&f_b).unwrap());
            prop_assert!((one - other).amax() < 1e-9 * one.amax(), "{one} {other}");
        }
    }

    /// A turn of known size, about a mean attitude of any size, leaves `hat(f) w` in a reading; nothing else counts.
    #[test]
    fn a_turn_leaves_what_it_should(v in prop::array::uniform3(-3.0..3.0_f64), f in prop::array::uniform3(-100.0..100.0_f64)) {
        let mut covariance = DMatrix::zeros(3, 3);
        covariance[(2, 2)] = 1e-8;
        let model = ModelInAxes::new(Vec::new(), rotation(&Vector3::from(v)), covariance).unwrap();
        let found = model.covariance_at(&Vector3::from(f)).unwrap();
        let expected = Vector3::new(-f[1], f[0], 0.0) * 1e-4;
        prop_assert!((found - expected * expected.transpose()).amax() < 1e-18 + 1e-12 * found.amax());
    }
}
