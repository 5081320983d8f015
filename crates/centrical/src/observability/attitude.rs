//! Which attitude to add to rests that only gravity shows.

use nalgebra::{DMatrix, Vector3};

use super::addition::{Addition, cube_directions};
use super::study::Study;
use crate::model::{Kind, TypeB};

/// The best attitude to add: of the faces, edges and corners of a cube, the one that brings back most, then the one that makes the
/// coefficients of the error model most certain together.
#[derive(Debug, Clone, PartialEq)]
pub struct NextAttitude {
    /// Where up is, instrument axes, of length 1.
    pub up_z: Vector3<f64>,
    /// Number of lost combinations that it brings back.
    pub gain: usize,
    /// Standard uncertainties of the coefficients after it over those before, their geometric mean; 1 where a combination comes back,
    /// since it had none.
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
    pub fn next_attitude(&self) -> Option<NextAttitude> {
        let experiment = self.model().experiment();
        experiment.positions.iter().find(|position| position.is_free)?;
        if self.observability().lost() > 0 {
            return self.regaining_attitude();
        }
        // What the laboratory states, such as gravity, is off in all rests alike: noise alone tells one attitude from another.
        let model = self.model().clone().with_stated(TypeB::default());
        let up_z = Self::at_zero(model, self.weights().to_vec()).ok()?.sharpening_direction()?;
        let after = Addition::Attitude(up_z).apply(self).ok()?;
        let parameters = self.model().parameters();
        let terms = (0..parameters.len()).filter(|&j| matches!(parameters[j].kind, Kind::Term(_)));
        let ratio = |j: usize| {
            let same = after.model().parameters().find(&parameters[j].name)?;
            Some((j, after.standard_uncertainty(same)? / self.standard_uncertainty(j)?))
        };
        let ratios: Vec<(usize, f64)> = terms.filter_map(ratio).collect();
        let factor = (ratios.iter().map(|(_, ratio)| ratio.ln()).sum::<f64>() / ratios.len() as f64).exp();
        let most = ratios.into_iter().min_by(|a, b| a.1.total_cmp(&b.1));
        Some(NextAttitude { up_z, gain: 0, factor, most })
    }

    /// The direction of up whose rest leaves the smallest determinant of the covariance `C` of what all rests share.
    ///
    /// A rest adds equations with the rows `R` and the covariance `S`: see [`Study::equations`]. The determinant of `C` shrinks by
    /// `det S / det (S + R C R^T)`.
    fn sharpening_direction(&self) -> Option<Vector3<f64>> {
        let shared = self.shared();
        let count = shared.len();
        let covariance = DMatrix::from_fn(count, count, |i, j| self.observability().covariance(shared[i], shared[j]));
        let mut best: Option<(f64, Vector3<f64>)> = None;
        for up_z in cube_directions() {
            let Equations { rows, covariance: noise } = self.equations(&up_z, &shared);
            let volume = |matrix: DMatrix<f64>| Some(matrix.cholesky()?.l_dirty().diagonal().product());
            let before = volume(noise.clone())?;
            let factor = before / volume(noise + &rows * &covariance * rows.transpose())?;
            // A later direction has to be better beyond rounding, so that the simplest of equal ones is taken.
            if best.is_none_or(|(least, _)| factor < least * (1.0 - 1e-9)) {
                best = Some((factor, up_z));
            }
        }
        best.map(|(_, up_z)| up_z)
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
        let Some(uncertainty) = model.experiment().position_of(set_point).attitude_uncertainty else {
            let along = DMatrix::from_fn(1, 3, |_, i| up_z[i]);
            let variance = self.variance_along_force();
            return Equations { rows: along * rows, covariance: DMatrix::from_element(1, 1, variance) };
        };
        let noise = DMatrix::from_fn(3, 3, |i, j| new.covariance[(i, j)]);
        Equations { rows, covariance: noise + &theta * theta.transpose() * uncertainty.powi(2) }
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
