//! Many calibrations as text for the terminal.

mod chart;
mod list;
mod station;
mod unit;
mod units;

pub use self::chart::chart_text;
pub use self::list::history_list_text;
pub use self::station::station_history_text;
pub use self::unit::unit_history_text;
pub use self::units::{finding_mark, units_history_text};
