//! What a plan makes small.
//!
//! Every criterion is a function of the covariance `C` of the instrument's parameters, given here as the root columns
//! `K` of what it weighs: goals `r_j = sum over the columns k of goal j of k^T C k`.

use std::f64::consts::FRAC_1_SQRT_2;

use nalgebra::{DMatrix, DVector, Vector3};

use super::error::PlanError;
use crate::model::MeasurementModel;

/// What a plan makes small.
#[derive(Debug, Clone, PartialEq)]
pub enum Criterion {
    /// D: `det(C)^(1/s)` of the `s` parameters of the instrument: the volume of their joint uncertainty.
    Determinant,
    /// A: mean of `(u / typical)^2` over the parameters of the instrument.
    Average,
    /// I: mean variance of the compensated reading over forces up to this one [m/s^2]: magnitudes uniform from 0, all directions alike,
    /// mean of the three components.
    Reading(f64),
    /// The worst `(u / wanted)^2` over goals: 1 when all are just met.
    Worst(Vec<Goal>),
}

/// How the criteria `Phi_s` of several scenarios are combined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Robustness {
    /// Their weighted geometric mean, which needs no reference values.
    #[default]
    Mean,
    /// The largest: what the plan reaches whichever scenario comes true. Weights do not count. It is of use where no scenario
    /// is the worst for every plan: noise that is white, or that longer plateaus do not lower.
    Worst,
}

/// One wanted standard uncertainty.
#[derive(Debug, Clone, PartialEq)]
pub enum Goal {
    /// Of a parameter of the instrument.
    Parameter {
        /// Its name.
        name: String,
        /// Wanted standard uncertainty [its unit].
        uncertainty: f64,
    },
    /// Of the compensated reading: root mean variance, as in [`Criterion::Reading`].
    Reading {
        /// Largest magnitude of the specific force [m/s^2].
        range: f64,
        /// Wanted standard uncertainty [m/s^2].
        uncertainty: f64,
    },
}

impl Goal {
    /// The parameter, or "reading".
    pub fn name(&self) -> &str {
        match self {
            Self::Parameter { name, .. } => name,
            Self::Reading { .. } => "reading",
        }
    }

    /// Wanted standard uncertainty [its unit].
    pub fn uncertainty(&self) -> f64 {
        match self {
            Self::Parameter { uncertainty, .. } | Self::Reading { uncertainty, .. } => *uncertainty,
        }
    }

    /// The same goal with another wanted standard uncertainty.
    #[must_use]
    pub fn with_uncertainty(&self, wanted: f64) -> Self {
        let mut goal = self.clone();
        match &mut goal {
            Self::Parameter { uncertainty, .. } | Self::Reading { uncertainty, .. } => *uncertainty = wanted,
        }
        goal
    }
}

/// Columns `K` in the unknowns of a model, `p x m`, and the goal that each belongs to.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Columns {
    pub k: DMatrix<f64>,
    pub goal: Vec<usize>,
    pub is_determinant: bool,
}

impl Criterion {
    /// Its columns for the unknowns of `model`.
    pub(super) fn columns(&self, model: &MeasurementModel) -> Result<Columns, PlanError> {
        let instrument: Vec<usize> =
            (0..model.parameters().len()).filter(|&j| model.parameters()[j].is_of_instrument()).collect();
        let count = instrument.len();
        let diagonal = |entry: &dyn Fn(usize) -> f64| {
            let mut k = DMatrix::zeros(model.parameters().len(), count);
            instrument.iter().enumerate().for_each(|(m, &j)| k[(j, m)] = entry(j));
            k
        };
        match self {
            Self::Determinant => {
                let k = diagonal(&|j| 1.0 / model.parameters()[j].typical);
                Ok(Columns { k, goal: vec![0; count], is_determinant: true })
            }
            Self::Average => {
                let k = diagonal(&|j| 1.0 / (model.parameters()[j].typical * (count as f64).sqrt()));
                Ok(Columns { k, goal: vec![0; count], is_determinant: false })
            }
            Self::Reading(range) => {
                let k = reading_columns(model, *range);
                Ok(Columns { goal: vec![0; k.ncols()], k, is_determinant: false })
            }
            Self::Worst(goals) => worst(goals, model),
        }
    }
}

