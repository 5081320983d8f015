//! From plateaus to the weighted design matrix: three whitened rows per plateau, and one per prior.
//!
//! A plateau's covariance is that of its mean plus the speed error's rank-one term `d d^T`,
//! `d = sigma d f' / d ln Omega` of the full model (`docs/source-and-findings.md`). Rows are whitened by its Cholesky factor,
//! so that least squares on them is the generalised least squares of the plateaus.

use nalgebra::{Cholesky, Const, DMatrix, DVector, Matrix3, Vector3};

use crate::error::FitError;
use crate::measurement::{Linearisation, MeasurementModel};
use crate::prior::{self, Prior};

/// The mean reading of one plateau, as data.
#[derive(Debug, Clone, PartialEq)]
pub struct Observation {
    /// Index of the plateau in [`crate::Experiment::set_points`].
    pub set_point: usize,
    /// Mean reading [m/s^2].
    pub mean: Vector3<f64>,
    /// Covariance of the mean, noise alone [m^2/s^4].
    pub covariance: Matrix3<f64>,
}

/// How well the mean of a plateau is known, or will be: an observation without its value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weight {
    /// Index of the plateau in [`crate::Experiment::set_points`].
    pub set_point: usize,
    /// Covariance of the mean, noise alone [m^2/s^4].
    pub covariance: Matrix3<f64>,
}

impl Weight {
    /// The same white noise of standard deviation `sigma` [m/s^2] on the means of the first `count` plateaus.
    pub fn equal(count: usize, sigma: f64) -> Vec<Self> {
        let covariance = Matrix3::identity() * (sigma * sigma);
        (0..count).map(|set_point| Self { set_point, covariance }).collect()
    }
}

impl From<&Observation> for Weight {
    fn from(observation: &Observation) -> Self {
        Self { set_point: observation.set_point, covariance: observation.covariance }
    }
}

impl Observation {
    /// `L` of the covariance of the mean, `C = L L^T` [m/s^2].
    pub(crate) fn noise_factor(&self) -> Result<Matrix3<f64>, FitError> {
        let diagonal = self.covariance.diagonal().into();
        let error = FitError::Covariance { set_point: self.set_point, diagonal };
        self.covariance.cholesky().map(|factor| factor.l()).ok_or(error)
    }
}

/// Weighted linearised equations `rows du = misfit` of all plateaus, and of the priors if any.
pub(crate) struct Design {
    /// `3 n x p`, whitened; then the priors.
    pub rows: DMatrix<f64>,
    /// `3 n`, whitened readings less whitened model; then the priors.
    pub misfit: DVector<f64>,
    /// Norm of what no unknown can take up, where it has been rotated out of the rows; 0 where it is still in them.
    pub rest: f64,
    /// Norm of the whitened readings of the model: what rounding is relative to.
    pub magnitude: f64,
}

impl Design {
    /// Stacks the plateaus' linearisations, whitened by their covariances.
    ///
    /// # Errors
    /// [`FitError::Covariance`] when a plateau's covariance is not positive definite.
    pub fn new(
        observations: &[Observation],
        linearisations: &[Linearisation],
        columns: usize,
    ) -> Result<Self, FitError> {
        let mut rows = DMatrix::zeros(3 * observations.len(), columns);
        let mut misfit = DVector::zeros(3 * observations.len());
        let mut magnitude = 0.0;
        for (n, (observation, linearisation)) in observations.iter().zip(linearisations).enumerate() {
            let whitener = Whitener::new(&observation.into(), &linearisation.speed_error)?;
            whitener.fill(&mut rows, n, linearisation);
            misfit.fixed_rows_mut::<3>(3 * n).copy_from(&whitener.apply(&(observation.mean - linearisation.reading)));
            magnitude += whitener.apply(&linearisation.reading).norm_squared();
        }
        Ok(Self { rows, misfit, rest: 0.0, magnitude: magnitude.sqrt() })
    }

    /// The equations of the plateaus and of the priors of `model`, linearised at `x`.
    ///
    /// # Errors
    /// As [`Design::new`].
    pub fn at(
        x: &[f64],
        model: &MeasurementModel,
        observations: &[Observation],
        linearisations: &[Linearisation],
    ) -> Result<Self, FitError> {
        let data = Self::new(observations, linearisations, x.len())?;
        Ok(data.with_priors(model.priors(), &DVector::from_column_slice(x)))
    }

    /// Adds the equations of the priors at the point `x` of the linearisation.
    pub fn with_priors(mut self, priors: &[Prior], x: &DVector<f64>) -> Self {
        let equations = prior::rows(priors, self.rows.ncols());
        let (n, m) = (self.rows.nrows(), priors.len());
        self.rows = self.rows.resize_vertically(n + m, 0.0);
        self.misfit = self.misfit.resize_vertically(n + m, 0.0);
        self.misfit.rows_mut(n, m).copy_from(&-(&equations * x));
        self.rows.rows_mut(n, m).copy_from(&equations);
        self
    }
}

/// The whitened rows of plateaus of given weights, `3 n x p`.
///
/// # Errors
/// [`FitError::Covariance`] when a covariance is not positive definite.
pub(crate) fn whitened_rows(
    weights: &[Weight],
    linearisations: &[Linearisation],
    columns: usize,
) -> Result<DMatrix<f64>, FitError> {
    let mut rows = DMatrix::zeros(3 * weights.len(), columns);
    for (n, (weight, linearisation)) in weights.iter().zip(linearisations).enumerate() {
        Whitener::new(weight, &linearisation.speed_error)?.fill(&mut rows, n, linearisation);
    }
    Ok(rows)
}

/// Takes a plateau's errors to independent ones of unit variance.
#[derive(Debug, Clone)]
pub(crate) struct Whitener(Cholesky<f64, Const<3>>);

impl Whitener {
    /// From the covariance of the mean and the speed term.
    pub fn new(weight: &Weight, speed_error: &Vector3<f64>) -> Result<Self, FitError> {
        let total = total_covariance(&weight.covariance, speed_error);
        Cholesky::new(total)
            .map(Self)
            .ok_or(FitError::Covariance { set_point: weight.set_point, diagonal: weight.covariance.diagonal().into() })
    }

    /// `L^-1 v`.
    pub fn apply(&self, v: &Vector3<f64>) -> Vector3<f64> {
        // A Cholesky factor has no zero on its diagonal, so the triangular system has a solution.
        self.0.l_dirty().solve_lower_triangular(v).unwrap_or_else(Vector3::zeros)
    }

    /// Writes the three rows of plateau `n`.
    fn fill(&self, rows: &mut DMatrix<f64>, n: usize, linearisation: &Linearisation) {
        let mut block = rows.fixed_rows_mut::<3>(3 * n);
        for (column, derivative) in &linearisation.columns {
            block.set_column(*column, &self.apply(derivative));
        }
    }
}

/// `C + d d^T` [m^2/s^4], `d` the change of the mean by one standard uncertainty of the speed.
pub(crate) fn total_covariance(mean: &Matrix3<f64>, speed_error: &Vector3<f64>) -> Matrix3<f64> {
    mean + speed_error * speed_error.transpose()
}
