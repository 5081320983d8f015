//! What an experiment can see, as text for the terminal.

use std::fmt::Write;

use centrical_session::{
    ConditionReport, ObservabilityReport, ObservedParameter, RemedyReport, customary, harmless_line,
};

use super::prediction::prediction_text;
use crate::number::trimmed;

/// Remedies beyond these only raise the rank, and the list is long enough.
const MOST_REMEDIES: usize = 8;

/// The report as text: rank, what is lost and why, remedies, what is hardly told apart, the source's conditions, the
/// uncertainties to be expected.
pub fn observation_text(report: &ObservabilityReport) -> String {
    let mut text = String::new();
    heading(&mut text, report);
    lost(&mut text, report);
    remedies(&mut text, report);
    combinations(&mut text, report);
    groups(&mut text, report);
    conditions(&mut text, report);
    priors(&mut text, report);
    uncertainties(&mut text, report);
    text.push('\n');
    text.push_str(&prediction_text(&report.prediction));
    text
}

fn heading(text: &mut String, report: &ObservabilityReport) {
    if !report.title.is_empty() {
        let _ = writeln!(text, "{}", harmless_line(&report.title));
    }
    let _ = writeln!(
        text,
        "{} plateaus, pair relation {:?}, weighted by {}",
        report.plateaus, report.pair_relation, report.weighted_by
    );
    let _ = writeln!(
        text,
        "\nRANK  {} of {} (singular values below {:.0e} of the largest count as zero)",
        report.rank, report.columns, report.tolerance
    );
    if let Some(condition) = report.condition_number {
        let _ = writeln!(text, "  condition number of what is seen: {condition:.3e}");
    }
    if report.doubtful {
        text.push_str(
            "  WARNING: a singular value lies within two decades of the tolerance: the rank is a matter of rounding\n",
        );
    }
    let of_instrument = || report.parameters.iter().filter(|p| p.of_instrument);
    let (count, seen) = (of_instrument().count(), of_instrument().filter(|p| p.estimable).count());
    let _ = writeln!(text, "  {seen} of the {count} parameters of the instrument are determined");
}

fn lost(text: &mut String, report: &ObservabilityReport) {
    if report.lost.is_empty() {
        return;
    }
    text.push_str("\nLOST  no reading changes along\n");
    for lost in &report.lost {
        paragraph(text, "  - ", "    ", &lost.reason);
    }
}

fn remedies(text: &mut String, report: &ObservabilityReport) {
    if report.lost.is_empty() {
        return;
    }
    if report.remedies.is_empty() {
        text.push_str("\nREMEDIES  none of the additions that were tried brings anything back\n");
        return;
    }
    let (restoring, raising): (Vec<_>, Vec<_>) = report.remedies.iter().partition(|remedy| remedy.restores_rank);
    if !restoring.is_empty() {
        text.push_str("\nREMEDIES that restore the rank, cheapest first\n");
        for remedy in restoring {
            one_remedy(text, remedy);
        }
    }
    if !raising.is_empty() {
        text.push_str("\nREMEDIES that bring back a part, cheapest first\n");
        for remedy in raising.iter().take(MOST_REMEDIES) {
            one_remedy(text, remedy);
        }
        if raising.len() > MOST_REMEDIES {
            let _ = writeln!(text, "  and {} more", raising.len() - MOST_REMEDIES);
        }
    }
}

fn one_remedy(text: &mut String, remedy: &RemedyReport) {
    let steps: Vec<String> = remedy.steps.iter().map(|step| format!("{} (+{})", step.text, step.gain)).collect();
    let condition = remedy.condition_number.map_or(String::new(), |c| format!("; condition number then {c:.1e}"));
    paragraph(text, "  - ", "    ", &format!("{}{condition}", steps.join(", then ")));
}

fn combinations(text: &mut String, report: &ObservabilityReport) {
    if report.combinations.is_empty() {
        return;
    }
    text.push_str("\nCOMBINATIONS asked for\n");
    for combination in &report.combinations {
        let outcome = match combination.standard_uncertainty {
            Some(uncertainty) => format!("determined, standard uncertainty {uncertainty:.2e} (SI)"),
            None => "not determined".to_owned(),
        };
        let _ = writeln!(text, "  {}: {outcome}", combination.text);
    }
}

