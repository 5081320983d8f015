//! Observability of an experiment, as text for the terminal.

use centrical::Group;
use centrical_session::{ConditionReport, ObservabilityReport, ObservedParameter, RemedyReport, customary};

use super::phrases::{extent, rests_name};
use super::prediction::prediction_text;
use super::rests_on::priors as prior_table;
use super::screen::Screen;
use crate::number::{counted, two_digits};

/// Remedies beyond these only raise the rank, and the list is long enough.
const MOST_REMEDIES: usize = 8;

/// The report as text: rank, undetermined combinations and reasons, remedies, correlated groups, the source's
/// conditions, expected uncertainties.
pub fn observation_text(report: &ObservabilityReport) -> Screen {
    let mut screen = Screen::default();
    heading(&mut screen, report);
    lost(&mut screen, report);
    remedies(&mut screen, report);
    combinations(&mut screen, report);
    groups(&mut screen, report);
    conditions(&mut screen, report);
    priors(&mut screen, report);
    uncertainties(&mut screen, report);
    screen.gap();
    screen.add(prediction_text(&report.prediction));
    screen
}

fn heading(screen: &mut Screen, report: &ObservabilityReport) {
    if !report.title.is_empty() {
        screen.say(0, &report.title);
    }
    let text = format!(
        "{}, pair relation {:?}, weighted by {}",
        counted(report.plateaus, "plateau"),
        report.pair_relation,
        report.weighted_by
    );
    screen.say(0, &text);
    screen.gap();
    let text = format!(
        "{} of {} (singular values below {:.0e} of the largest count as zero)",
        report.rank, report.columns, report.tolerance
    );
    screen.head("RANK", &text);
    if let Some(condition) = report.condition_number {
        screen.say(2, &format!("condition number of what is seen: {condition:.3e}"));
    }
    if report.doubtful {
        screen.say(
            2,
            "WARNING: a singular value lies within two decades of the tolerance: the rank is a matter of rounding",
        );
    }
    let of_instrument = || report.parameters.iter().filter(|p| p.of_instrument);
    let (count, seen) = (of_instrument().count(), of_instrument().filter(|p| p.estimable).count());
    screen.say(2, &format!("{seen} of the {count} parameters of the instrument are determined"));
}

fn lost(screen: &mut Screen, report: &ObservabilityReport) {
    if report.lost.is_empty() {
        return;
    }
    screen.gap();
    screen.head("LOST", "no reading changes along");
    for lost in &report.lost {
        screen.sentence(2, 4, &format!("- {}", lost.reason));
    }
}

fn remedies(screen: &mut Screen, report: &ObservabilityReport) {
    if report.lost.is_empty() {
        return;
    }
    if report.remedies.is_empty() {
        screen.gap();
        screen.head("REMEDIES", "none of the additions that were tried brings anything back");
        return;
    }
    let (restoring, raising): (Vec<_>, Vec<_>) = report.remedies.iter().partition(|remedy| remedy.restores_rank);
    if !restoring.is_empty() {
        screen.gap();
        screen.head("REMEDIES", "that restore the rank, cheapest first");
        for remedy in restoring {
            one_remedy(screen, remedy);
        }
    }
    if !raising.is_empty() {
        screen.gap();
        screen.head("REMEDIES", "that bring back a part, cheapest first");
        for remedy in raising.iter().take(MOST_REMEDIES) {
            one_remedy(screen, remedy);
        }
        if raising.len() > MOST_REMEDIES {
            screen.say(2, &format!("and {} more", raising.len() - MOST_REMEDIES));
        }
    }
}

fn one_remedy(screen: &mut Screen, remedy: &RemedyReport) {
    let steps: Vec<String> = remedy.steps.iter().map(|step| format!("{} (+{})", step.text, step.gain)).collect();
    let condition = remedy.condition_number.map_or(String::new(), |c| format!("; condition number then {c:.1e}"));
    screen.sentence(2, 4, &format!("- {}{condition}", steps.join(", then ")));
}

