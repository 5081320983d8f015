//! Calibration of newtonometer (accelerometer) triads on precision centrifuges: the numerics.
//!
//! # Conventions
//! - SI throughout, plain `f64`: m, rad, rad/s, m/s^2. "1 g" shown to people is 9.80665 m/s^2.
//! - Frames are suffixes: `_x` reference (East, North, Up), `_y` arm, `_z` instrument; `c_zy` takes `y` to `z`.
//! - Small turns and rotation vectors have the source's sign: a frame turned by `v` sees `(E + hat(v)) u`,
//!   [`hat`] being the transpose of the usual cross-product matrix.
//! - Equations are cited as `[K5.3]`: A. V. Kozlov, "Identification of the error-model parameters of a
//!   newtonometer unit on a centrifuge", numbered as in `docs/notation.md`, which maps each of the source's
//!   symbols to its name here.
//! - Nothing here reads files, prints, or depends on the number of threads.

mod convergence;
mod design;
mod error;
mod error_model;
mod experiment;
/// Estimation from plateau means.
pub mod fit;
mod frame;
mod group;
mod least_squares;
mod measurement;
/// Noise of a record: stability deviations, spectrum, noise terms.
pub mod noise;
/// What an experiment can see, why not more, and what would help.
pub mod observability;
mod parameter;
/// Plans of experiments.
pub mod plan;
/// The positions of the unit on the arm.
pub mod position;
mod prior;
mod random;
/// Reduction of continuous records to plateau means.
pub mod reduction;
/// Simulation of records.
pub mod simulate;
/// How far a calibration can be trusted.
pub mod uncertainty;

pub use convergence::{Checkpoint, convergence};
pub use design::{Observation, Weight};
pub use error::FitError;
pub use error_model::{ErrorModel, Extra, Monomial, Term};
pub use experiment::{
    EARTH_RATE, Experiment, Mounting, PairRelation, ReferencePoint, STANDARD_GRAVITY, SetPoint, Site, Unit,
};
pub use fit::{Fit, Termination};
pub use frame::{carousel, hat, is_rotation, rotation, rotation_rate};
pub use group::Group;
pub use least_squares::LeastSquares;
pub use measurement::{ArmMotion, Linearisation, MeasurementModel, linear};
pub use observability::{Combination, NullDirection, Observability, RANK_TOLERANCE, Study};
pub use parameter::{Extension, Kind, Law, Parameter, Parameters};
pub use position::Position;
pub use prior::{Prior, PriorError, PriorUse};