fn groups(text: &mut String, report: &ObservabilityReport) {
    if report.correlated_groups.is_empty() {
        return;
    }
    text.push_str("\nHARDLY TOLD APART  each is a combination of the others to 0.99 or more\n");
    for group in &report.correlated_groups {
        let weakest = group.multiple_correlations.iter().copied().fold(1.0, f64::min);
        let strongest = group.multiple_correlations.iter().copied().fold(0.0, f64::max);
        paragraph(
            text,
            "  - ",
            "    ",
            &format!("{} (multiple correlations {weakest:.5} to {strongest:.5})", group.parameters.join(", ")),
        );
    }
}

fn conditions(text: &mut String, report: &ObservabilityReport) {
    text.push_str("\nTHE SOURCE'S SUFFICIENT CONDITIONS\n");
    for condition in &report.conditions {
        let _ = writeln!(text, "  [{}] {}", if condition.is_met { 'x' } else { ' ' }, condition.requirement);
        let _ = writeln!(text, "      {}; {}", condition.found, need(condition));
    }
}

fn need(condition: &ConditionReport) -> String {
    let count = condition.combinations;
    let plural = if count == 1 { "" } else { "s" };
    match (condition.is_met, condition.is_needed) {
        (true, true) => format!("needed here: without it {count} more combination{plural} would be lost"),
        (true, false) => "not needed here: without it no more would be lost".to_owned(),
        (false, true) => format!("needed here: it would bring back {count} combination{plural}"),
        (false, false) => "not needed here".to_owned(),
    }
}

fn priors(text: &mut String, report: &ObservabilityReport) {
    let given: Vec<_> = report.parameters.iter().filter_map(|p| Some((p, p.prior?))).collect();
    if given.is_empty() {
        return;
    }
    text.push_str("\nPRIORS  standard uncertainty after the data over that before\n");
    for (parameter, prior) in given {
        let _ = writeln!(text, "  {:<22}{:.3}", parameter.name, prior.posterior_over_prior);
    }
    let resting: Vec<&str> = report.parameters.iter().filter(|p| p.rests_on_prior).map(|p| p.name.as_str()).collect();
    if !resting.is_empty() {
        paragraph(text, "  ", "  ", &format!("without the priors these would be lost: {}", resting.join(", ")));
    }
}

/// Parameters of one group and unit on a line.
fn uncertainties(text: &mut String, report: &ObservabilityReport) {
    text.push_str("\nSTANDARD UNCERTAINTIES to be expected of a unit without errors\n");
    let mut rest: &[ObservedParameter] = &report.parameters;
    while let Some(first) = rest.first() {
        let same = rest.iter().take_while(|p| p.group == first.group && p.unit == first.unit).count();
        let (line, others) = rest.split_at(same);
        let (factor, unit) = customary(&first.unit, first.group);
        let shown: Vec<String> = line
            .iter()
            .map(|p| {
                let value = p.standard_uncertainty.map_or("lost".to_owned(), |u| trimmed(u * factor));
                format!("{} {value}", p.name)
            })
            .collect();
        paragraph(text, &format!("  {unit:<9}"), "           ", &shown.join(", "));
        rest = others;
    }
}

/// Words in lines of a width that every terminal has.
fn paragraph(text: &mut String, first: &str, further: &str, words: &str) {
    const WIDTH: usize = 100;
    let mut line = first.to_owned();
    let mut is_empty = true;
    for word in words.split(' ') {
        if !is_empty && line.chars().count() + 1 + word.chars().count() > WIDTH {
            text.push_str(&line);
            text.push('\n');
            further.clone_into(&mut line);
            is_empty = true;
        }
        if !is_empty {
            line.push(' ');
        }
        line.push_str(word);
        is_empty = false;
    }
    text.push_str(&line);
    text.push('\n');
}
