//! `result.json`: the form in which a calibration leaves the program, schema `centrical-result/1`.
//!
//! Everything else (tables, reports, certificates, compensation) is made from it, so it holds all of them need.
//! The same inputs give the same bytes: fields in a fixed order, numbers in their shortest exact decimal form,
//! no time of day, no absolute paths.

use centrical::{Group, PairRelation, ReferencePoint, Termination};
use serde::{Deserialize, Serialize};

use super::axes_summary::AxesSummary;
use super::budget_and_checks::{BetweenRestsSummary, BudgetSummary, ValiditySummary};
use super::next_attitude::NextAttitudeSummary;
use super::rivals::RestsOn;
use super::speeds::SpeedsSummary;
use crate::document::steadiness::{DriftSummary, LeftOutSummary, TiltSummary};
use crate::experiment::Turning;
use crate::record::{Input, RecordOverview};
use crate::store::TermSummary;

/// Name of the schema's present version.
pub(crate) const SCHEMA: &str = "centrical-result/1";

/// A calibration's result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CalibrationResult {
    /// `centrical-result/1`.
    pub schema: String,
    /// What made it.
    pub program: Program,
    /// The files it was made from.
    pub inputs: Vec<Input>,
    /// What was calibrated, when.
    pub session: SessionSummary,
    /// The model that was fitted.
    pub model: ModelSummary,
    /// How the output of the unit was taken to m/s^2, unless its records are in m/s^2.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub output: Option<OutputSummary>,
    /// The error model in other axes, if it was stated in such.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axes: Option<AxesSummary>,
    /// The unknowns in the order of the covariance.
    pub parameters: Vec<ParameterEstimate>,
    /// Covariance of the estimates, SI; null where a parameter is not estimable. That of the fit, which has what the session states as
    /// uncertain among its unknowns.
    pub covariance: Vec<Vec<Option<f64>>>,
    /// What the experiment sees.
    pub observability: ObservabilitySummary,
    /// The best attitude to add; of rests in free attitudes alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub next_attitude: Option<NextAttitudeSummary>,
    /// What differs from rest to rest beside the noise within rests; of acceptable rests alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub between_rests: Option<BetweenRestsSummary>,
    /// Slow rotation among the rests, where it was asked for and found.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub turning: Option<Turning>,
    /// How the fit went.
    pub fit: FitSummary,
    /// The mountings, in the order of the session.
    pub mountings: Vec<MountingSummary>,
    /// The plateaus it rests on.
    pub plateaus: Vec<PlateauSummary>,
    /// How the uncertainties shrank plateau by plateau.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub convergence: Option<ConvergenceSummary>,
    /// The uncertainties by their sources, if a budget was made.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub budget: Option<BudgetSummary>,
    /// The checks of the fit, if they were made.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub validity: Option<ValiditySummary>,
    /// The effects whose absence the result rests on, the worst first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rests_on: Vec<RestsOn>,
    /// How the readings drifted over plateaus and over the session; none for a session that came already averaged.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drift: Option<DriftSummary>,
    /// The tilt of the axis seen while spinning, against the fitted one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tilt: Option<TiltSummary>,
    /// How the speeds are known, where they are measured or contradicted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub speeds: Option<SpeedsSummary>,
    /// What the records look like; empty for a session that came already averaged.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub records: Vec<RecordOverview>,
}

/// The program and its version.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Program {
    /// `centrical`.
    pub name: String,
    /// Version.
    pub version: String,
}

impl Program {
    /// This program.
    pub(crate) fn this() -> Self {
        Self { name: "centrical".to_owned(), version: env!("CARGO_PKG_VERSION").to_owned() }
    }
}

/// What the session file says of itself.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SessionSummary {
    /// Title.
    pub title: String,
    /// Date as written in the session.
    pub date: String,
    /// Model of the unit.
    pub unit_model: String,
    /// Serial number of the unit.
    pub unit_serial: String,
    /// Name of the station, if the session states one.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub station: String,
    /// Free text of the session.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub text: String,
}

/// The scale and bias by which the output of the unit was taken to readings: `f' = (raw - bias) / scale`; nominal ones of raw output.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OutputSummary {
    /// Unit of the output, as the session names it: `counts`, `V`, `g`.
    pub unit: String,
    /// Scale of each newtonometer [unit per m/s^2].
    pub scale: [f64; 3],
    /// Output of each at no specific force [unit].
    pub bias: [f64; 3],
}

