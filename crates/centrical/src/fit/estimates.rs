//! The estimates of a fit and all that is known about them.

use nalgebra::{DMatrix, Matrix3, Vector3};

use crate::model::prior::{self, Prior};
use crate::observability::Observability;

/// How an iteration ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Termination {
    /// One linear solution was asked for.
    Linear,
    /// The next step would be below a millionth of a standard uncertainty, or of rounding size.
    Converged,
    /// No step along the Gauss-Newton direction lowers chi^2 any more.
    Stalled,
    /// The limit of iterations was reached.
    IterationLimit,
}

/// Estimates and all that is known about them.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// Estimates in the order of the model's parameters, SI; those that are not estimable have no meaning.
    pub(super) values: Vec<f64>,
    /// Estimates of the influences, in their standard uncertainties.
    pub(super) deviations: Vec<f64>,
    /// Where the model was linearised last and holds: the estimates themselves, unless weak directions are held.
    pub(super) point: Vec<f64>,
    /// Of the parameters, then the influences.
    pub(super) covariance: DMatrix<f64>,
    /// What the curvature of the model along directions that priors alone determine leaves in the estimates: columns of the
    /// covariance's root.
    pub(super) curved: DMatrix<f64>,
    pub(super) observability: Observability,
    /// What the data determine without the priors, if there are any.
    pub(super) of_data: Option<Observability>,
    pub(super) priors: Vec<Prior>,
    /// Sum of squared whitened residuals, of the priors and the influences too.
    pub chi_squared: f64,
    /// Whether the null directions, if any, had to be held to the end (see the module's text).
    pub null_directions_held: bool,
    /// `3 n` and the number of priors, less the rank; 0 when nothing is redundant.
    pub degrees_of_freedom: usize,
    /// Linearisations made.
    pub iterations: usize,
    /// How it ended.
    pub termination: Termination,
    /// Mean less model, per observation [m/s^2].
    pub residuals: Vec<Vector3<f64>>,
    /// Covariance of each observation with the errors of its setting and rounding [m^2/s^4].
    pub observation_covariances: Vec<Matrix3<f64>>,
}

impl Fit {
    /// Estimate of parameter `j`, unless the data do not determine it.
    pub fn value(&self, j: usize) -> Option<f64> {
        self.observability.is_estimable(j).then(|| self.values[j])
    }

    /// Covariance of the estimates of parameters `i` and `j`, if both are determined.
    pub fn covariance(&self, i: usize, j: usize) -> Option<f64> {
        let both = self.observability.is_estimable(i) && self.observability.is_estimable(j);
        both.then(|| self.covariance[(i, j)])
    }

    /// Covariance of the estimates of some parameters, if all are determined.
    pub(crate) fn covariance_of(&self, parameters: &[usize]) -> Option<DMatrix<f64>> {
        let determined = parameters.iter().all(|&j| self.observability.is_estimable(j));
        determined.then(|| self.covariance.select_rows(parameters).select_columns(parameters))
    }

    /// Standard uncertainty of the estimate of parameter `j`, if it is determined.
    pub fn standard_uncertainty(&self, j: usize) -> Option<f64> {
        self.covariance(j, j).map(f64::sqrt)
    }

    /// The point in parameter space at which the fit stands, lost combinations included: for prediction of
    /// readings, never as estimates.
    pub fn state(&self) -> &[f64] {
        &self.point[..self.values.len()]
    }

    /// Estimates of the influences on the experiment, in standard uncertainties and in the model's order, each with the
    /// standard uncertainty that the data leave it: near 1 where they say nothing of it.
    pub fn deviations(&self) -> Vec<(f64, f64)> {
        let first = self.values.len();
        let estimates = self.deviations.iter().enumerate();
        estimates.map(|(n, value)| (*value, self.covariance[(first + n, first + n)].sqrt())).collect()
    }

    /// What the curvature of the model leaves in the parameters, column by column.
    pub(crate) fn curved(&self) -> DMatrix<f64> {
        self.curved.rows(0, self.values.len()).into_owned()
    }

    /// Where the fit stands: the parameters, then the influences.
    pub(super) fn unknowns(&self) -> &[f64] {
        &self.point
    }

    /// What the experiment sees.
    pub fn observability(&self) -> &Observability {
        &self.observability
    }

    /// Each prior with the standard uncertainty after the data over that before: 1 when the value rests on the prior alone, near 0 when the data
    /// determine it.
    pub fn prior_uses(&self) -> Vec<(Prior, f64)> {
        prior::uses(&self.priors, |i, j| self.covariance[(i, j)])
    }

    /// Part of the variance of estimate `j` that comes from the priors, 0 to 1; `None` if it is not determined.
    pub fn prior_share(&self, j: usize) -> Option<f64> {
        let determined = self.observability.is_estimable(j);
        determined.then(|| prior::share(&self.priors, j, |i, j| self.covariance[(i, j)]))
    }

    /// Whether parameter `j` is determined only thanks to the priors.
    pub fn rests_on_prior(&self, j: usize) -> bool {
        self.observability.is_estimable(j) && self.of_data.as_ref().is_some_and(|data| !data.is_estimable(j))
    }

    /// chi^2 per degree of freedom; `None` without redundancy.
    pub fn reduced_chi_squared(&self) -> Option<f64> {
        (self.degrees_of_freedom > 0).then(|| self.chi_squared / self.degrees_of_freedom as f64)
    }
}
