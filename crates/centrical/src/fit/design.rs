//! The weighted linearised equations of all plateaus and priors.

use nalgebra::{DMatrix, DVector};

use super::data::Data;
use crate::model::prior::{self, Prior};
use crate::model::whitening::Whitener;
use crate::model::{FitError, Linearisation};

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
    pub fn of(data: &Data, linearisations: &[Linearisation]) -> Result<Self, FitError> {
        let observations = data.observations();
        let mut rows = DMatrix::zeros(3 * observations.len(), data.unknowns());
        let mut misfit = DVector::zeros(3 * observations.len());
        let mut magnitude = 0.0;
        for (n, (observation, linearisation)) in observations.iter().zip(linearisations).enumerate() {
            let whitener = Whitener::new(&observation.into(), linearisation)?;
            whitener.fill(&mut rows, n, linearisation);
            misfit.fixed_rows_mut::<3>(3 * n).copy_from(&whitener.apply(&(observation.mean - linearisation.reading)));
            magnitude += whitener.apply(&linearisation.reading).norm_squared();
        }
        Ok(Self { rows, misfit, rest: 0.0, magnitude: magnitude.sqrt() })
    }

    /// Adds the equations of the priors and of `influences`, the last unknowns, at the point `x` of the linearisation.
    pub fn with_priors(mut self, priors: &[Prior], influences: usize, x: &[f64]) -> Self {
        let (n, unknowns) = self.rows.shape();
        let (m, parameters) = (priors.len(), unknowns - influences);
        self.rows = self.rows.resize_vertically(n + m + influences, 0.0);
        self.misfit = self.misfit.resize_vertically(n + m + influences, 0.0);
        let at = DVector::from_column_slice(&x[..parameters]);
        self.misfit.rows_mut(n, m).copy_from(&prior::misfit(priors, &at));
        self.rows.view_mut((n, 0), (m, parameters)).copy_from(&prior::rows(priors, parameters));
        self.rows.view_mut((n + m, parameters), (influences, influences)).fill_with_identity();
        self.misfit.rows_mut(n + m, influences).copy_from(&-DVector::from_column_slice(&x[parameters..]));
        self
    }
}
