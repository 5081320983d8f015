//! The documents that the program writes, one schema a file.

mod json;
mod noise;
mod observability;
mod plan;
mod prediction;
mod result;
mod steadiness;
mod truth;
mod watch;
mod words;

pub use self::noise::{NOISE_SCHEMA, NoiseAnalysis, ReadingNoise};
pub use self::observability::{
    CombinationReport, ConditionReport, GroupReport, LostCombination, OBSERVABILITY_SCHEMA, ObservabilityReport,
    ObservedParameter, PairReport, RemedyReport, SightReport, StepReport, Subject,
};
pub(crate) use self::plan::SCHEMA as PLAN_SCHEMA;
pub use self::plan::{
    CriterionName, FrontierRow, GoalReport, PlanReport, PlannedMounting, PlannedPlateau, ReasonReport,
};
pub use self::prediction::{PredictedParameter, PredictionReport};
pub use self::result::{
    BudgetSource, BudgetSummary, CalibrationResult, ConvergenceSummary, FitSummary, Follows, Method, ModelSummary,
    MountingPrediction, MountingSummary, ObservabilitySummary, OutlyingPlateau, OutputSummary, ParameterEstimate,
    PatternSummary, PlateauSummary, PositionSummary, PriorSummary, Program, RestsOn, ResultObjection, RivalSize,
    RivalSummary, SCHEMA, SessionSummary, SpeedDifference, SpeedFinding, SpeedsSummary, StabilityCurve, TermSummary,
    ValiditySummary,
};
pub use self::steadiness::{
    DriftSummary, LeftOutSummary, RepeatedPlateau, SessionDriftVerdict, SessionTrend, TiltSummary, TiltVerdict,
};
pub(crate) use self::truth::{Written, truth_json};
pub use self::watch::{
    HistoryEntry, HistoryEstimate, InnovationSummary, WatchState, WatchedPlateau, append_history, keep_history,
    read_history,
};
