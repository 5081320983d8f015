//! A plan as text for the terminal: the schedule, why each plateau is there, what will be known, time against uncertainty.

use std::f64::consts::TAU;
use std::fmt::Write;

use centrical::STANDARD_GRAVITY;
use centrical_session::{FrontierRow, PlanReport, PlannedMounting, PlannedPlateau, PredictionReport, ReasonReport};

use crate::assessment::short;
use crate::customary::customary;
use crate::plot::{Axis, Plot, Point, Series};

/// The plan as text.
pub fn plan_text(report: &PlanReport) -> String {
    let mut text = String::new();
    heading(&mut text, report);
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
    frontier(&mut text, report);
    scenarios(&mut text, report);
    floors(&mut text, report);
    text
}

fn heading(text: &mut String, report: &PlanReport) {
    if !report.title.is_empty() {
        let _ = writeln!(text, "{}", report.title);
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
        "I" => "mean uncertainty of the compensated reading over the range (I)",
        "A" => "mean uncertainty of the instrument's parameters in typical magnitudes (A)",
        "D" => "geometric mean of the axes of the joint uncertainty in typical magnitudes (D)",
        _ => "worst uncertainty over its goal",
    }
}

fn value(report: &PlanReport, value: f64) -> String {
    match report.criterion {
        "I" => format!("{} ug", digits(value / STANDARD_GRAVITY * 1e6)),
        "worst" => format!("{value:.4}"),
        _ => format!("{value:.4e}"),
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

/// Said of a parameter in which lost combinations leave doubt that no number beside it holds.
pub(crate) const LEANING: &str = "  leans on what is lost";

/// What will be known: parameters, and the compensated reading.
pub fn prediction_text(prediction: &PredictionReport) -> String {
    let mut text = String::new();
    let _ = writeln!(
        text,
        "PREDICTION  by {}\n  {:<12}{:<9}{:>10}{:>10}{:>10}",
        prediction.sources.join(", "),
        "",
        "unit",
        "type A",
        "combined",
        "expanded"
    );
    for p in &prediction.parameters {
        let (factor, unit) = customary(&p.unit, p.group);
        let _ = write!(text, "  {:<12}{unit:<9}", p.name);
        let _ = match (p.type_a, p.combined, p.expanded) {
            (Some(a), Some(all), Some(expanded)) => {
                let note = if p.is_affected_by_null_space { LEANING } else { "" };
                let [a, all, expanded] = [a, all, expanded].map(|u| digits(u * factor));
                writeln!(text, "{a:>10}{all:>10}{expanded:>10}{note}")
            }
            _ => writeln!(text, "  not determined"),
        };
    }
    let _ = writeln!(text, "  expanded for {:.2} %", 100.0 * prediction.coverage);
    let ug = |u: f64| digits(u / STANDARD_GRAVITY * 1e6);
    let range = prediction.range / STANDARD_GRAVITY;
    match prediction.reading {
        Some([a, all]) => {
            let _ = writeln!(
                text,
                "  compensated reading, root mean square over all directions to {range:.0} g: type A {} ug, combined {} ug",
                ug(a),
                ug(all)
            );
        }
        None => text.push_str("  compensated reading: a coefficient is not determined\n"),
    }
    if !prediction.curves.is_empty() {
        let _ = writeln!(text, "  {:>16}{:>14}{:>14}{:>14}", "along, ug, at", "axis 1", "axis 2", "axis 3");
        for [force, u @ ..] in &prediction.curves {
            let [a, b, c] = u.map(ug);
            let _ = writeln!(text, "  {:>14.0} g{a:>14}{b:>14}{c:>14}", force / STANDARD_GRAVITY);
        }
    }
    text
}

fn frontier(text: &mut String, report: &PlanReport) {
    if report.frontier.is_empty() {
        return;
    }
    let unit = if report.criterion == "I" { ", ug" } else { "" };
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
        let shown = |value: Option<f64>| value.map_or("-".to_owned(), |v| digits(v * scale(report)));
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
}

/// From a value of the criterion to what is shown.
fn scale(report: &PlanReport) -> f64 {
    if report.criterion == "I" { 1e6 / STANDARD_GRAVITY } else { 1.0 }
}

/// What the plan reaches in each scenario, and how they count.
fn scenarios(text: &mut String, report: &PlanReport) {
    if report.by_scenario.is_empty() {
        return;
    }
    let (scale, unit) = if report.criterion == "I" { (1e6 / STANDARD_GRAVITY, " ug") } else { (1.0, "") };
    let values: Vec<String> = report.by_scenario.iter().map(|value| format!("{:.4}", scale * value)).collect();
    let _ = writeln!(
        text,
        "\nSCENARIOS  the expected one first, then those of [robust]; the {} counts\n  {}{unit}",
        report.against,
        values.join(", ")
    );
}

/// What the stated type B alone leaves of each goal.
fn floors(text: &mut String, report: &PlanReport) {
    let mut heading = "\nTYPE B  what is stated under [uncertainty] leaves this much, and no plan lowers it by much; noise and speeds have the rest\n";
    for goal in &report.goals {
        if let Some(floor) = goal.type_b.filter(|floor| *floor > 0.0) {
            let _ = writeln!(text, "{heading}  {}: {:.1} % of its goal", goal.name, 100.0 * floor / goal.wanted);
            heading = "";
        }
    }
}

/// Time against uncertainty as a plot.
pub fn frontier_plot(report: &PlanReport) -> String {
    let label = match report.criterion {
        "I" => "mean uncertainty of the compensated reading, ug",
        "worst" => "worst uncertainty over its goal",
        _ => "uncertainty in typical magnitudes",
    };
    let points = |value: &dyn Fn(&FrontierRow) -> Option<f64>| -> Vec<Point> {
        let point = |row: &FrontierRow| Some(Point::new(row.time / 3600.0, value(row)? * scale(report)));
        report.frontier.iter().filter_map(point).collect()
    };
    let plot = Plot::new("Time against uncertainty", Axis::linear("time on the centrifuge, h"), Axis::log(label))
        .with(Series::line_and_markers("best plan", points(&|row| Some(row.best))))
        .with(Series::line("bound", points(&|row| Some(row.bound))))
        .with(Series::line_and_markers("uniform plan", points(&|row| row.uniform)))
        .with(Series::line_and_markers("[K5.5]", points(&|row| row.normalised)));
    plot.to_svg()
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

/// Three significant digits, without an exponent where that is shorter.
fn digits(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || !(1e-3..1e5).contains(&size) {
        return if size == 0.0 { "0".to_owned() } else { format!("{value:.2e}") };
    }
    // As rounded to three digits.
    let exponent = format!("{size:.2e}").split_once('e').and_then(|(_, e)| e.parse::<i32>().ok()).unwrap_or(0);
    let places = usize::try_from(2 - exponent).unwrap_or(0);
    format!("{value:.places$}")
}
