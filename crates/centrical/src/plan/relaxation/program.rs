//! A convex quadratic programme by interior points: `min (x - w)^T H (x - w) / 2 - b^T (x - w)` within bounds and under rows
//! `a^T x <= most`, from any start. Bounds and rows are kept by a barrier `mu`, lowered at each Newton step of the joint
//! equations of `x` and the multipliers (primal and dual, infeasible start; Wright 1997, "Primal-Dual Interior-Point Methods").

use nalgebra::{DMatrix, DVector};

/// Newton steps at most.
const STEPS: usize = 40;

/// What is left of the barrier after a step.
const CENTRING: f64 = 0.12;

/// Part of the way to the nearest bound that a step goes at most.
const INSIDE: f64 = 0.98;

/// The barrier at the start.
const BARRIER: f64 = 1e-3;

/// `sum a_i x_i <= most`.
#[derive(Debug, Clone)]
pub(super) struct Row {
    pub terms: Vec<(usize, f64)>,
    pub most: f64,
}

impl Row {
    fn at(&self, x: &DVector<f64>) -> f64 {
        self.terms.iter().map(|(i, a)| a * x[*i]).sum()
    }
}

/// The programme.
pub(super) struct Program {
    pub hessian: DMatrix<f64>,
    /// `b`.
    pub benefit: DVector<f64>,
    /// `w`.
    pub start: DVector<f64>,
    pub low: DVector<f64>,
    pub high: DVector<f64>,
    pub rows: Vec<Row>,
}

/// A point, and the multipliers of the rows there.
pub(super) struct Optimum {
    pub x: DVector<f64>,
    pub multipliers: Vec<f64>,
}

/// Unknowns of the joint equations: multipliers of the bounds below and above and of the rows, and what the rows leave.
struct State {
    x: DVector<f64>,
    below: DVector<f64>,
    above: DVector<f64>,
    of_rows: Vec<f64>,
    left: Vec<f64>,
}

impl Program {
    /// The optimum, its objective to `tolerance`; none where there is no way on inside the bounds and rows.
    pub fn solve(&self, tolerance: f64) -> Option<Optimum> {
        let mut state = self.inside();
        let count = (2 * state.x.len() + self.rows.len()) as f64;
        for _ in 0..STEPS {
            let barrier = self.barrier(&state);
            let missed =
                self.rows.iter().zip(&state.left).map(|(row, left)| (row.most - row.at(&state.x) - left).abs());
            if barrier * count < tolerance && missed.fold(0.0, f64::max) < 1e-6 {
                break;
            }
            self.step(&mut state, CENTRING * barrier)?;
        }
        Some(Optimum { x: state.x, multipliers: state.of_rows })
    }

    fn inside(&self) -> State {
        let n = self.start.len();
        let x = DVector::from_fn(n, |i, _| {
            let margin = 0.05 * (self.high[i] - self.low[i]);
            self.start[i].clamp(self.low[i] + margin, self.high[i] - margin)
        });
        let left: Vec<f64> = self.rows.iter().map(|row| (row.most - row.at(&x)).max(0.05)).collect();
        State {
            below: DVector::from_fn(n, |i, _| BARRIER / (x[i] - self.low[i])),
            above: DVector::from_fn(n, |i, _| BARRIER / (self.high[i] - x[i])),
            of_rows: left.iter().map(|left| BARRIER / left).collect(),
            left,
            x,
        }
    }

    /// Mean product of what is left of a bound or a row and its multiplier.
    fn barrier(&self, state: &State) -> f64 {
        let n = state.x.len();
        let of_bounds =
            |i: usize| state.below[i] * (state.x[i] - self.low[i]) + state.above[i] * (self.high[i] - state.x[i]);
        let of_rows: f64 = state.of_rows.iter().zip(&state.left).map(|(z, s)| z * s).sum();
        ((0..n).map(of_bounds).sum::<f64>() + of_rows) / (2 * n + self.rows.len()) as f64
    }

    /// One Newton step towards the barrier `mu`.
    fn step(&self, state: &mut State, mu: f64) -> Option<()> {
        let n = state.x.len();
        let mut system = self.hessian.clone();
        // -H (x - w) + b, to which the multipliers come.
        let mut right = &self.benefit - &self.hessian * (&state.x - &self.start);
        for i in 0..n {
            let (below, above) = (state.x[i] - self.low[i], self.high[i] - state.x[i]);
            system[(i, i)] += state.below[i] / below + state.above[i] / above;
            right[i] += mu / below - mu / above;
        }
        let mut missed = Vec::with_capacity(self.rows.len());
        for (k, row) in self.rows.iter().enumerate() {
            let miss = row.most - row.at(&state.x) - state.left[k];
            let stiffness = state.of_rows[k] / state.left[k];
            for &(i, a) in &row.terms {
                right[i] -= a * (mu / state.left[k] - stiffness * miss);
                for &(j, b) in &row.terms {
                    system[(i, j)] += stiffness * a * b;
                }
            }
            missed.push(miss);
        }
        let dx = system.cholesky()?.solve(&right);
        if dx.iter().any(|d| !d.is_finite()) {
            // Rows that hardly leave an inside have brought an unknown to its bound to the last digit.
            return None;
        }
        let mut part: f64 = 1.0;
        let mut limit = |value: f64, change: f64| {
            if change < 0.0 {
                part = part.min(-INSIDE * value / change);
            }
        };
        let (mut d_below, mut d_above) = (DVector::zeros(n), DVector::zeros(n));
        for i in 0..n {
            let (below, above) = (state.x[i] - self.low[i], self.high[i] - state.x[i]);
            d_below[i] = (mu - state.below[i] * dx[i]) / below - state.below[i];
            d_above[i] = (mu + state.above[i] * dx[i]) / above - state.above[i];
            limit(below, dx[i]);
            limit(above, -dx[i]);
            limit(state.below[i], d_below[i]);
            limit(state.above[i], d_above[i]);
        }
        let mut of_rows = Vec::with_capacity(self.rows.len());
        for (k, row) in self.rows.iter().enumerate() {
            let d_left = missed[k] - row.at(&dx);
            let d_row = (mu - state.of_rows[k] * d_left) / state.left[k] - state.of_rows[k];
            limit(state.left[k], d_left);
            limit(state.of_rows[k], d_row);
            of_rows.push((d_left, d_row));
        }
        state.x += part * dx;
        state.below += part * d_below;
        state.above += part * d_above;
        for (k, (d_left, d_row)) in of_rows.into_iter().enumerate() {
            state.left[k] += part * d_left;
            state.of_rows[k] += part * d_row;
        }
        Some(())
    }
}
