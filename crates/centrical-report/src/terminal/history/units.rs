//! Units of one type beside each other.

use centrical_session::{
    BatchWithoutUnit, BeyondLimit, UnitFindingKind, UnitsHistoryReport, UnitsParameter, UntestedStation, customary,
};

use super::unit::left_out;
use crate::number::{counted, with_uncertainty};
use crate::terminal::phrases::{chance, legend, short_list};
use crate::terminal::screen::{Emphasis, Screen};
use crate::terminal::table::{Align, Cell, Table};

/// Calibrations that are left out and named one by one.
const SHOWN: usize = 5;

/// Units of one type beside each other.
pub fn units_history_text(report: &UnitsHistoryReport) -> Screen {
    let mut screen = Screen::default();
    verdict(&mut screen, report);
    untested(&mut screen, report);
    beyond_limits(&mut screen, report);
    calibrations(&mut screen, report);
    batches(&mut screen, report);
    without_unit(&mut screen, report);
    outlying(&mut screen, report);
    findings(&mut screen, report);
    batch_means(&mut screen, report);
    parameters(&mut screen, report);
    screen
}

fn verdict(screen: &mut Screen, report: &UnitsHistoryReport) {
    let are_alike =
        report.outlying.is_empty() && report.findings.is_empty() && !report.parameters.iter().any(|p| p.batches_differ);
    let (emphasis, mark, words) = match (report.is_sound, report.is_tested) {
        (true, true) => (Emphasis::Acceptable, "ALIKE", "no unit stands out, drifts or scatters more than the others"),
        (true, false) => (Emphasis::Warning, "NOT TESTED", "nothing was found, but not all units could be compared"),
        (false, _) if !are_alike => (Emphasis::NotAcceptable, "NOT ALIKE", "the units stand below; family-wise 5 %"),
        (false, _) if !report.beyond_limits.is_empty() => {
            (Emphasis::NotAcceptable, "NOT WITHIN LIMITS", "the units stand below")
        }
        (false, _) => (Emphasis::NotAcceptable, "NOT COMPARED", "no unit stands out, but batches were not compared"),
    };
    screen.marked(emphasis, mark, words);
}

/// Stations with too few units to compare them.
fn untested(screen: &mut Screen, report: &UnitsHistoryReport) {
    for UntestedStation { station, units } in &report.untested {
        let at = if station.is_empty() { String::new() } else { format!(" at the station {station}") };
        let words = format!(
            "{}{at}, and fewer than ten do not show which of them is outlying: {}",
            counted(units.len(), "unit"),
            short_list(units, SHOWN, ", ")
        );
        screen.marked(Emphasis::Warning, "FEW", &words);
    }
}

fn beyond_limits(screen: &mut Screen, report: &UnitsHistoryReport) {
    for BeyondLimit { parameter, units } in &report.beyond_limits {
        let words = format!("{parameter}: {}, serial {}", counted(units.len(), "unit"), short_list(units, SHOWN, ", "));
        screen.marked(Emphasis::NotAcceptable, "BEYOND LIMITS", &words);
    }
}

/// Calibrations that are left out, or that count with an objection.
fn calibrations(screen: &mut Screen, report: &UnitsHistoryReport) {
    for session in report.left_out.iter().take(SHOWN) {
        let words = format!("serial {}, {}", session.session.unit_serial, left_out(session));
        screen.marked(Emphasis::Warning, "INCOMPLETE", &words);
    }
    if report.left_out.len() > SHOWN {
        let words = format!("and {} more", counted(report.left_out.len() - SHOWN, "calibration"));
        screen.marked(Emphasis::Warning, "INCOMPLETE", &words);
    }
    if !report.not_compared.is_empty() {
        let names: Vec<String> = report.not_compared.iter().map(|p| format!("{} ({})", p.name, p.sessions)).collect();
        let words = format!("some calibrations alone determine {}", short_list(&names, SHOWN, ", "));
        screen.marked(Emphasis::Warning, "NOT COMPARED", &words);
    }
    if report.not_acceptable > 0 {
        let words =
            format!("{} with an objection count as the others do", counted(report.not_acceptable, "calibration"));
        screen.marked(Emphasis::Warning, "NOT ACCEPTABLE", &words);
    }
}

fn outlying(screen: &mut Screen, report: &UnitsHistoryReport) {
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
}

/// Units that drift or scatter more than the others.
fn findings(screen: &mut Screen, report: &UnitsHistoryReport) {
    for finding in &report.findings {
        let step = finding.step.map_or_else(String::new, |[before, after]| {
            format!("; a step between {before} and {after} explains it better than a line")
        });
        let words = format!(
            "serial {}, {}: family-wise probability {}{step}",
            finding.unit_serial,
            finding.parameter,
            chance(finding.probability)
        );
        screen.marked(Emphasis::NotAcceptable, finding_mark(finding.kind), &words);
    }
}

/// The mark of what a unit does.
pub fn finding_mark(kind: UnitFindingKind) -> &'static str {
    match kind {
        UnitFindingKind::Drifts => "DRIFTS",
        UnitFindingKind::Scatters => "SCATTERS",
    }
}

