//! A plan as text for the terminal: time against uncertainty, the schedule, the reason for each plateau, the uncertainties to be
//! expected.

use std::f64::consts::TAU;
use std::fmt::Write;

use centrical_session::harmless_line;
use centrical_session::{
    CriterionName, GoalReport, MICRO_G, PlanReport, PlannedMounting, PlannedPlateau, ReasonReport, customary,
};

use super::prediction::prediction_text;
use crate::evaluation::criterion_unit;
use crate::number::{digits, short};

/// The plan as text.
pub fn plan_text(report: &PlanReport) -> String {
    let mut text = String::new();
    heading(&mut text, report);
    frontier(&mut text, report);
    text.push_str(
        "\nSCHEDULE  what is lost without a plateau: rise of the criterion, and the parameter that suffers most\n",
    );
    for (number, mounting) in report.mountings.iter().enumerate() {
        one_mounting(&mut text, number + 1, mounting);
    }
    text.push_str(
        "  Visits of one plateau come in separate runs through the speeds: each has a speed error of its own.\n",
    );
    goals(&mut text, report);
    text.push('\n');
    text.push_str(&prediction_text(&report.prediction));
    scenarios(&mut text, report);
    floors(&mut text, report);
    text
}

fn heading(text: &mut String, report: &PlanReport) {
    if !report.title.is_empty() {
        let _ = writeln!(text, "{}", harmless_line(&report.title));
    }
    let visits: usize = report.mountings.iter().map(|m| m.plateaus.len()).sum();
    let [measuring, ramps, set_ups] = report.time_by_use;
    let _ = writeln!(
        text,
        "PLAN  {} in {} mountings, {visits} plateaus of {} candidates\n  measuring {}, ramps and turns {}, set-ups {}",
        span(report.time),
        report.mountings.len(),
        report.candidates,
        span(measuring),
        span(ramps),
        span(set_ups)
    );
    let _ = writeln!(text, "  {}: {}", criterion(report), value(report, report.value));
    if report.for_typical {
        text.push_str(
            "  for a unit of typical errors, signs in turn: a plan for one without errors misses goals with such errors\n",
        );
    }
    let percent = |part: f64| format!("{:.2} %", 100.0 * part);
    if let Some(least) = report.least_time {
        let _ = writeln!(
            text,
            "  no plan of these candidates keeps the goals in less than {}: at most {} shorter",
            span(least),
            percent(1.0 - least / report.time)
        );
    } else {
        let _ = writeln!(
            text,
            "  no plan of these candidates in this time is below {}: at most {} better ({} nodes over mountings)",
            value(report, report.bound),
            percent(1.0 - report.bound / report.value),
            report.nodes
        );
    }
    let _ = writeln!(
        text,
        "  continuous design on these mountings: {}, certified to {} by the equivalence theorem; whole visits cost {}",
        value(report, report.continuous),
        percent(report.continuous_gap),
        percent(report.value / report.continuous - 1.0)
    );
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

fn one_mounting(text: &mut String, number: usize, mounting: &PlannedMounting) {
    let _ = writeln!(
        text,
        "  MOUNTING {number}  position {}, radius {} m, {}; without it {}",
        mounting.position,
        mounting.radius,
        span(mounting.reason.time),
        lost(&mounting.reason)
    );
    let mut plateaus = mounting.plateaus.clone();
    plateaus.sort_by(|a, b| {
        let by_set_point = a.speed.total_cmp(&b.speed).then(a.angle.total_cmp(&b.angle));
        by_set_point.then(a.duration.total_cmp(&b.duration))
    });
    for same in plateaus.chunk_by(|a, b| a == b) {
        let plateau = &same[0];
        let times = if same.len() > 1 { format!("{} x ", same.len()) } else { String::new() };
        let duration = format!("{times}{} s", digits(plateau.duration));
        let _ = writeln!(text, "    {:<18}{duration:>12}   {}", set(plateau), lost(&plateau.reason));
    }
}

fn set(plateau: &PlannedPlateau) -> String {
    if plateau.speed == 0.0 {
        format!("rest at {:.0} deg", plateau.angle.to_degrees())
    } else {
        format!("{:.2} rpm", plateau.speed * 60.0 / TAU)
    }
}

/// A factor beyond this is a parameter that is not determined any more.
const LOST: f64 = 300.0;

fn lost(reason: &ReasonReport) -> String {
    let factor = match reason.factor {
        factor if factor > LOST => format!("{} is lost", reason.parameter),
        factor if factor >= 2.0 => format!("{} x {}", reason.parameter, short(factor)),
        factor => format!("{} +{} %", reason.parameter, short(100.0 * (factor - 1.0))),
    };
    match reason.rise {
        rise if rise >= 1.0 => format!("x {}, {factor}", short(1.0 + rise)),
        rise => format!("+{} %, {factor}", short(100.0 * rise)),
    }
}

fn goals(text: &mut String, report: &PlanReport) {
    if report.goals.is_empty() {
        return;
    }
    let _ = writeln!(text, "\nGOALS\n  {:<12}{:<9}{:>10}{:>12}{:>12}", "", "unit", "wanted", "type A", "combined");
    for goal in &report.goals {
        let (factor, unit) = customary(&goal.unit, goal.group);
        let shown = |u: Option<f64>| u.map_or("lost".to_owned(), |u| digits(u * factor));
        let is_met = |u: Option<f64>| u.is_some_and(|u| u <= goal.wanted * (1.0 + 1e-6));
        let verdict = match (is_met(goal.type_a), is_met(goal.combined)) {
            (true, true) => "",
            (true, false) => "  MISSED by type B",
            (false, _) => "  MISSED",
        };
        let (a, all) = (shown(goal.type_a), shown(goal.combined));
        let _ =
            writeln!(text, "  {:<12}{unit:<9}{:>10}{a:>12}{all:>12}{verdict}", goal.name, digits(goal.wanted * factor));
    }
}

fn frontier(text: &mut String, report: &PlanReport) {
    if report.frontier.is_empty() {
        return;
    }
    let (size, unit) = criterion_unit(report);
    let unit = unit.map_or(String::new(), |unit| format!(", {unit}"));
    let _ = writeln!(
        text,
        "\nFRONTIER  {}{unit}\n  {:>10}{:>12}{:>12}{:>12}{:>12}",
        criterion(report),
        "time",
        "best",
        "bound",
        "uniform",
        "[K5.5]"
    );
    for row in &report.frontier {
        let shown = |value: Option<f64>| value.map_or("-".to_owned(), |v| digits(v / size));
        let _ = writeln!(
            text,
            "  {:>10}{:>12}{:>12}{:>12}{:>12}",
            span(row.time),
            shown(Some(row.best)),
            shown(Some(row.bound)),
            shown(row.uniform),
            shown(row.normalised)
        );
    }
    text.push_str("  [K5.5] has speeds and a duration of its own, which need not be among the candidates.\n");
}

/// What the plan reaches in each scenario, and how they count.
fn scenarios(text: &mut String, report: &PlanReport) {
    if report.by_scenario.is_empty() {
        return;
    }
    let (size, unit) = criterion_unit(report);
    let values: Vec<String> = report.by_scenario.iter().map(|value| format!("{:.4}", value / size)).collect();
    let _ = writeln!(
        text,
        "\nSCENARIOS  the expected one first, then those of [robust]; the {} counts\n  {}{}",
        report.against,
        values.join(", "),
        unit.map_or(String::new(), |unit| format!(" {unit}"))
    );
}

/// What the stated type B alone leaves of each goal.
fn floors(text: &mut String, report: &PlanReport) {
    let of_goal = |goal: &GoalReport| {
        let type_b = goal.type_b.filter(|b| *b > 0.0)?;
        Some(format!("  {}: {:.1} % of its goal\n", goal.name, 100.0 * type_b / goal.wanted))
    };
    let lines: String = report.goals.iter().filter_map(of_goal).collect();
    if !lines.is_empty() {
        text.push_str(
            "\nTYPE B  what is stated under [uncertainty] leaves this much, and no plan lowers it by much; noise and speeds have the rest\n",
        );
        text.push_str(&lines);
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
