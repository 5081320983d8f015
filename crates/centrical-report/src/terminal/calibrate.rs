//! A result as a table for the terminal: what a person reads first.

use centrical::Group;
use centrical_session::{
    CalibrationResult, OutlyingPlateau, OutputSummary, ParameterEstimate, RestsOn, RivalSummary, TermSummary,
    ValiditySummary, customary,
};

use super::axes::axes as other_axes;
use super::drift::drift;
use super::phrases::{chance_to_three_places, legend, pattern_in_words};
use super::rests::rests;
use super::rests_on::{priors as prior_table, remedy, rests_on_text};
use super::screen::Screen;
use super::table::{Align, Cell, Table};
use crate::document::{counts_as_exact, rival, speeds};
use crate::evaluation::{ParameterName, combination, monomial};
use crate::language::Language;
use crate::number::counted;

/// The result as text: parameters with standard uncertainties in customary units, the fit, what is not
/// estimable and why, what was rejected.
pub(super) fn table_of(result: &CalibrationResult) -> Screen {
    let mut screen = Screen::default();
    heading(&mut screen, result);
    error_model(&mut screen, result);
    other_axes(&mut screen, result);
    if result.model.has_arm() {
        mounting(&mut screen, result);
    }
    rests(&mut screen, result);
    others(&mut screen, result);
    not_estimable(&mut screen, result);
    priors(&mut screen, result);
    plateaus(&mut screen, result);
    drift(&mut screen, result);
    known_speeds(&mut screen, result);
    fit(&mut screen, result);
    uncertainties(&mut screen, result);
    validity(&mut screen, result);
    screen.add(rests_on_text(&result.rests_on));
    screen
}

fn heading(screen: &mut Screen, result: &CalibrationResult) {
    let session = &result.session;
    let serial = if session.unit_serial.is_empty() { "not given" } else { &session.unit_serial };
    let joined = |words: [&str; 2]| words.into_iter().filter(|word| !word.is_empty()).collect::<Vec<_>>().join(", ");
    screen.say(0, &joined([&session.unit_model, &format!("serial {serial}")]));
    screen.say(0, &joined([&session.title, &session.date]));
    let combined = if result.stated_sources().is_empty() { "" } else { "combined " };
    screen.say(0, &format!("value ± {combined}standard uncertainty (k = 1); 1 g = 9.80665 m/s^2"));
    if let Some(OutputSummary { unit, scale, bias }) = result.raw_output() {
        // Six digits show which scale it is; all of them are in result.json.
        let six = |number: &f64| {
            format!("{number:.5e}").parse().map_or_else(|_| number.to_string(), |six: f64| six.to_string())
        };
        let three = |numbers: &[f64; 3]| numbers.each_ref().map(six).join(", ");
        let text = format!(
            "reading = (raw - bias) / scale with the scale {} {unit} per m/s^2 and the bias {} {unit}",
            three(scale),
            three(bias)
        );
        screen.sentence(0, 2, &text);
    }
}

/// One row per monomial, one column per newtonometer.
fn error_model(screen: &mut Screen, result: &CalibrationResult) {
    screen.gap();
    screen.head("ERROR MODEL", "reading = f + sum of term x coefficient");
    let mut rows: Vec<(String, &str)> = Vec::new();
    for term in &result.model.error_model {
        let key = row_of(result, term);
        if !rows.contains(&key) {
            rows.push(key);
        }
    }
    let mut table = axes("term", "newtonometer");
    for key in rows {
        let mut unit = "";
        let mut cells: [Cell; 3] = Default::default();
        for term in result.model.error_model.iter().filter(|term| row_of(result, term) == key) {
            if let Some(parameter) = result.parameter(&term.name) {
                unit = customary(&parameter.unit, parameter.group).1;
                cells[term.axis - 1] = cell(parameter);
            }
        }
        table.row([key.0.into(), unit.into()].into_iter().chain(cells));
    }
    screen.table(table);
    screen.sentence(
        2,
        2,
        "1: bias; own f in ppm: scale error; other f in urad: misalignment; f1, f2, f3: specific force.",
    );
}

/// A table of estimates by axis.
fn axes(label: &str, axis: &str) -> Table {
    let numbers = [1, 2, 3].map(|n| format!("{axis} {n}"));
    Table::new(2, &[(Align::Left, &[label, "unit"]), (Align::Right, &numbers.each_ref().map(String::as_str))])
}

