//! A result as a table for the terminal: what a person reads first.

use std::fmt::Write;

use centrical_session::{
    CalibrationResult, ParameterEstimate, ResultObjection, RivalSummary, TermSummary, ValiditySummary, customary,
    harmless_line,
};

use super::drift::drift;
use super::pattern::pattern_in_words;
use super::rests_on::rests_on_text;
use super::rivals::lines_of;
use crate::document::{objection, rival};
use crate::evaluation::{combination, monomial};
use crate::language::Language;
use crate::number::with_uncertainty;

/// Width of a column "value ± uncertainty".
const CELL: usize = 24;
/// Width of the two columns before them.
const LABEL: usize = 10;
const UNIT: usize = 10;

/// The result as text: parameters with standard uncertainties in customary units, the fit, what is not
/// estimable and why, what was rejected.
pub fn terminal_table(result: &CalibrationResult) -> String {
    let mut text = String::new();
    heading(&mut text, result);
    error_model(&mut text, result);
    mounting(&mut text, result);
    others(&mut text, result);
    not_estimable(&mut text, result);
    priors(&mut text, result);
    plateaus(&mut text, result);
    drift(&mut text, result);
    speeds(&mut text, result);
    fit(&mut text, result);
    uncertainties(&mut text, result);
    validity(&mut text, result);
    text.push_str(&rests_on_text(&result.rests_on));
    text
}

fn heading(text: &mut String, result: &CalibrationResult) {
    let session = &result.session;
    let serial = if session.unit_serial.is_empty() { "not given" } else { &session.unit_serial };
    let _ = writeln!(text, "{}, serial {}", harmless_line(&session.unit_model), harmless_line(serial));
    let _ = writeln!(text, "{}, {}", harmless_line(&session.title), harmless_line(&session.date));
    let combined = if result.stated_sources().is_empty() { "" } else { "combined " };
    let _ = writeln!(text, "value ± {combined}standard uncertainty; 1 g = 9.80665 m/s^2");
}

/// One row per monomial, one column per newtonometer.
fn error_model(text: &mut String, result: &CalibrationResult) {
    text.push_str("\nERROR MODEL  reading = f + sum of term x coefficient\n");
    row(text, "term", "unit", &["newtonometer 1", "newtonometer 2", "newtonometer 3"].map(str::to_owned));
    let mut rows: Vec<(String, &str)> = Vec::new();
    for term in &result.model.error_model {
        let key = row_of(result, term);
        if !rows.contains(&key) {
            rows.push(key);
        }
    }
    for key in rows {
        let mut unit = "";
        let mut cells: [String; 3] = Default::default();
        for term in result.model.error_model.iter().filter(|term| row_of(result, term) == key) {
            if let Some(parameter) = result.parameter(&term.name) {
                unit = customary(&parameter.unit, parameter.group).1;
                cells[term.axis - 1] = cell(parameter);
            }
        }
        row(text, &key.0, unit, &cells);
    }
}

/// Terms that share a row: the same monomial in the same customary unit.
fn row_of<'r>(result: &'r CalibrationResult, term: &TermSummary) -> (String, &'r str) {
    let unit = result.parameter(&term.name).map_or("", |p| customary(&p.unit, p.group).1);
    (monomial(term), unit)
}

/// Turns by position, shifts by pair, tilt and proof masses.
fn mounting(text: &mut String, result: &CalibrationResult) {
    text.push_str("\nMOUNTING\n");
    row(text, "", "unit", &["axis 1", "axis 2", "axis 3"].map(str::to_owned));
    let mut rows: Vec<(String, &str, [String; 3])> = Vec::new();
    for parameter in result.parameters.iter().filter(|p| p.group.is_of_mounting()) {
        let Some((label, axis)) = label_and_axis(&parameter.name) else { continue };
        let unit = customary(&parameter.unit, parameter.group).1;
        if rows.last().is_none_or(|(last, _, _)| *last != label) {
            rows.push((label, unit, Default::default()));
        }
        if let Some((_, _, cells)) = rows.last_mut() {
            cells[axis] = cell(parameter);
        }
    }
    for (label, unit, cells) in rows {
        row(text, &label, unit, &cells);
    }
}

/// `delta_2[4]` is axis 1 of the row `delta[4]`; `drho_33` axis 2 of `drho`.
fn label_and_axis(name: &str) -> Option<(String, usize)> {
    let (stem, rest) = name.split_once('_')?;
    let axis = rest.chars().next()?.to_digit(10)?;
    let index = rest.find('[').map_or("", |start| &rest[start..]);
    Some((format!("{stem}{index}"), usize::try_from(axis).ok()?.checked_sub(1).filter(|axis| *axis < 3)?))
}

