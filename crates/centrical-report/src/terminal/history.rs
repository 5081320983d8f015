//! Histories as text for the terminal.

use centrical_session::{
    ChartReport, DueDate, ReadingHistory, StationHistoryReport, UnitHistoryReport, UnitParameter, UnitsHistoryReport,
    customary,
};

use super::screen::{Emphasis, Screen};
use super::symbols::legend;
use super::table::{Align, Cell, Table};
use crate::number::{counted, two_digits, unsigned_zero, with_uncertainty};

/// One micro-g in m/s^2.
const MICRO_G: f64 = centrical_session::MICRO_G;

/// One g in m/s^2.
const G: f64 = centrical_session::STANDARD_GRAVITY;

/// A unit over its calibrations.
pub fn unit_history_text(report: &UnitHistoryReport) -> Screen {
    let mut screen = Screen::default();
    verdict(&mut screen, report);
    screen.gap();
    let UnitHistoryReport { unit_model, unit_serial, sessions, .. } = report;
    screen.head("UNIT", &format!("{unit_model}, serial {unit_serial}: {}", counted(sessions.len(), "calibration")));
    let mut table = Table::new(
        1,
        [("", Align::Left), ("date", Align::Left), ("station", Align::Left), ("", Align::Left), ("", Align::Words)],
    );
    for (n, session) in sessions.iter().enumerate() {
        let verdict = if session.acceptable { "" } else { "NOT ACCEPTABLE" };
        let date = session.date.to_string();
        table.row([
            (n + 1).to_string().into(),
            date.into(),
            session.station.as_str().into(),
            verdict.into(),
            session.source.as_str().into(),
        ]);
    }
    screen.table(table);
    screen.gap();
    parameters(&mut screen, report);
    screen.gap();
    readings(&mut screen, report);
    legend(&mut screen, report.parameters.iter().map(|p| (p.name.as_str(), p.group)));
    screen
}

fn verdict(screen: &mut Screen, report: &UnitHistoryReport) {
    let percent = percent(report.coverage);
    let within = |limit: f64| format!("within {} µg with a probability of {percent}", two_digits(limit / MICRO_G));
    match (&report.due, report.limit, report.due_after) {
        (Some(due), Some(limit), _) if report.is_acceptable() => {
            let within = within(limit);
            let words = format!(
                "{}: until then a compensated reading is {within} after each switch-on; first to leave: {}",
                due.date,
                place(due)
            );
            screen.marked(Emphasis::Acceptable, "DUE", &words);
        }
        (Some(due), Some(limit), _) => {
            let words = format!(
                "a compensated reading is not {} after the next switch-on; first: {}",
                within(limit),
                place(due)
            );
            screen.marked(Emphasis::NotAcceptable, "OVERDUE", &words);
        }
        (None, Some(limit), Some(day)) if !report.readings.is_empty() => {
            let words =
                format!("after {day}: until then every compensated reading is {} after each switch-on", within(limit));
            screen.marked(Emphasis::Acceptable, "DUE", &words);
        }
        _ => {}
    }
    if let Some(test) = report.sameness {
        let words = format!(
            "chi^2 = {:.1} with {} degrees of freedom; as large by the stated uncertainties alone with a probability of {}",
            test.chi_squared,
            test.degrees_of_freedom,
            chance(test.probability)
        );
        let (emphasis, mark) =
            if test.probability < 0.01 { (Emphasis::Warning, "DIFFERS") } else { (Emphasis::Acceptable, "THE SAME") };
        screen.marked(emphasis, mark, &words);
    }
    if report.sessions.len() < 3 {
        screen.marked(Emphasis::Warning, "FEW", "two calibrations show no trend beside the scatter between sessions");
    }
}

/// A probability in percent: 95 %, 95.45 %.
fn percent(probability: f64) -> String {
    format!("{} %", (1e8 * probability).round() / 1e6)
}

/// A small probability, which may be too small for a number.
fn chance(probability: f64) -> String {
    if probability < 1e-300 { "below 1e-300".to_owned() } else { format!("{probability:.1e}") }
}

fn place(due: &DueDate) -> String {
    format!("newtonometer {} at {} g", due.axis, force(due.force))
}

fn force(f: [f64; 3]) -> String {
    format!("({})", f.map(|f| unsigned_zero(format!("{:.0}", f / G))).join(", "))
}

fn parameters(screen: &mut Screen, report: &UnitHistoryReport) {
    let together = match report.units_together {
        1 => String::new(),
        units => format!(", common to {units} units"),
    };
    let kind = if report.trend { "about a line in time" } else { "about a constant" };
    screen.head(
        "PARAMETERS",
        &format!(
            "last ± its standard uncertainty; standard deviation between sessions beside the stated one, {kind}{together}, with its \
             interval of {}; F of the scatter; drift per year ± standard uncertainty; E_n (k = 2) against the calibration before and the first",
            percent(report.coverage)
        ),
    );
    let columns = [
        ("", Align::Left),
        ("unit", Align::Left),
        ("last", Align::Right),
        ("between", Align::Right),
        ("interval", Align::Left),
        ("F", Align::Right),
        ("per year", Align::Right),
        ("E_n", Align::Right),
        ("first", Align::Right),
        ("", Align::Words),
    ];
    let mut table = Table::new(2, columns);
    for p in &report.parameters {
        table.row(parameter(p));
    }
    screen.table(table);
}