/// Terms that share a row: the same monomial in the same customary unit.
fn row_of<'r>(result: &'r CalibrationResult, term: &TermSummary) -> (String, &'r str) {
    let unit = result.parameter(&term.name).map_or("", |p| customary(&p.unit, p.group).1);
    (monomial(term), unit)
}

/// Turns by position, shifts by pair, tilt and proof masses.
fn mounting(screen: &mut Screen, result: &CalibrationResult) {
    screen.gap();
    screen.head("MOUNTING", "");
    let mut rows: Vec<(String, &str, [Cell; 3])> = Vec::new();
    let of_mounting = || result.parameters.iter().filter(|p| p.group.is_of_mounting());
    for parameter in of_mounting() {
        let Some((label, axis)) = label_and_axis(&parameter.name) else { continue };
        let unit = customary(&parameter.unit, parameter.group).1;
        if rows.last().is_none_or(|(last, _, _)| *last != label) {
            rows.push((label, unit, Default::default()));
        }
        if let Some((_, _, cells)) = rows.last_mut() {
            cells[axis] = cell(parameter);
        }
    }
    let mut table = axes("", "axis");
    for (label, unit, cells) in rows {
        table.row([label.into(), unit.into()].into_iter().chain(cells));
    }
    screen.table(table);
    legend(screen, of_mounting().map(|p| (p.name.as_str(), p.group)));
}

/// `delta_2[4]` is axis 1 of the row `delta[4]`; `drho_33` axis 2 of `drho`.
fn label_and_axis(name: &str) -> Option<(String, usize)> {
    let ParameterName { stem, index, place } = ParameterName::of(name);
    let axis = match index.as_bytes().first()? {
        b'1' => 0,
        b'2' => 1,
        b'3' => 2,
        _ => return None,
    };
    Some((format!("{stem}{place}"), axis))
}

/// What fits neither table: extensions of the model.
fn others(screen: &mut Screen, result: &CalibrationResult) {
    let is_known = |p: &ParameterEstimate| p.group.is_of_mounting() || p.group == Group::Attitude;
    let is_other = |p: &&ParameterEstimate| !is_known(p) && !result.is_coefficient(p);
    let others: Vec<_> = result.parameters.iter().filter(is_other).collect();
    if others.is_empty() {
        return;
    }
    screen.gap();
    let is_of_case = others.iter().all(|p| p.group == Group::CaseTurn);
    screen.head(if is_of_case { "CASE" } else { "EXTENSIONS" }, "");
    let mut table = Table::new(2, &[(Align::Left, &["", "unit"]), (Align::Right, &["value"])]);
    for parameter in &others {
        let unit = customary(&parameter.unit, parameter.group).1;
        table.row([parameter.name.as_str().into(), unit.into(), cell(parameter)]);
    }
    screen.table(table);
    legend(screen, others.iter().map(|p| (p.name.as_str(), p.group)));
}

fn cell(parameter: &ParameterEstimate) -> Cell {
    let factor = customary(&parameter.unit, parameter.group).0;
    match (parameter.value, parameter.standard_uncertainty) {
        (Some(value), Some(uncertainty)) => Cell::estimate(factor, value, uncertainty),
        _ => "undetermined".into(),
    }
}

fn not_estimable(screen: &mut Screen, result: &CalibrationResult) {
    let seen = &result.observability;
    if seen.null_directions.is_empty() {
        let vague: Vec<&str> = result.parameters.iter().filter(|p| !p.estimable).map(|p| p.name.as_str()).collect();
        if !vague.is_empty() {
            screen.gap();
            screen.head("UNDETERMINED", &format!("to a tenth or better: {}", vague.join(", ")));
        }
        return;
    }
    screen.gap();
    screen.head("UNDETERMINED", &format!("rank {} of {}: the readings do not change along", seen.rank, seen.columns));
    for direction in &result.null_directions_in_short() {
        screen.say(2, &combination(direction));
    }
    if !result.model.has_arm() {
        screen.say(2, "each with small changes of other coefficients and of the attitudes");
        if let Some(terms) = terms_without(result) {
            screen.sentence(2, 4, &format!("what the others are if these are zero: --terms {terms}"));
        }
    }
    let is_shown = |p: &&ParameterEstimate| result.model.has_arm() || result.is_coefficient(p);
    let lost = result.parameters.iter().filter(|p| !p.estimable).filter(is_shown);
    let lost: Vec<&str> = lost.map(|p| p.name.as_str()).collect();
    screen.say(2, &format!("so these have no value of their own: {}", lost.join(", ")));
    let of_instrument = result.parameters.iter().filter(|p| result.is_coefficient(p));
    let (of_instrument, lost_of_it) =
        of_instrument.fold((0, 0), |(n, lost), p| (n + 1, lost + usize::from(!p.estimable)));
    screen.say(
        2,
        &match lost_of_it {
            0 => format!("All {of_instrument} parameters of the instrument are determined."),
            1 => format!("1 of the {of_instrument} parameters of the instrument is not determined."),
            _ => format!("{lost_of_it} of the {of_instrument} parameters of the instrument are not determined."),
        },
    );
}

