//! What an experiment can see: rank, singular values, null directions, estimability and correlation.
//!
//! The columns of the weighted design matrix are scaled to unit length, so that the answer does not depend on
//! units; then its singular value decomposition is taken (of the triangle of its QR factorisation). Weights
//! change the singular values, never which of them are zero.

mod addition;
mod attitude;
mod combination;
mod condition;
mod correlation;
mod direction;
mod rank;
mod reason;
mod remedy;
mod study;

pub use addition::{Addition, attitude_in_words, cube_directions};
pub use attitude::NextAttitude;
pub use combination::{Combination, CombinationError};
pub use condition::{Condition, Need};
pub use correlation::{CorrelatedGroup, STRONG_CORRELATION};
pub use direction::NullDirection;
pub use rank::{Observability, RANK_TOLERANCE};
pub use reason::{Cause, Reason, Sight};
pub use remedy::{Remedy, Step};
pub use study::Study;
