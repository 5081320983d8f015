//! The page of a unit, of a model of units, of a station.

use std::fmt::Write;

use centrical_session::{ParameterLimits, StationHistoryReport, UnitHistoryReport, UnitsHistoryReport, unit_name};

use super::charts::StoreCharts;
use super::frame::{opening, page, panels};
use super::units::{ListedUnit, units_table};
use crate::figure::{batches_plot, distribution_plot, unit_history_plots};
use crate::render::frame::shown;
use crate::terminal::{station_history_text, unit_history_text, units_history_text};

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

/// The page of a model of units. `values` has for each parameter of the report the means of its units, by groups with a name.
pub fn history_model_page(
    report: &UnitsHistoryReport,
    values: &[Vec<(String, Vec<f64>)>],
    units: &[ListedUnit],
    limits: &ParameterLimits,
    charts: &StoreCharts,
) -> String {
    let mut body = opening("Model", &report.unit_model);
    shown(&mut body, &units_history_text(report));
    units_table(&mut body, units, Some(report));
    body.push_str("<h2>Distributions over the units</h2>\n");
    panels(&mut body, report.parameters.iter().zip(values).map(|(p, groups)| distribution_plot(p, groups, limits)));
    if report.parameters.iter().any(|p| !p.batches.is_empty()) {
        body.push_str("<h2>Batches</h2>\n<p class=\"note\">Means with their expanded uncertainty (k = 2).</p>\n");
        panels(&mut body, report.parameters.iter().map(batches_plot));
    }
    charts.write(&mut body);
    page(&report.unit_model, &body)
}

/// The page of a station and of the units that it has calibrated.
pub fn history_station_page(report: &StationHistoryReport, units: &[ListedUnit], charts: &StoreCharts) -> String {
    let name = if report.station.is_empty() { "without a name" } else { &report.station };
    let mut body = opening("Station", name);
    shown(&mut body, &station_history_text(report));
    units_table(&mut body, units, None);
    charts.write(&mut body);
    page(name, &body)
}