/// The terms of a model without those that lead the combinations that rests do not show; `None` where one leads two of them.
fn terms_without(result: &CalibrationResult) -> Option<String> {
    let directions = result.null_directions_in_short();
    let mut left: Vec<&str> = result.model.error_model.iter().map(|term| term.name.as_str()).collect();
    let all = left.len();
    for direction in &directions {
        let last = direction.keys().next_back()?;
        left.retain(|name| name != last);
    }
    (left.len() + directions.len() == all).then(|| left.join(","))
}

/// What rests on priors, and what the data added to each.
fn priors(screen: &mut Screen, result: &CalibrationResult) {
    let ratio = |p: &ParameterEstimate| Some(p.prior?.posterior_over_prior);
    prior_table(screen, result.parameters.iter().filter_map(|p| Some((p.name.as_str(), p.group, ratio(p)?))));
    let resting = result.parameters.iter().filter(|p| p.rests_on_prior && p.group != Group::Attitude);
    let resting: Vec<&str> = resting.map(|p| p.name.as_str()).collect();
    if !resting.is_empty() {
        screen.sentence(2, 4, &format!("without the priors these would have no value: {}", resting.join(", ")));
    }
}

fn plateaus(screen: &mut Screen, result: &CalibrationResult) {
    let samples: u64 = result.plateaus.iter().map(|p| p.samples).sum();
    let rejected: u64 = result.plateaus.iter().map(|p| p.rejected).sum();
    let mountings = result.plateaus.iter().map(|p| p.mounting).max().unwrap_or(0);
    let rests = result.rests().count();
    let on_arm = format!(
        "{} in {}",
        counted(result.plateaus.len() - rests, "plateau"),
        counted(mountings.saturating_sub(rests), "mounting")
    );
    let all = match (rests, result.plateaus.len() - rests) {
        (0, _) => on_arm,
        (_, 0) => counted(rests, "rest"),
        _ => format!("{on_arm} and {} beside the arm", counted(rests, "rest")),
    };
    screen.gap();
    screen.fact("DATA", &format!("{all}, {} used, {rejected} rejected", counted(samples, "sample")));
}

/// How the speeds are known, where they are measured or contradicted.
fn known_speeds(screen: &mut Screen, result: &CalibrationResult) {
    for (n, line) in speeds(result, Language::English).iter().enumerate() {
        screen.fact(if n == 0 { "SPEED" } else { "" }, line);
    }
}

fn fit(screen: &mut Screen, result: &CalibrationResult) {
    let fit = &result.fit;
    let words = &Language::English.messages().words;
    let course = format!(
        "{}, {} after {}",
        (words.method)(fit.method),
        (words.termination)(fit.termination),
        counted(fit.iterations, "iteration")
    );
    let Some((ratio, spread)) = fit.ratio() else {
        return screen.fact("FIT", &format!("{course}; no redundancy, so nothing checks the stated uncertainties"));
    };
    let degrees = counted(fit.degrees_of_freedom, "degree");
    screen.fact("FIT", &course);
    screen.fact("", &format!("chi^2 per degree of freedom {ratio:.3} (expected 1 ± {spread:.3}; {degrees})"));
}

/// What the uncertainties hold, and what they take as exact.
fn uncertainties(screen: &mut Screen, result: &CalibrationResult) {
    let Some(budget) = &result.budget else { return };
    let names: Vec<&str> = budget.sources.iter().map(|source| source.name.name()).collect();
    screen.fact("FROM", &names.join(", "));
    let exact = counts_as_exact(result, Language::English);
    let exact =
        exact.map_or("no input quantity is treated as exact".to_owned(), |names| format!("counts as exact: {names}"));
    screen.fact("", &format!("{exact}; gravity is {} m/s^2", result.model.gravity));
}