/// The parameters over the units: a row each.
fn parameters(screen: &mut Screen, report: &UnitsHistoryReport) {
    screen.gap();
    let counts = format!("{}, {}", counted(report.units, "unit"), counted(report.sessions, "calibration"));
    screen.head("UNITS", &format!("{}: {counts}; of each unit the mean over its calibrations", report.unit_model));
    let columns: [(Align, &[&str]); 4] = [
        (Align::Left, &["", "unit"]),
        (Align::Right, &["mean", "least", "largest", "Cp", "Cpk"]),
        (Align::Left, &["interval"]),
        (Align::Words, &[""]),
    ];
    let mut table = Table::new(2, &columns);
    for p in &report.parameters {
        let (factor, unit) = customary(&p.unit, p.group);
        let shown = |value: f64| in_digits_of(factor, value, p.deviation.unwrap_or(0.0));
        let mean = p.deviation.map_or_else(|| shown(p.mean), |deviation| Cell::estimate(factor, p.mean, deviation));
        let capability = p.capability.as_ref();
        let interval = capability.map(|c| format!("{:.2} to {:.2}", c.cpk_interval[0], c.cpk_interval[1]));
        table.row([
            p.name.as_str().into(),
            unit.into(),
            mean,
            shown(p.least),
            shown(p.largest),
            capability.and_then(|c| c.cp).map_or_else(String::new, |cp| format!("{cp:.2}")).into(),
            capability.map_or_else(String::new, |c| format!("{:.2}", c.cpk)).into(),
            interval.unwrap_or_default().into(),
            if p.batches_differ { "BATCHES DIFFER" } else { "" }.into(),
        ]);
    }
    screen.table(table);
    legend(screen, report.parameters.iter().map(|p| (p.name.as_str(), p.group)));
}

/// A value times `factor` with the digits that it has beside a deviation.
fn in_digits_of(factor: f64, value: f64, deviation: f64) -> Cell {
    with_uncertainty(factor * value, factor.abs() * deviation).0.into()
}

/// What the comparison of batches says where they do not differ.
fn batches(screen: &mut Screen, report: &UnitsHistoryReport) {
    let all = report.parameters.first().map_or(&[][..], |of| &of.batches);
    let list: Vec<String> = all.iter().map(|b| format!("{} ({})", b.batch, b.units)).collect();
    let list = if list.is_empty() { "no unit of a batch".to_owned() } else { short_list(&list, SHOWN, ", ") };
    let compared = report.parameters.iter().filter(|p| p.batch_probability.is_some()).count();
    if let Some(station) = report.batches_at.as_ref().filter(|_| !all.is_empty()) {
        let words =
            format!("{list} at {station:?} alone: what sessions of a station share would separate batches of two");
        screen.marked(Emphasis::Warning, "BATCHES", &words);
    }
    if report.batches_not_compared {
        let words = format!("{list}: two batches of two units at least at one station can be compared");
        screen.marked(Emphasis::Warning, "BATCHES NOT COMPARED", &words);
    } else if compared > 0 && !report.parameters.iter().any(|p| p.batches_differ) {
        let words = format!("{list}: their means differ in none of {}", counted(compared, "parameter"));
        screen.marked(Emphasis::Acceptable, "BATCHES ALIKE", &words);
    }
}

/// The parameters by batch where batches differ: a row for each of the two.
fn batch_means(screen: &mut Screen, report: &UnitsHistoryReport) {
    let differing: Vec<&UnitsParameter> = report.parameters.iter().filter(|p| p.batches_differ).collect();
    if differing.is_empty() {
        return;
    }
    screen.gap();
    screen.head(
        "BATCHES",
        "mean ± standard deviation over the units of a batch; probability of means as different by chance (Welch)",
    );
    let columns: [(Align, &[&str]); 3] =
        [(Align::Left, &["", "unit", "batch"]), (Align::Right, &["units", "mean"]), (Align::Left, &["probability"])];
    let mut table = Table::new(3, &columns);
    for p in differing {
        let (factor, unit) = customary(&p.unit, p.group);
        for b in &p.batches {
            let alone = || in_digits_of(factor, b.mean, p.deviation.unwrap_or(0.0));
            let mean = b.deviation.map_or_else(alone, |deviation| Cell::estimate(factor, b.mean, deviation));
            table.row([
                p.name.as_str().into(),
                unit.into(),
                b.batch.as_str().into(),
                b.units.to_string().into(),
                mean,
                p.batch_probability.map_or_else(String::new, chance).into(),
            ]);
        }
    }
    screen.table(table);
}

/// Serial numbers of the batches that no unit has: those near one by itself, the others together.
fn without_unit(screen: &mut Screen, report: &UnitsHistoryReport) {
    let quoted = |serials: &[String]| {
        short_list(&serials.iter().map(|serial| format!("{serial:?}")).collect::<Vec<String>>(), SHOWN, ", ")
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
