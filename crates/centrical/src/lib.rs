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

/// Estimation from plateau means.
pub mod fit;
mod least_squares;
mod model;
/// What an experiment can see, why not more, and what would help.
pub mod observability;
/// Plans of experiments.
pub mod plan;
mod random;
/// Reduction of continuous records to plateau means.
pub mod reduction;
mod simd;
/// Simulation of records.
pub mod simulate;
/// Stability analysis of a record: deviations of the Allan family, spectrum, noise terms.
pub mod stability;
mod statistics;
/// How far a calibration can be trusted.
pub mod uncertainty;

pub use fit::{Calibration, Checkpoint, Data, Fit, Termination};
pub use least_squares::LeastSquares;
pub use model::{
    ArmMotion, Centrifuge, EARTH_RATE, ErrorModel, Experiment, Extension, Extra, FitError, Kind, Law, Linearisation,
    MeasurementModel, Monomial, Mounting, NULL_HOLD, Observation, PairRelation, Parameter, Parameters, Position, Prior,
    PriorError, PriorUse, ReferencePoint, Rotation, STANDARD_GRAVITY, SetPoint, Site, Term, Unit, Weight, carousel, hat,
    is_rotation, linear, position, rotation, rotation_rate,
};
pub use observability::{Combination, NullDirection, Observability, RANK_TOLERANCE, Study};
