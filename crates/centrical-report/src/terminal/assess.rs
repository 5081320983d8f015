//! How far a calibration can be trusted, as text for the terminal: budget, validity, prediction.

use centrical::uncertainty::{Budget, CurvePoint, Degrees, Level, Pattern, Validity};
use centrical::{Experiment, Fit, MeasurementModel, Parameter, Parameters, STANDARD_GRAVITY};
use centrical_session::{Assessment, MICRO_G, PatternSummary, customary, rpm};

use super::phrases::{legend, pattern_in_words};
use super::screen::Screen;
use super::table::{Align, Cell, Table};
use super::verdict::verdict_text;
use crate::number::{counted, two_digits, unsigned_zero};

/// The whole assessment, expanded uncertainties for a probability of `coverage`; the correlations if they are wanted.
pub fn assessment_text(assessment: &Assessment, coverage: f64, correlations: bool) -> Screen {
    let Assessment { model, fit, cleaned, budget, validity, patterns, prediction, result, .. } = assessment;
    let mut screen = Screen::default();
    if let Some((after, left_out)) = cleaned {
        outliers_text(&mut screen, model, [fit, after], left_out);
        screen.gap();
    }
    budget_table(&mut screen, model.parameters(), budget, coverage);
    screen.gap();
    if correlations {
        correlation_table(&mut screen, model.parameters(), budget);
        screen.gap();
    }
    validity_text(&mut screen, model.experiment(), validity, patterns);
    screen.gap();
    match prediction {
        Some(curves) => prediction_table(&mut screen, curves, result.calibrated_range()),
        None => screen.head("PREDICTION", "none: not all parameters of the instrument are determined"),
    }
    screen.gap();
    screen.add(verdict_text(result));
    screen
}

/// The budget: parameter by source, in customary units, with combined and expanded uncertainty for a probability of
/// `coverage`; then what to improve first.
fn budget_table(screen: &mut Screen, parameters: &Parameters, budget: &Budget, coverage: f64) {
    screen.head("UNCERTAINTY BUDGET", "standard uncertainty that each source leaves");
    let mut columns = vec![(String::new(), Align::Left), ("unit".to_owned(), Align::Left)];
    for (n, contribution) in budget.contributions().iter().enumerate() {
        screen.say(2, &format!("[{}] {}", n + 1, contribution.source.name()));
        columns.push((format!("[{}]", n + 1), Align::Right));
    }
    columns.extend(["combined", "dof", "k", "expanded"].map(|title| (title.to_owned(), Align::Right)));
    columns.push((String::new(), Align::Words));
    let mut table = Table::of(2, columns);
    for (j, parameter) in parameters.iter().enumerate() {
        table.row(budget_row(budget, j, parameter, coverage));
    }
    screen.table(table);
    screen.say(2, &format!("expanded = k x combined, for a probability of {:.2} %", 100.0 * coverage));
    screen.say(
        2,
        "dof: effective degrees of freedom by Welch-Satterthwaite, for each parameter by itself: contributions are \
         independent, so it is valid; there is none for several parameters jointly. \"inf\": the covariances of the \
         means and the stated uncertainties are taken as exact.",
    );
    legend(screen, parameters.iter().map(|p| (p.name.as_str(), p.group)));
    improvements(screen, parameters, budget);
}

/// What each source leaves of parameter `j`, and all together.
fn budget_row(budget: &Budget, j: usize, parameter: &Parameter, coverage: f64) -> Vec<Cell> {
    let (factor, unit) = customary(&parameter.unit, parameter.group);
    let mut cells: Vec<Cell> = vec![parameter.name.as_str().into(), unit.into()];
    let Some((combined, degrees)) = budget.standard_uncertainty(j).zip(budget.degrees_of_freedom(j)) else {
        cells.extend(std::iter::repeat_n(Cell::default(), budget.contributions().len() + 4));
        cells.push("not determined".into());
        return cells;
    };
    cells.extend(budget.contributions().iter().map(|c| two_digits(c.standard_uncertainty(j) * factor).into()));
    let k = degrees.coverage_factor(coverage);
    let dof = match degrees {
        Degrees::Infinite => "inf".to_owned(),
        Degrees::Finite(nu) => format!("{nu:.0}"),
    };
    let [combined, expanded] = [combined, k * combined].map(|u| two_digits(u * factor));
    cells.extend([combined, dof, format!("{k:.2}"), expanded].map(Cell::from));
    cells
}

