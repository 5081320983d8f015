//! The model: what is set, what is unknown, what the unit reads, and how well a plateau mean is known.
//!
//! An [`Experiment`] and the unit's [`ErrorModel`] define the unknowns ([`Parameters`]); the [`MeasurementModel`] says what the
//! unit reads on a plateau as a function of them. It has two forms, kept apart on purpose so that each checks the other:
//! - [`MeasurementModel::linearise`], the exact model: exact rotations, every proof mass at its own point,
//!   mean over a revolution or at rest, with its analytic Jacobian;
//! - [`linear`], the source's small-parameter model `Z = H X + r` [K5.3].
//!
//! `H` is the Jacobian of the exact model at `X = 0` (test `h_is_the_jacobian_at_zero`).

mod course;
mod effect;
mod error;
mod error_model;
mod exact;
mod experiment;
mod extension;
mod frame;
mod group;
mod history;
mod instant;
mod linear;
mod measurement;
mod nominal;
mod parameter;
mod parameters;
pub(crate) mod plateau;
pub(crate) mod position;
pub(crate) mod prior;
mod rival;
mod single_rest;
mod stated;
mod unknowns;

pub use course::{Course, Law};
pub use effect::Effect;
pub use error::FitError;
pub use error_model::{ErrorModel, Extra, Term};
pub use experiment::{
    Centrifuge, Experiment, History, Mounting, PairRelation, ReferencePoint, Rotation, STANDARD_GRAVITY, SetPoint,
    Site, Unit,
};
pub use extension::{Difference, Extension};
pub(crate) use frame::hat;
pub use frame::{is_rotation, rotation, rotation_rate};
pub use group::Group;
pub(crate) use instant::{ArmMotion, MountedUnit};
pub use measurement::MeasurementModel;
pub use parameter::{Kind, Parameter};
pub use parameters::Parameters;
pub use plateau::{Linearisation, Observation, Weight};
pub use position::{Position, SwitchOn, ThirdPosition};
pub use prior::{Prior, PriorError};
pub use rival::Rival;
pub use stated::{Influence, Source, TypeB};
