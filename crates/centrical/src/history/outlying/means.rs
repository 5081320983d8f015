//! The mean of each unit over its sessions, with its errors by what sessions state and how they scatter.

use nalgebra::DMatrix;

use super::component::{Component, Known};
use super::rows::{Rows, add_scaled};
use crate::history::together::SessionEstimates;

/// The sessions of units of one type.
pub struct UnitSessions<'a> {
    /// Number of sessions of each unit, one or more.
    pub counts: &'a [usize],
    /// Session `t` of a unit, in the order of time: `p` values and the covariance of their errors as it states them, made when it is asked for.
    pub session: &'a (dyn Fn(usize, usize) -> SessionEstimates + Sync),
}

/// What units are by their sessions.
pub struct UnitMeans {
    /// Means over the sessions of each unit, `n x p`.
    pub values: DMatrix<f64>,
    /// Variances of their errors, `n x p`.
    pub variances: DMatrix<f64>,
    /// Covariance of what differs from session to session beside stated errors.
    between: DMatrix<f64>,
    /// The factor of stated errors, 1 or less.
    factor: f64,
}

/// Fewer differences say nothing.
const FEWEST_DIFFERENCES: usize = 10;

impl UnitMeans {
    /// Those of `sessions`. The errors of session `t` have the covariance `f C_t + T`: as stated, corrected by the differences of neighbouring
    /// sessions. Units, their drift and what sessions share cancel in differences, or nearly.
    pub fn of(sessions: &UnitSessions) -> Self {
        let session = sessions.session;
        let p = session(0, 0).values.len();
        let (between, factor) =
            differences(sessions, p).map_or((DMatrix::zeros(p, p), 1.0), |of| (of.between * 0.5, of.factor));
        let n = sessions.counts.len();
        let mut means = Self { values: DMatrix::zeros(n, p), variances: DMatrix::zeros(n, p), between, factor };
        for (unit, &count) in sessions.counts.iter().enumerate() {
            let mut errors = DMatrix::zeros(p, p);
            for session in (0..count).map(|t| session(unit, t)) {
                let mut sum = means.values.row_mut(unit);
                sum += session.values.transpose() / count as f64;
            }
            means.add_errors(sessions, unit, 1.0, &mut errors);
            means.variances.set_row(unit, &errors.diagonal().transpose());
        }
        means
    }

    /// Adds the covariance of the errors of a unit's mean, times a weight, to a sum.
    pub fn add_errors(&self, sessions: &UnitSessions, unit: usize, weight: f64, sum: &mut DMatrix<f64>) {
        let count = sessions.counts[unit] as f64;
        for t in 0..sessions.counts[unit] {
            add_scaled(&(sessions.session)(unit, t).covariance, weight * self.factor / (count * count), sum);
        }
        add_scaled(&self.between, weight / count, sum);
    }
}

/// What neighbouring sessions differ by beside stated errors; `None` where there are too few, or they do not differ.
fn differences(sessions: &UnitSessions, p: usize) -> Option<Component> {
    let pairs_of = |(unit, count): (usize, &usize)| (1..*count).map(move |t| (unit, t));
    let pairs: Vec<(usize, usize)> = sessions.counts.iter().enumerate().flat_map(pairs_of).collect();
    if pairs.len() < FEWEST_DIFFERENCES {
        return None;
    }
    let session = sessions.session;
    let add_errors = |pair: usize, weight: f64, sum: &mut DMatrix<f64>| {
        let (unit, t) = pairs[pair];
        add_scaled(&session(unit, t - 1).covariance, weight, sum);
        add_scaled(&session(unit, t).covariance, weight, sum);
    };
    let (mut values, mut variances) = (DMatrix::zeros(pairs.len(), p), DMatrix::zeros(pairs.len(), p));
    for (pair, &(unit, t)) in pairs.iter().enumerate() {
        let (before, after) = (session(unit, t - 1), session(unit, t));
        values.set_row(pair, &(after.values - before.values).transpose());
        variances.set_row(pair, &(after.covariance.diagonal() + before.covariance.diagonal()).transpose());
    }
    let rows = Rows { values, variances, add_errors: &add_errors };
    Component::of(&rows, &Known::of(pairs.len(), p)?)
}
