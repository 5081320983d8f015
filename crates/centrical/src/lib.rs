//! Calibration of newtonometer (accelerometer) triads on precision centrifuges: the numerics.
//!
//! # Conventions
//! - SI throughout, plain `f64`: m, rad, rad/s, m/s^2. "1 g" shown to people is 9.80665 m/s^2.
//! - Frames are suffixes: `_x` reference (East, North, Up), `_y` arm, `_z` instrument; `c_zy` takes `y` to `z`.
//! - Small turns and rotation vectors have the source's sign: a frame turned by `v` sees `(E + hat(v)) u`,
//!   `hat(v)` being the transpose of the usual cross-product matrix.
//! - Equations are cited as `[K5.3]`: A. V. Kozlov, "Identification of the error-model parameters of a
//!   newtonometer unit on a centrifuge", numbered as in `docs/notation.md`, which maps each of the source's
//!   symbols to its name here.
//! - Nothing here reads files, prints, or depends on the number of threads.
//!
//! # From an experiment to an estimate
//! The source's experiment [K5.5] and a unit with a scale error of 0.1 %, whose plateau means are known to 10 ug:
//!
//! ```
//! use centrical::plan::Normalised;
//! use centrical::{Calibration, Data, ErrorModel, MeasurementModel, Observation, PairRelation, Weight};
//!
//! let experiment = Normalised { pair_relation: PairRelation::Common, ..Normalised::default() }.experiment();
//! let model = MeasurementModel::new(experiment, ErrorModel::kozlov_2017(), &[]);
//! let scale = model.parameters().find("G0_11").expect("the preset has a scale error");
//! let mut truth = vec![0.0; model.parameters().len()];
//! truth[scale] = 1e-3;
//!
//! let set_points = &model.experiment().set_points;
//! let read = |weight: Weight| Observation {
//!     set_point: weight.set_point,
//!     mean: model.reading(&set_points[weight.set_point], &truth),
//!     covariance: weight.covariance,
//! };
//! let observations: Vec<Observation> = Weight::equal(set_points.len(), 1e-4).into_iter().map(read).collect();
//!
//! let data = Data::new(&model, observations)?;
//! let calibration = Calibration::exact(&data)?;
//! let (value, u) = (calibration.value("G0_11"), calibration.fit().standard_uncertainty(scale));
//! assert!(value.is_some_and(|value| (value - 1e-3).abs() < 1e-9) && u.is_some_and(|u| u < 1e-4));
//! # Ok::<(), centrical::FitError>(())
//! ```

/// Estimation from plateau means.
pub mod fit;
/// Many calibrations: a unit over the years, units beside each other, a machine over its sessions.
pub mod history;
mod linalg;
mod model;
/// Observability of an experiment: rank, undetermined combinations, their causes and remedies.
pub mod observability;
/// Plans of experiments.
pub mod plan;
mod progress;
/// Reduction of continuous records to plateau means.
pub mod reduction;
/// Simulation of records.
pub mod simulate;
/// Stability analysis of a record: deviations of the Allan family, spectrum, noise terms.
pub mod stability;
mod statistics;
/// How far a calibration can be trusted.
pub mod uncertainty;

pub use centrical_compensate::Monomial;
pub use fit::calibration::Calibration;
pub use fit::data::Data;
pub use fit::estimates::{Fit, Termination};
pub use linalg::least_squares::LeastSquares;
pub use model::{
    Centrifuge, Course, Difference, Effect, ErrorModel, Experiment, Extension, Extra, FitError, Group, History,
    Influence, Kind, Law, Linearisation, MeasurementModel, Mounting, Observation, PairRelation, Parameter, Parameters,
    Position, Prior, PriorError, ReferencePoint, Rival, Rotation, STANDARD_GRAVITY, SetPoint, Site, Source, SwitchOn,
    Term, ThirdPosition, TypeB, Unit, Weight, is_rotation, rotation, rotation_rate,
};
pub use nalgebra;
pub use observability::combination::Combination;
pub use observability::direction::NullDirection;
pub use observability::rank::Observability;
pub use observability::study::Study;
pub use progress::{OnProgress, Stopped, advance, unwatched};
