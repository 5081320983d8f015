//! Monte Carlo, choice of the model and comparison of calibrations, as text for the terminal.

use std::fmt::Write;

use centrical::Parameters;
use centrical::uncertainty::{Comparison, MonteCarlo, Selection};
use centrical_session::{CalibrationResult, MonteCarloCase};

use crate::assessment::short;
use crate::customary::customary;

/// For which unit the readings were drawn where that is not the one of the data, and what the runs show beside what was
/// stated; `coverage` is the probability that the intervals are to cover.
pub fn monte_carlo_text(case: &MonteCarloCase, monte_carlo: &MonteCarlo, coverage: f64) -> String {
    let parameters = case.model.parameters();
    let mut text = drawn_unit(parameters, &case.truth).to_owned();
    let _ = writeln!(text, "MONTE CARLO  {} calibrations, {} did not converge", monte_carlo.runs, monte_carlo.failures);
    let percent = 100.0 * coverage;
    let _ = writeln!(
        text,
        "  {:<12}{:<9}{:>10}{:>10}{:>8}{:>14}{:>12}",
        "", "unit", "stated u", "spread", "ratio", "bias, in u", "covered, %"
    );
    for (parameter, statistics) in parameters.iter().zip(&monte_carlo.parameters) {
        let (factor, unit) = customary(&parameter.unit, parameter.group);
        let _ = write!(text, "  {:<12}{unit:<9}", parameter.name);
        let Some(s) = statistics else {
            text.push_str("  not determined\n");
            continue;
        };
        let _ = writeln!(
            text,
            "{:>10}{:>10}{:>8.3}{:>14.3}{:>12.2}{}",
            short(s.stated * factor),
            short(s.standard_deviation * factor),
            s.standard_deviation / s.stated,
            s.bias / s.stated,
            100.0 * s.coverage,
            if s.is_affected_by_null_space { crate::plan::LEANING } else { "" }
        );
    }
    let chance = 2.0 * (percent * (100.0 - percent) / monte_carlo.runs.max(1) as f64).sqrt();
    let _ = writeln!(
        text,
        "  intervals are to cover {percent:.2} %, within {chance:.2} by chance (two standard deviations)"
    );
    for (name, square) in
        [("weighted squared error", &monte_carlo.weighted_square), ("chi^2 of the fit", &monte_carlo.chi_squared)]
    {
        let _ = writeln!(
            text,
            "  {name}: mean {:.2}, standard deviation {:.2}; expected {} and {:.2}; distance from the chi^2 \
             distribution {:.4}, {:.4} by chance once in twenty",
            square.mean,
            square.standard_deviation,
            square.degrees_of_freedom,
            (2.0 * square.degrees_of_freedom as f64).sqrt(),
            square.distance_from_chi_squared(),
            1.36 / (monte_carlo.runs.max(1) as f64).sqrt()
        );
    }
    text
}

fn drawn_unit(parameters: &Parameters, truth: &[f64]) -> &'static str {
    if truth.iter().all(|value| *value == 0.0) {
        "A unit without errors, as it is predicted; --typical draws for one of typical errors\n"
    } else if truth == parameters.typical_alternating() {
        "A unit of typical errors, signs in turn\n"
    } else {
        ""
    }
}

/// The rivals in one table, the recommendation and its reason, the terms one by one.
pub fn selection_table(selection: &Selection) -> String {
    let mut text = String::from("MODELS\n");
    let _ = writeln!(
        text,
        "  {:<32}{:>9} {:>11} {:>5} {:>11} {:>9}  F test against",
        "", "unknowns", "chi^2", "dof", "BIC", "hold-out"
    );
    for (n, rival) in selection.rivals.iter().enumerate() {
        let mark = if n == selection.recommended { "*" } else { " " };
        let determined = if rival.rank == rival.unknowns {
            rival.rank.to_string()
        } else {
            format!("{}/{}", rival.rank, rival.unknowns)
        };
        let _ = write!(
            text,
            "{mark} {:<32}{determined:>9} {:>11} {:>5} {:>11} {:>9}",
            rival.name,
            wide(rival.chi_squared),
            rival.degrees_of_freedom,
            wide(rival.bic),
            wide(rival.hold_out_score)
        );
        if let Some(test) = &rival.against {
            let name = &selection.rivals[test.nested].name;
            let _ = write!(text, "  {name}: {:.2} for {}, p = {}", test.f, test.further, probability(test.probability));
        }
        text.push_str(if rival.converged { "\n" } else { "  did not converge\n" });
    }
    text.push_str(&reason(selection));
    let of = |kept: bool| {
        let names: Vec<&str> = selection.terms.iter().filter(|t| t.kept == kept).map(|t| t.name.as_str()).collect();
        if names.is_empty() { "none".to_owned() } else { names.join(", ") }
    };
    let _ = writeln!(text, "  terms that the data show, one by one: {}", of(true));
    let _ = writeln!(text, "  terms that they do not show: {}", of(false));
    text
}

