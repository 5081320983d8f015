//! Errors of planning.

use thiserror::Error;

use crate::model::FitError;
use crate::progress::Stopped;

/// Why there is no plan.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PlanError {
    /// There is nothing to choose from.
    #[error("found no {0}, expected at least one")]
    Nothing(&'static str),
    /// A time or duration is negative or not finite.
    #[error("found a time that is negative or not finite, expected durations above 0 and costs of 0 or more")]
    Time,
    /// A re-seating costs more than a change of position, which contains one.
    #[error("found a re-seating dearer than a change of position, expected at most as much")]
    SeatAbovePosition,
    /// A rest beside the arm precedes a mounting on it.
    #[error("found a rest beside the arm before a mounting on it, expected all mountings on the arm first")]
    RestsFirst,
    /// The scenarios are of different experiments.
    #[error("found scenarios of different experiments, expected the same candidates in all")]
    Experiments,
    /// The expected unknowns are not those of the model.
    #[error("found expected unknowns of another number than the model's parameters, expected one for each")]
    Nominal,
    /// The noise of a candidate is invalid.
    #[error("candidate {}: found an invalid noise covariance, expected finite noise above 0", candidate + 1)]
    Noise {
        /// Its index.
        candidate: usize,
    },
    /// A goal names an unknown parameter.
    #[error("goal {name:?}: found no such parameter, expected one of the instrument")]
    Unknown {
        /// As given.
        name: String,
    },
    /// No visit fits into the time.
    #[error("found {found:.0} s, expected at least {least:.0} s, the set-up of one mounting and its shortest plateau")]
    TooShort {
        /// Time given [s].
        found: f64,
        /// Least time in which anything can be measured [s].
        least: f64,
    },
    /// A goal is below its type B uncertainty.
    #[error(
        "goal {name:?}: found one that the stated type B uncertainties alone miss by a factor of {factor:.3} when all candidates \
         are measured, expected one above them: no plan lowers gravity, radii and attitudes as they are stated"
    )]
    BelowTypeB {
        /// The parameter, or "reading".
        name: String,
        /// Its type B uncertainty over the goal.
        factor: f64,
    },
    /// All candidates together do not reach the goals.
    #[error("found goals that all candidates together miss by a factor of {factor:.3}, expected goals that they reach")]
    OutOfReach {
        /// Worst uncertainty over its goal.
        factor: f64,
    },
    /// A schedule cannot be predicted.
    #[error(transparent)]
    Prediction(#[from] FitError),
    /// The caller stopped the search.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}
