//! Control charts.

use centrical_session::{ChartReport, customary};

use crate::number::{counted, with_uncertainty};
use crate::terminal::screen::{Emphasis, Screen};
use crate::terminal::table::{Align, Table};

/// Control charts.
pub fn chart_text(report: &ChartReport) -> Screen {
    let mut screen = Screen::default();
    if report.signals.is_empty() {
        screen.marked(Emphasis::Acceptable, "IN CONTROL", "no rule gives a signal");
    } else {
        let stands = if report.signals.len() == 1 { "stands" } else { "stand" };
        let words = format!("{} {stands} below", counted(report.signals.len(), "signal"));
        screen.marked(Emphasis::NotAcceptable, "NOT IN CONTROL", &words);
    }
    screen.gap();
    let (factor, unit) = customary(&report.unit, report.group);
    let estimate = with_uncertainty(factor * report.centre, factor.abs() * report.deviation);
    let from = match report.accepted {
        0 => "limits as stated".to_owned(),
        accepted => format!("limits from the first {accepted} acceptable sessions"),
    };
    screen.head(
        "CHART",
        &format!("{}: centre {} {unit}, standard deviation {} {unit}, {from}", report.name, estimate.0, estimate.1),
    );
    let mut table = Table::new(
        2,
        &[
            (Align::Left, &["date", "serial"]),
            (Align::Right, &["value"]),
            (Align::Left, &["rule"]),
            (Align::Words, &[""]),
        ],
    );
    for signal in &report.signals {
        let session = &report.sessions[signal.session];
        table.row([
            session.date.to_string().into(),
            session.unit_serial.as_str().into(),
            with_uncertainty(factor * report.values[signal.session], factor.abs() * report.deviation).0.into(),
            signal.rule.to_string().into(),
            signal.words.into(),
        ]);
    }
    if !report.signals.is_empty() {
        screen.table(table);
    }
    screen
}
