//! Which attitude to add to rests that only gravity shows.

use nalgebra::{DMatrix, Vector3};

use super::addition::{Addition, cube_directions};
use super::study::Study;
use crate::model::Kind;

/// The best attitude to add: of the faces, edges and corners of a cube, the one that brings back most, then the one that makes the
/// coefficients of the error model most certain together.
#[derive(Debug, Clone, PartialEq)]
pub struct NextAttitude {
    /// Where up is, instrument axes, of length 1.
    pub up_z: Vector3<f64>,
    /// Number of lost combinations that it brings back.
    pub gain: usize,
    /// Standard uncertainties of the coefficients, and of the turn against the case where attitudes are known, after it over those
    /// before, their geometric mean over independent directions; 1 where a combination comes back, since it had none.
    pub factor: f64,
    /// The coefficient that it improves most, by its index, and the same ratio of its uncertainty.
    pub most: Option<(usize, f64)>,
}

/// What a rest adds: `R` for the unknowns that all rests share, and `S`, the covariance of the errors of its equations.
struct Equations {
    rows: DMatrix<f64>,
    covariance: DMatrix<f64>,
}

impl Study {
    /// The best attitude to add to rests in free attitudes, of those of a cube; `None` where the experiment has no such rest, or where
    /// something is lost that no such attitude brings back. A new rest is as noisy as the median one, and as well known as the others.
    ///
    /// A rest adds equations with the rows `R` and the covariance `S`: see [`Study::equations`]. With the covariance `C` of the
    /// coefficients, and of the turn against the case where attitudes are known, the determinant of `C` shrinks by `det S / det M`,
    /// `M = S + R C R^T`, and the variance of coefficient `j` by `1 - (C R^T M^-1 R C)_jj / C_jj`.
    pub fn next_attitude(&self) -> Option<NextAttitude> {
        let experiment = self.model().experiment();
        experiment.positions.iter().find(|position| position.is_free)?;
        if self.observability().lost() > 0 {
            return self.regaining_attitude();
        }
        let shared = self.shared();
        let count = shared.len();
        let covariance = DMatrix::from_fn(count, count, |i, j| self.observability().covariance(shared[i], shared[j]));
        let mut best: Option<NextAttitude> = None;
        for up_z in cube_directions() {
            let Equations { rows, covariance: noise } = self.equations(&up_z, &shared);
            let change = &rows * &covariance;
            let before = noise.clone().cholesky()?;
            let after = (noise + &change * rows.transpose()).cholesky()?;
            let factor = (before.l_dirty().diagonal().component_div(&after.l_dirty().diagonal()))
                .product()
                .powf(1.0 / count as f64);
            let whitened = after.l().solve_lower_triangular(&change)?;
            let ratio = |j: usize| (1.0 - whitened.column(j).norm_squared() / covariance[(j, j)]).max(0.0).sqrt();
            let terms = (0..count).filter(|&j| matches!(self.model().parameters()[shared[j]].kind, Kind::Term(_)));
            let most = terms.map(|j| (shared[j], ratio(j))).min_by(|a, b| a.1.total_cmp(&b.1));
            // A later direction has to be better beyond rounding, so that the simplest of equal ones is taken.
            if best.as_ref().is_none_or(|best| factor < best.factor * (1.0 - 1e-9)) {
                best = Some(NextAttitude { up_z, gain: 0, factor, most });
            }
        }
        best
    }

    /// What all rests in free attitudes share, by index: the coefficients, and the turn against the case where attitudes are known.
    fn shared(&self) -> Vec<usize> {
        let parameters = self.model().parameters().iter().enumerate();
        let shared = parameters.filter(|(_, parameter)| matches!(parameter.kind, Kind::Term(_) | Kind::CaseTurn(_)));
        shared.map(|(j, _)| j).collect()
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

    /// The equations that a rest with `up_z` adds for the unknowns `shared`, at zero.
    ///
    /// Where its attitude is unknown, `theta` takes two of the three equations of its mean, and the one along the specific force
    /// remains: `R = u^T H`, `S = u^T N u`, `H` the design matrix and `N` the covariance of the mean. Where its attitude is known to
    /// `u(theta)`, all three remain: `R = H`, `S = N + u(theta)^2 Theta Theta^T`, `Theta` the columns of `theta`.
    fn equations(&self, up_z: &Vector3<f64>, shared: &[usize]) -> Equations {
        let (model, weights) = Addition::Attitude(*up_z).added_to(self);
        let parameters = model.parameters();
        let new = weights[weights.len() - 1];
        let set_point = &model.experiment().set_points[new.set_point];
        let columns = model.linearise_at_zero(set_point).columns;
        let mut rows = DMatrix::zeros(3, shared.len());
        let mut theta = DMatrix::zeros(3, 0);
        for (j, column) in &columns {
            let parameter = &parameters[*j];
            if let Some(at) = shared.iter().position(|&known| self.model().parameters()[known].name == parameter.name) {
                rows.set_column(at, column);
            } else {
                theta = theta.insert_column(0, 0.0);
                theta.set_column(0, column);
            }
        }
        match model.experiment().position_of(set_point).attitude_uncertainty {
            Some(uncertainty) => {
                let noise = DMatrix::from_fn(3, 3, |i, j| new.covariance[(i, j)]);
                Equations { rows, covariance: noise + &theta * theta.transpose() * uncertainty.powi(2) }
            }
            None => {
                let along = DMatrix::from_fn(1, 3, |_, i| up_z[i]);
                Equations { rows: along * rows, covariance: DMatrix::from_element(1, 1, self.variance_along_force()) }
            }
        }
    }

    /// Variance of the median rest along its force [m^2/s^4]: what trembles in a hand is the attitude, so that across the force a rest
    /// is noisier.
    fn variance_along_force(&self) -> f64 {
        let experiment = self.model().experiment();
        let mut variances: Vec<f64> = (self.weights().iter())
            .map(|weight| {
                let position = experiment.position_of(&experiment.set_points[weight.set_point]);
                let along = position.p_zy.column(2).into_owned();
                along.dot(&(weight.covariance * along))
            })
            .collect();
        variances.sort_by(f64::total_cmp);
        variances[variances.len() / 2]
    }
}
