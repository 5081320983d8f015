//! The page of a model of units: distribution, capability, outlying units, batches.

use centrical_session::{ParameterLimits, UnitsHistoryReport};

use super::charts::StoreCharts;
use super::frame::{opening, page, panels};
use super::units::{ListedUnit, units_table};
use crate::figure::{batches_plot, distribution_plot};
use crate::render::screen::shown;
use crate::terminal::units_history_text;

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
