//! One unit over its calibrations.

use std::collections::BTreeMap;

use centrical_session::{
    Date, DueDate, LeftOutSession, MICRO_G, PastSession, ReadingHistory, STANDARD_GRAVITY as G, UnitHistoryReport,
    UnitParameter, customary, unit_name,
};

use crate::number::{counted, two_digits, unsigned_zero, with_uncertainty};
use crate::terminal::phrases::{chance, legend, short_list};
use crate::terminal::screen::{Emphasis, Screen};
use crate::terminal::table::{Align, Cell, Table};

/// A unit over its calibrations.
pub fn unit_history_text(report: &UnitHistoryReport) -> Screen {
    let mut screen = Screen::default();
    verdict(&mut screen, report);
    screen.gap();
    let UnitHistoryReport { unit_model, unit_serial, sessions, .. } = report;
    screen.head("UNIT", &format!("{}: {}", unit_name(unit_model, unit_serial), counted(sessions.len(), "calibration")));
    let mut table = Table::new(1, &[(Align::Left, &["", "date", "station", ""]), (Align::Words, &[""])]);
    for (n, session) in sessions.iter().enumerate() {
        let verdict = if session.acceptable { "" } else { "NOT ACCEPTABLE" };
        let date = session.stamp.clone().unwrap_or_else(|| session.date.to_string());
        table.row([
            (n + 1).to_string().into(),
            date.into(),
            session.station.as_str().into(),
            verdict.into(),
            short(&session.source).into(),
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
    due(screen, report);
    last_calibration(screen, report);
    incomplete(screen, report);
    steps(screen, report);
    sameness(screen, report);
    gravities(screen, report);
    twice(screen, report);
    if report.sessions.len() < 3 {
        screen.marked(Emphasis::Warning, "FEW", "two calibrations show no trend beside the scatter between sessions");
    } else if report.is_unexplained() {
        screen.marked(Emphasis::Warning, "FEW", "the calibrations are too few to tell a drift from scatter");
    }
}

/// Until when readings are within the limit.
fn due(screen: &mut Screen, report: &UnitHistoryReport) {
    let percent = percent(report.coverage);
    let within = |limit: f64| {
        let range = format!("{:.0} g", report.range / G);
        format!("within {} µg up to {range} with a probability of {percent}", two_digits(limit / MICRO_G))
    };
    match (&report.due, report.limit, report.due_after) {
        (Some(due), Some(limit), _) if report.is_within != Some(false) => {
            let within = within(limit);
            let words = format!(
                "{}: until then a compensated reading is {within} after each switch-on; first to leave: {}",
                due.date,
                place(due)
            );
            screen.marked(Emphasis::Acceptable, "DUE", &words);
        }
        (Some(due), Some(limit), _) => {
            let since = match report.sessions.last() {
                Some(last) if due.date > last.date => format!("since {}; on {} ", due.date, report.on),
                _ => String::new(),
            };
            let words = format!(
                "{since}a compensated reading is not {} after a switch-on; first: {}",
                within(limit),
                place(due)
            );
            screen.marked(Emphasis::NotAcceptable, "OVERDUE", &words);
        }
        (None, Some(limit), Some(day)) => {
            let words =
                format!("after {day}: until then every compensated reading is {} after each switch-on", within(limit));
            screen.marked(Emphasis::Acceptable, "DUE", &words);
        }
        (None, Some(limit), None) => {
            let of_one_day = report.sessions.windows(2).all(|pair| pair[0].date == pair[1].date);
            let calibrations = match report.sessions.len() {
                _ if of_one_day => "calibrations of a single day",
                2 => "two calibrations",
                _ => "the calibrations",
            };
            let words = format!("{calibrations} do not show until when a compensated reading is {}", within(limit));
            screen.marked(Emphasis::Warning, "NOT KNOWN", &words);
        }
        (_, None, _) => {}
    }
}

/// What is wrong with the last calibration, which all rests on.
fn last_calibration(screen: &mut Screen, report: &UnitHistoryReport) {
    if !report.has_acceptable_last() {
        let words = "the last calibration has an objection, and all that stands here takes it as it is";
        screen.marked(Emphasis::NotAcceptable, "NOT ACCEPTABLE", words);
    }
    if report.ahead {
        let words = format!(
            "the last calibration is of {}, later than today: a wrong clock, or day and month exchanged; all that stands here takes it as it is",
            report.sessions.last().map_or(report.on, |last| last.date)
        );
        screen.marked(Emphasis::NotAcceptable, "AHEAD", &words);
    }
}

/// Calibrations and parameters that are not compared, and calibrations with an objection.
fn incomplete(screen: &mut Screen, report: &UnitHistoryReport) {
    for LeftOutSession { session, lacks } in report.incomplete.iter().take(NAMES) {
        let words = format!("{}: it does not determine {}", named(session), first_of(lacks));
        screen.marked(Emphasis::Warning, "INCOMPLETE", &words);
    }
    if report.incomplete.len() > NAMES {
        let words = format!("and {} more", counted(report.incomplete.len() - NAMES, "calibration"));
        screen.marked(Emphasis::Warning, "INCOMPLETE", &words);
    }
    for session in &report.left_out {
        screen.marked(Emphasis::Warning, "INCOMPLETE", &left_out(session));
    }
    if !report.not_compared.is_empty() {
        let words = format!("not determined before the last calibration: {}", first_of(&report.not_compared));
        screen.marked(Emphasis::Warning, "NOT COMPARED", &words);
    }
    if !report.not_in_last.is_empty() {
        let words = format!(
            "the last calibration does not determine {}, as earlier ones do; a due date counts them as an error",
            first_of(&report.not_in_last)
        );
        screen.marked(Emphasis::Warning, "NOT IN LAST", &words);
    }
    let refused = report.sessions.iter().rev().skip(1).filter(|session| !session.acceptable).count();
    if refused > 0 {
        let words = format!("{} before the last with an objection, not left out", counted(refused, "calibration"));
        screen.marked(Emphasis::Warning, "NOT ACCEPTABLE", &words);
    }
}

/// Steps between two sessions, with the parameters that have them.
fn steps(screen: &mut Screen, report: &UnitHistoryReport) {
    let mut by_days: BTreeMap<[Date; 2], Vec<String>> = BTreeMap::new();
    for p in &report.parameters {
        if let Some(days) = p.step {
            by_days.entry(days).or_default().push(p.name.clone());
        }
    }
    for ([before, after], names) in by_days {
        let words = format!(
            "between {before} and {after}, in {}: it explains the values better than a line in time does, as a repair or another unit of this \
             serial number would; forecasts and due dates continue the line",
            first_of(&names)
        );
        screen.marked(Emphasis::Warning, "STEP", &words);
    }
}

/// All parameters of all sessions together, and the session that deviates.
fn sameness(screen: &mut Screen, report: &UnitHistoryReport) {
    if let Some(test) = &report.sameness {
        let words = format!(
            "chi^2 = {:.1} with {} degrees of freedom; as large by the stated uncertainties alone with a probability of {}",
            test.chi_squared,
            test.degrees_of_freedom,
            chance(test.probability)
        );
        let (emphasis, mark, why) = if report.differs() {
            (Emphasis::Warning, "DIFFERS", "")
        } else if report.agrees_too_well() {
            (
                Emphasis::Warning,
                "TOO ALIKE",
                "; the calibrations agree better than independent ones do: results of the same records, or uncertainties that are too large",
            )
        } else if report.deviating().is_some() {
            (Emphasis::Heading, "TOGETHER", "")
        } else {
            (Emphasis::Acceptable, "THE SAME", "")
        };
        screen.marked(emphasis, mark, &(words + why));
    }
    if let Some(session) = report.deviating() {
        let words = format!(
            "{}, {}: a session deviates as much by the stated uncertainties with a probability of {}, and by the scatter of the others with {}; \
             the others as they do by the stated uncertainties with {}",
            session.date,
            short(&session.source),
            chance(session.probability),
            chance(session.probability_by_scatter),
            chance(session.probability_of_others)
        );
        screen.marked(Emphasis::Warning, "DEVIATES", &words);
    }
}

/// Sessions of one place that state different gravities.
fn gravities(screen: &mut Screen, report: &UnitHistoryReport) {
    let pairs = report.gravities();
    for [one, other] in pairs.iter().take(NAMES) {
        let [first, then] = [one, other].map(|session| session.gravity.map_or_else(String::new, |g| g.to_string()));
        let place =
            if one.station.is_empty() { "without a station to tell two places apart" } else { "at one station" };
        let words = format!(
            "{} states {first} m/s^2 and {} {then} m/s^2, {place}: a wrong value moves each scale error from rests by as much",
            named(one),
            named(other)
        );
        screen.marked(Emphasis::Warning, "GRAVITY", &words);
    }
    if pairs.len() > NAMES {
        screen.marked(Emphasis::Warning, "GRAVITY", &format!("and {} more changes", pairs.len() - NAMES));
    }
}

/// Sessions that may be one.
fn twice(screen: &mut Screen, report: &UnitHistoryReport) {
    for [one, other] in report.twice() {
        let words = format!(
            "{} and {} have the same values to the last digit, and count as two sessions",
            named(one),
            named(other)
        );
        screen.marked(Emphasis::Warning, "TWICE", &words);
    }
    for [one, other] in report.same_days() {
        let words = format!(
            "{}: {} and {} count as two sessions in this order, by the times of their dates and then by their names",
            one.date,
            short(&one.source),
            short(&other.source)
        );
        screen.marked(Emphasis::Warning, "SAME DAY", &words);
    }
}

/// A calibration that is left out, and why.
pub(super) fn left_out(left_out: &LeftOutSession) -> String {
    let LeftOutSession { session, lacks } = left_out;
    format!("{}: it does not determine {}, and is not compared", named(session), first_of(lacks))
}

/// A session by its day and file.
fn named(session: &PastSession) -> String {
    format!("{}, {}", session.date, short(&session.source))
}

/// The file of a session; of its key in a store, 64 digits, the first that a person compares.
fn short(source: &str) -> &str {
    const DIGITS: usize = 12;
    let is_key = source.len() == 64 && source.bytes().all(|digit| digit.is_ascii_hexdigit());
    if is_key { &source[..DIGITS] } else { source }
}

/// The first names, and the number of the others.
fn first_of(names: &[String]) -> String {
    short_list(names, NAMES, ", ")
}

/// Names in a short list.
const NAMES: usize = 3;

/// A probability in percent: 95 %, 95.45 %.
fn percent(probability: f64) -> String {
    format!("{} %", (1e8 * probability).round() / 1e6)
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
    let percent = percent(report.coverage);
    let kind = if report.trend { "about a line in time" } else { "about a constant" };
    let text = format!(
        "last ± its standard uncertainty; standard deviation between sessions beside the stated one, {kind}{together}, with its \
             interval of {percent}; F of the scatter; drift per year ± standard uncertainty; interval of {percent} of the value after a switch-on \
             on {}; E_n (k = 2) against the calibration before and the first",
        report.until
    );
    screen.head("PARAMETERS", &text);
    let columns: [(Align, &[&str]); 7] = [
        (Align::Left, &["", "unit"]),
        (Align::Right, &["last", "between"]),
        (Align::Left, &["interval"]),
        (Align::Right, &["F", "per year"]),
        (Align::Left, &["forecast"]),
        (Align::Right, &["E_n", "first"]),
        (Align::Words, &[""]),
    ];
    let mut table = Table::new(2, &columns);
    for p in &report.parameters {
        table.row(parameter(p));
    }
    screen.table(table);
}

fn parameter(p: &UnitParameter) -> [Cell; 11] {
    let (factor, unit) = customary(&p.unit, p.group);
    let estimate = |(value, u): (f64, f64)| Cell::estimate(factor, value, u);
    let last = p.values.iter().zip(&p.standard_uncertainties).rev().find_map(|(value, u)| value.zip(*u));
    let shown = |value: f64| two_digits(factor.abs() * value);
    let between = p.between.map_or_else(String::new, shown);
    let slope = p.slope_per_year.zip(p.slope_uncertainty);
    let mark = match (p.drifts, p.scatters) {
        (true, true) => "DRIFTS, SCATTERS",
        (true, false) => "DRIFTS",
        (false, true) => "SCATTERS",
        (false, false) => "",
    };
    let e_n = |e_n: f64| unsigned_zero(format!("{e_n:.2}"));
    [
        p.name.as_str().into(),
        unit.into(),
        last.map_or_else(Cell::default, estimate),
        between.into(),
        p.between_interval.map_or_else(String::new, |ends| interval(ends, shown)).into(),
        p.variance_ratio.map_or_else(String::new, |f| format!("{f:.1}")).into(),
        slope.map_or_else(Cell::default, estimate),
        p.forecast.map_or_else(String::new, |ends| forecast(ends.map(|end| factor * end))).into(),
        e_n(p.e_n_previous).into(),
        e_n(p.e_n_first).into(),
        mark.into(),
    ]
}

/// The interval of a standard deviation between sessions. It has no length where nearly all sessions would scatter more that state such
/// uncertainties.
fn interval([low, high]: [f64; 2], shown: impl Fn(f64) -> String) -> String {
    if high == 0.0 { "less than stated".to_owned() } else { format!("{} to {}", shown(low), shown(high)) }
}

/// An interval of values, each to two digits of its half length.
fn forecast(ends: [f64; 2]) -> String {
    let half = 0.5 * (ends[1] - ends[0]).abs();
    let [a, b] = [ends[0].min(ends[1]), ends[0].max(ends[1])].map(|end| with_uncertainty(end, half).0);
    format!("{a} to {b}")
}

fn readings(screen: &mut Screen, report: &UnitHistoryReport) {
    if report.readings.is_empty() {
        return;
    }
    screen.head(
        "AFTER A SWITCH-ON",
        "standard uncertainty of a reading compensated by the last calibration, µg: stated; between sessions with its interval; after a switch-on, \
         sqrt(stated^2 + 2 between^2), and expanded; of each newtonometer at rest, and where it is largest or first due",
    );
    let expanded = percent(report.coverage);
    let columns: [(Align, &[&str]); 5] = [
        (Align::Left, &["newtonometer", "force, g"]),
        (Align::Right, &["stated", "between"]),
        (Align::Left, &["interval"]),
        (Align::Right, &["after", &expanded]),
        (Align::Left, &["due"]),
    ];
    let mut table = Table::new(2, &columns);
    for r in report.shown_readings() {
        table.row(reading(r));
    }
    screen.table(table);
}

fn reading(r: &ReadingHistory) -> [Cell; 8] {
    let micro_g = |value: f64| Cell::from(two_digits(value / MICRO_G));
    [
        r.axis.to_string().into(),
        force(r.force).into(),
        micro_g(r.stated),
        micro_g(r.between),
        interval(r.between_interval, |value| two_digits(value / MICRO_G)).into(),
        micro_g(r.after_switch_on),
        r.expanded_after_switch_on.map_or_else(Cell::default, micro_g),
        r.due.as_ref().map_or_else(String::new, |due| due.date.to_string()).into(),
    ]
}
