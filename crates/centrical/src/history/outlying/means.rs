//! The mean of each unit over its sessions, with its errors.

use nalgebra::DMatrix;

use super::corrected::Corrected;
use super::sessions::UnitSessions;

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
        let count = sessions.counts[unit];
        for t in 0..count {
            self.corrected.add_errors(&(sessions.session)(unit, t), weight / (count * count) as f64, sum);
        }
    }
}