fn combinations(screen: &mut Screen, report: &ObservabilityReport) {
    if report.combinations.is_empty() {
        return;
    }
    screen.gap();
    screen.head("COMBINATIONS", "asked for");
    for combination in &report.combinations {
        let outcome = match combination.standard_uncertainty {
            Some(uncertainty) => format!("determined, standard uncertainty {uncertainty:.2e} (SI)"),
            None => "not determined".to_owned(),
        };
        screen.say(2, &format!("{}: {outcome}", combination.text));
    }
}

fn groups(screen: &mut Screen, report: &ObservabilityReport) {
    if report.correlated_groups.is_empty() {
        return;
    }
    screen.gap();
    screen.head("NEARLY COLLINEAR", "each is a combination of the others to 0.99 or more");
    for group in &report.correlated_groups {
        let weakest = group.multiple_correlations.iter().copied().fold(1.0, f64::min);
        let strongest = group.multiple_correlations.iter().copied().fold(0.0, f64::max);
        screen.sentence(
            2,
            4,
            &format!("- {} (multiple correlations {weakest:.5} to {strongest:.5})", group.parameters.join(", ")),
        );
    }
}

fn conditions(screen: &mut Screen, report: &ObservabilityReport) {
    if report.conditions.is_empty() {
        return;
    }
    screen.gap();
    screen.head("THE SOURCE'S SUFFICIENT CONDITIONS", "");
    for condition in &report.conditions {
        screen.say(2, &format!("[{}] {}", if condition.is_met { 'x' } else { ' ' }, condition.requirement));
        screen.say(6, &format!("{}; {}", condition.found, need(condition)));
    }
}

fn need(condition: &ConditionReport) -> String {
    let count = condition.combinations;
    let more = counted(count, "more combination");
    let combinations = counted(count, "combination");
    match (condition.is_met, condition.is_needed) {
        (true, true) => format!("needed here: without it {more} would be lost"),
        (true, false) => "not needed here: without it no more would be lost".to_owned(),
        (false, true) => format!("needed here: it would bring back {combinations}"),
        (false, false) => "not needed here".to_owned(),
    }
}

fn priors(screen: &mut Screen, report: &ObservabilityReport) {
    let ratio = |p: &ObservedParameter| Some(p.prior?.posterior_over_prior);
    prior_table(screen, report.parameters.iter().filter_map(|p| Some((p.name.as_str(), p.group, ratio(p)?))));
    let resting = report.parameters.iter().filter(|p| p.rests_on_prior && p.group != Group::Attitude);
    let resting: Vec<&str> = resting.map(|p| p.name.as_str()).collect();
    if !resting.is_empty() {
        screen.sentence(2, 2, &format!("without the priors these would be lost: {}", resting.join(", ")));
    }
}

/// Parameters of one group and unit on a line.
fn uncertainties(screen: &mut Screen, report: &ObservabilityReport) {
    screen.gap();
    screen.head("STANDARD UNCERTAINTIES", "to be expected of a unit without errors");
    let mut rest: &[ObservedParameter] = &report.parameters;
    while let Some(first) = rest.first() {
        let same = rest.iter().take_while(|p| p.group == first.group && p.unit == first.unit).count();
        let (line, others) = rest.split_at(same);
        let (factor, unit) = customary(&first.unit, first.group);
        rest = others;
        if first.group == Group::Attitude {
            let all = extent(line.iter().map(|p| p.standard_uncertainty.map(|u| u * factor)));
            screen.sentence(2, 11, &format!("{unit:\u{a0}<9}{} {all}", rests_name(line.len())));
            continue;
        }
        let shown: Vec<String> = line
            .iter()
            .map(|p| {
                let value = p.standard_uncertainty.map_or("lost".to_owned(), |u| two_digits(u * factor));
                format!("{} {value}", p.name)
            })
            .collect();
        screen.sentence(2, 11, &format!("{unit:\u{a0}<9}{}", shown.join(", ")));
    }
}
