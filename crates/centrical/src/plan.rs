//! Planning: the best experiment for the time on the centrifuge.
//!
//! Candidates are set points (a mounting with a speed, or with an angle at rest) and a list of durations; a candidate with one
//! of the durations is an atom, and a schedule is a list of visits of atoms. A mounting costs the time of its set-up, a visit
//! that of its ramp and its duration. A visit of duration `T` reads with the covariance
//! `Sigma = (density^2 / 2T + floor^2) E + sigma^2 d d^T`: the speed's error does not fall with time. A schedule has the
//! information `M = M_0 + sum J^T Sigma^-1 J`, where `J` are the three rows of `g H` [K5.3].
//!
//! - [`Criterion`]: what is made small, always about the instrument: D, A, I, or the worst of several goals;
//! - [`Task`]: what is to be planned, and the search over goals with their type B;
//! - `search`: the best schedule for a time and the shortest for goals, by branch and bound over mountings, whose set-ups are
//!   costs of groups. `relaxation` bounds schedules: the continuous design, any candidate for any part of its visits, by
//!   sequential quadratic programming with the bound of the equivalence theorem (Kiefer and Wolfowitz 1960). `exchange`
//!   finds them, by rounding and exchange of whole visits;
//! - [`Prediction`]: the uncertainties of a plan; [`Rationale`]: the reason for each visit; [`Candidates::frontier`]: time
//!   against uncertainty; [`NextPlateau`]: the best next plateau.
//!
//! **Unknowns that a schedule does not determine** (turns of a position that is not mounted, lost combinations) are held by a
//! standard deviation of ten typical magnitudes, as in a fit ([`crate::Parameter::NULL_HOLD`]): that is `M_0`, with the priors.
//! Turns and shifts are free otherwise, and count only by their effect on the instrument's parameters.

mod atom;
mod candidates;
mod criterion;
mod error;
mod exchange;
mod frontier;
mod goals;
mod information;
mod next;
mod normalised;
mod prediction;
mod rationale;
mod relaxation;
mod scenarios;
mod search;

pub use candidates::{Candidates, Costs, Noise, Scenario, Schedule, Visit};
pub use criterion::{Criterion, Goal, Robustness};
pub use error::PlanError;
pub use goals::Task;
pub use next::NextPlateau;
pub use normalised::Normalised;
pub use prediction::Prediction;
pub use rationale::Rationale;
pub use relaxation::Relaxed;
pub use search::{Effort, Plan};
