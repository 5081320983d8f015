//! The mean of each unit over its sessions, with its errors.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::corrected::{Corrected, UnitSessions};

/// What units are by their sessions.
pub struct UnitMeans {
    /// Means over the sessions of each unit, `n x p`.
    pub values: DMatrix<f64>,
    /// Variances of their errors, `n x p`.
    pub variances: DMatrix<f64>,
    corrected: Corrected,
}

impl UnitMeans {
    /// Those of `sessions`. The errors of session `t` are as stated, and corrected by the differences of neighbouring sessions, if there are
    /// enough. Units, their drift and what sessions share cancel in differences, or nearly.
    pub fn of(sessions: &UnitSessions) -> Self {
        let session = sessions.session;
        let (n, p) = (sessions.counts.len(), session(0, 0).values.len());
        let corrected = Corrected::of(sessions, p);
        let mut means = Self { values: DMatrix::zeros(n, p), variances: DMatrix::zeros(n, p), corrected };
        let of_unit = |unit: usize| {
            let count = sessions.counts[unit];
            let (mut mean, mut errors) = (DVector::zeros(p), DMatrix::zeros(p, p));
            (0..count).for_each(|t| mean += session(unit, t).values / count as f64);
            means.add_errors(sessions, unit, 1.0, &mut errors);
            (mean, errors.diagonal())
        };
        let of_units: Vec<(DVector<f64>, DVector<f64>)> = (0..n).into_par_iter().map(of_unit).collect();
        for (unit, (mean, variances)) in of_units.into_iter().enumerate() {
            means.values.set_row(unit, &mean.transpose());
            means.variances.set_row(unit, &variances.transpose());
        }
        means
    }

    /// Adds the covariance of the errors of a unit's mean, times a weight, to a sum.
    pub fn add_errors(&self, sessions: &UnitSessions, unit: usize, weight: f64, sum: &mut DMatrix<f64>) {
        let count = sessions.counts[unit];
        for t in 0..count {
            self.corrected.add_errors(&(sessions.session)(unit, t), weight / (count * count) as f64, sum);
        }
    }
}
