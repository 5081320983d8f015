//! One station over its sessions.

use centrical_session::{StationHistoryReport, StationParameter, customary};

use crate::number::{counted, two_digits};
use crate::terminal::phrases::{chance, legend};
use crate::terminal::screen::{Emphasis, Screen};
use crate::terminal::table::{Align, Cell, Table};

/// What is found of a parameter.
fn finding(p: &StationParameter) -> String {
    let day = p.farthest.filter(|_| p.stands_out());
    match day {
        Some(day) if p.changes => format!("{day} STANDS OUT"),
        _ if p.changes && p.wanders() => "WANDERS".to_owned(),
        _ if p.changes => "CHANGES".to_owned(),
        _ => String::new(),
    }
}

/// A station over its sessions.
pub fn station_history_text(report: &StationHistoryReport) -> Screen {
    let mut screen = Screen::default();
    verdict(&mut screen, report);
    screen.gap();
    parameters(&mut screen, report);
    legend(&mut screen, report.parameters.iter().map(|p| (p.name.as_str(), p.group)));
    screen
}

/// Whether the machine is steady, and what is not tested.
fn verdict(screen: &mut Screen, report: &StationHistoryReport) {
    if report.parameters.is_empty() {
        let words = "the calibrations have no parameters of a machine in common: rests alone have none";
        screen.marked(Emphasis::Warning, "NOT TESTED", words);
        return;
    }
    let untested = report.parameters.iter().filter(|p| p.probability.is_none()).count();
    match report.is_steady {
        Some(true) => {
            let parameters = if untested == 0 { "of the machine" } else { "that is tested" };
            let words = format!(
                "no parameter {parameters} has a slope, a change that lasts, a session that stands out, or wanders beyond its scatter"
            );
            screen.marked(Emphasis::Acceptable, "STEADY", &words);
        }
        Some(false) => {
            screen.marked(Emphasis::NotAcceptable, "NOT STEADY", "the parameters are marked below; family-wise 5 %");
        }
        None => {}
    }
    let confounded = report.parameters.iter().filter(|p| p.is_confounded).count();
    if confounded > 0 {
        let words = format!(
            "{} not tested: the units came one after another, and a machine that changes with them does not show it; a unit that comes again and again does",
            counted(confounded, "parameter")
        );
        screen.marked(Emphasis::Warning, "NOT TESTED", &words);
    }
    let untested = untested - confounded;
    if untested > 0 || report.is_steady.is_none() && confounded == 0 {
        let words = match report.is_steady {
            None => "the sessions do not show whether the machine is steady".to_owned(),
            Some(_) => format!("{} not tested", counted(untested, "parameter")),
        };
        let words = format!("{words}: a test takes eight sessions that count, on different days");
        screen.marked(Emphasis::Warning, "FEW", &words);
    }
}

/// The parameters of the machine.
fn parameters(screen: &mut Screen, report: &StationHistoryReport) {
    let name = if report.station.is_empty() { "without a name" } else { &report.station };
    let counts = format!("{} of {}", counted(report.sessions, "session"), counted(report.units, "unit"));
    let text = format!(
        "{name}: {counts}, {} to {}; mean ± scatter; scatter over the stated uncertainties; slope; largest change that lasts, and the last \
             session before it; probability of the most unlikely of four tests, a finding below 5 % over all parameters together",
        report.first, report.last
    );
    screen.head("STATION", &text);
    let columns: [(Align, &[&str]); 5] = [
        (Align::Left, &["", "unit"]),
        (Align::Right, &["mean", "over stated", "per year", "change"]),
        (Align::Left, &["after"]),
        (Align::Right, &["probability"]),
        (Align::Words, &[""]),
    ];
    let mut table = Table::new(2, &columns);
    for p in &report.parameters {
        let (factor, unit) = customary(&p.unit, p.group);
        let slope = p.slope_per_year.zip(p.slope_uncertainty);
        table.row([
            p.name.as_str().into(),
            unit.into(),
            Cell::estimate(factor, p.mean, p.scatter),
            format!("{:.1}", p.scatter_ratio).into(),
            slope.map_or_else(Cell::default, |(slope, u)| Cell::estimate(factor, slope, u)),
            p.change.map_or_else(String::new, |change| two_digits(factor * change)).into(),
            p.changed_after.map_or_else(String::new, |day| day.to_string()).into(),
            p.probability.map_or_else(|| "not tested".to_owned(), chance).into(),
            finding(p).into(),
        ]);
    }
    screen.table(table);
}
