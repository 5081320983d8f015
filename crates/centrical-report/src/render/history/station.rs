//! The page of a station.

use centrical_session::StationHistoryReport;

use super::charts::StoreCharts;
use super::frame::{opening, page};
use super::units::{ListedUnit, units_table};
use crate::render::screen::shown;
use crate::terminal::station_history_text;

/// The page of a station and of the units that it has calibrated.
pub fn history_station_page(report: &StationHistoryReport, units: &[ListedUnit], charts: &StoreCharts) -> String {
    let name = if report.station.is_empty() { "without a name" } else { &report.station };
    let mut body = opening("Station", name);
    shown(&mut body, &station_history_text(report));
    units_table(&mut body, units, None);
    charts.write(&mut body);
    page(name, &body)
}
