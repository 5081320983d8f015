//! Planning: the best experiment for the time on the centrifuge.
//!
//! Candidates are plateaus (a mounting, a speed or an angle at rest) with a list of durations; a mounting costs the time
//! of its set-up, a plateau that of its ramp and its duration. Reading `i` of a plateau of duration `T` has the
//! covariance `Sigma = (density^2 / 2T + floor^2) E + sigma^2 d d^T` (the speed's error does not fall with time), and a
//! schedule the information `M = M_0 + sum J^T Sigma^-1 J`, `J` the three rows of `g H` [K5.3].
//!
//! - [`Criterion`]: what is made small, always about the instrument: D, A, I, or the worst of several targets;
//! - [`relax`](relaxation): the continuous design (any plateau for any part of its visits) by sequential quadratic
//!   programming, with the bound of the equivalence theorem (Kiefer and Wolfowitz 1960) as its certificate;
//! - [`exchange`]: the schedule in whole visits, by rounding and exchange;
//! - [`search`]: both under branch and bound over mountings, whose set-ups are costs of groups;
//! - [`account`]: why each plateau is there; [`frontier`]: time against uncertainty; [`next_best`]: the best next plateau.
//!
//! **Unknowns that a schedule does not see** (turns of a position that is not mounted, lost combinations) are held by a
//! standard deviation of ten typical magnitudes, as in a fit ([`crate::NULL_HOLD`]): that is `M_0`, with the priors.
//! Turns and shifts are free otherwise, and count only by what they leave in the instrument's parameters.

mod account;
mod candidates;
mod criterion;
mod error;
mod exchange;
mod frontier;
mod information;
mod next;
mod normalised;
mod prediction;
mod relaxation;
mod robustness;
mod search;

pub use account::{Account, Reason};
pub use candidates::{Candidates, Costs, Noise, Scenario, Schedule, Visit};
pub use criterion::{Criterion, Goal, ReadingRange};
pub use error::PlanError;
pub use frontier::{FrontierPoint, frontier};
pub use next::{Gain, next_best};
pub use normalised::Normalised;
pub use prediction::{Prediction, predict, unit_of};
pub use relaxation::Relaxed;
pub use robustness::Robustness;
pub use search::{Effort, Plan, best_for_time, shortest_for_goals};
