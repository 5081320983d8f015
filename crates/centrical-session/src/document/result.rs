//! `result.json`: the form in which a calibration leaves the program, schema `centrical-result/1`.

mod axes;
mod axes_summary;
mod budget_and_checks;
mod contradiction;
mod error_terms;
mod file;
mod from_calibration;
mod next_attitude;
mod rivals;
mod schema;
mod speeds;
mod verdict;

pub(crate) use self::axes::Attitude;
pub use self::axes_summary::{AxesName, AxesParameter, AxesSummary};
pub use self::budget_and_checks::{
    BetweenRestsSummary, BudgetSource, BudgetSummary, Follows, MountingPrediction, OutlyingPlateau, PatternSummary,
    ValiditySummary,
};
pub use self::from_calibration::unit_name;
pub use self::next_attitude::NextAttitudeSummary;
pub use self::rivals::{RestsOn, RivalSize, RivalSummary};
pub(super) use self::schema::SCHEMA;
pub use self::schema::{
    CalibrationResult, ConvergenceSummary, FitSummary, Method, ModelSummary, MountingSummary, ObservabilitySummary,
    OutputSummary, ParameterEstimate, PlateauSummary, PositionSummary, PriorSummary, Program, SessionSummary,
};
pub use self::speeds::{DifferenceExtent, FollowedSpeeds, SpeedDifference, SpeedFinding, SpeedsSummary};
pub use self::verdict::ResultObjection;
