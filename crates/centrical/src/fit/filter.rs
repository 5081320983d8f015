//! The recursive method of the source's section 6: a square-root information filter over plateaus.
//!
//! Three readings at a time are rotated into a triangle of the unknowns at work ([`Factor`]). What belongs to a position
//! or a pair is re-initialised when that changes ([`Lifetimes`]), so that the source's experiment takes 30 states instead
//! of 49, and is smoothed at the end ([`Filter`]). A plateau is tested as it comes ([`Filter::innovation`]).
//!
//! [`recursive_linear`](super::Calibration::recursive_linear) is one pass on [K5.3].
//! [`recursive`](super::Calibration::recursive) relinearises all plateaus at the smoothed estimate and filters again, until
//! nothing moves. Both are the estimates of the batch computed another way.
//! [`Follower`](super::Follower) is for the time while the centrifuge turns: after each plateau it stands where a fit of the
//! plateaus so far stands.

mod information;
pub(super) mod innovation;
mod lifetimes;

pub use crate::linalg::factor::Factor;
pub use crate::model::plateau::Readings;
pub use information::Filter;
pub(super) use information::smoothed;
pub use lifetimes::Lifetimes;
