//! A session on the way, as a table for the terminal: what is known by now, and what the next plateau will bring.

use std::f64::consts::PI;
use std::fmt::Write;

use centrical::fit::Progress;
use centrical::fit::filter::Lifetimes;
use centrical::{Group, MeasurementModel, Parameter};
use centrical_session::{
    InnovationSummary, PlateauName, Session, WatchProgress, WatchedPlateau, customary, harmless_line,
};

/// Wanted standard uncertainties: group, and value in its customary unit.
type Targets = [(String, f64)];

/// The table: a line per group of unknowns with its largest standard uncertainty, beside the wanted one. Earlier alarms stand in
/// it with `all_alarms`, for a terminal that is cleared between two tables; elsewhere they stand in the table of their plateau.
pub fn watch_table(view: &WatchProgress, targets: &Targets, all_alarms: bool) -> String {
    let mut text = String::new();
    let (arrived, all) = (view.plateaus.len(), view.session.experiment.set_points.len());
    let columns = view.model.parameters().len();
    let _ = writeln!(
        text,
        "{}\nPLATEAU {arrived} of {all}   RANK {} of {columns}",
        harmless_line(&view.session.title),
        view.now.rank
    );
    for (n, plateau) in (1..).zip(view.plateaus) {
        if all_alarms && plateau.alarm || n == arrived {
            outcome(&mut text, view.session, plateau);
        }
    }
    let label = |set_point: usize| label(view.session, set_point);
    let heading = view.next.as_ref().map_or(String::new(), |(next, _)| format!("with {}", label(*next)));
    row(&mut text, ["group", "unit", "determined", "largest u", "target", &heading]);
    let groups = groups(view.model);
    for &group in &groups {
        group_row(&mut text, view, group, targets);
    }
    if !view.best.is_empty() {
        let shown: Vec<String> =
            view.best.iter().map(|gain| format!("{} (x {:.3})", label(gain.set_point), gain.factor)).collect();
        let _ = writeln!(text, "BEST NEXT for the compensated reading's mean uncertainty: {}", shown.join("; "));
    }
    let is_kept = |(name, target): &(String, f64)| {
        groups.iter().any(|group| group.name() == name && is_met(view, *group, *target))
    };
    if !targets.is_empty() && targets.iter().all(is_kept) {
        text.push_str("Every target is met.\n");
    }
    text
}

/// How many states a filter carries at a time for `order`, and what an order costs that does not keep positions together.
pub fn states_text(model: &MeasurementModel, order: &[usize]) -> String {
    let lifetimes = Lifetimes::new(model, order);
    let mut text = format!("{} states of {} unknowns at a time\n", lifetimes.states(), lifetimes.unknowns());
    if lifetimes.cost() > 0 {
        let waiting: Vec<&str> =
            lifetimes.waiting(model).iter().map(|&j| model.parameters()[j].name.as_str()).collect();
        let _ = writeln!(
            text,
            "The order does not keep positions together, which costs {} states; waiting at the fullest: {}",
            lifetimes.cost(),
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

/// `4:3, 189.2 rpm`.
fn label(session: &Session, set_point: usize) -> String {
    let PlateauName { mounting, plateau } = PlateauName::of(session, set_point);
    let set = &session.experiment.set_points[set_point];
    if set.is_rest() {
        format!("{mounting}:{plateau}, rest at {:.0} deg", set.angle.to_degrees())
    } else {
        format!("{mounting}:{plateau}, {:.1} rpm", set.omega * 30.0 / PI)
    }
}

fn outcome(text: &mut String, session: &Session, plateau: &WatchedPlateau) {
    let WatchedPlateau { set_point, innovation, alarm, held_out, .. } = plateau;
    let plateau = label(session, *set_point);
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

fn group_row(text: &mut String, view: &WatchProgress, group: Group, targets: &Targets) {
    let of_group: Vec<&Parameter> = view.model.parameters().iter().filter(|p| p.group == group).collect();
    let unit = of_group.first().map_or("", |p| customary(&p.unit, group).1);
    let (determined, now) = largest(view.model, &view.now, group);
    let next = view.next.as_ref().and_then(|(_, next)| largest(view.model, next, group).1);
    let target = targets.iter().find(|(name, _)| name == group.name());
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
fn is_met(view: &WatchProgress, group: Group, target: f64) -> bool {
    let (determined, largest) = largest(view.model, &view.now, group);
    let all = view.model.parameters().iter().filter(|p| p.group == group).count();
    determined == all && largest.is_some_and(|u| u <= target)
}

fn row(text: &mut String, cells: [&str; 6]) {
    let [group, unit, determined, now, target, next] = cells;
    let line = format!("  {group:<15}{unit:<8}{determined:>10}  {now:>11}  {target:>12}  {next}");
    text.push_str(line.trim_end());
    text.push('\n');
}