fn improvements(screen: &mut Screen, parameters: &Parameters, budget: &Budget) {
    let instrument: Vec<usize> = (0..parameters.len()).filter(|&j| parameters[j].is_of_instrument()).collect();
    screen.gap();
    screen.head("WHAT TO IMPROVE FIRST", "for the parameters of the instrument; the most that each source could bring");
    for improvement in budget.improvements(&instrument).iter().filter(|i| i.share >= 0.01) {
        let text = format!(
            "{}: {:.0} % of the variance; without it uncertainties fall by {:.0} % on average, {} by {:.0} %",
            improvement.source.name(),
            100.0 * improvement.share,
            100.0 * (1.0 - improvement.mean_factor),
            parameters[improvement.most].name,
            100.0 * (1.0 - improvement.most_factor)
        );
        screen.say(2, &text);
    }
}

/// Correlations of the parameters of the instrument, the lower triangle with two decimals.
fn correlation_table(screen: &mut Screen, parameters: &Parameters, budget: &Budget) {
    let own: Vec<usize> = (0..parameters.len()).filter(|&j| parameters[j].is_of_instrument()).collect();
    screen.head("CORRELATION", "of the parameters of the instrument");
    let names = own.iter().map(|&j| (parameters[j].name.clone(), Align::Right));
    let mut table = Table::of(1, [(String::new(), Align::Left)].into_iter().chain(names).collect());
    for (n, &i) in own.iter().enumerate() {
        let cell = |&j: &usize| -> Cell {
            budget.correlation(i, j).map_or("-".to_owned(), |r| unsigned_zero(format!("{r:.2}"))).into()
        };
        table.row([parameters[i].name.as_str().into()].into_iter().chain(own[..=n].iter().map(cell)));
    }
    screen.table(table);
}

/// chi^2, plateaus that stand out, hold-out by mounting, and patterns in words.
fn validity_text(screen: &mut Screen, experiment: &Experiment, validity: &Validity, patterns: &[Pattern]) {
    screen.head("VALIDITY", "");
    let chance = validity.probability;
    screen.say(2, &format!("chi^2: a value as large or larger has a probability of {chance:.3}"));
    largest_residuals(screen, experiment, validity);
    screen.say(2, "each mounting predicted from all others:");
    let mut table = Table::new(1, &[(Align::Right, &["mounting", "chi^2", "dof", "probability"])]);
    for (mounting, p) in &validity.mountings {
        let numbers =
            [format!("{:.1}", p.statistic), p.degrees_of_freedom.to_string(), format!("{:.3}", p.probability)];
        table.row([(mounting + 1).to_string().into()].into_iter().chain(numbers.map(Cell::from)));
    }
    screen.table(table);
    let found: Vec<&Pattern> = patterns.iter().filter(|p| Level::Reported.is_passed_by(p.family_wise)).collect();
    if found.is_empty() {
        let count = counted(patterns.len(), "pattern");
        screen.say(2, &format!("residuals show none of {count} against speed, position, radius, time"));
    }
    for pattern in found {
        screen.say(2, &pattern_in_words(&PatternSummary::new(experiment, pattern)));
    }
}

