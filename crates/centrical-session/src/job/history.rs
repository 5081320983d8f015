//! Many calibrations: stores of them, a unit over the years, units beside each other, a station over its sessions, control charts.

mod add;
mod calibrated;
mod chart;
mod check;
mod comparable;
mod earlier;
mod no_history;
mod of_data;
mod read;
mod station;
mod unit;
mod units;

pub use self::add::{add_result, add_results, refuse_date};
pub use self::calibrated::Calibrated;
pub(crate) use self::calibrated::{CalibratedParameter, Kinds, shared_changes};
pub use self::chart::{ChartLimits, ChartRequest, RuleSet, chart, chart_of_one};
pub use self::check::{check_store, list_store, spelling};
pub use self::comparable::ComparedUnits;
pub use self::earlier::history_up_to;
pub use self::no_history::NoHistory;
pub(crate) use self::read::refuse_other_output;
pub use self::read::{ParameterLimits, Past, by_unit, collect_results, read_batches, read_calibrations, read_limits};
pub use self::station::station_history;
pub use self::unit::{UnitHistoryRequest, unit_history, unit_history_among};
pub use self::units::{UnitsHistoryRequest, unit_means, units_history};
