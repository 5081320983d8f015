//! What can be wrong with the input of a fit.

use thiserror::Error;

use crate::progress::Stopped;

/// Why a fit cannot be made at all. A rank that is short is not among them: it is an answer.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum FitError {
    /// There is nothing to fit.
    #[error("no plateau to fit: found 0, expected at least 1")]
    Empty,
    /// The experiment is out of the range of numbers: a speed, a radius or a weight is beyond all measure.
    #[error("the design matrix: found entries that are not finite, expected speeds, radii and noise within reason")]
    Overflow,
    /// A mean or a covariance is not a number.
    #[error("plateau {}: found a mean or covariance that is not finite, expected numbers", set_point + 1)]
    NotFinite {
        /// Index of the plateau.
        set_point: usize,
    },
    /// An observation names a plateau that the experiment does not have.
    #[error("plateau {}: found no such set point, expected at most {count}", set_point + 1)]
    Unknown {
        /// Index of the plateau.
        set_point: usize,
        /// Number of set points.
        count: usize,
    },
    /// A covariance is not positive definite.
    #[error(
        "plateau {}: found a covariance of the mean with diagonal {diagonal:?} that is not positive definite, \
         expected a positive definite matrix in m^2/s^4", set_point + 1
    )]
    Covariance {
        /// Index of the plateau.
        set_point: usize,
        /// Its diagonal [m^2/s^4].
        diagonal: [f64; 3],
    },
    /// The caller stopped the work.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// A plateau comes when unknowns that it sees are not carried any more, or not yet.
    #[error("plateau at place {} of the order: found its unknowns retired, expected the plateaus in their order", place + 1)]
    Retired {
        /// Place in the order.
        place: usize,
    },
}
