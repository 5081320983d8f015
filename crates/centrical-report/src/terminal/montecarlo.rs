//! Monte Carlo runs as text for the terminal.

use std::fmt::Write;

use centrical::Parameters;
use centrical::uncertainty::MonteCarlo;

use super::prediction::LEANING;
use centrical_session::{MonteCarloCase, customary};

use crate::number::short;

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
            if s.is_affected_by_null_space { LEANING } else { "" }
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