/// Plateaus that are named one by one where they are held out.
const NAMES: usize = 8;

/// What the residuals say of the model and of the weights.
fn validity(screen: &mut Screen, result: &CalibrationResult) {
    let Some(validity) = result.validity.as_ref().filter(|_| result.fit.degrees_of_freedom > 0) else { return };
    let chance = chance_to_three_places(validity.probability);
    screen.fact("VALID", &format!("chi^2 as large or larger comes by chance with a probability of {chance}"));
    if result.chi_squared_is_small() {
        screen.fact("", Language::English.messages().chi_squared_small);
    }
    let is_of_rests = result.rests().count() == result.plateaus.len();
    outlying(screen, result, &validity.outlying, is_of_rests);
    rivals(screen, validity, &result.rests_on);
    if validity.patterns.is_empty() && validity.patterns_tested > 0 {
        let against = if is_of_rests { "time" } else { "speed, position, radius and time" };
        let count = counted(validity.patterns_tested, "pattern");
        let text = format!("none of {count} against {against} in the residuals");
        screen.fact("", &text);
    }
    for pattern in &validity.patterns {
        screen.fact("", &pattern_in_words(pattern));
    }
    if let Some((worst, family_wise)) = validity.worst_mounting() {
        let what = if is_of_rests { "rest" } else { "mounting" };
        let text = format!(
            "each {what} predicted from all others: {what} {} is the worst, chi^2 {:.1} with {}; by the F test a worst of {} as \
                 large comes by chance with a probability of at most {family_wise:.3}",
            worst.mounting,
            worst.chi_squared,
            counted(worst.degrees_of_freedom, "degree"),
            validity.mountings.len()
        );
        screen.fact("", &text);
    }
}

/// Plateaus that were held out, and those that stand out.
fn outlying(screen: &mut Screen, result: &CalibrationResult, outlying: &[OutlyingPlateau], is_of_rests: bool) {
    let held_out = result.held_out();
    let fitted = result.plateaus.len() - held_out.len();
    if !held_out.is_empty() {
        let names = held_out.iter().take(NAMES).map(String::as_str).collect::<Vec<_>>().join(", ");
        let others = if held_out.len() > NAMES { ", ..." } else { "" };
        screen.fact("", &format!("{} held out of the fit: {names}{others}", counted(held_out.len(), "plateau")));
    }
    if outlying.is_empty() {
        screen.fact(
            "",
            &format!("none of the {} stands out", counted(fitted, if is_of_rests { "rest" } else { "plateau" })),
        );
    }
    for plateau in outlying {
        let [r_1, r_2, r_3] = plateau.standardised;
        let number = format!("{}:{}", plateau.mounting, plateau.index + 1);
        // A rest is a mounting of its own; a session alone can hold it out.
        let (name, command) = if is_of_rests {
            (format!("rest {}", plateau.mounting), "calibrate SESSION ")
        } else {
            (format!("plateau {number}"), "")
        };
        screen.fact(
            "",
            &format!(
                "{name} STANDS OUT, standardised residuals {r_1:.1}, {r_2:.1}, {r_3:.1}, chance {:.1e}; \
             {command}--hold-out {number} leaves it out",
                plateau.probability
            ),
        );
    }
}

/// What the residuals show of effects that the model leaves out, and how to put the first into the model.
fn rivals(screen: &mut Screen, validity: &ValiditySummary, rests_on: &[RestsOn]) {
    let (shown, tested) = (&validity.rivals, validity.rivals_tested);
    if shown.is_empty() && tested > 0 {
        screen.fact(
            "",
            &format!("none of {} that the model leaves out shows in the residuals", counted(tested, "effect")),
        );
    }
    for summary in shown.iter().filter(|summary| summary.explains_most) {
        let text = format!(
            "LEFT OUT  {} explains {:.1} of chi^2 by {}, chance {:.1e}",
            rival(summary, Language::English),
            summary.chi_squared,
            summary.degrees_of_freedom,
            summary.probability
        );
        screen.fact("", &text);
    }
    if let Some(first) = shown.first().and_then(RivalSummary::rival) {
        screen.fact("", &remedy(first, rests_on));
    }
}
