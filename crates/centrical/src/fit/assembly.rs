//! The two ways to bring the whitened equations of all plateaus together.

use super::data::Data;
use super::design::Design;
use super::filter;
use crate::model::{FitError, Linearisation};

/// How the whitened equations of all plateaus, linearised at a point, are brought together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Assembly {
    /// Stacked as they are.
    Batch,
    /// Rotated into a triangle by the filter, plateau by plateau, and smoothed back.
    Filter,
}

impl Assembly {
    /// The equations of the plateaus and of the priors, linearised at `x`.
    pub fn design(self, data: &Data, x: &[f64], linearisations: &[Linearisation]) -> Result<Design, FitError> {
        let design = match self {
            Self::Batch => Design::of(data, linearisations)?,
            Self::Filter => filter::smoothed(data, linearisations)?,
        };
        Ok(design.with_priors(data.model().priors(), data.model().influences().len(), x))
    }
}
