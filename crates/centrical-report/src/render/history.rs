//! The pages of a store: a list of its calibrations, a page for each unit, each model of units and each station. No network; one short
//! script sorts and filters lists, which are whole without it.

mod charts;
mod due;
mod frame;
mod index;
mod pages;
mod units;

pub use self::charts::StoreCharts;
pub use self::due::{UnitDue, due_comment, due_of_page, history_due_page};
pub use self::frame::PageKind;
pub use self::index::{Indexed, history_index};
pub use self::pages::{history_model_page, history_station_page, history_unit_page, no_unit_history_page};
pub use self::units::ListedUnit;