/// One digit; what is too small for a double by its bound.
fn probability(p: f64) -> String {
    if p > 0.0 { format!("{p:.1e}") } else { "less than 1e-300".to_owned() }
}

/// Two decimals where they fit, an exponent where not.
fn wide(value: f64) -> String {
    if value.abs() < 1e6 { format!("{value:.2}") } else { format!("{value:.2e}") }
}

/// Why the recommended one.
fn reason(selection: &Selection) -> String {
    let best = &selection.rivals[selection.recommended];
    let mut text = format!("  recommended: \"{}\", the lowest BIC", best.name);
    if let Some(test) = &best.against {
        let _ = write!(
            text,
            "; its {} further unknowns over \"{}\" would all be zero with a probability of {}",
            test.further,
            selection.rivals[test.nested].name,
            probability(test.probability)
        );
    }
    let others = selection.rivals.iter().enumerate().filter(|(n, _)| *n != selection.recommended).map(|(_, r)| r);
    if let Some(second) = others.min_by(|a, b| a.bic.total_cmp(&b.bic)) {
        let _ = write!(text, "; the next, \"{}\", is {:.1} behind", second.name, second.bic - best.bic);
    }
    let sound = selection.rivals.iter().filter(|rival| rival.converged);
    match sound.min_by(|a, b| a.hold_out_score.total_cmp(&b.hold_out_score)) {
        Some(first) if first.hold_out_score < best.hold_out_score => {
            let _ = writeln!(
                text,
                "; left-out mountings are predicted better by \"{}\", a score of {:.3} against {:.3}",
                first.name, first.hold_out_score, best.hold_out_score
            );
        }
        _ => text.push_str("; it predicts left-out mountings best as well\n"),
    }
    text
}

/// Two calibrations of one unit, the `first` and a second one; `years` lie between them, where known.
pub fn comparison_table(first: &CalibrationResult, comparison: &Comparison, years: Option<f64>) -> String {
    let years = years.filter(|years| *years != 0.0);
    let mut text =
        String::from("COMPARISON  second less first; E_n with expanded uncertainties, k = 2: beyond 1 they disagree\n");
    let drift = if years.is_some() { "per year" } else { "" };
    let _ = writeln!(text, "  {:<12}{:<9}{:>12}{:>10}{:>8}{drift:>12}", "", "unit", "difference", "u", "E_n");
    for d in &comparison.differences {
        let (factor, unit) = first.parameter(&d.name).map_or((1.0, ""), |p| customary(&p.unit, &p.group));
        let (difference, u) = (short(d.difference * factor), short(d.standard_uncertainty * factor));
        let drift = years.map_or(String::new(), |years| short(d.difference * factor / years));
        let mark = if d.e_n.abs() > 1.0 { "  DISAGREE" } else { "" };
        let _ = writeln!(text, "  {:<12}{unit:<9}{difference:>12}{u:>10}{:>8.2}{drift:>12}{mark}", d.name, d.e_n);
    }
    if let (Some(chi_squared), Some(probability)) = (comparison.chi_squared, comparison.probability) {
        let count = comparison.differences.len();
        let _ = writeln!(
            text,
            "  all {count} together: chi^2 = {chi_squared:.1} with {count} degrees of freedom, probability {probability:.1e} \
             if nothing has changed"
        );
    }
    text
}
