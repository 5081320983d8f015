//! A plateau as a fit sees it: what was read there, what the model reads there, and the weight of the difference.
//!
//! The covariance of a plateau is that of its mean, a rank-one term `d d^T` and its rounding. The term is that of the
//! speed, `d = sigma d f' / d ln Omega` of the full model (`docs/source-and-findings.md`), or at rest that of the angle.
//! Its Cholesky factor whitens the rows: three per plateau, of independent errors of unit variance. Least squares on them is the
//! generalised least squares of the plateaus.

use nalgebra::{Cholesky, Const, DMatrix, DVector, Matrix3, Vector3};

use super::error::FitError;
use super::prior::{self, Prior};

/// The mean reading of one plateau, as data.
#[derive(Debug, Clone, PartialEq)]
pub struct Observation {
    /// Index of the plateau in [`crate::Experiment::set_points`].
    pub set_point: usize,
    /// Mean reading [m/s^2].
    pub mean: Vector3<f64>,
    /// Covariance of the mean [m^2/s^4]: the noise, and of rests what differs from one to the next.
    pub covariance: Matrix3<f64>,
}

/// How well the mean of a plateau is known, or will be: an observation without its value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weight {
    /// Index of the plateau in [`crate::Experiment::set_points`].
    pub set_point: usize,
    /// As [`Observation::covariance`] [m^2/s^4].
    pub covariance: Matrix3<f64>,
}

impl Weight {
    /// The same white noise of standard deviation `sigma` [m/s^2] on the means of the first `count` plateaus.
    pub fn equal(count: usize, sigma: f64) -> Vec<Self> {
        let covariance = Matrix3::identity() * (sigma * sigma);
        (0..count).map(|set_point| Self { set_point, covariance }).collect()
    }

    /// The Cholesky factor of `covariance`, which is that of the mean or follows from it.
    pub(crate) fn factor(&self, covariance: Matrix3<f64>) -> Result<Cholesky<f64, Const<3>>, FitError> {
        let error = FitError::Covariance { set_point: self.set_point, diagonal: self.covariance.diagonal().into() };
        Cholesky::new(covariance).ok_or(error)
    }
}

impl From<&Observation> for Weight {
    fn from(observation: &Observation) -> Self {
        Self { set_point: observation.set_point, covariance: observation.covariance }
    }
}

/// Reading of a plateau and its first derivatives at some `X`.
#[derive(Debug, Clone, PartialEq)]
pub struct Linearisation {
    /// Mean reading `f'` [m/s^2].
    pub reading: Vector3<f64>,
    /// Change of `f'` by one standard uncertainty of what the plateau was set to [m/s^2]: of its speed,
    /// `sigma d f' / d ln Omega`; at rest of its angle.
    pub setting_error: Vector3<f64>,
    /// Standard uncertainty of the plateau's own rounding [m/s^2].
    pub rounding: f64,
    /// Where only gravity shows the attitude: the normal of all readings that a turn of the unit reaches, of length 1. What moves a mean
    /// across it turns the unknown attitude, and is not an error.
    pub normal: Option<Vector3<f64>>,
    /// Non-zero columns of the Jacobian: (index of the parameter, `d f' / d x`), each index once.
    pub columns: Vec<(usize, Vector3<f64>)>,
    /// Non-zero changes of `f'` by one standard uncertainty of an influence [m/s^2]: (index of the unknown, change).
    /// The unknowns of a fit are the parameters, and behind them the influences.
    pub stated: Vec<(usize, Vector3<f64>)>,
}

impl Linearisation {
    /// Non-zero changes of `f'` by the unknowns of a fit: (index of the unknown, change).
    pub fn by_unknowns(&self) -> impl Iterator<Item = (usize, &Vector3<f64>)> {
        self.columns.iter().chain(&self.stated).map(|(unknown, change)| (*unknown, change))
    }

    /// The change of `f'` with the unknowns of a fit, by the linearisation.
    pub(crate) fn change(&self, dx: &DVector<f64>) -> Vector3<f64> {
        self.by_unknowns().map(|(unknown, change)| change * dx[unknown]).sum()
    }

