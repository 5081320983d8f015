//! How far a calibration can be trusted, as text for the terminal: budget, validity, prediction.

use std::fmt::Write;

use centrical::uncertainty::{Budget, CurvePoint, Degrees, Level, Pattern, Validity, coverage_factor};
use centrical::{Experiment, Fit, MeasurementModel, Parameters, STANDARD_GRAVITY};
use centrical_session::{Assessment, MICRO_G, PatternSummary, customary};

use super::pattern::pattern_in_words;
use crate::number::short;

/// The whole assessment, expanded uncertainties for a probability of `coverage`; the correlations if they are wanted.
pub fn assessment_text(assessment: &Assessment, coverage: f64, correlations: bool) -> String {
    let Assessment { model, fit, cleaned, budget, validity, patterns, prediction, .. } = assessment;
    let mut text =
        cleaned.as_ref().map_or(String::new(), |(after, left_out)| outliers_text(model, [fit, after], left_out));
    text.push_str(&budget_table(model.parameters(), budget, coverage));
    text.push('\n');
    if correlations {
        text.push_str(&correlation_table(model.parameters(), budget));
        text.push('\n');
    }
    text.push_str(&validity_text(model.experiment(), validity, patterns));
    text.push('\n');
    match prediction {
        Some(curves) => text.push_str(&prediction_table(curves)),
        None => text.push_str("PREDICTION  none: not all parameters of the instrument are determined\n"),
    }
    text
}

/// The budget: parameter by source, in customary units, with combined and expanded uncertainty for a probability of
/// `coverage`; then what to improve first.
fn budget_table(parameters: &Parameters, budget: &Budget, coverage: f64) -> String {
    let mut text = String::from("UNCERTAINTY BUDGET  standard uncertainty that each source leaves\n");
    let mut heading = format!("  {:<12}{:<9}", "", "unit");
    for (n, contribution) in budget.contributions().iter().enumerate() {
        let _ = writeln!(text, "  [{}] {}", n + 1, contribution.source.name());
        let _ = write!(heading, "{:>9}", format!("[{}]", n + 1));
    }
    let _ = writeln!(text, "{heading}{:>10}{:>8}{:>7}{:>10}", "combined", "dof", "k", "expanded");
    for (j, parameter) in parameters.iter().enumerate() {
        let (factor, unit) = customary(&parameter.unit, parameter.group);
        let _ = write!(text, "  {:<12}{unit:<9}", parameter.name);
        let known = budget.standard_uncertainty(j).zip(budget.degrees_of_freedom(j));
        let Some((combined, degrees)) = known else {
            text.push_str("  not determined\n");
            continue;
        };
        for contribution in budget.contributions() {
            let _ = write!(text, "{:>9}", short(contribution.standard_uncertainty(j) * factor));
        }
        let k = coverage_factor(coverage, degrees);
        let dof = match degrees {
            Degrees::Infinite => "inf".to_owned(),
            Degrees::Finite(nu) => format!("{nu:.0}"),
        };
        let (combined, expanded) = (short(combined * factor), short(k * combined * factor));
        let _ = writeln!(text, "{combined:>10}{dof:>8}{k:>7.2}{expanded:>10}");
    }
    let _ = writeln!(
        text,
        "  expanded for {:.2} %; effective degrees of freedom by Welch-Satterthwaite, for each parameter by itself:\n  \
         contributions are independent, so it is valid; there is none for several parameters jointly. \"inf\": the\n  \
         covariances of the means and the stated uncertainties are taken as exact.",
        100.0 * coverage
    );
    improvements(&mut text, parameters, budget);
    text
}

fn improvements(text: &mut String, parameters: &Parameters, budget: &Budget) {
    let instrument: Vec<usize> = (0..parameters.len()).filter(|&j| parameters[j].is_of_instrument()).collect();
    text.push_str(
        "\nWHAT TO IMPROVE FIRST  for the parameters of the instrument; the most that each source could bring\n",
    );
    for improvement in budget.improvements(&instrument).iter().filter(|i| i.share >= 0.01) {
        let _ = writeln!(
            text,
            "  {:<24}{:>3.0} % of the variance; without it uncertainties fall by {:.0} % on average, {} by {:.0} %",
            improvement.source.name(),
            100.0 * improvement.share,
            100.0 * (1.0 - improvement.mean_factor),
            parameters[improvement.most].name,
            100.0 * (1.0 - improvement.most_factor)
        );
    }
}

/// Correlations of the parameters of the instrument, the lower triangle with two decimals.
fn correlation_table(parameters: &Parameters, budget: &Budget) -> String {
    let own: Vec<usize> = (0..parameters.len()).filter(|&j| parameters[j].is_of_instrument()).collect();
    let mut text = String::from("CORRELATION  of the parameters of the instrument\n");
    for (n, &i) in own.iter().enumerate() {
        let _ = write!(text, "  {:<12}", parameters[i].name);
        for &j in &own[..=n] {
            let _ = match budget.correlation(i, j) {
                Some(r) => write!(text, "{r:>6.2}"),
                None => write!(text, "{:>6}", "-"),
            };
        }
        text.push('\n');
    }
    let _ = write!(text, "  {:<12}", "");
    for j in own {
        let _ = write!(text, "{:>6}", parameters[j].name);
    }
    text.push('\n');
    text
}

