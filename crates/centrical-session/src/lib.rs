//! What stands in the files of a session, and the whole jobs on them: session folders in, results out.
//!
//! Inputs are of any make: nothing in a file can make this crate panic, hang or fill the memory. What is
//! wrong with a file is an [`Error`] with the file, the place, what was found and what was expected.
//!
//! ```
//! use std::path::Path;
//!
//! use centrical_session::{Method, Session, calibrate, unwatched};
//!
//! let session = Session::read(Path::new("../../examples/ta-200"))?;
//! let result = calibrate(&session, &[], Method::Exact, &unwatched)?;
//! let bias = result.parameter("df_1").expect("the error model has a bias");
//! assert!(bias.estimable && bias.standard_uncertainty.is_some_and(|u| u < 1e-3));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Records and telemetry are tables in any format of [`centrical_table`]. Time is a number in a unit, a count of samples at
//! a rate, or (text and Parquet) a stamp. It never decreases; it may stand still.

mod document;
mod error;
mod experiment;
mod job;
mod laboratory;
mod quantity;
mod record;
mod reduced;
mod settings;
mod store;
mod truth;
mod units;

pub use centrical::reduction::{Record, RecordSlice, SpeedTrace};
pub use centrical::stability::Estimator;
pub use centrical::{OnProgress, STANDARD_GRAVITY, Stopped, advance, unwatched};
pub use centrical_table::{
    Bytes, ClaimedFolder, ColumnName, Source, TableFormat, abandon_files, claim_folder, create_folder, harmless,
    harmless_line, refuse_inputs, write_stream, write_whole,
};
pub use document::{
    AddedReport, AssessedFit, AssessedParameter, AssessedPlateau, Assessment, AssessmentReport, CandidateSummary,
    ComparedResultSummary, ComparisonReport, CompensatedUncertainty, CompensationReport, DifferenceSummary,
    DocumentKind, DocumentsReport, Doubt, DoubtKind, DraftReport, FirstReading, HistoryLine, HistoryList,
    ImprovementSummary, LeftOutPlateau, LineToFillIn, ModelsReport, MonteCarloReport, NestedTestSummary, ObjectionName,
    PairComparison, ReadingsBeyond, ReducedPlateauSummary, ReductionReport, RepeatedFit, RepeatedParameter,
    SeriesSummary, SimulationReport, SquareSummary, TermSupport, UnscheduledPlateau, WithoutOutliers, WrittenDocument,
};
pub use document::{
    Agreement, GroupProgress, LiveBenefit, LiveCause, LiveLost, LivePlateau, LiveRecord, LiveReport, LiveSpeed,
    LiveStatus, PlateauLabel, seconds_since_1970,
};
pub use document::{
    AxesName, AxesParameter, AxesSummary, BetweenRestsSummary, BudgetSource, BudgetSummary, CalibrationResult,
    ChosenRest, ChosenRests, CombinationReport, ConditionReport, ConvergenceSummary, CreepSummary, CriterionName,
    DifferenceExtent, DisturbedPlateau, DriftSummary, FitSummary, FollowedSpeeds, Follows, FrontierRow, GoalReport,
    GroupReport, HistoryEntry, HistoryEstimate, InnovationSummary, LeftOutSummary, LostCombination, Method,
    ModelSummary, MountingPrediction, MountingSummary, NextAttitudeSummary, NoiseAnalysis, ObservabilityReport,
    ObservabilitySummary, ObservedParameter, OutlyingPlateau, OutputSummary, PairReport, ParameterEstimate,
    PatternSummary, PlanReport, PlannedMounting, PlannedPlateau, PlateauDriftVerdict, PlateauSummary, PositionSummary,
    PredictedParameter, PredictionReport, PriorSummary, Program, ReadingNoise, ReasonReport, RemedyReport,
    RepeatedPlateau, RestsOn, ResultObjection, RivalSize, RivalSummary, SessionDriftVerdict, SessionSummary,
    SessionTrend, SightReport, SpeedDifference, SpeedFinding, SpeedsSummary, StepReport, Subject, TiltSummary,
    TiltVerdict, ValiditySummary, WatchState, WatchedPlateau, read_history, unit_name,
};
pub use document::{
    BatchSummary, BatchWithoutUnit, BeyondLimit, CapabilitySummary, ChartKind, ChartReport, ChartRule, ChartSignal,
    DeviatingSession, DueDate, FailedSession, LeftOutSession, NotComparedParameter, OutlyingUnit, PastSession,
    ReadingHistory, SamenessSummary, StationHistoryReport, StationParameter, UnitFinding, UnitFindingKind,
    UnitHistoryReport, UnitParameter, UnitsHistoryReport, UnitsParameter, UntestedStation,
};
pub use error::{Error, ErrorKind, NoErrorModel, Place};
pub use experiment::{
    Folder, KnownAttitudes, Measured, MountingFiles, OutputUnit, Plan, PlannedRests, Planning, PlateauMean,
    PlateauName, PlateauTable, RecordedRests, RestSource, RestTable, Session, SpeedSource, Speeds, StatedAttitudes,
    Turning, available_time, write_plateaus,
};
pub use job::{
    AssessmentRequest, Axes, ComparisonRequest, Compensated, CompensationRequest, Draft, InitRequest, LiveRequest,
    MonteCarloCase, MonteCarloRequest, NoiseRequest, PlanRequest, Recorded, SeriesRequest, SettingsForm, Tumble,
    TumbleRequest, USUAL_LEVELS, USUAL_TIMES, Watch, WatchEnd, WatchEvent, WatchProgress, WatchRequest, add_result,
    add_results, assess, calibrate, calibrate_reduced, calibrate_series, check_store, collect_results, compare_results,
    compensate, compensate_record, init, list_store, matching_paths, noise_of, noise_of_plateau, plan, read_plan,
    read_planning, reduce, reduce_recorded, reduce_without_inputs, refuse_date, select_model, settings_schema,
    simulate_session, spelling, subject, subject_of, time_column, tumble, watch, write_reduced,
};
pub use job::{
    Calibrated, CalibratedParameter, ChartLimits, ChartRequest, ComparedUnits, NoHistory, ParameterLimits, Past,
    RuleSet, UnitHistoryRequest, UnitsHistoryRequest, by_unit, chart, chart_of_one, history_up_to, read_batches,
    read_calibrations, read_limits, station_history, unit_history, unit_history_among, unit_means, units_history,
};
pub use laboratory::{
    Address, Certificate, Condition, Contact, Customer, Decision, DecisionRule, Environment, Item, Laboratory,
    LaboratoryTable, Limit, LimitEnd, Limitable, Limited, MethodTable, Person, Standard, StatedLimit,
};
pub use quantity::{Date, Dimension, NotADay, NotThatQuantity, Quantity};
pub use record::{Column, Columns, Input, MissingReadings, RecordOverview, RecordReader, RecordWriter, Scale, stretch};
pub use reduced::{MountingFindings, Reduced, ReducedPlateau, Steadiness};
pub use store::{
    Added, Depth, Failure, Row, RowPrior, Rows, Selection, SharedInfluence, Status, Store, TermSummary, sha256,
};
pub use truth::Truth;
pub use units::{MICRO_G, Symbol, Unit, UnknownUnit, customary, rpm};
