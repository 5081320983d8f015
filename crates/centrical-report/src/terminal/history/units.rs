//! Units of one type beside each other.

use centrical_session::{BatchWithoutUnit, UnitFindingKind, UnitsHistoryReport, customary};

use super::chance::chance;
use super::unit::{first_of, left_out};
use crate::number::{counted, with_uncertainty};
use crate::terminal::screen::{Emphasis, Screen};
use crate::terminal::symbols::legend;
use crate::terminal::table::{Align, Cell, Table};

/// Calibrations that are left out and named one by one.
const SHOWN: usize = 5;

/// Units of one type beside each other.
pub fn units_history_text(report: &UnitsHistoryReport) -> Screen {
    let mut screen = Screen::default();
    let (emphasis, mark, words) = if report.is_sound {
        (Emphasis::Acceptable, "ALIKE", "no unit stands out, drifts or scatters more than the others")
    } else {
        (Emphasis::NotAcceptable, "NOT ALIKE", "the units stand below; family-wise 5 %")
    };
    screen.marked(emphasis, mark, words);
    if !report.is_tested {
        screen.marked(Emphasis::Warning, "FEW", "fewer than ten units do not show which of them is outlying");
    }
    for session in report.left_out.iter().take(SHOWN) {
        let words = format!("serial {}, {}", session.session.unit_serial, left_out(session));
        screen.marked(Emphasis::Warning, "INCOMPLETE", &words);
    }
    if report.left_out.len() > SHOWN {
        let words = format!("and {} more", counted(report.left_out.len() - SHOWN, "calibration"));
        screen.marked(Emphasis::Warning, "INCOMPLETE", &words);
    }
    if report.not_acceptable > 0 {
        let words =
            format!("{} with an objection count as the others do", counted(report.not_acceptable, "calibration"));
        screen.marked(Emphasis::Warning, "NOT ACCEPTABLE", &words);
    }
    without_unit(&mut screen, report);
    for unit in &report.outlying {
        let most = unit.most.iter().map(|(name, score)| format!("{name} {score:+.1}")).collect::<Vec<_>>().join(", ");
        let words = format!(
            "serial {}: robust distance {:.1}, probability {} among as many sound units; farthest, in standard deviations: {most}",
            unit.unit_serial,
            unit.distance,
            chance(unit.probability)
        );
        screen.marked(Emphasis::NotAcceptable, "OUTLYING", &words);
    }
    for finding in &report.findings {
        let words = format!(
            "serial {}, {}: family-wise probability {}",
            finding.unit_serial,
            finding.parameter,
            chance(finding.probability)
        );
        let does = match finding.kind {
            UnitFindingKind::Drifts => "DRIFTS",
            UnitFindingKind::Scatters => "SCATTERS",
        };
        screen.marked(Emphasis::NotAcceptable, does, &words);
    }
    screen.gap();
    let counts = format!("{}, {}", counted(report.units, "unit"), counted(report.sessions, "calibration"));
    screen.head("UNITS", &format!("{}: {counts}; of each unit the mean over its calibrations", report.unit_model));
    let columns = [
        ("", Align::Left),
        ("unit", Align::Left),
        ("mean", Align::Right),
        ("least", Align::Right),
        ("largest", Align::Right),
        ("Cp", Align::Right),
        ("Cpk", Align::Right),
        ("interval", Align::Left),
        ("", Align::Words),
    ];
    let mut table = Table::new(2, columns);
    for p in &report.parameters {
        let (factor, unit) = customary(&p.unit, p.group);
        let shown = |value: f64| Cell::from(with_uncertainty(factor * value, factor.abs() * p.deviation).0);
        let capability = p.capability.as_ref();
        let interval = capability.map(|c| format!("{:.2} to {:.2}", c.cpk_interval[0], c.cpk_interval[1]));
        table.row([
            p.name.as_str().into(),
            unit.into(),
            Cell::estimate(with_uncertainty(factor * p.mean, factor.abs() * p.deviation)),
            shown(p.least),
            shown(p.largest),
            capability.and_then(|c| c.cp).map_or_else(String::new, |cp| format!("{cp:.2}")).into(),
            capability.map_or_else(String::new, |c| format!("{:.2}", c.cpk)).into(),
            interval.unwrap_or_default().into(),
            if p.batches_differ { "BATCHES DIFFER" } else { "" }.into(),
        ]);
    }
    screen.table(table);
    legend(&mut screen, report.parameters.iter().map(|p| (p.name.as_str(), p.group)));
    screen
}

/// Serial numbers of the batches that no unit has: those near one by itself, the others together.
fn without_unit(screen: &mut Screen, report: &UnitsHistoryReport) {
    let quoted = |serials: &[String]| {
        first_of(&serials.iter().map(|serial| format!("{serial:?}")).collect::<Vec<String>>(), SHOWN)
    };
    let (near, other): (Vec<&BatchWithoutUnit>, Vec<_>) =
        report.without_unit.iter().partition(|of| !of.near.is_empty());
    for of in near.iter().take(SHOWN) {
        let words =
            format!("no unit has the serial {:?} of the batches, expected {}?", of.unit_serial, quoted(&of.near));
        screen.marked(Emphasis::Warning, "NO UNIT", &words);
    }
    let others = near.into_iter().skip(SHOWN).chain(other).map(|of| of.unit_serial.clone());
    let others: Vec<String> = others.collect();
    if !others.is_empty() {
        let words = format!("no unit has these serials of the batches: {}", quoted(&others));
        screen.marked(Emphasis::Warning, "NO UNIT", &words);
    }
}