fn worst(goals: &[Goal], model: &MeasurementModel) -> Result<Columns, PlanError> {
    if goals.is_empty() {
        return Err(PlanError::Nothing("goals"));
    }
    let mut columns: Vec<DVector<f64>> = Vec::new();
    let mut goal = Vec::new();
    for (n, wanted) in goals.iter().enumerate() {
        match wanted {
            Goal::Parameter { name, uncertainty } => {
                let j = model.parameters().find(name).ok_or_else(|| PlanError::Unknown { name: name.clone() })?;
                let mut column = DVector::zeros(model.parameters().len());
                column[j] = 1.0 / uncertainty;
                columns.push(column);
                goal.push(n);
            }
            Goal::Reading { range, uncertainty } => {
                for column in reading_columns(model, *range).column_iter() {
                    columns.push(column / *uncertainty);
                    goal.push(n);
                }
            }
        }
    }
    Ok(Columns { k: DMatrix::from_columns(&columns), goal, is_determinant: false })
}

impl MeasurementModel {
    /// Root of the mean variance of the compensated reading [m/s^2], over forces up to `range` as in [`Criterion::Reading`], that `covariance`
    /// of the coefficients, in the order of the terms, leaves.
    pub fn reading_uncertainty(&self, range: f64, covariance: &DMatrix<f64>) -> f64 {
        let k = reading_columns(self, range).rows(self.parameters().first_term(), covariance.nrows()).into_owned();
        (k.transpose() * covariance * k).trace().max(0.0).sqrt()
    }
}

/// `K` with `tr(K^T C K)` the mean variance of the compensated reading: at no errors `df = -sum_t dc_t m_t(f) e_axis`
/// [K4.1], averaged over the forces by cubature.
fn reading_columns(model: &MeasurementModel, range: f64) -> DMatrix<f64> {
    let terms = &model.error_model().terms;
    let nodes = forces(range);
    let mut rows = DMatrix::zeros(3 * nodes.len(), terms.len());
    for (n, (force, weight)) in nodes.iter().enumerate() {
        for (t, term) in terms.iter().enumerate() {
            rows[(3 * n + term.axis, t)] = term.monomial.value((*force).into()) * (weight / 3.0).sqrt();
        }
    }
    // The triangle has the same squares in as many rows as there are terms.
    let triangle = rows.qr().r();
    let mut k = DMatrix::zeros(model.parameters().len(), triangle.nrows());
    k.rows_mut(model.parameters().first_term(), terms.len()).copy_from(&triangle.transpose());
    k
}

/// Forces up to `range` and their weights, which sum to 1: the 26 directions of Lebedev's rule of degree 7, at the four magnitudes
/// of the Gauss-Legendre rule of degree 7. Exact for squares of cubic polynomials in both.
pub(super) fn forces(range: f64) -> Vec<(Vector3<f64>, f64)> {
    const LEGENDRE: [(f64, f64); 4] = [
        (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
        (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
        (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
        (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
    ];
    let mut nodes = Vec::with_capacity(104);
    for (direction, weight) in lebedev_26() {
        for (part, share) in LEGENDRE {
            nodes.push((direction * (part * range), weight * share));
        }
    }
    nodes
}

/// Lebedev's rule of 26 points: vertices, edges and faces of the cube (V. I. Lebedev, 1976).
fn lebedev_26() -> Vec<(Vector3<f64>, f64)> {
    let mut rule = Vec::with_capacity(26);
    for x in -1_i8..=1 {
        for y in -1_i8..=1 {
            for z in -1_i8..=1 {
                let direction = Vector3::new(f64::from(x), f64::from(y), f64::from(z));
                match x.abs() + y.abs() + z.abs() {
                    1 => rule.push((direction, 1.0 / 21.0)),
                    2 => rule.push((direction * FRAC_1_SQRT_2, 4.0 / 105.0)),
                    3 => rule.push((direction / 3.0_f64.sqrt(), 9.0 / 280.0)),
                    _ => {}
                }
            }
        }
    }
    rule
}
