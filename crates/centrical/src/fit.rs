//! Estimation of the unknowns from plateau means.
//!
//! [`Data`] are plateau means with the model of them; a [`Calibration`] is a fit together with its data.
//! [`Calibration::linear`] is the source's weighted least squares on `Z = H X + r` [K5.3]; [`Calibration::exact`] goes on from
//! there by Gauss-Newton on the exact model. [`filter`] gives the same estimates plateau by plateau.
//!
//! **Short rank.** What is estimable is decided on `H`, where the structure of the experiment is exact. Away
//! from zero the products of two unknowns let second-order traces of the lost combinations into the exact model:
//! too weak to give an honest value, too strong to be ignored in the others. The lost combinations therefore stay
//! free in the exact fit. They are kept from running away by a standard deviation of [`Parameter::NULL_HOLD`](crate::Parameter::NULL_HOLD)
//! typical magnitudes, which is released as soon as the traces themselves keep them; whatever doubt the
//! lost combinations leave in the estimable parameters is in the covariance of those.
//!
//! **Weak directions.** What remains of a short rank may be determined to hundreds of typical magnitudes only, and the model is not linear
//! so far. Directions beyond that hold along which it is not are held as well, to find a point where it can be
//! linearised. The estimates are one linear step on from there, without that hold: it informs none of them.
//!
//! A first reading can leave out `curvature.rs`, which acts with priors and free attitudes alone, and the elimination in
//! `linalg/least_squares.rs`, which gives the same numbers in less time.
//!
//! **Priors** of the model are rows of the design like any other; the fit says what rests on them.

pub(crate) mod batch;
pub(crate) mod calibration;
mod convergence;
mod curvature;
pub(crate) mod data;
mod departure;
pub(crate) mod estimates;
/// The same estimates by a filter over plateaus, with the states that the order of the experiments asks for.
pub mod filter;
mod follower;
mod gain;
mod global;
mod linearised;
mod past;
mod structure;

pub(crate) use calibration::Calibration;
pub use convergence::Checkpoint;
pub(crate) use data::Data;
pub(crate) use estimates::{Fit, Termination};
pub use follower::{Arrival, Follower, Progress};
pub(crate) use gain::Gain;
pub(crate) use structure::Structure;
