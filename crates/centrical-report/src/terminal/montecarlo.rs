//! Monte Carlo runs as text for the terminal.

use centrical::Parameters;
use centrical::uncertainty::{MonteCarlo, ParameterStatistics, WeightedSquare};
use centrical_session::{MonteCarloCase, customary};

use super::phrases::{legend, short_list};
use super::prediction::LEANING;
use super::screen::{Emphasis, Screen};
use super::table::{Align, Cell, Table};
use crate::number::{counted, two_digits, unsigned_zero};

/// For which unit the readings were drawn where that is not the one of the data, and what the runs show beside what was
/// stated; `coverage` is the probability that the intervals are to cover.
pub fn monte_carlo_text(case: &MonteCarloCase, monte_carlo: &MonteCarlo, coverage: f64) -> Screen {
    let parameters = case.model.parameters();
    let mut screen = verdict(parameters, monte_carlo, coverage);
    if let Some(unit) = drawn_unit(parameters, &case.truth) {
        screen.say(0, unit);
    }
    let runs = counted(monte_carlo.runs, "calibration");
    screen.head("MONTE CARLO", &format!("{runs}, {} did not converge", monte_carlo.failures));
    screen.say(2, &format!("drawn with {}", case.weighted_by));
    statistics(&mut screen, parameters, monte_carlo);
    let (percent, chance) = (100.0 * coverage, chance_of_coverage(coverage, monte_carlo));
    screen.say(
        2,
        &format!("intervals are to cover {percent:.2} %, within {chance:.2} by chance (two standard deviations)"),
    );
    for (name, square) in
        [("weighted squared error", &monte_carlo.weighted_square), ("chi^2 of the fit", &monte_carlo.chi_squared)]
    {
        let text = format!(
            "{name}: mean {:.2}, standard deviation {:.2}; expected {} and {:.2}; distance from the chi^2 \
             distribution {:.4}, {:.4} by chance once in twenty",
            square.mean,
            square.standard_deviation,
            square.degrees_of_freedom,
            expected_deviation(square),
            square.distance_from_chi_squared(),
            chance_distance(monte_carlo)
        );
        screen.say(2, &text);
    }
    screen
}

/// Why the stated uncertainties do not hold: empty where they do.
fn verdict(parameters: &Parameters, monte_carlo: &MonteCarlo, coverage: f64) -> Screen {
    /// Parameters that are named.
    const NAMED: usize = 9;
    let mut screen = Screen::default();
    if monte_carlo.is_acceptable(coverage) {
        return screen;
    }
    let ratio = |j: usize| monte_carlo.parameters[j].as_ref().map_or(1.0, ParameterStatistics::ratio);
    let mut understated = monte_carlo.understated();
    understated.sort_by(|&a, &b| ratio(b).total_cmp(&ratio(a)));
    let names: Vec<String> = understated.iter().map(|&j| parameters[j].name.clone()).collect();
    let words = match understated.first() {
        Some(&worst) => format!(
            "uncertainties are stated too small, at worst by a factor of {:.2}: {}",
            ratio(worst),
            short_list(&names, NAMED, ", ")
        ),
        None => format!("{} did not converge", counted(monte_carlo.failures, "calibration")),
    };
    screen.marked(Emphasis::NotAcceptable, "NOT ACCEPTABLE", &words);
    screen.close(Emphasis::NotAcceptable, "NOT ACCEPTABLE", "for the reason in the first lines");
    screen.gap();
    screen
}

/// A row for each parameter: stated uncertainty, spread, bias, coverage.
fn statistics(screen: &mut Screen, parameters: &Parameters, monte_carlo: &MonteCarlo) {
    let numbers = ["stated u", "spread", "ratio", "bias, in u", "covered, %"];
    let mut table = Table::new(2, &[(Align::Left, &["", "unit"]), (Align::Right, &numbers), (Align::Words, &[""])]);
    for (parameter, statistics) in parameters.iter().zip(&monte_carlo.parameters) {
        let (factor, unit) = customary(&parameter.unit, parameter.group);
        let names: [Cell; 2] = [parameter.name.as_str().into(), unit.into()];
        let cells: [Cell; 6] = match statistics {
            Some(s) => [
                two_digits(s.stated * factor).into(),
                two_digits(s.standard_deviation * factor).into(),
                format!("{:.3}", s.standard_deviation / s.stated).into(),
                unsigned_zero(format!("{:.3}", s.bias / s.stated)).into(),
                format!("{:.2}", 100.0 * s.coverage).into(),
                if s.is_affected_by_null_space { LEANING.into() } else { Cell::default() },
            ],
            None => ["-", "-", "", "", "", "not determined"].map(Cell::from),
        };
        table.row(names.into_iter().chain(cells));
    }
    screen.table(table);
    legend(screen, parameters.iter().map(|p| (p.name.as_str(), p.group)));
}

fn drawn_unit(parameters: &Parameters, truth: &[f64]) -> Option<&'static str> {
    if truth.iter().all(|value| *value == 0.0) {
        Some("A unit without errors, as it is predicted; --typical draws for one with typical errors")
    } else {
        (truth == parameters.typical_alternating()).then_some("A unit with typical errors of alternating sign")
    }
}

/// Two standard deviations of the part of the runs, in percent, whose intervals cover the truth, if each does with the probability
/// `coverage`.
fn chance_of_coverage(coverage: f64, of: &MonteCarlo) -> f64 {
    let percent = 100.0 * coverage;
    2.0 * (percent * (100.0 - percent) / runs(of)).sqrt()
}

/// Standard deviation of a quadratic form that has its chi^2 distribution.
fn expected_deviation(square: &WeightedSquare) -> f64 {
    (2.0 * square.degrees_of_freedom as f64).sqrt()
}

/// Distance from the distribution that as many runs pass by chance once in twenty (Kolmogorov).
fn chance_distance(of: &MonteCarlo) -> f64 {
    1.36 / runs(of).sqrt()
}

fn runs(of: &MonteCarlo) -> f64 {
    of.runs.max(1) as f64
}
