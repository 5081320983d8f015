//! The square-root update against exact rational arithmetic, where doubles are short: 200 g beside 1 g, variances over
//! 12 decades, a prior of a million standard uncertainties.
//!
//! The reference takes the same doubles for exact numbers, sums the normal equations and solves them by elimination
//! in rationals of any length: no rounding anywhere until its results are read as doubles.

use centrical::STANDARD_GRAVITY;
use centrical::fit::filter::Factor;
use nalgebra::{DMatrix, DVector, Vector3};
use num_rational::BigRational;
use num_traits::{ToPrimitive, Zero};

use crate::common::Random;

/// Bias, scale, quadratic and cubic of one newtonometer, and two turns that are read as a sum only.
const STATES: usize = 6;

/// Typical sizes of the states, SI.
const TYPICAL: [f64; STATES] = [5e-2, 1e-3, 1e-6, 1e-9, 1e-3, 1e-3];

/// Coefficients of the best reading: 200 g, 1e-6 m/s^2.
const BEST: [f64; STATES] = [1e6, 2e9, 4e12, 8e15, 2e9, 2e9];

/// Whitened equations `row x = misfit`.
type Equations = Vec<([f64; STATES], f64)>;

/// A prior on every state of `1e6` standard uncertainties of the best reading, then readings from -200 g to 200 g whose standard uncertainties go
/// from 1e-6 to 1 m/s^2, heavy and light ones mixed.
fn equations(random: &mut Random) -> Equations {
    let mut equations = Equations::new();
    for j in 0..STATES {
        let mut row = [0.0; STATES];
        row[j] = 1e-6 * BEST[j];
        equations.push((row, random.normal()));
    }
    for n in 0..36 {
        let g = [1.0, -1.0, 200.0, -200.0, 50.0, 120.0 * random.uniform()][n % 6];
        let f: f64 = g * STANDARD_GRAVITY;
        let sigma = 10_f64.powi(-6 + i32::try_from((n / 6) % 7).unwrap());
        let turn = f * random.normal();
        let row = [1.0, f, f * f, f * f * f, turn, turn].map(|value| value / sigma);
        let truth: f64 = row.iter().zip(TYPICAL).map(|(a, x)| a * x).sum();
        equations.push((row, truth + random.normal()));
    }
    equations
}

/// Three at a time through the factor.
fn filtered(equations: &Equations) -> (DVector<f64>, DMatrix<f64>) {
    let mut factor = Factor::new(STATES);
    for three in equations.chunks(3) {
        let columns: Vec<_> = (0..STATES).map(|j| (j, Vector3::from_fn(|i, _| three[i].0[j]))).collect();
        factor.update(&columns, &Vector3::from_fn(|i, _| three[i].1));
    }
    factor.solve().unwrap()
}

/// The same in rationals: estimate and covariance.
fn reference(equations: &Equations) -> (DVector<f64>, DMatrix<f64>) {
    let exact = |value: f64| BigRational::from_float(value).unwrap();
    // [information | right side | unit matrix]
    let width = 2 * STATES + 1;
    let mut m = vec![vec![BigRational::zero(); width]; STATES];
    for (row, misfit) in equations {
        for i in 0..STATES {
            for j in 0..STATES {
                m[i][j] += exact(row[i]) * exact(row[j]);
            }
            m[i][STATES] += exact(row[i]) * exact(*misfit);
        }
    }
    for i in 0..STATES {
        m[i][STATES + 1 + i] = exact(1.0);
    }
    for pivot in 0..STATES {
        let scale = m[pivot][pivot].recip();
        m[pivot].iter_mut().for_each(|value| *value *= &scale);
        for other in (0..STATES).filter(|&other| other != pivot) {
            let factor = m[other][pivot].clone();
            for k in 0..width {
                let share = &factor * &m[pivot][k];
                m[other][k] -= share;
            }
        }
    }
    let read = |i: usize, k: usize| m[i][k].to_f64().unwrap();
    let x = DVector::from_fn(STATES, |i, _| read(i, STATES));
    (x, DMatrix::from_fn(STATES, STATES, |i, j| read(i, STATES + 1 + j)))
}

/// Values to a few last places of the largest whitened reading, covariances to 1e-9 relative, symmetric and
/// positive definite.
#[test]
fn square_root_update_equals_exact_rationals() {
    for seed in 0..10 {
        let equations = equations(&mut Random::new(seed));
        let (x, covariance) = filtered(&equations);
        let (x_exact, covariance_exact) = reference(&equations);
        // Some 1e7 standard uncertainties, so a few 1e-9 of one.
        let last_place = f64::EPSILON * equations.iter().map(|(_, misfit)| misfit.abs()).fold(0.0, f64::max);
        for i in 0..STATES {
            let sigma = covariance_exact[(i, i)].sqrt();
            let error = (x[i] - x_exact[i]).abs() / sigma;
            assert!(error < 4.0 * last_place, "seed {seed}, value {i}: {error:e}");
            for j in 0..STATES {
                let error = (covariance[(i, j)] - covariance_exact[(i, j)]).abs();
                let error = error / (sigma * covariance_exact[(j, j)].sqrt());
                assert!(error < 1e-9, "seed {seed}, covariance {i}, {j}: {error:e}");
                assert_eq!(covariance[(i, j)], covariance[(j, i)]);
            }
        }
        let spread = DVector::from_fn(STATES, |i, _| covariance[(i, i)].sqrt().recip());
        let correlation = DMatrix::from_diagonal(&spread) * &covariance * DMatrix::from_diagonal(&spread);
        assert!(correlation.cholesky().is_some(), "seed {seed}");
    }
}

/// The case is as hard as meant: the two turns are known apart by their prior alone, a million times less than
/// together, and the same equations in doubles by the information matrix lose the digits that the factor keeps.
#[test]
fn the_case_is_hard() {
    let equations = equations(&mut Random::new(0));
    let (_, exact) = reference(&equations);
    let apart = exact[(4, 4)] - 2.0 * exact[(4, 5)] + exact[(5, 5)];
    let together = exact[(4, 4)] + 2.0 * exact[(4, 5)] + exact[(5, 5)];
    assert!(apart > 1e10 * together, "{apart:e} {together:e}");
    let mut information = DMatrix::zeros(STATES, STATES);
    for (row, _) in &equations {
        let row = DVector::from_column_slice(row);
        information += &row * row.transpose();
    }
    let error = information.cholesky().map_or(f64::INFINITY, |c| (c.inverse()[(4, 4)] / exact[(4, 4)] - 1.0).abs());
    assert!(error > 1e-6, "{error:e}");
}
