//! A plan as text for the terminal: time against uncertainty, the schedule, the reason for each plateau, the uncertainties to be
//! expected.

use centrical_session::{
    ChosenRests, CriterionName, GoalReport, MICRO_G, PlanReport, PlannedMounting, PlannedPlateau, ReasonReport,
    customary, rpm,
};

use super::prediction::prediction_text;
use super::screen::Screen;
use super::table::{Align, Cell, Table};
use crate::evaluation::criterion_unit;
use crate::number::{counted, digits, two_digits};

/// The plan as text.
pub fn plan_text(report: &PlanReport) -> Screen {
    let mut screen = Screen::default();
    heading(&mut screen, report);
    frontier(&mut screen, report);
    screen.gap();
    screen
        .head("SCHEDULE", "what is lost without a plateau: rise of the criterion, and the parameter that suffers most");
    for (number, mounting) in report.mountings.iter().enumerate() {
        one_mounting(&mut screen, number + 1, mounting);
    }
    if let Some(rests) = &report.rests {
        rests_beside(&mut screen, rests);
    }
    screen.say(2, "Another plateau lies between two visits of one: the speed is set anew, with an error of its own.");
    goals(&mut screen, report);
    screen.gap();
    screen.add(prediction_text(&report.prediction));
    scenarios(&mut screen, report);
    floors(&mut screen, report);
    screen
}

fn heading(screen: &mut Screen, report: &PlanReport) {
    if !report.title.is_empty() {
        screen.say(0, &report.title);
    }
    let visits: usize = report.mountings.iter().map(|m| m.plateaus.len()).sum();
    let mut visited = counted(visits, "plateau");
    if let Some(beside) = &report.rests {
        visited = format!("{visited} and {} beside the arm", counted(beside.rests.len(), "rest"));
    }
    let text = format!(
        "{} in {}, {} of {}",
        span(report.time),
        counted(report.mountings.len(), "mounting"),
        visited,
        counted(report.candidates, "candidate")
    );
    screen.head("PLAN", &text);
    let [measuring, ramps, set_ups] = report.time_by_use.map(span);
    screen.say(2, &format!("measuring {measuring}, ramps and turns {ramps}, set-ups {set_ups}"));
    screen.say(2, &format!("{}: {}", criterion(report), value(report, report.value)));
    if report.for_typical {
        screen.say(
            2,
            "for a unit with typical errors of alternating sign: a plan for one without errors misses goals with such errors",
        );
    }
    let percent = |part: f64| format!("{:.2} %", 100.0 * part);
    if let Some(least) = report.least_time {
        let text = format!(
            "no plan of these candidates keeps the goals in less than {}: at most {} shorter",
            span(least),
            percent(1.0 - least / report.time)
        );
        screen.say(2, &text);
    } else {
        let text = format!(
            "no plan of these candidates in this time is below {}: at most {} better ({} over mountings)",
            value(report, report.bound),
            percent(1.0 - report.bound / report.value),
            counted(report.nodes, "node")
        );
        screen.say(2, &text);
    }
    screen.say(2, &format!("continuous design on these mountings: {}, certified to {} by the equivalence theorem; whole visits cost {}",
        value(report, report.continuous),
        percent(report.continuous_gap),
        percent(report.value / report.continuous - 1.0)
    ));
}

fn criterion(report: &PlanReport) -> &'static str {
    match report.criterion {
        CriterionName::I => "mean uncertainty of the compensated reading over the range (I)",
        CriterionName::A => "mean uncertainty of the instrument's parameters in typical magnitudes (A)",
        CriterionName::D => "geometric mean of the axes of the joint uncertainty in typical magnitudes (D)",
        CriterionName::Worst => "worst uncertainty over its goal",
    }
}

fn value(report: &PlanReport, value: f64) -> String {
    match report.criterion {
        CriterionName::I => format!("{} ug", digits(value / MICRO_G)),
        CriterionName::Worst => format!("{value:.4}"),
        CriterionName::A | CriterionName::D => format!("{value:.4e}"),
    }
}

fn one_mounting(screen: &mut Screen, number: usize, mounting: &PlannedMounting) {
    let text = format!(
        "MOUNTING {number}  position {}, radius {} m, {}; without it {}",
        mounting.position,
        mounting.radius,
        span(mounting.time),
        lost(&mounting.reason)
    );
    screen.say(2, &text);
    let mut plateaus = mounting.plateaus.clone();
    plateaus.sort_by(|a, b| {
        let by_set_point = a.speed.total_cmp(&b.speed).then(a.angle.total_cmp(&b.angle));
        by_set_point.then(a.duration.total_cmp(&b.duration))
    });
    let mut table = Table::new(1, &[(Align::Left, &[""]), (Align::Right, &[""]), (Align::Words, &[""])]);
    for same in plateaus.chunk_by(|a, b| a == b) {
        let plateau = &same[0];
        let times = if same.len() > 1 { format!("{} x ", same.len()) } else { String::new() };
        let duration = format!("{times}{} s", digits(plateau.duration));
        table.row([format!("  {}", set(plateau)), duration, lost(&plateau.reason)].map(Cell::from));
    }
    screen.table(table);
}

/// The rests beside the arm: where up is in each.
fn rests_beside(screen: &mut Screen, beside: &ChosenRests) {
    let attitudes = match beside.attitude_uncertainty {
        Some(u) => format!("attitudes known to {} deg", two_digits(u.to_degrees())),
        None => "attitudes by gravity alone".to_owned(),
    };
    let (time, lost_all) = (span(beside.reason.time), lost(&beside.reason));
    screen.say(2, &format!("RESTS beside the arm, {attitudes}, {time}; without them {lost_all}"));
    let mut table = Table::new(1, &[(Align::Left, &[""]), (Align::Right, &[""]), (Align::Words, &[""])]);
    for rest in &beside.rests {
        let [x, y, z] = rest.up;
        let up = format!("  up ({x:.2}, {y:.2}, {z:.2})");
        table.row([up, format!("{} s", digits(rest.duration)), lost(&rest.reason)].map(Cell::from));
    }
    screen.table(table);
}

