//! The whole jobs, a file a command: what the binary, a fleet's worker and a notebook all call.

mod assess;
mod axes;
mod calibrate;
mod compare;
mod compensate;
mod history;
mod init;
mod models;
mod montecarlo;
mod noise;
mod observe;
mod pattern;
mod plan;
mod reduce;
mod reduced_session;
mod scale;
mod series;
mod settings_schema;
mod simulate;
mod tumble;
mod watch;

pub use self::assess::{AssessmentRequest, assess};
pub use self::axes::Axes;
pub use self::calibrate::{calibrate, calibrate_reduced};
pub use self::compare::{ComparisonRequest, compare_results};
pub use self::compensate::{Compensated, CompensationRequest, compensate, compensate_record};
pub use self::history::{
    Calibrated, CalibratedParameter, ChartLimits, ChartRequest, ComparedUnits, NoHistory, ParameterLimits, Past,
    RuleSet, UnitHistoryRequest, UnitsHistoryRequest, by_unit, chart, chart_of_one, history_up_to, read_batches,
    read_calibrations, read_limits, station_history, unit_history, unit_history_among, unit_means, units_history,
};
pub use self::history::{add_result, add_results, check_store, collect_results, list_store, refuse_date, spelling};
pub use self::init::{Draft, InitRequest, init, time_column};
pub use self::models::select_model;
pub use self::montecarlo::{MonteCarloCase, MonteCarloRequest};
pub use self::noise::{NoiseRequest, noise_of, noise_of_plateau};
pub use self::observe::{subject, subject_of};
pub use self::pattern::matching_paths;
pub use self::plan::{PlanRequest, USUAL_LEVELS, USUAL_TIMES, plan, read_plan, read_planning};
pub use self::reduce::{Recorded, reduce, reduce_recorded, reduce_without_inputs};
pub use self::reduced_session::write_reduced;
pub use self::series::{SeriesRequest, calibrate_series};
pub use self::settings_schema::{SettingsForm, settings_schema};
pub use self::simulate::simulate_session;
pub use self::tumble::{Tumble, TumbleRequest, tumble};
pub use self::watch::{LiveRequest, Watch, WatchEnd, WatchEvent, WatchProgress, WatchRequest, watch};
