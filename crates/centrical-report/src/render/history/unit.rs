//! The page of a unit.

use std::fmt::Write;

use centrical_session::{ParameterLimits, UnitHistoryReport, unit_name};

use super::charts::StoreCharts;
use super::frame::{opening, page, panels};
use crate::figure::unit_history_plots;
use crate::render::screen::shown;
use crate::terminal::unit_history_text;

/// The page of a unit with a history; with `limits` of its parameters in the drawings.
pub fn history_unit_page(report: &UnitHistoryReport, limits: &ParameterLimits, charts: &StoreCharts) -> String {
    let title = unit_name(&report.unit_model, &report.unit_serial);
    let mut body = opening("Unit", &title);
    shown(&mut body, &unit_history_text(report));
    if report.limit.is_some() {
        let _ =
            writeln!(body, "<p>What is due and overdue is of {}; made anew, the page is of that day.</p>", report.on);
    }
    body.push_str("<h2>Parameters over time</h2>\n");
    panels(&mut body, unit_history_plots(report, limits).into_iter().map(|(_, plot)| plot.as_panel()));
    charts.write(&mut body);
    page(&title, &body)
}

/// The page of a unit whose calibrations have no parameter in common.
pub fn no_unit_history_page(unit_model: &str, unit_serial: &str) -> String {
    let title = unit_name(unit_model, unit_serial);
    page(&title, &(opening("Unit", &title) + "<p>Its calibrations have no parameter in common.</p>\n"))
}
