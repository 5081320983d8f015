//! Control charts of several parameters on one page.

use std::fmt::Write;

use centrical_session::{ChartKind, ChartReport, NoHistory, customary};

use super::frame::panels;
use crate::figure::chart_plots;
use crate::number::{counted, with_uncertainty};
use crate::plot::Escaped;
use crate::render::frame::Column::{Number, Words};
use crate::render::frame::sortable;

/// The charts of a page by parameter, and the reason why a parameter has none.
#[derive(Debug, Clone, PartialEq)]
pub struct StoreCharts {
    /// The charts, each of its last sessions.
    pub charts: Vec<ChartReport>,
    /// Why a parameter has none, the first of them.
    pub missing: Option<NoHistory>,
}

/// The kinds of charts with their titles.
const KINDS: [(&str, ChartKind); 4] = [
    ("individuals", ChartKind::Individuals),
    ("moving range", ChartKind::MovingRange),
    ("EWMA", ChartKind::Ewma),
    ("CUSUM", ChartKind::Cusum),
];

impl StoreCharts {
    /// Whether any of the sessions that are shown gives a signal.
    pub fn has_signals(&self) -> bool {
        self.charts.iter().any(|chart| !chart.signals.is_empty())
    }

    /// A table of the signals, then the charts of each parameter.
    pub(super) fn write(&self, body: &mut String) {
        body.push_str("<h2>Control charts</h2>\n");
        if let Some(missing) = &self.missing {
            let _ = writeln!(
                body,
                "<p class=\"note\">found {}, expected {}</p>",
                Escaped(&missing.found()),
                Escaped(&missing.expected())
            );
        }
        let Some(longest) = self.charts.iter().max_by_key(|chart| chart.values.len()) else { return };
        let (sessions, accepted) = (counted(longest.values.len(), "session"), longest.accepted);
        let _ = writeln!(
            body,
            "<p class=\"note\">The last {sessions}. Limits come from the first {accepted} acceptable ones. Where nothing changes, charts of 100 sessions \
             with limits from 20 give a false signal in one of two: a chart says where to look.</p>"
        );
        self.table(body);
        for chart in &self.charts {
            let signals = counted(chart.signals.len(), "signal");
            let _ = writeln!(body, "<details><summary>{}: {signals}</summary><div>", Escaped(&chart.name));
            panels(body, chart_plots(chart).into_iter().map(|(_, plot)| plot.as_panel()));
            body.push_str("</div></details>\n");
        }
    }

    fn table(&self, body: &mut String) {
        let kinds = KINDS.map(|(title, _)| Number(title));
        let names = [Words("parameter"), Words("unit"), Number("centre")];
        let columns: Vec<_> = names.into_iter().chain(kinds).chain([Words("last signal")]).collect();
        sortable(body, "", &columns, |body| self.charts.iter().for_each(|chart| row(body, chart)));
    }
}

fn row(body: &mut String, chart: &ChartReport) {
    let (factor, unit) = customary(&chart.unit, chart.group);
    let (centre, _) = with_uncertainty(factor * chart.centre, factor.abs() * chart.deviation);
    let _ = write!(
        body,
        "<tr><th scope=\"row\">{}</th><td>{unit}</td><td class=\"number\">{centre}</td>",
        Escaped(&chart.name)
    );
    for (_, kind) in KINDS {
        let count = chart.signals.iter().filter(|signal| signal.rule.kind() == kind).count();
        let _ = write!(body, "<td class=\"number\">{count}</td>");
    }
    let last = chart.signals.last().and_then(|signal| Some((signal, chart.sessions.get(signal.session)?)));
    let words = last.map(|(signal, of)| format!("{}, serial {}: {}", of.date, of.unit_serial, signal.words));
    let _ = writeln!(body, "<td>{}</td></tr>", Escaped(&words.unwrap_or_default()));
}