/// chi^2, plateaus that stand out, hold-out by mounting, and patterns in words.
fn validity_text(experiment: &Experiment, validity: &Validity, patterns: &[Pattern]) -> String {
    let mut text = String::from("VALIDITY\n");
    let _ = writeln!(text, "  chi^2: a value as large or larger has a probability of {:.3}", validity.probability);
    text.push_str("  largest standardised residuals:\n");
    let mut worst: Vec<_> = validity.plateaus.iter().collect();
    worst.sort_by(|a, b| a.prediction.probability.total_cmp(&b.prediction.probability));
    for check in worst.iter().take(5) {
        let r = check.standardised;
        let family_wise = (check.prediction.probability * validity.plateaus.len() as f64).min(1.0);
        let _ = writeln!(
            text,
            "    {:<34}{:>7.2}{:>7.2}{:>7.2}  leverage {:.2}, probability over all plateaus {family_wise:.3}{}",
            plateau(experiment, check.set_point),
            r.x,
            r.y,
            r.z,
            check.leverage,
            if Level::Reported.is_passed_by(family_wise) { "  OUTLYING" } else { "" }
        );
    }
    text.push_str("  each mounting predicted from all others (chi^2 / degrees of freedom, probability):\n");
    for check in &validity.mountings {
        let p = check.prediction;
        let _ = writeln!(
            text,
            "    mounting {:<4} {:>8.1} / {:<4} {:.3}",
            check.mounting + 1,
            p.statistic,
            p.degrees_of_freedom,
            p.probability
        );
    }
    let found: Vec<&Pattern> = patterns.iter().filter(|p| Level::Reported.is_passed_by(p.family_wise)).collect();
    if found.is_empty() {
        let _ = writeln!(
            text,
            "  residuals show none of {} patterns against speed, position, radius, time",
            patterns.len()
        );
    }
    for pattern in found {
        let _ = writeln!(text, "  {}", pattern_in_words(&PatternSummary::new(experiment, pattern)));
    }
    text
}

/// Which plateaus were left out, and what changed between the fits before and after.
fn outliers_text(model: &MeasurementModel, [before, after]: [&Fit; 2], left_out: &[(usize, f64)]) -> String {
    if left_out.is_empty() {
        return "OUTLIERS  no plateau stands out\n\n".to_owned();
    }
    let mut text = format!("OUTLIERS  {} plateaus left out\n", left_out.len());
    for (set_point, probability) in left_out {
        let _ = writeln!(text, "  {}, probability {probability:.1e}", plateau(model.experiment(), *set_point));
    }
    let _ = writeln!(
        text,
        "  chi^2 {:.1} with {} degrees of freedom before, {:.1} with {} after",
        before.chi_squared, before.degrees_of_freedom, after.chi_squared, after.degrees_of_freedom
    );
    let moved = |j: usize| Some((after.value(j)? - before.value(j)?) / after.standard_uncertainty(j)?);
    let mut moves: Vec<(usize, f64)> = (0..model.parameters().len()).filter_map(|j| Some((j, moved(j)?))).collect();
    moves.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    text.push_str("  estimates that moved most, in standard uncertainties:\n");
    for (j, moved) in moves.iter().take(5) {
        let _ = writeln!(text, "    {:<12}{moved:>8.2}", model.parameters()[*j].name);
    }
    text.push('\n');
    text
}

/// `mounting 3, plateau 5, 378.4 rpm`.
fn plateau(experiment: &Experiment, index: usize) -> String {
    let set_point = &experiment.set_points[index];
    let before = experiment.set_points[..index].iter().filter(|s| s.mounting == set_point.mounting).count();
    let speed = set_point.omega * 60.0 / std::f64::consts::TAU;
    format!("mounting {}, plateau {}, {speed:.1} rpm", set_point.mounting + 1, before + 1)
}

/// Standard uncertainty of a compensated reading along each instrument axis, as a table.
fn prediction_table(curves: &[Vec<CurvePoint>; 3]) -> String {
    let mut text = String::from(
        "PREDICTION  standard uncertainty of a compensated reading, calibration alone, in ug\n  specific force  along axis 1  along axis 2  along axis 3\n",
    );
    for n in 0..curves[0].len() {
        let _ = write!(text, "  {:>12.1} g", curves[0][n].force / STANDARD_GRAVITY);
        for curve in curves {
            let u = curve.get(n).map_or(f64::NAN, |p| p.along);
            let _ = write!(text, "{:>14}", short(u / MICRO_G));
        }
        text.push('\n');
    }
    text
}
