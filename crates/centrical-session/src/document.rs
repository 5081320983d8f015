//! The documents that the program writes, one schema a file.

mod added;
mod assessment;
mod compact;
mod comparison;
mod compensation;
mod documents;
mod draft;
mod history;
mod history_list;
mod json;
mod models;
mod montecarlo;
mod noise;
mod observability;
mod plan;
mod prediction;
mod record_findings;
mod reduction;
mod result;
mod series;
mod simulation;
mod steadiness;
mod truth;
mod watch;
mod words;

pub use self::added::AddedReport;
pub use self::assessment::{
    AssessedFit, AssessedParameter, AssessedPlateau, Assessment, AssessmentReport, CompensatedUncertainty,
    ImprovementSummary, LeftOutPlateau, WithoutOutliers,
};
pub use self::comparison::{ComparedResultSummary, ComparisonReport, DifferenceSummary, PairComparison};
pub use self::compensation::{COMPENSATION_SCHEMA, CompensationReport, FirstReading, ReadingsBeyond};
pub use self::documents::{DocumentKind, DocumentsReport, ObjectionName, WrittenDocument};
pub use self::draft::{DraftReport, LineToFillIn};
pub use self::history::{
    BatchSummary, BatchWithoutUnit, BeyondLimit, CHART_SCHEMA, CapabilitySummary, ChartKind, ChartReport, ChartRule,
    ChartSignal, DeviatingSession, DueDate, LeftOutSession, NotComparedParameter, OutlyingUnit, PastSession,
    ReadingHistory, STATION_HISTORY_SCHEMA, SamenessSummary, StationHistoryReport, StationParameter,
    UNIT_HISTORY_SCHEMA, UNITS_HISTORY_SCHEMA, UnitFinding, UnitFindingKind, UnitHistoryReport, UnitParameter,
    UnitsHistoryReport, UnitsParameter, UntestedStation,
};
pub(crate) use self::history::{FAMILY, shown_readings};
pub use self::history_list::{Doubt, DoubtKind, HistoryLine, HistoryList};
pub(crate) use self::json::line as json_line;
pub use self::models::{CandidateSummary, ModelsReport, NestedTestSummary, TermSupport};
pub use self::montecarlo::{MonteCarloReport, RepeatedFit, RepeatedParameter, SquareSummary};
pub use self::noise::{NoiseAnalysis, ReadingNoise};
pub(crate) use self::observability::largest_force;
pub use self::observability::{
    CombinationReport, ConditionReport, GroupReport, LostCombination, ObservabilityReport, ObservedParameter,
    PairReport, RemedyReport, SightReport, StepReport, Subject,
};
pub(crate) use self::plan::SCHEMA as PLAN_SCHEMA;
pub use self::plan::{
    ChosenRest, ChosenRests, CriterionName, FrontierRow, GoalReport, PlanReport, PlannedMounting, PlannedPlateau,
    ReasonReport,
};
pub use self::prediction::{PredictedParameter, PredictionReport};
pub(crate) use self::record_findings::RecordFindings;
pub use self::reduction::{ReducedPlateauSummary, ReductionReport, UnscheduledPlateau};
pub(crate) use self::result::Attitude;
pub use self::result::{
    AxesName, AxesParameter, AxesSummary, BetweenRestsSummary, BudgetSource, BudgetSummary, CalibrationResult,
    ConvergenceSummary, DifferenceExtent, FitSummary, FollowedSpeeds, Follows, Method, ModelSummary,
    MountingPrediction, MountingSummary, NextAttitudeSummary, ObservabilitySummary, OutlyingPlateau, OutputSummary,
    ParameterEstimate, PatternSummary, PlateauSummary, PositionSummary, PriorSummary, Program, RestsOn,
    ResultObjection, RivalSize, RivalSummary, SessionSummary, SpeedDifference, SpeedFinding, SpeedsSummary,
    ValiditySummary, unit_name,
};
pub use self::series::{FailedSession, SeriesSummary};
pub use self::simulation::SimulationReport;
pub use self::steadiness::{
    CreepSummary, DisturbedPlateau, DriftSummary, LeftOutSummary, PlateauDriftVerdict, RepeatedPlateau,
    SessionDriftVerdict, SessionTrend, TiltSummary, TiltVerdict,
};
pub(crate) use self::truth::{Written, WrittenSession, WrittenTumble, truth_json};
pub use self::watch::{
    Agreement, GroupProgress, HistoryEntry, HistoryEstimate, InnovationSummary, LIVE_SCHEMA, LiveBenefit, LiveCause,
    LiveLost, LivePlateau, LiveRecord, LiveReport, LiveSpeed, LiveStatus, PlateauLabel, WatchState, WatchedPlateau,
    append_history, keep_history, read_history, seconds_since_1970,
};

json::documents! {
    AddedReport: added::ADDED_SCHEMA,
    AssessmentReport: assessment::ASSESSMENT_SCHEMA,
    CalibrationResult: result::SCHEMA,
    ChartReport: CHART_SCHEMA,
    ComparisonReport: comparison::COMPARISON_SCHEMA,
    CompensationReport: COMPENSATION_SCHEMA,
    DocumentsReport: documents::DOCUMENTS_SCHEMA,
    DraftReport: draft::DRAFT_SCHEMA,
    HistoryList: history_list::HISTORY_LIST_SCHEMA,
    ModelsReport: models::MODELS_SCHEMA,
    MonteCarloReport: montecarlo::MONTE_CARLO_SCHEMA,
    ObservabilityReport: observability::OBSERVABILITY_SCHEMA,
    PlanReport: PLAN_SCHEMA,
    RecordFindings: record_findings::KEY,
    ReductionReport: reduction::REDUCTION_SCHEMA,
    SeriesSummary: series::SERIES_SCHEMA,
    SimulationReport: simulation::SIMULATION_SCHEMA,
    StationHistoryReport: STATION_HISTORY_SCHEMA,
    UnitHistoryReport: UNIT_HISTORY_SCHEMA,
    UnitsHistoryReport: UNITS_HISTORY_SCHEMA,
}