/// The model that was fitted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModelSummary {
    /// The terms of the error model: reading = f + sum of coefficient times monomial.
    pub error_model: Vec<TermSummary>,
    /// "common", "opposite" or "free".
    #[serde(with = "crate::document::json")]
    pub pair_relation: PairRelation,
    /// "first-proof-mass" or "own-axes".
    #[serde(with = "crate::document::json")]
    pub reference: ReferencePoint,
    /// Local gravity [m/s^2].
    pub gravity: f64,
    /// Latitude [rad], if the Earth-rate term is applied.
    pub latitude: Option<f64>,
    /// Relative standard uncertainty of a plateau's speed.
    pub speed_uncertainty: f64,
    /// Whether the nominal scale and bias of a raw output were found by this calibration: its biases and scale errors are then relative to
    /// themselves.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub nominal_found: bool,
    /// Nominal attitudes of the unit.
    #[serde(default)]
    pub positions: Vec<PositionSummary>,
}

impl ModelSummary {
    /// Whether the unit was on an arm in any position.
    pub fn has_arm(&self) -> bool {
        self.positions.is_empty() || self.positions.iter().any(|position| !position.is_free)
    }
}

/// A nominal attitude of the unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PositionSummary {
    /// Name, as in the names of parameters.
    pub id: String,
    /// Name of its pair.
    pub pair: String,
    /// `P_k`, row by row: takes arm axes to instrument axes; of an attitude that is known, to axes of the case.
    pub matrix: [[f64; 3]; 3],
    /// Whether the unit rested here in an attitude of its own, not on the arm.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_free: bool,
    /// Standard uncertainty of an attitude that is known, about each horizontal axis, as an error of this rest alone [rad]: above the stated one where
    /// rests in one attitude share it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub attitude_uncertainty: Option<f64>,
}

/// An estimate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ParameterEstimate {
    /// Name.
    pub name: String,
    /// Estimate, SI; null if the data do not determine it.
    pub value: Option<f64>,
    /// Its standard uncertainty, SI; null if the data do not determine it.
    pub standard_uncertainty: Option<f64>,
    /// Unit of both.
    pub unit: String,
    /// bias, scale, misalignment, ...
    #[serde(with = "crate::document::json")]
    pub group: Group,
    /// Whether the data determine it.
    pub estimable: bool,
    /// The prior it was given, if any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub prior: Option<PriorSummary>,
    /// Part of its variance that comes from priors, 0 to 1; only where there are priors.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub prior_share: Option<f64>,
    /// Whether it is determined only thanks to priors.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub rests_on_prior: bool,
}

/// A prior and what the data added to it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PriorSummary {
    /// Its mean, SI; not written where it is zero.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub mean: f64,
    /// Standard uncertainty before the data, SI.
    pub standard_uncertainty: f64,
    /// Standard uncertainty after the data over that before: 1 when the value rests on the prior alone.
    pub posterior_over_prior: f64,
}

/// What the experiment sees.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ObservabilitySummary {
    /// Rank of the weighted, column-scaled design.
    pub rank: usize,
    /// Number of unknowns.
    pub columns: usize,
    /// Singular values below this part of the largest count as zero.
    pub tolerance: f64,
    /// Singular values, falling.
    pub singular_values: Vec<f64>,
    /// Combinations along which the data do not change: parameter to component.
    pub null_directions: Vec<serde_json::Map<String, serde_json::Value>>,
    /// Whether the null directions had to be held near zero in the exact fit, at ten typical magnitudes.
    pub null_directions_held: bool,
}

/// How the unknowns are estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Method {
    /// Gauss-Newton on the exact model.
    #[default]
    #[serde(rename = "exact, Gauss-Newton")]
    Exact,
    /// The same estimates by the recursive filter, iterated.
    #[serde(rename = "exact, recursive filter")]
    Recursive,
    /// The linear fit of [K5.3] alone, with its second-order error.
    #[serde(rename = "linear [K5.3]")]
    Linear,
    /// The same estimates by one pass of the recursive filter.
    #[serde(rename = "linear [K5.3], recursive filter")]
    RecursiveLinear,
}

impl Method {
    /// Whether the model is the linear one.
    pub fn is_linear(self) -> bool {
        matches!(self, Self::Linear | Self::RecursiveLinear)
    }
}

