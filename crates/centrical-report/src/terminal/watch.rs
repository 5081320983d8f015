//! A session on the way, as text for the terminal: what is known by now, what the next plateau will bring, and what an alarm says.

use std::path::Path;
use std::time::Duration;

use centrical::MeasurementModel;
use centrical::fit::filter::Lifetimes;
use centrical::uncertainty::Test;
use centrical_session::{GroupProgress, PlateauName, Session, WatchEvent, WatchProgress, WatchedPlateau, rpm};

use super::screen::Screen;
use super::table::{Align, Cell, Table};
use crate::number::{counted, two_digits};

/// Wanted standard uncertainties: group, and value in its customary unit.
type Targets = [(String, f64)];

/// The table: a line per group of unknowns with its largest standard uncertainty, beside the wanted one. Earlier alarms stand in
/// it with `all_alarms`, for a terminal that is cleared between two tables; elsewhere they stand in the table of their plateau.
pub fn watch_table(view: &WatchProgress, targets: &Targets, all_alarms: bool) -> Screen {
    let mut screen = Screen::default();
    let (arrived, all) = (view.plateaus.len(), view.session.experiment.set_points.len());
    let columns = view.model.parameters().len();
    screen.say(0, &view.session.title);
    screen.head(&format!("PLATEAU {arrived} of {all}"), &format!("RANK {} of {columns}", view.now.rank));
    for (n, plateau) in (1..).zip(view.plateaus) {
        if all_alarms && plateau.alarm || n == arrived {
            screen.say(0, &outcome(view.session, plateau));
        }
    }
    let groups = view.groups(targets);
    let label = |set_point: usize| label(view.session, set_point);
    let next = view.next.as_ref().map_or(String::new(), |(next, _)| format!("with {}", label(*next)));
    let columns: [(Align, &[&str]); 2] =
        [(Align::Left, &["group", "unit"]), (Align::Right, &["determined", "largest u", "target", &next])];
    let mut table = Table::new(2, &columns);
    for group in &groups {
        table.row(group_row(group).map(Cell::from));
    }
    screen.table(table);
    if !view.best.is_empty() {
        let shown: Vec<String> =
            view.best.iter().map(|&(set_point, factor)| format!("{} (x {factor:.3})", label(set_point))).collect();
        screen.head("BEST NEXT", &format!("for the compensated reading's mean uncertainty: {}", shown.join("; ")));
    }
    if !targets.is_empty() && groups.iter().all(|group| group.is_met != Some(false)) {
        screen.say(0, "Every target is met.");
    }
    screen
}

/// How many states a filter carries at a time for `order`, and what an order costs that does not keep positions together.
pub fn states_text(model: &MeasurementModel, order: &[usize]) -> Screen {
    let lifetimes = Lifetimes::new(model, order);
    let mut screen = Screen::default();
    let (states, unknowns) = (counted(lifetimes.states(), "state"), counted(lifetimes.unknowns(), "unknown"));
    screen.say(0, &format!("{states} of {unknowns} at a time"));
    if lifetimes.cost() > 0 {
        let waiting: Vec<&str> =
            lifetimes.waiting(model).iter().map(|&j| model.parameters()[j].name.as_str()).collect();
        let text = format!(
            "The order does not keep positions together, which costs {}; waiting at the fullest: {}",
            counted(lifetimes.cost(), "state"),
            waiting.join(", ")
        );
        screen.say(0, &text);
    }
    screen
}

/// What an alarm is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AlarmKind {
    /// A plateau that does not fit.
    Plateau,
    /// A record that is frozen.
    Frozen,
    /// A record that is wrong, or another error that ends the watch.
    Failed,
}

impl AlarmKind {
    /// Its name for programs.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plateau => "plateau",
            Self::Frozen => "frozen",
            Self::Failed => "failed",
        }
    }
}

/// The alarm of an event and what was found, if the event is one.
pub fn alarm_text(event: &WatchEvent) -> Option<(AlarmKind, String)> {
    match event {
        WatchEvent::Plateau(progress) => {
            let last = progress.plateaus.last().filter(|last| last.alarm)?;
            let PlateauName { mounting, plateau } = PlateauName::of(progress.session, last.set_point);
            let probability = last.innovation().probability;
            let found = format!("plateau {mounting}:{plateau} does not fit: a chance of {probability:.2e}");
            Some((AlarmKind::Plateau, found))
        }
        WatchEvent::Frozen { file, age } => Some((AlarmKind::Frozen, frozen_text(file, *age))),
        WatchEvent::Failed(error) => Some((AlarmKind::Failed, error.to_string())),
        WatchEvent::Begun(_) | WatchEvent::Followed(_) | WatchEvent::Waiting(_) => None,
    }
}

/// What is said of a frozen record.
pub fn frozen_text(file: &Path, age: Duration) -> String {
    format!("{}: found no new sample for {:.0} s, expected a record that grows", file.display(), age.as_secs_f64())
}

/// `4:3, 189.2 rpm`; `rest r7` in an attitude of its own.
fn label(session: &Session, set_point: usize) -> String {
    let PlateauName { mounting, plateau } = PlateauName::of(session, set_point);
    let set = &session.experiment.set_points[set_point];
    if let Some(rest) = session.rest_of(set.mounting) {
        format!("rest r{rest}")
    } else if set.is_rest() {
        format!("{mounting}:{plateau}, rest at {:.0} deg", set.angle.to_degrees())
    } else {
        format!("{mounting}:{plateau}, {:.1} rpm", rpm(set.omega))
    }
}

fn outcome(session: &Session, plateau: &WatchedPlateau) -> String {
    let WatchedPlateau { set_point, alarm, held_out, .. } = plateau;
    let Test { statistic, degrees_of_freedom, probability } = plateau.innovation();
    let plateau = label(session, *set_point);
    let tested = match degrees_of_freedom {
        0 => "nothing to test it by yet".to_owned(),
        _ => format!(
            "normalised innovation {statistic:.2} with {} of freedom, a chance of {probability:.2e}",
            counted(degrees_of_freedom, "degree")
        ),
    };
    let alarm = if *alarm { "; DOES NOT FIT" } else { "" };
    format!("{plateau}: {tested}{alarm}{}", if *held_out { ", held out" } else { "" })
}

fn group_row(row: &GroupProgress) -> [String; 6] {
    let met = row
        .target
        .map_or(String::new(), |target| format!("{target} {}", if row.is_met == Some(true) { "met" } else { "-" }));
    let shown = |u: Option<f64>| u.map_or("-".to_owned(), two_digits);
    let determined = format!("{} of {}", row.determined, row.unknowns);
    [row.group.name().to_owned(), row.unit.clone(), determined, shown(row.largest), met, shown(row.next)]
}