/// What fits neither table: extensions of the model.
fn others(text: &mut String, result: &CalibrationResult) {
    let in_model = |p: &ParameterEstimate| result.model.error_model.iter().any(|term| term.name == p.name);
    let others: Vec<_> = result.parameters.iter().filter(|p| !p.group.is_of_mounting() && !in_model(p)).collect();
    if others.is_empty() {
        return;
    }
    text.push_str("\nEXTENSIONS\n");
    for parameter in others {
        let unit = customary(&parameter.unit, parameter.group).1;
        let _ = writeln!(text, "  {:<22}{:<18}{}", parameter.name, unit, cell(parameter).trim_start());
    }
}

fn cell(parameter: &ParameterEstimate) -> String {
    let factor = customary(&parameter.unit, parameter.group).0;
    match (parameter.value, parameter.standard_uncertainty) {
        (Some(value), Some(uncertainty)) => {
            let (value, uncertainty) = with_uncertainty(value * factor, uncertainty * factor);
            format!("{value:>11} ± {uncertainty:<8}")
        }
        _ => format!("{:>11}", "not seen"),
    }
}

fn row(text: &mut String, label: &str, unit: &str, cells: &[String; 3]) {
    let mut line = format!("  {label:<LABEL$}{unit:<UNIT$}");
    for cell in cells {
        let _ = write!(line, "{cell:<CELL$}");
    }
    text.push_str(line.trim_end());
    text.push('\n');
}

fn not_estimable(text: &mut String, result: &CalibrationResult) {
    let seen = &result.observability;
    if seen.null_directions.is_empty() {
        return;
    }
    let _ = writeln!(text, "\nNOT SEEN  rank {} of {}: the readings do not change along", seen.rank, seen.columns);
    for direction in &seen.null_directions {
        let _ = writeln!(text, "  {}", combination(direction));
    }
    let lost: Vec<&str> = result.parameters.iter().filter(|p| !p.estimable).map(|p| p.name.as_str()).collect();
    let _ = writeln!(text, "  so these have no value of their own: {}", lost.join(", "));
    let names = |p: &&ParameterEstimate| result.model.error_model.iter().any(|term| term.name == p.name);
    let (of_instrument, lost_of_it) =
        result.parameters.iter().filter(names).fold((0, 0), |(n, lost), p| (n + 1, lost + usize::from(!p.estimable)));
    if lost_of_it == 0 {
        let _ = writeln!(text, "  All {of_instrument} parameters of the instrument are determined.");
    } else {
        let _ =
            writeln!(text, "  {lost_of_it} of the {of_instrument} parameters of the instrument are not determined.");
    }
}

/// What rests on priors, and what the data added to each.
fn priors(text: &mut String, result: &CalibrationResult) {
    let given: Vec<_> = result.parameters.iter().filter_map(|p| Some((p, p.prior?))).collect();
    if given.is_empty() {
        return;
    }
    text.push_str("\nPRIORS  standard uncertainty after the data over that before\n");
    for (parameter, prior) in given {
        let _ = writeln!(text, "  {:<22}{:.3}", parameter.name, prior.posterior_over_prior);
    }
    let resting = result.parameters.iter().filter(|p| p.rests_on_prior);
    let resting: Vec<&str> = resting.map(|p| p.name.as_str()).collect();
    if !resting.is_empty() {
        let _ = writeln!(text, "  without the priors these would have no value: {}", resting.join(", "));
    }
}

fn plateaus(text: &mut String, result: &CalibrationResult) {
    let samples: u64 = result.plateaus.iter().map(|p| p.samples).sum();
    let rejected: u64 = result.plateaus.iter().map(|p| p.rejected).sum();
    let mountings = result.plateaus.iter().map(|p| p.mounting).max().unwrap_or(0);
    let _ = writeln!(
        text,
        "\nDATA  {} plateaus in {mountings} mountings, {samples} samples used, {rejected} rejected",
        result.plateaus.len()
    );
}

/// How the speeds are known, where they are measured or contradicted.
fn speeds(text: &mut String, result: &CalibrationResult) {
    let Some(speeds) = &result.speeds else { return };
    let words = &Language::English.messages().words;
    let measured = speeds.measured_by.as_ref().map(|_| (words.speeds_measured)(speeds));
    let found = speeds.findings.iter().map(words.speed_finding);
    for (n, line) in measured.into_iter().chain(found).enumerate() {
        let _ = writeln!(text, "{} {line}", if n == 0 { "SPEED" } else { "     " });
    }
}

