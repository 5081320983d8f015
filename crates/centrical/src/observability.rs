//! Observability of an experiment: rank, singular values, null directions, estimability and correlation.
//!
//! The columns of the weighted design matrix are scaled to unit length, so that the answer does not depend on
//! units; then its singular value decomposition is taken (of the triangle of its QR factorisation). Weights
//! change the singular values, never which of them are zero.

mod addition;
mod attitude;
pub(crate) mod combination;
mod condition;
mod correlation;
pub(crate) mod direction;
pub(crate) mod rank;
mod reason;
mod remedy;
pub(crate) mod study;

pub use addition::{Addition, attitude_in_words, cube_directions};
pub use attitude::NextAttitude;
pub use combination::CombinationError;
pub use condition::{Condition, Need};
pub use correlation::CorrelatedGroup;
pub(crate) use rank::Observability;
pub use reason::{Cause, Reason, Sight};
pub use remedy::{Remedy, Step};
