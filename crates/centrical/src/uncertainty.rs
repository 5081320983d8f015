//! How far a calibration can be trusted.
//!
//! - [`Budget`]: what each source of uncertainty leaves in each parameter (GUM, JCGM 100:2008);
//! - [`MonteCarlo`]: the whole calibration repeated on drawn readings and drawn type B errors, to check the budget;
//! - [`Validity`], [`Cleaned`], [`Pattern`]: whether the residuals are those of a true model;
//! - [`StatedSpeeds::contradictions`]: the speeds of the telemetry against those that were set;
//! - [`TiltComparison`]: the tilt of the axis by the once-per-revolution terms, which the fit does not use;
//! - [`BetweenRests`]: scatter and drift of rests that their own noise does not show;
//! - [`Creep`]: readings that still change after the unit was turned;
//! - [`ModelSelection`]: which of several models the data speak for;
//! - [`Compensated`]: the uncertainty of a compensated reading;
//! - [`ModelInAxes`], [`ScaleForm`]: a calibrated error model in other axes;
//! - [`Comparison`]: two calibrations of one unit.
//!
//! Type A is what the data show: the noise of the plateau means. Type B is what they cannot show and the laboratory
//! states ([`TypeB`]): errors of quantities that the model takes as exact, gravity or a radius, are further unknowns of the
//! fit, zero with the stated uncertainty.

mod axes;
mod between_rests;
mod budget;
mod comparison;
mod compensated;
mod coverage;
mod creep;
mod drift;
mod monte_carlo;
mod pattern;
mod repeats;
mod rivals;
mod selection;
mod speeds;
mod tilt;
mod validity;
mod verdict;

pub use crate::statistics::{Test, family_wise};
pub use axes::{ModelInAxes, ScaleForm};
pub use between_rests::BetweenRests;
pub use budget::{Budget, Contribution, Improvement};
pub use comparison::{Comparison, Estimates, ParameterDifference};
pub use compensated::{Compensated, CurvePoint};
pub use coverage::Degrees;
pub use drift::Slope;
pub use monte_carlo::{MonteCarlo, ParameterStatistics, Settings, WeightedSquare};
pub use pattern::{Pattern, Trend};
pub use rivals::{RivalTest, Rivals, Suspects, Unseen};
pub use selection::{Candidate, FittedCandidate, ModelSelection, TermVerdict};
pub use speeds::{Extent, ShownSpeed, SpeedContradiction, StatedSpeeds};
pub use tilt::{OncePerRevolution, TiltComparison};
pub use validity::{PlateauCheck, Validity};
pub use verdict::{Findings, Level, Objection, chance_of_residuals};
