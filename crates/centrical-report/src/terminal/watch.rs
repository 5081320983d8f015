//! A session on the way, as a table for the terminal: what is known by now, and what the next plateau will bring.

use std::fmt::Write;

use centrical::fit::recursive::{Lives, Progress};
use centrical::{Group, MeasurementModel, Parameter};
use centrical_session::{InnovationSummary, customary};

/// What is shown after a plateau.
#[derive(Debug)]
pub struct WatchView<'a> {
    /// Title of the session.
    pub title: &'a str,
    /// The unknowns.
    pub model: &'a MeasurementModel,
    /// Plateaus measured, and those of the whole schedule.
    pub plateaus: (usize, usize),
    /// The last one, and those that do not fit.
    pub tests: &'a [WatchedTest],
    /// What is known.
    pub now: &'a Progress,
    /// The next plateau, and what will be known after it.
    pub next: Option<(String, &'a Progress)>,
    /// What each plateau that remains would bring, the best first: its name, and the mean uncertainty of the compensated
    /// reading with it over that without.
    pub best: Vec<(String, f64)>,
    /// Wanted standard uncertainties: group, and value in its customary unit.
    pub targets: &'a [(String, f64)],
}

/// The test of a plateau.
#[derive(Debug, Clone, PartialEq)]
pub struct WatchedTest {
    /// The plateau: "4:3, 189.2 rpm".
    pub plateau: String,
    /// Its outcome.
    pub innovation: InnovationSummary,
    /// Whether the plateau does not fit.
    pub alarm: bool,
    /// Whether it was held out.
    pub held_out: bool,
}

/// The table: a line per group of unknowns with its largest standard uncertainty.
pub fn watch_table(view: &WatchView) -> String {
    let mut text = String::new();
    let (come, all) = view.plateaus;
    let columns = view.model.parameters().len();
    let _ = writeln!(text, "{}\nPLATEAU {come} of {all}   RANK {} of {columns}", view.title, view.now.rank);
    for test in view.tests.iter().take(view.tests.len().saturating_sub(1)).filter(|test| test.alarm) {
        outcome(&mut text, test);
    }
    view.tests.last().iter().for_each(|test| outcome(&mut text, test));
    let heading = view.next.as_ref().map_or(String::new(), |(plateau, _)| format!("with {plateau}"));
    row(&mut text, ["group", "unit", "determined", "largest u", "target", &heading]);
    let groups = groups(view.model);
    for group in &groups {
        group_row(&mut text, view, *group);
    }
    if !view.best.is_empty() {
        let shown: Vec<String> = view.best.iter().map(|(name, factor)| format!("{name} (x {factor:.3})")).collect();
        let _ = writeln!(text, "BEST NEXT for the compensated reading's mean uncertainty: {}", shown.join("; "));
    }
    let is_kept = |(name, target): &(String, f64)| {
        groups.iter().any(|group| group.name() == name && is_met(view, *group, *target))
    };
    if !view.targets.is_empty() && view.targets.iter().all(is_kept) {
        text.push_str("Every target is met.\n");
    }
    text
}

/// How many states a filter carries at a time for `order`, and what an order costs that does not keep positions together.
pub fn states_text(model: &MeasurementModel, order: &[usize]) -> String {
    let lives = Lives::new(model, order);
    let mut text = format!("{} states of {} unknowns at a time\n", lives.states(), lives.unknowns());
    if lives.cost() > 0 {
        let waiting: Vec<&str> = lives.waiting(model).iter().map(|&j| model.parameters()[j].name.as_str()).collect();
        let _ = writeln!(
            text,
            "The order does not keep positions together, which costs {} states; waiting at the fullest: {}",
            lives.cost(),
            waiting.join(", ")
        );
    }
    text
}

/// The groups of the unknowns in the order of results.
fn groups(model: &MeasurementModel) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for parameter in model.parameters() {
        if !groups.contains(&parameter.group) {
            groups.push(parameter.group);
        }
    }
    groups
}

fn outcome(text: &mut String, test: &WatchedTest) {
    let WatchedTest { plateau, innovation, alarm, held_out } = test;
    let InnovationSummary { squared, degrees_of_freedom, probability } = innovation;
    let _ = match degrees_of_freedom {
        0 => write!(text, "{plateau}: nothing to test it by yet"),
        _ => write!(
            text,
            "{plateau}: normalised innovation {squared:.2} with {degrees_of_freedom} degrees of freedom, \
             a chance of {probability:.2e}"
        ),
    };
    text.push_str(if *alarm { "; DOES NOT FIT" } else { "" });
    text.push_str(if *held_out { ", held out\n" } else { "\n" });
}

fn group_row(text: &mut String, view: &WatchView, group: Group) {
    let of_group: Vec<&Parameter> = view.model.parameters().iter().filter(|p| p.group == group).collect();
    let unit = of_group.first().map_or("", |p| customary(&p.unit, group).1);
    let (determined, now) = largest(view.model, view.now, group);
    let next = view.next.as_ref().and_then(|(_, next)| largest(view.model, next, group).1);
    let target = view.targets.iter().find(|(name, _)| name == group.name());
    let met = target.map_or(String::new(), |(_, target)| {
        format!("{target} {}", if is_met(view, group, *target) { "met" } else { "-" })
    });
    let shown = |u: Option<f64>| u.map_or("-".to_owned(), |u| format!("{u:.3e}"));
    let determined = format!("{determined} of {}", of_group.len());
    row(text, [group.name(), unit, &determined, &shown(now), &met, &shown(next)]);
}

/// How many of a group are determined, and the largest standard uncertainty of those in the customary unit.
fn largest(model: &MeasurementModel, progress: &Progress, group: Group) -> (usize, Option<f64>) {
    let of_group = model.parameters().iter().zip(&progress.estimates).filter(|(p, _)| p.group == group);
    let uncertainties = of_group.filter_map(|(p, known)| Some(customary(&p.unit, group).0 * (*known)?.1));
    uncertainties.fold((0, None), |(count, most), u| (count + 1, Some(u.max(most.unwrap_or(0.0)))))
}

/// Whether all of a group are determined, and to its target.
fn is_met(view: &WatchView, group: Group, target: f64) -> bool {
    let (determined, largest) = largest(view.model, view.now, group);
    let all = view.model.parameters().iter().filter(|p| p.group == group).count();
    determined == all && largest.is_some_and(|u| u <= target)
}

fn row(text: &mut String, cells: [&str; 6]) {
    let [group, unit, determined, now, target, next] = cells;
    let line = format!("  {group:<15}{unit:<8}{determined:>10}  {now:>11}  {target:>12}  {next}");
    text.push_str(line.trim_end());
    text.push('\n');
}