    /// The linearisation at the influences of the unknowns `x` of a fit, which act linearly.
    pub(crate) fn with_influences(mut self, x: &[f64]) -> Self {
        for (unknown, change) in &self.stated {
            self.reading += change * x[*unknown];
        }
        self
    }
}

/// Weighted linearised equations `rows du = misfit` of all plateaus, and of the priors and influences if any.
pub(crate) struct Design {
    /// `3 n x (p + q)`, whitened: parameters, then influences; then the rows of the priors and the influences.
    pub rows: DMatrix<f64>,
    /// `3 n`, whitened readings less whitened model; then the priors and the influences.
    pub misfit: DVector<f64>,
    /// Norm of the part that no unknown can follow, once rotated out of the rows; 0 while it is still in them.
    pub rest: f64,
    /// Norm of the whitened readings of the model: what rounding is relative to.
    pub magnitude: f64,
}

impl Design {
    /// Stacks the plateaus' linearisations, whitened by their covariances.
    ///
    /// # Errors
    /// [`FitError::Covariance`] when a plateau's covariance is not positive definite.
    pub fn of(
        observations: &[Observation],
        linearisations: &[Linearisation],
        unknowns: usize,
    ) -> Result<Self, FitError> {
        let mut rows = DMatrix::zeros(3 * observations.len(), unknowns);
        let mut misfit = DVector::zeros(3 * observations.len());
        let mut magnitude = 0.0;
        for (n, (observation, linearisation)) in observations.iter().zip(linearisations).enumerate() {
            let whitener = Whitener::new(observation, linearisation)?;
            whitener.fill(&mut rows, n, linearisation);
            misfit.fixed_rows_mut::<3>(3 * n).copy_from(&whitener.apply(&(observation.mean - linearisation.reading)));
            magnitude += whitener.apply(&linearisation.reading).norm_squared();
        }
        Ok(Self { rows, misfit, rest: 0.0, magnitude: magnitude.sqrt() })
    }

    /// Adds the equations of the priors and of `influences`, the last unknowns, at the point `x` of the linearisation.
    pub fn with_priors(mut self, priors: &[Prior], influences: usize, x: &[f64]) -> Self {
        let ((n, unknowns), m) = (self.rows.shape(), priors.len());
        let parameters = unknowns - influences;
        self.rows = with_prior_rows(self.rows, priors, influences);
        self.misfit = self.misfit.resize_vertically(n + m + influences, 0.0);
        let at = DVector::from_column_slice(&x[..parameters]);
        self.misfit.rows_mut(n, m).copy_from(&prior::misfit(priors, &at));
        self.misfit.rows_mut(n + m, influences).copy_from(&-DVector::from_column_slice(&x[parameters..]));
        self
    }
}

/// Three whitened readings of a plateau, linearised about a point of the unknowns: `rows (x - point) = misfit`.
#[derive(Debug, Clone, PartialEq)]
pub struct Readings {
    /// Non-zero columns: (index of the unknown, whitened derivative). Influences stand behind the parameters.
    pub columns: Vec<(usize, Vector3<f64>)>,
    /// Whitened reading less whitened model.
    pub misfit: Vector3<f64>,
    /// Norm of the whitened reading of the model.
    pub(crate) magnitude: f64,
}

impl Readings {
    /// Whitens a plateau by the covariance of its mean and the speed's rank-one term.
    ///
    /// # Errors
    /// [`FitError::Covariance`] when the covariance is not positive definite.
    pub fn new(observation: &Observation, linearisation: &Linearisation) -> Result<Self, FitError> {
        let whitener = Whitener::new(observation, linearisation)?;
        Ok(Self {
            columns: linearisation.by_unknowns().map(|(column, d)| (column, whitener.apply(d))).collect(),
            misfit: whitener.apply(&(observation.mean - linearisation.reading)),
            magnitude: whitener.apply(&linearisation.reading).norm(),
        })
    }
}

