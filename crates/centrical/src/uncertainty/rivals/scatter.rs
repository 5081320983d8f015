//! The scatter of residuals, against which what an effect or a pattern explains is large or small.

use super::columns::Columns;
use crate::fit::Calibration;
use crate::model::FitError;
use crate::statistics::{chi_squared_tail, f_tail};

/// Squares of residuals and how many there are.
#[derive(Debug, Clone, Copy)]
pub(in crate::uncertainty) struct Scatter {
    chi_squared: f64,
    degrees_of_freedom: f64,
    /// Of rests in known attitudes, those along the forces, and their expectation.
    along_forces: Option<(f64, f64)>,
    /// Whether each rest is in a free attitude: its variance is that of the noise which its own record shows.
    is_of_record: bool,
}

impl Scatter {
    /// That of a calibration.
    pub fn of(calibration: &Calibration) -> Result<Self, FitError> {
        let (fit, data) = (calibration.fit(), calibration.data());
        let all = Self {
            chi_squared: fit.chi_squared,
            degrees_of_freedom: fit.degrees_of_freedom as f64,
            along_forces: None,
            is_of_record: false,
        };
        if data.model().experiment().has_arm() {
            return Ok(all);
        }
        let gain = calibration.gain()?;
        if gain.linearisations().iter().all(|at| at.normal.is_some()) {
            return Ok(Self { is_of_record: true, ..all });
        }
        // Known attitudes state an uncertainty that hides, across the forces, what a unit does: residuals there would make any scatter look
        // small.
        let columns = Columns::along_forces(gain, data.observations());
        Ok(Self { along_forces: Some((columns.along.norm_squared(), columns.redundant_length())), ..all })
    }

    /// What is left where `count` combinations explain `statistic`.
    pub fn without(&self, statistic: f64, count: usize) -> Self {
        let along = |(chi_squared, freedom)| (chi_squared - statistic, freedom - count as f64);
        Self {
            chi_squared: self.chi_squared - statistic,
            degrees_of_freedom: self.degrees_of_freedom - count as f64,
            along_forces: self.along_forces.map(along),
            ..*self
        }
    }

    /// Probability that `count` combinations explain as much as `statistic` by chance: the largest of those by the stated variances, by
    /// the scatter of all other residuals, and by that along the forces. In free attitudes nothing is stated: what differs from rest to rest is in
    /// the noise of slow rotation too, whose variance then calls it chance, and the scatter of the others alone counts.
    pub fn chance_of_explaining(&self, statistic: f64, count: usize) -> f64 {
        let left = self.without(statistic, count);
        let freedom = whole(left.degrees_of_freedom);
        if self.is_of_record {
            return by_others(statistic, count, left.chi_squared, freedom);
        }
        let by_all = chance_of_explaining(statistic, count, left.chi_squared, freedom);
        let along = left.along_forces.filter(|(_, freedom)| *freedom >= 1.0);
        along.map_or(by_all, |(rest, freedom)| by_all.max(chance_of_explaining(statistic, count, rest, whole(freedom))))
    }
}

/// Rounded down, but for rounding errors.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn whole(degrees_of_freedom: f64) -> usize {
    (degrees_of_freedom.max(0.0) + 1e-6) as usize
}

/// Probability that `m` combinations explain that much of chi^2 by chance, where `n` others leave `rest`: the larger of that by the stated
/// variances and that by the scatter of the others. A scatter below what is stated does not say of what too much is stated.
pub(in crate::uncertainty) fn chance_of_explaining(statistic: f64, m: usize, rest: f64, n: usize) -> f64 {
    by_others(statistic, m, rest, n).max(chi_squared_tail(statistic, m))
}

/// The same by the scatter of the others alone.
fn by_others(statistic: f64, m: usize, rest: f64, n: usize) -> f64 {
    f_tail((statistic / m as f64) / (rest.max(0.0) / n as f64), m as f64, n as f64)
}