fn set(plateau: &PlannedPlateau) -> String {
    if plateau.speed == 0.0 {
        format!("rest at {:.0} deg", plateau.angle.to_degrees())
    } else {
        format!("{:.2} rpm", rpm(plateau.speed))
    }
}

/// A factor beyond this is a parameter that is not determined any more.
const LOST: f64 = 300.0;

fn lost(reason: &ReasonReport) -> String {
    let factor = match reason.factor {
        factor if factor > LOST => format!("{} is lost", reason.parameter),
        factor if factor >= 2.0 => format!("{} x {}", reason.parameter, two_digits(factor)),
        factor => format!("{} +{} %", reason.parameter, two_digits(100.0 * (factor - 1.0))),
    };
    match reason.rise {
        rise if rise >= 1.0 => format!("x {}, {factor}", two_digits(1.0 + rise)),
        rise => format!("+{} %, {factor}", two_digits(100.0 * rise)),
    }
}

fn goals(screen: &mut Screen, report: &PlanReport) {
    if report.goals.is_empty() {
        return;
    }
    screen.gap();
    let of = if report.for_typical { "of typical errors" } else { "without errors; with errors some are larger" };
    screen.head("GOALS", &format!("standard uncertainties to be expected of a unit {of}"));
    let numbers = ["wanted", "type A", "combined"];
    let mut table = Table::new(2, &[(Align::Left, &["", "unit"]), (Align::Right, &numbers), (Align::Words, &[""])]);
    for goal in &report.goals {
        let (factor, unit) = customary(&goal.unit, goal.group);
        let shown = |u: Option<f64>| u.map_or("lost".to_owned(), |u| two_digits(u * factor));
        let is_met = |u: Option<f64>| u.is_some_and(|u| u <= goal.wanted * (1.0 + 1e-6));
        let beyond =
            |u: Option<f64>| u.map_or(String::new(), |u| format!(" by {:.1} %", 100.0 * (u / goal.wanted - 1.0)));
        let verdict = match (is_met(goal.type_a), is_met(goal.combined)) {
            (true, true) => String::new(),
            (true, false) => format!("MISSED by type B,{}", beyond(goal.combined)),
            (false, _) => format!("MISSED{}", beyond(goal.combined)),
        };
        let (a, all) = (shown(goal.type_a), shown(goal.combined));
        let wanted = digits(goal.wanted * factor);
        table.row([goal.name.clone(), unit.to_owned(), wanted, a, all, verdict].map(Cell::from));
    }
    screen.table(table);
}

fn frontier(screen: &mut Screen, report: &PlanReport) {
    if report.frontier.is_empty() {
        return;
    }
    let (size, unit) = criterion_unit(report);
    let unit = unit.map_or(String::new(), |unit| format!(", {unit}"));
    screen.gap();
    screen.head("FRONTIER", &format!("{}{unit}", criterion(report)));
    let mut table = Table::new(1, &[(Align::Right, &["time", "best", "bound", "uniform", "[K5.5]"])]);
    for row in &report.frontier {
        let shown = |value: Option<f64>| value.map_or("-".to_owned(), |v| digits(v / size));
        let values = [Some(row.best), Some(row.bound), row.uniform, row.normalised];
        table.row([span(row.time).into()].into_iter().chain(values.map(|value| shown(value).into())));
    }
    screen.table(table);
    screen.say(2, "[K5.5] has speeds and a duration of its own, which need not be among the candidates.");
}

/// What the plan reaches in each scenario, and how they count.
fn scenarios(screen: &mut Screen, report: &PlanReport) {
    if report.by_scenario.is_empty() {
        return;
    }
    let (size, unit) = criterion_unit(report);
    let values: Vec<String> = report.by_scenario.iter().map(|value| format!("{:.4}", value / size)).collect();
    screen.gap();
    screen.head("SCENARIOS", &format!("the expected one first, then those of [robust]; the {} counts", report.against));
    let unit = unit.map_or(String::new(), |unit| format!(" {unit}"));
    screen.say(2, &format!("{}{unit}", values.join(", ")));
}

/// What the stated type B alone leaves of each goal.
fn floors(screen: &mut Screen, report: &PlanReport) {
    let of_goal = |goal: &GoalReport| {
        let type_b = goal.type_b.filter(|b| *b > 0.0)?;
        Some(format!("{}: {:.1} % of its goal", goal.name, 100.0 * type_b / goal.wanted))
    };
    let lines: Vec<String> = report.goals.iter().filter_map(of_goal).collect();
    if !lines.is_empty() {
        screen.gap();
        screen.head("TYPE B", "what is stated under [uncertainty] leaves this much, and no plan lowers it by much; noise and speeds have the rest");
        for line in &lines {
            screen.say(2, line);
        }
    }
}

/// `7 h 05 min`, `12 min`, `40 s`.
fn span(seconds: f64) -> String {
    let minutes = (seconds / 60.0).round();
    if seconds < 60.0 {
        format!("{seconds:.0} s")
    } else if minutes < 60.0 {
        format!("{minutes:.0} min")
    } else {
        format!("{:.0} h {:02.0} min", (minutes / 60.0).floor(), minutes % 60.0)
    }
}
