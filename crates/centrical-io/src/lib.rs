//! Session folders and records in, calibration results out.
//!
//! Inputs are of any make: nothing in a file can make this crate panic, hang or fill the memory. What is
//! wrong with a file is an [`Error`] with the file, the place, what was found and what was expected.
//!
//! # Formats of records and telemetry
//! | format | columns |
//! |---|---|
//! | text, also in gzip or Zstandard: any delimiter, decimal commas, comments | by name, or by number without a header |
//! | Parquet (uncompressed, snappy, gzip, lz4, zstd) | by name or number |
//! | Arrow IPC: files (Feather) and streams, plain, lz4 or zstd | by name or number |
//! | NumPy: `.npy` matrices and records, `.npz` | by name; of a matrix by number |
//! | MATLAB 5 (`save -v6`, `-v7`) | variables by name; of a matrix by number |
//! | HDF5 and MATLAB 7.3, with the feature `hdf5` | datasets by name; of a matrix by number |
//!
//! The format is told by the first bytes. Time is a number in a unit, a count of samples at a rate, or (text and
//! Parquet) a stamp. It never decreases; it may stand still.

mod calibration;
mod compensate;
mod error;
mod input;
mod laboratory;
mod noise;
mod observation;
mod overview;
mod planning;
mod plateaus;
mod prediction;
mod quantity;
mod record;
mod record_writer;
mod reduce;
mod reduced_session;
mod result;
mod session;
mod simulate;
mod steadiness;
mod watch;

pub use calibration::{Method, PlateauName, Problem, calibrate, calibrate_without};
pub use centrical::reduction::{Record, RecordSlice, SpeedTrace};
pub use centrical_table::{ColumnName, TableFormat, create_folder, write_whole};
pub use compensate::{Compensated, FirstOutside, compensate_record};
pub use error::{Error, NoErrorModel, Place};
pub use input::Input;
pub use laboratory::{
    Address, Certificate, Condition, Contact, Customer, Date, Decision, DecisionRule, Environment, Item, Laboratory,
    LaboratoryTable, Limit, MethodTable, Person, Standard,
};
pub use noise::{NOISE_SCHEMA, NoiseAnalysis, ReadingNoise, Series};
pub use observation::{
    CombinationReport, ConditionReport, Design, GroupReport, LostCombination, OBSERVATION_SCHEMA, ObservationReport,
    ObservedParameter, PairReport, RemedyReport, SightReport, StepReport,
};
pub use overview::RecordOverview;
pub use planning::{
    FrontierRow, GoalReport, PlanReport, PlanRequest, PlannedMounting, PlannedPlateau, ReasonReport, USUAL_LEVELS,
};
pub use plateaus::{PlateauMean, read_plateaus, write_plateaus};
pub use prediction::{PredictedParameter, PredictionReport};
pub use quantity::{Dimension, NotThatQuantity, Quantity};
pub use record::{Column, Columns, Scale, read_growing_record, read_record, read_telemetry, scan_record};
pub use record_writer::RecordWriter;
pub use reduce::{MountingFindings, Reduced, ReducedPlateau};
pub use reduced_session::write_reduced;
pub use result::{
    BudgetSource, BudgetSummary, CalibrationResult, ConvergenceSummary, FitSummary, Follows, ModelSummary,
    MountingPrediction, MountingSummary, ObservabilitySummary, OutlyingPlateau, ParameterEstimate, PatternSummary,
    PlateauSummary, PositionSummary, PriorSummary, Program, SCHEMA, SessionSummary, StabilityCurve, TermSummary,
    ValiditySummary,
};
pub use session::{MountingFiles, Noise, Plan, Planning, PlateauTable, Session};
pub use simulate::{Truth, simulate_session};
pub use steadiness::{DriftSummary, LeftOutSummary, RepeatedPlateau, SessionTrend, Steadiness, TiltSummary};
pub use watch::{
    HistoryEntry, HistoryEstimate, InnovationSummary, Watch, WatchState, WatchedPlateau, append_history, keep_history,
    read_history,
};
