//! The page of a station.

use centrical_session::StationHistoryReport;

use super::charts::StoreCharts;
use super::frame::{opening, page, text};
use crate::terminal::station_history_text;

/// The page of a station.
pub fn history_station_page(report: &StationHistoryReport, charts: &StoreCharts) -> String {
    let name = if report.station.is_empty() { "without a name" } else { &report.station };
    let mut body = opening("Station", name);
    text(&mut body, &station_history_text(report));
    charts.write(&mut body);
    page(name, &body)
}