fn fit(text: &mut String, result: &CalibrationResult) {
    let fit = &result.fit;
    let words = &Language::English.messages().words;
    let _ = write!(
        text,
        "FIT   {}, {} after {} iterations; ",
        (words.method)(fit.method),
        (words.termination)(fit.termination),
        fit.iterations
    );
    if fit.degrees_of_freedom == 0 {
        text.push_str("no redundancy, so nothing checks the stated uncertainties\n");
        return;
    }
    let dof = fit.degrees_of_freedom as f64;
    let spread = (2.0 / dof).sqrt();
    let _ = writeln!(
        text,
        "chi^2 per degree of freedom {:.3} (expected 1 ± {spread:.3}; {} degrees)",
        fit.chi_squared / dof,
        fit.degrees_of_freedom
    );
}

/// What the uncertainties hold, and what they take as exact.
fn uncertainties(text: &mut String, result: &CalibrationResult) {
    let Some(budget) = &result.budget else { return };
    let names: Vec<&str> = budget.sources.iter().map(|source| source.name.name()).collect();
    let _ = writeln!(text, "FROM  {}", names.join(", "));
    if result.stated_sources().is_empty() {
        text.push_str(
            "      the session states no [uncertainty]: gravity, radii, attitudes and the like count as exact\n",
        );
    }
}

/// What the residuals say of the model and of the weights.
fn validity(text: &mut String, result: &CalibrationResult) {
    let Some(validity) = result.validity.as_ref().filter(|_| result.fit.degrees_of_freedom > 0) else { return };
    let _ = writeln!(
        text,
        "VALID chi^2 as large or larger comes by chance with a probability of {:.3}",
        validity.probability
    );
    if result.chi_squared_is_small() {
        let _ = writeln!(text, "      {}", Language::English.messages().chi_squared_small);
    }
    let fitted = result.plateaus.iter().filter(|plateau| !plateau.held_out).count();
    if validity.outlying.is_empty() {
        let _ = writeln!(text, "      none of the {fitted} plateaus stands out");
    }
    for plateau in &validity.outlying {
        let [r_1, r_2, r_3] = plateau.standardised;
        let _ = writeln!(
            text,
            "      plateau {}:{} STANDS OUT, standardised residuals {r_1:.1}, {r_2:.1}, {r_3:.1}, chance {:.1e}; --hold-out \
             {0}:{1} leaves it out",
            plateau.mounting,
            plateau.index + 1,
            plateau.probability
        );
    }
    rivals(text, validity);
    if validity.patterns.is_empty() {
        let _ = writeln!(
            text,
            "      none of {} patterns against speed, position, radius and time in the residuals",
            validity.patterns_tested
        );
    }
    for pattern in &validity.patterns {
        let _ = writeln!(text, "      {}", pattern_in_words(pattern));
    }
    let worst = validity.mountings.iter().min_by(|a, b| a.probability.total_cmp(&b.probability));
    if let Some(worst) = worst {
        let family_wise = (validity.mountings.len() as f64 * worst.probability).min(1.0);
        let _ = writeln!(
            text,
            "      each mounting predicted from all others: the worst, {}, chi^2 {:.1} with {} degrees, chance {family_wise:.3}",
            worst.mounting, worst.chi_squared, worst.degrees_of_freedom
        );
    }
}

/// What the residuals show of effects that the model leaves out, and how to put the first into the model.
fn rivals(text: &mut String, validity: &ValiditySummary) {
    let (shown, tested) = (&validity.rivals, validity.rivals_tested);
    if shown.is_empty() && tested > 0 {
        let _ = writeln!(text, "      none of {tested} effects that the model leaves out shows in the residuals");
    }
    for summary in shown.iter().filter(|summary| summary.explains_most) {
        let _ = writeln!(
            text,
            "      LEFT OUT  {} explains {:.1} of chi^2 by {}, chance {:.1e}",
            rival(summary, Language::English),
            summary.chi_squared,
            summary.degrees_of_freedom,
            summary.probability
        );
    }
    if let Some(first) = shown.first().and_then(RivalSummary::rival) {
        let _ = writeln!(text, "      models fits it in full; to add it: {}", lines_of(&[first]).join("; "));
    }
}

/// The verdict in a line, or one for each objection.
pub fn verdict_text(objections: &[ResultObjection]) -> String {
    if objections.is_empty() {
        return "ACCEPTABLE  no check raised an objection\n".to_owned();
    }
    let said = |reason| objection(reason, Language::English);
    let lines: Vec<String> =
        objections.iter().map(|objection| format!("NOT ACCEPTABLE  {}\n", said(objection))).collect();
    lines.concat()
}