fn parameter(p: &UnitParameter) -> [Cell; 10] {
    let (factor, unit) = customary(&p.unit, p.group);
    let estimate = |value: f64, u: f64| Cell::estimate(with_uncertainty(factor * value, factor.abs() * u));
    let last = p.values.last().zip(p.standard_uncertainties.last());
    let shown = |value: f64| two_digits(factor.abs() * value);
    let between = p.between.map_or_else(String::new, shown);
    let interval =
        p.between_interval.map_or_else(String::new, |[low, high]| format!("{} to {}", shown(low), shown(high)));
    let slope = p.slope_per_year.zip(p.slope_uncertainty);
    let mark = match (p.drifts, p.scatters) {
        (true, _) => "DRIFTS",
        (false, true) => "SCATTERS",
        (false, false) => "",
    };
    let e_n = |e_n: f64| unsigned_zero(format!("{e_n:.2}"));
    [
        p.name.as_str().into(),
        unit.into(),
        last.map_or_else(Cell::default, |(value, u)| estimate(*value, *u)),
        between.into(),
        interval.into(),
        p.variance_ratio.map_or_else(String::new, |f| format!("{f:.1}")).into(),
        slope.map_or_else(Cell::default, |(value, u)| estimate(value, u)),
        e_n(p.e_n_previous).into(),
        e_n(p.e_n_first).into(),
        mark.into(),
    ]
}

fn readings(screen: &mut Screen, report: &UnitHistoryReport) {
    if report.readings.is_empty() {
        return;
    }
    screen.head(
        "AFTER A SWITCH-ON",
        "standard uncertainty of a reading compensated by the last calibration, µg: stated, between sessions, and both; the worst of each newtonometer",
    );
    let columns = [
        ("newtonometer", Align::Left),
        ("force, g", Align::Left),
        ("stated", Align::Right),
        ("between", Align::Right),
        ("both", Align::Right),
        ("due", Align::Left),
    ];
    let mut table = Table::new(1, columns);
    for axis in 1..=3 {
        let of_axis = || report.readings.iter().filter(|r| r.axis == axis);
        let at_rest = of_axis().find(|r| r.force == [0.0; 3]);
        let worst = of_axis().max_by(|a, b| a.after_switch_on.total_cmp(&b.after_switch_on));
        for r in at_rest.into_iter().chain(worst) {
            table.row(reading(r));
        }
    }
    screen.table(table);
}

fn reading(r: &ReadingHistory) -> [Cell; 6] {
    let micro_g = |value: f64| Cell::from(two_digits(value / MICRO_G));
    [
        r.axis.to_string().into(),
        force(r.force).into(),
        micro_g(r.stated),
        micro_g(r.between),
        micro_g(r.after_switch_on),
        r.due.as_ref().map_or_else(String::new, |due| due.date.to_string()).into(),
    ]
}

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
            "serial {}, {}: family-wise probability {:.1e}",
            finding.unit_serial, finding.parameter, finding.probability
        );
        screen.marked(Emphasis::NotAcceptable, if finding.kind == "drifts" { "DRIFTS" } else { "SCATTERS" }, &words);
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

/// A station over its sessions.
pub fn station_history_text(report: &StationHistoryReport) -> Screen {
    let mut screen = Screen::default();
    let (emphasis, mark, words) = if report.is_steady {
        (Emphasis::Acceptable, "STEADY", "no parameter of the machine drifts or has changed")
    } else {
        (Emphasis::NotAcceptable, "NOT STEADY", "the parameters are marked below; family-wise 5 %")
    };
    screen.marked(emphasis, mark, words);
    screen.gap();
    let name = if report.station.is_empty() { "without a name" } else { &report.station };
    let counts = format!("{} of {}", counted(report.sessions, "session"), counted(report.units, "unit"));
    screen.head("STATION", &format!("{name}: {counts}, {} to {}", report.first, report.last));
    let columns = [
        ("", Align::Left),
        ("unit", Align::Left),
        ("mean", Align::Right),
        ("per year", Align::Right),
        ("change", Align::Right),
        ("after", Align::Left),
        ("probability", Align::Right),
        ("", Align::Words),
    ];
    let mut table = Table::new(2, columns);
    for p in &report.parameters {
        let (factor, unit) = customary(&p.unit, p.group);
        let estimate = |value: f64, u: f64| Cell::estimate(with_uncertainty(factor * value, factor.abs() * u));
        let slope = p.slope_per_year.zip(p.slope_uncertainty);
        table.row([
            p.name.as_str().into(),
            unit.into(),
            estimate(p.mean, p.scatter),
            slope.map_or_else(Cell::default, |(slope, u)| estimate(slope, u)),
            p.change.map_or_else(String::new, |change| two_digits(factor * change)).into(),
            p.changed_after.map_or_else(String::new, |day| day.to_string()).into(),
            p.probability.map_or_else(|| "too few".to_owned(), chance).into(),
            if p.changes { "CHANGES" } else { "" }.into(),
        ]);
    }
    screen.table(table);
    legend(&mut screen, report.parameters.iter().map(|p| (p.name.as_str(), p.group)));
    screen
}

/// Control charts.
pub fn chart_text(report: &ChartReport) -> Screen {
    let mut screen = Screen::default();
    if report.signals.is_empty() {
        screen.marked(Emphasis::Acceptable, "IN CONTROL", "no rule gives a signal");
    } else {
        let words = format!("{} stand below", counted(report.signals.len(), "signal"));
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
    let columns = [
        ("date", Align::Left),
        ("serial", Align::Left),
        ("value", Align::Right),
        ("rule", Align::Left),
        ("", Align::Words),
    ];
    let mut table = Table::new(2, columns);
    for signal in &report.signals {
        let session = &report.sessions[signal.session];
        table.row([
            session.date.to_string().into(),
            session.unit_serial.as_str().into(),
            with_uncertainty(factor * report.values[signal.session], factor.abs() * report.deviation).0.into(),
            signal.rule.as_str().into(),
            signal.words.into(),
        ]);
    }
    if !report.signals.is_empty() {
        screen.table(table);
    }
    screen
}