/// The five plateaus whose residuals are the least probable.
fn largest_residuals(screen: &mut Screen, experiment: &Experiment, validity: &Validity) {
    screen.say(2, "largest standardised residuals, and their probability over all plateaus:");
    let numbers = ["f1", "f2", "f3", "leverage", "probability"];
    let mut table = Table::new(1, &[(Align::Left, &[""]), (Align::Right, &numbers), (Align::Words, &[""])]);
    let mut worst: Vec<_> = validity.plateaus.iter().collect();
    worst.sort_by(|a, b| a.test.probability.total_cmp(&b.test.probability));
    for check in worst.iter().take(5) {
        let family_wise = (check.test.probability * validity.plateaus.len() as f64).min(1.0);
        let r = check.standardised;
        let residuals = [r.x, r.y, r.z].map(|r| unsigned_zero(format!("{r:.2}")));
        let mark = if Level::Reported.is_passed_by(family_wise) { "OUTLYING" } else { "" };
        let others = [format!("{:.2}", check.leverage), format!("{family_wise:.3}"), mark.to_owned()];
        let cells = residuals.into_iter().chain(others).map(Cell::from);
        table.row([plateau(experiment, check.set_point).into()].into_iter().chain(cells));
    }
    screen.table(table);
}

/// Which plateaus were left out, and what changed between the fits before and after.
fn outliers_text(screen: &mut Screen, model: &MeasurementModel, [before, after]: [&Fit; 2], left_out: &[(usize, f64)]) {
    if left_out.is_empty() {
        return screen.head("OUTLIERS", "no plateau stands out");
    }
    screen.head("OUTLIERS", &format!("{} left out", counted(left_out.len(), "plateau")));
    for (set_point, probability) in left_out {
        screen.say(2, &format!("{}, probability {probability:.1e}", plateau(model.experiment(), *set_point)));
    }
    let text = format!(
        "chi^2 {:.1} with {} of freedom before, {:.1} with {} after",
        before.chi_squared,
        counted(before.degrees_of_freedom, "degree"),
        after.chi_squared,
        after.degrees_of_freedom
    );
    screen.say(2, &text);
    let moved = |j: usize| Some((after.value(j)? - before.value(j)?) / after.standard_uncertainty(j)?);
    let mut moves: Vec<(usize, f64)> = (0..model.parameters().len()).filter_map(|j| Some((j, moved(j)?))).collect();
    moves.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    screen.say(2, "estimates that moved most, in standard uncertainties:");
    let mut table = Table::new(1, &[(Align::Left, &[""]), (Align::Right, &[""])]);
    for (j, moved) in moves.iter().take(5) {
        table.row([model.parameters()[*j].name.clone(), unsigned_zero(format!("{moved:.2}"))].map(Cell::from));
    }
    screen.table(table);
}

/// `mounting 3, plateau 5, 378.4 rpm`.
fn plateau(experiment: &Experiment, index: usize) -> String {
    let set_point = &experiment.set_points[index];
    let before = experiment.set_points[..index].iter().filter(|s| s.mounting == set_point.mounting).count();
    let speed = rpm(set_point.omega);
    format!("mounting {}, plateau {}, {speed:.1} rpm", set_point.mounting + 1, before + 1)
}

/// Standard uncertainty of a compensated reading along each instrument axis, as a table; beyond what was `calibrated` [m/s^2] by the model alone.
fn prediction_table(screen: &mut Screen, curves: &[Vec<CurvePoint>; 3], calibrated: f64) {
    screen.head("PREDICTION", "standard uncertainty of a compensated reading, calibration alone, in ug");
    let titles = ["specific force", "along axis 1", "along axis 2", "along axis 3"];
    let mut table = Table::new(1, &[(Align::Right, &titles)]);
    for n in 0..curves[0].len() {
        let force = unsigned_zero(format!("{:.1} g", curves[0][n].force / STANDARD_GRAVITY));
        let along = |curve: &Vec<CurvePoint>| two_digits(curve.get(n).map_or(f64::NAN, |p| p.along) / MICRO_G).into();
        table.row([force.into()].into_iter().chain(curves.iter().map(along)));
    }
    screen.table(table);
    if curves[0].last().is_some_and(|point| point.force > 1.01 * calibrated) {
        let words = format!(
            "beyond {:.0} g, the largest reading of the session, the error model is extrapolated: terms that it leaves out count \
             as absent there",
            calibrated / STANDARD_GRAVITY
        );
        screen.sentence(2, 2, &words);
    }
}
