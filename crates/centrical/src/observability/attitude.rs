//! Which attitude to add to rests that only gravity shows.

use nalgebra::{DMatrix, DVector, Vector3};

use super::addition::{Addition, cube_directions};
use super::study::Study;

/// The best attitude to add: of the faces, edges and corners of a cube, the one that brings back most, then the one that makes the
/// coefficients of the error model most certain together.
#[derive(Debug, Clone, PartialEq)]
pub struct NextAttitude {
    /// Where up is, instrument axes, of length 1.
    pub up_z: Vector3<f64>,
    /// Number of lost combinations that it brings back.
    pub gain: usize,
    /// Standard uncertainties of the coefficients after it over those before, their geometric mean over independent directions;
    /// 1 where a combination comes back, since it had none.
    pub factor: f64,
    /// The coefficient that it improves most, by its index, and the same ratio of its uncertainty.
    pub most: Option<(usize, f64)>,
}

impl Study {
    /// The best attitude to add to rests in free attitudes, of those of a cube; `None` where the experiment has no such rest, or where
    /// something is lost that no such attitude brings back. A new rest is as noisy as the median one.
    ///
    /// A rest in a free attitude is one equation for the coefficients, along the specific force. With the covariance `C` of the
    /// coefficients, the row `r` of the equation and its variance `s^2`, the determinant of `C` shrinks by `1 + r C r^T / s^2`, and the
    /// variance of coefficient `j` by `1 - (C r^T)_j^2 / (C_jj (s^2 + r C r^T))`.
    pub fn next_attitude(&self) -> Option<NextAttitude> {
        let experiment = self.model().experiment();
        experiment.positions.iter().find(|position| position.is_free)?;
        if self.observability().lost() > 0 {
            return self.regaining_attitude();
        }
        let (first, count) = (self.model().parameters().first_term(), self.model().error_model().terms.len());
        let covariance = DMatrix::from_fn(count, count, |i, j| self.observability().covariance(first + i, first + j));
        let mut best: Option<NextAttitude> = None;
        for up_z in cube_directions() {
            let (row, variance) = self.equation(&up_z);
            let change = &covariance * &row;
            let shown = row.dot(&change);
            let factor = (1.0 + shown / variance).powf(-0.5 / count as f64);
            let ratio =
                |j: usize| (1.0 - change[j].powi(2) / (covariance[(j, j)] * (variance + shown))).max(0.0).sqrt();
            let most = (0..count).map(|j| (first + j, ratio(j))).min_by(|a, b| a.1.total_cmp(&b.1));
            // A later direction has to be better beyond rounding, so that the simplest of equal ones is taken.
            if best.as_ref().is_none_or(|best| factor < best.factor * (1.0 - 1e-9)) {
                best = Some(NextAttitude { up_z, gain: 0, factor, most });
            }
        }
        best
    }

    /// The attitude that brings back most, and leaves the smallest singular value largest.
    fn regaining_attitude(&self) -> Option<NextAttitude> {
        let mut best: Option<(usize, f64, Vector3<f64>)> = None;
        for up_z in cube_directions() {
            let Ok(after) = Addition::Attitude(up_z).apply(self) else { continue };
            let gain = self.observability().lost().saturating_sub(after.observability().lost());
            let smallest = after.observability().smallest_relative().unwrap_or(0.0);
            let is_better = |(most, large, _): &(usize, f64, _)| (gain, smallest) > (*most, *large * (1.0 + 1e-9));
            if gain > 0 && best.as_ref().is_none_or(is_better) {
                best = Some((gain, smallest, up_z));
            }
        }
        best.map(|(gain, _, up_z)| NextAttitude { up_z, gain, factor: 1.0, most: None })
    }

    /// The row of the equation that a rest with `up_z` adds for the coefficients, at zero: `u_i m_j(g u)` for the monomial `m_j` of
    /// newtonometer `i`; and its variance, that of the median rest along its force [m^2/s^4].
    fn equation(&self, up_z: &Vector3<f64>) -> (DVector<f64>, f64) {
        let force = up_z * self.model().experiment().site.gravity;
        let terms = &self.model().error_model().terms;
        let row = terms.iter().map(|term| up_z[term.axis] * term.monomial.value(force.into()));
        // What trembles in a hand is the attitude: across the force a rest is noisier than along it.
        let experiment = self.model().experiment();
        let mut variances: Vec<f64> = (self.weights().iter())
            .map(|weight| {
                let along =
                    experiment.position_of(&experiment.set_points[weight.set_point]).p_zy.column(2).into_owned();
                along.dot(&(weight.covariance * along))
            })
            .collect();
        variances.sort_by(f64::total_cmp);
        (DVector::from_iterator(terms.len(), row), variances[variances.len() / 2])
    }
}
