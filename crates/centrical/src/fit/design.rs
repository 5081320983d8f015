//! The weighted linearised equations of all plateaus and priors.

use nalgebra::{DMatrix, DVector};

use super::data::Data;
use crate::model::prior::{self, Prior};
use crate::model::whitening::Whitener;
use crate::model::{FitError, Linearisation};

/// Weighted linearised equations `rows du = misfit` of all plateaus, and of the priors if any.
pub(crate) struct Design {
    /// `3 n x p`, whitened; then the priors.
    pub rows: DMatrix<f64>,
    /// `3 n`, whitened readings less whitened model; then the priors.
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
    pub fn of(data: &Data, linearisations: &[Linearisation]) -> Result<Self, FitError> {
        let observations = data.observations();
        let mut rows = DMatrix::zeros(3 * observations.len(), data.model().parameters().len());
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

    /// Adds the equations of the priors at the point `x` of the linearisation.
    pub fn with_priors(mut self, priors: &[Prior], x: &[f64]) -> Self {
        let equations = prior::rows(priors, self.rows.ncols());
        let (n, m) = (self.rows.nrows(), priors.len());
        self.rows = self.rows.resize_vertically(n + m, 0.0);
        self.misfit = self.misfit.resize_vertically(n + m, 0.0);
        self.misfit.rows_mut(n, m).copy_from(&-(&equations * DVector::from_column_slice(x)));
        self.rows.rows_mut(n, m).copy_from(&equations);
        self
    }
}