/// How the fit went.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FitSummary {
    /// How the unknowns were estimated.
    pub method: Method,
    /// "converged", "stalled", "iteration limit" or "linear".
    #[serde(with = "crate::document::json")]
    pub termination: Termination,
    /// Linearisations made.
    pub iterations: usize,
    /// Weighted sum of squared residuals.
    pub chi_squared: f64,
    /// Readings less rank.
    pub degrees_of_freedom: usize,
}

impl FitSummary {
    /// chi^2 per degree of freedom with its standard deviation, about 1 if the model and the weights are right; `None` without
    /// redundancy.
    pub fn ratio(&self) -> Option<(f64, f64)> {
        let degrees = self.degrees_of_freedom as f64;
        (degrees > 0.0).then(|| (self.chi_squared / degrees, (2.0 / degrees).sqrt()))
    }
}

/// A mounting.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MountingSummary {
    /// Id of its position.
    pub position: String,
    /// Nominal place of the reference point, arm axes [m].
    pub arm: [f64; 3],
    /// Time constant of the settling after a ramp [s], if any was seen.
    pub settling_time: Option<f64>,
    /// What to add to the time of the telemetry to have that of the record [s]; null without telemetry.
    pub clock_offset: Option<f64>,
    /// Readings of newtonometers 1, 2, 3 that were interpolated to the stamps of another one; none unless each has a file with stamps
    /// of its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interpolated: Option<[u64; 3]>,
    /// Plateaus that the record shows and the schedule does not have, from and to, the record's clock [s].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unscheduled: Vec<[f64; 2]>,
}

/// A plateau.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlateauSummary {
    /// Mounting, counted from 1 in the order of the session.
    pub mounting: usize,
    /// Plateau of the mounting's schedule, counted from 0.
    pub index: usize,
    /// Speed [rad/s], signed by the sense of rotation: as it was set, or as it was measured where speeds are measured.
    pub speed: f64,
    /// Relative standard uncertainty of a speed that was measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub speed_uncertainty: Option<f64>,
    /// Speed that was set, where the telemetry or a counter measures the speed [rad/s].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub set_speed: Option<f64>,
    /// Carousel angle at rest [rad]; null while spinning.
    pub angle: Option<f64>,
    /// First and last instant used, the record's clock [s]; null for a plateau that came already averaged.
    pub window: Option<[f64; 2]>,
    /// Samples used.
    pub samples: u64,
    /// Samples of the window left out.
    pub rejected: u64,
    /// Mean reading [m/s^2].
    pub mean: [f64; 3],
    /// Covariance of the mean from its noise [m^2/s^4].
    pub covariance: [[f64; 3]; 3],
    /// The same with the speed's uncertainty: the weight in the fit is its inverse [m^2/s^4].
    pub fit_covariance: [[f64; 3]; 3],
    /// Mean less fitted model [m/s^2].
    pub residual: [f64; 3],
    /// Specific force along the sensitive axes at the fitted geometry [m/s^2]: the reading without instrument errors.
    #[serde(default)]
    pub specific_force: Option<[f64; 3]>,
    /// Amplitude of the once-per-revolution term [m/s^2]: the tilt of the axis seen while spinning.
    pub once_per_revolution: Option<[f64; 3]>,
    /// Standard uncertainty of either quadrature of that term [m/s^2].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub once_per_revolution_uncertainty: Option<[f64; 3]>,
    /// Phase of that term as the window starts [rad]: `amplitude cos(Omega (t - start) + phase)`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub once_per_revolution_phase: Option<[f64; 3]>,
    /// Slope of the readings over the window [m/s^3].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drift: Option<[f64; 3]>,
    /// Its standard uncertainty [m/s^3].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drift_uncertainty: Option<[f64; 3]>,
    /// Samples that are not used, by kind.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub left_out: Option<LeftOutSummary>,
    /// Median speed by the telemetry [rad/s].
    pub measured_speed: Option<f64>,
    /// Whether the plateau was held out of the fit; its residual is against a fit of the others then.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub held_out: bool,
}

/// How the uncertainties shrank.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ConvergenceSummary {
    /// Numbers of plateaus at which it was looked, rising.
    pub plateaus: Vec<usize>,
    /// Standard uncertainty, SI: one row for each of these numbers, in the order of the parameters; `null` for the attitude of a single rest.
    pub standard_uncertainty: Vec<Vec<Option<f64>>>,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde asks for a reference")]
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}