/// The whitened rows of plateaus of given weights, `3 n x (p + q)`, for all `unknowns`: parameters, then influences.
///
/// # Errors
/// [`FitError::Covariance`] when a covariance is not positive definite.
pub(crate) fn whitened_rows(
    weights: &[Weight],
    linearisations: &[Linearisation],
    unknowns: usize,
) -> Result<DMatrix<f64>, FitError> {
    let mut rows = DMatrix::zeros(3 * weights.len(), unknowns);
    for (n, (weight, linearisation)) in weights.iter().zip(linearisations).enumerate() {
        Whitener::new(*weight, linearisation)?.fill(&mut rows, n, linearisation);
    }
    Ok(rows)
}

/// `rows` of plateaus with those of the priors, and of `influences`, the last unknowns.
pub(crate) fn with_prior_rows(rows: DMatrix<f64>, priors: &[Prior], influences: usize) -> DMatrix<f64> {
    let ((n, unknowns), m) = (rows.shape(), priors.len());
    let parameters = unknowns - influences;
    let mut rows = rows.resize_vertically(n + m + influences, 0.0);
    rows.view_mut((n, 0), (m, parameters)).copy_from(&prior::rows(priors, parameters));
    rows.view_mut((n + m, parameters), (influences, influences)).fill_with_identity();
    rows
}

/// Takes a plateau's errors to independent ones of unit variance.
#[derive(Debug, Clone)]
pub(crate) struct Whitener(Cholesky<f64, Const<3>>);

impl Whitener {
    /// From the covariance of the mean and the errors of the plateau alone.
    pub fn new(plateau: impl Into<Weight>, linearisation: &Linearisation) -> Result<Self, FitError> {
        let weight = plateau.into();
        weight.factor(total_covariance(&weight.covariance, linearisation)).map(Self)
    }

    /// `L^-1 v`.
    pub fn apply(&self, v: &Vector3<f64>) -> Vector3<f64> {
        // A Cholesky factor has no zero on its diagonal, so the triangular system has a solution.
        self.0.l_dirty().solve_lower_triangular(v).unwrap_or_else(Vector3::zeros)
    }

    /// Writes the three rows of plateau `n`.
    pub fn fill(&self, rows: &mut DMatrix<f64>, n: usize, linearisation: &Linearisation) {
        let mut block = rows.fixed_rows_mut::<3>(3 * n);
        for (unknown, derivative) in linearisation.by_unknowns() {
            block.set_column(unknown, &self.apply(derivative));
        }
    }
}

/// `C + d d^T + r^2 E` [m^2/s^4]: the covariance of the mean with the errors of what was set and of the plateau's rounding.
pub(crate) fn total_covariance(mean: &Matrix3<f64>, at: &Linearisation) -> Matrix3<f64> {
    let set = noise_covariance(mean, at) + at.setting_error * at.setting_error.transpose();
    if at.rounding > 0.0 { set + Matrix3::from_diagonal_element(at.rounding * at.rounding) } else { set }
}

/// `C`, the covariance of the mean as the fit takes it [m^2/s^4].
///
/// Where only gravity shows the attitude, `C` is `(n^T C n) E`, with the normal `n`. The two unknowns of the attitude follow the mean across
/// `n`, whatever its variance there. A hand trembles across: taken for an error, that would let the fit turn the attitude by as much, to where
/// the sphere of readings bends towards the mean.
fn noise_covariance(mean: &Matrix3<f64>, at: &Linearisation) -> Matrix3<f64> {
    at.normal.map_or(*mean, |n| Matrix3::from_diagonal_element(n.dot(&(mean * n))))
}

/// `L` of that covariance, `C = L L^T` [m/s^2].
pub(crate) fn noise_factor(observation: &Observation, at: &Linearisation) -> Result<Matrix3<f64>, FitError> {
    let factor = Weight::from(observation).factor(noise_covariance(&observation.covariance, at))?;
    Ok(factor.l())
}
