//! The two ways to bring the whitened equations of all plateaus together.

use super::data::Data;
use super::design::Design;
use super::filter;
use crate::linalg::elimination::Own;
use crate::model::{FitError, Linearisation, Prior};

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

    /// Unknowns that few of the equations with `priors` contain, as long as the equations stand as they are: attitudes of single rests; those
    /// of all positions where the equations determine all unknowns, since then each position's own do so.
    pub fn own(self, data: &Data, priors: &[Prior], determine_all: bool) -> Vec<Own> {
        let set_points: Vec<usize> = data.observations().iter().map(|observation| observation.set_point).collect();
        match self {
            Self::Batch if determine_all => data.model().unknowns_of_positions(&set_points, priors),
            Self::Batch => data.model().attitudes_of_single_rests(&set_points, priors),
            Self::Filter => Vec::new(),
        }
    }
}
