//! What in a `result.json` contradicts itself: a file that was edited by hand or put together.

use std::collections::HashSet;

use centrical::{ErrorModel, Term};
use centrical_table::LARGEST_NUMBER;

use super::schema::{CalibrationResult, ConvergenceSummary, ObservabilitySummary, ParameterEstimate};
use crate::experiment::RAW_OUTPUT;
use crate::quantity::Quantity;
use crate::store::{ROUNDING, of_terms};
use crate::units::Dimension;

/// Relative difference of uncertainties that are computed in two ways, where sums over plateaus round.
const BUDGET_ROUNDING: f64 = 1e-3;

/// What was found, and what was expected.
type Contradiction = (String, String);

/// The first contradiction.
pub(super) fn contradiction(result: &CalibrationResult) -> Option<Contradiction> {
    let n = result.parameters.len();
    of_gravity(result)
        .or_else(|| of_output(result))
        .or_else(|| of_parameters(result))
        .or_else(|| of_error_model(result))
        .or_else(|| of_observability(&result.observability, n))
        .or_else(|| of_convergence(result.convergence.as_ref()?, n))
        .or_else(|| of_plateaus(result))
        .or_else(|| of_records(result))
        .or_else(|| of_covariance(result))
        .or_else(|| of_budget(result))
        .or_else(|| of_checks(result))
}

/// No chi^2 and no uncertainty is negative, and probabilities lie between 0 and 1.
fn of_checks(result: &CalibrationResult) -> Option<Contradiction> {
    let mut probabilities = Vec::new();
    let mut at_least_zero = vec![("fit.chi_squared", result.fit.chi_squared)];
    if let Some(drift) = &result.drift {
        at_least_zero.push(("drift.chi_squared", drift.chi_squared));
        probabilities.push(("drift.probability", drift.probability));
        probabilities.extend(drift.over_session.iter().map(|trend| ("drift.over_session", trend.probability)));
    }
    if let Some(tilt) = &result.tilt {
        at_least_zero.push(("tilt.chi_squared", tilt.chi_squared));
        at_least_zero.push(("tilt.at_rest_uncertainty", tilt.at_rest_uncertainty));
        at_least_zero.push(("tilt.spinning_uncertainty", tilt.spinning_uncertainty));
        probabilities.push(("tilt.probability", tilt.probability));
    }
    if let Some(validity) = &result.validity {
        let of_outliers = validity.outlying.iter().map(|plateau| ("validity.outlying", plateau.probability));
        let of_mountings = validity.mountings.iter().map(|mounting| ("validity.mountings", mounting.probability));
        probabilities.push(("validity", validity.probability));
        probabilities.extend(of_outliers.chain(of_mountings));
    }
    let negative = at_least_zero.into_iter().find(|(_, number)| *number < 0.0);
    let negative = negative.map(|(name, number)| (format!("{name} = {number}"), "zero or more".to_owned()));
    let impossible = || probabilities.into_iter().find(|(_, number)| !(0.0..=1.0).contains(number));
    negative.or_else(|| {
        let (name, number) = impossible()?;
        Some((format!("a probability of {number} in {name}"), "0 to 1".to_owned()))
    })
}

/// Forces in g, and what gravity shows, are those of a place on Earth.
fn of_gravity(result: &CalibrationResult) -> Option<Contradiction> {
    let not = Quantity::Number(result.model.gravity).gravity().err()?;
    Some((format!("model.gravity = {}", not.found), not.expected))
}

/// The output has a unit that sessions know, and a scale: a unit of acceleration its own.
fn of_output(result: &CalibrationResult) -> Option<Contradiction> {
    let output = result.output.as_ref()?;
    if !output.is_raw() {
        let Some(factor) = Dimension::Acceleration.factor(&output.unit) else {
            let known = RAW_OUTPUT.map(|(_, unit, _)| unit);
            let expected = format!("one of {}, {}", known.join(", "), Dimension::Acceleration.unit_list());
            return Some((format!("output in {:?}", output.unit), expected));
        };
        let is_its_own = |scale: &f64| (scale * factor - 1.0).abs() < ROUNDING;
        if !output.scale.iter().all(is_its_own) || output.bias != [0.0; 3] {
            let found =
                format!("output.scale = {:?} and output.bias = {:?} in {}", output.scale, output.bias, output.unit);
            return Some((found, format!("{:e} per m/s^2 and no bias", 1.0 / factor)));
        }
    }
    let is_scale = |scale: &f64| scale.is_normal();
    (!output.scale.iter().all(is_scale))
        .then(|| (format!("output.scale = {:?}", output.scale), "numbers other than zero".to_owned()))
}

/// Each parameter stands once, and has both numbers or none; those of a parameter that the data determine.
fn of_parameters(result: &CalibrationResult) -> Option<Contradiction> {
    let mut names = HashSet::new();
    if let Some(twice) = result.parameters.iter().find(|parameter| !names.insert(&parameter.name)) {
        return Some((format!("the parameter {:?} twice", twice.name), "each once".to_owned()));
    }
    let half = |p: &&ParameterEstimate| p.value.is_some() != p.standard_uncertainty.is_some();
    if let Some(half) = result.parameters.iter().find(half) {
        let found = format!("{} with one of value and standard_uncertainty", half.name);
        return Some((found, "both or neither".to_owned()));
    }
    let other = result.parameters.iter().find(|p| p.value.is_some() && !p.estimable)?;
    Some((format!("{} with a value and estimable: false", other.name), "one of them".to_owned()))
}

/// The terms of the error model act as their names say, each once, and their coefficients are the parameters of the unit, in their units.
fn of_error_model(result: &CalibrationResult) -> Option<Contradiction> {
    let terms = &result.model.error_model;
    if let Some((_, found, expected)) = of_terms(terms, |name| result.parameter(name).is_some()) {
        return Some((format!("{found} in error_model"), expected));
    }
    for term in terms {
        let (parameter, monomial) = (result.parameter(&term.name)?, term.monomial().ok()?);
        let unit = Term::new(term.axis - 1, monomial).unit();
        if parameter.unit != unit {
            return Some((
                format!("{} in {:?}", parameter.name, parameter.unit),
                format!("{unit:?}, the unit of its term"),
            ));
        }
    }
    let missing = result.parameters.iter().find(|p| ErrorModel::has_name(&p.name) && !result.is_coefficient(p))?;
    Some((format!("the parameter {:?} without its term in error_model", missing.name), "one".to_owned()))
}

/// Rank and null directions make up the number of unknowns.
fn of_observability(seen: &ObservabilitySummary, parameters: usize) -> Option<Contradiction> {
    let ObservabilitySummary { rank, columns, null_directions, .. } = seen;
    if *columns != parameters {
        return Some((
            format!("observability of {columns} columns"),
            format!("{parameters}, the number of parameters"),
        ));
    }
    (rank + null_directions.len() != *columns).then(|| {
        let found = format!("observability with rank {rank} and {} null directions", null_directions.len());
        (found, format!("{columns} in all, the number of columns"))
    })
}

/// Each row has as many numbers as there are parameters.
fn of_convergence(convergence: &ConvergenceSummary, parameters: usize) -> Option<Contradiction> {
    let ConvergenceSummary { plateaus, standard_uncertainty: rows } = convergence;
    if rows.len() != plateaus.len() {
        return Some((format!("convergence with {} rows", rows.len()), plateaus.len().to_string()));
    }
    let row = rows.iter().position(|row| row.len() != parameters)?;
    let found = format!("convergence.standard_uncertainty[{row}] with {} numbers", rows[row].len());
    Some((found, format!("{parameters}, the number of parameters")))
}

/// Each plateau belongs to a mounting, its numbers are of a size that readings have, and its covariances are covariances.
fn of_plateaus(result: &CalibrationResult) -> Option<Contradiction> {
    let mountings = result.mountings.len();
    result.plateaus.iter().enumerate().find_map(|(n, plateau)| {
        let of = |what: &str| format!("plateaus[{n}] with {what}");
        let numbers = [Some(plateau.mean), Some(plateau.residual), plateau.specific_force].into_iter().flatten();
        if !(1..=mountings).contains(&plateau.mounting) {
            Some((of(&format!("mounting {}", plateau.mounting)), format!("1 to {mountings}")))
        } else if let Some(number) = numbers.flatten().find(|number| number.abs() > LARGEST_NUMBER) {
            Some((of(&format!("the number {number:e}")), format!("{LARGEST_NUMBER:e} at most")))
        } else {
            let mut covariances = [plateau.covariance, plateau.fit_covariance].into_iter();
            let (what, expected) = covariances.find_map(|covariance| of_errors(&covariance))?;
            Some((of(&what), expected))
        }
    })
}

/// A covariance of three errors has no negative variance, is symmetric and has no correlation above 1.
fn of_errors(covariance: &[[f64; 3]; 3]) -> Option<Contradiction> {
    let variances = [0, 1, 2].map(|axis| covariance[axis][axis]);
    if let Some(variance) = variances.into_iter().find(|v| *v < 0.0 || *v > LARGEST_NUMBER || v.is_subnormal()) {
        return Some((format!("the variance {variance:e}"), format!("zero or more, and {LARGEST_NUMBER:e} at most")));
    }
    [(0, 1), (0, 2), (1, 2)].into_iter().find_map(|(i, j)| {
        let (entry, mirrored, most) = (covariance[i][j], covariance[j][i], (variances[i] * variances[j]).sqrt());
        let is_one = (entry - mirrored).abs() <= ROUNDING * most && entry.abs() <= (1.0 + ROUNDING) * most;
        let expected = || format!("two equal ones, {most:e} at most, the product of the standard uncertainties");
        (!is_one).then(|| (format!("the covariances {entry:e} and {mirrored:e}"), expected()))
    })
}

/// The steps of the drawings of records are longer than zero.
fn of_records(result: &CalibrationResult) -> Option<Contradiction> {
    let (n, record) =
        result.records.iter().enumerate().find(|(_, record)| !record.step.is_normal() || record.step < 0.0)?;
    Some((format!("records[{n}] with steps of {:e} s", record.step), "above 0".to_owned()))
}

/// The covariance is symmetric, and has the squares of the standard uncertainties on its diagonal and no correlation above 1.
fn of_covariance(result: &CalibrationResult) -> Option<Contradiction> {
    let (parameters, covariance) = (&result.parameters, &result.covariance);
    let n = parameters.len();
    let sizes = std::iter::once(covariance.len()).chain(covariance.iter().map(Vec::len));
    if let Some(size) = sizes.into_iter().find(|size| *size != n) {
        return Some((format!("a covariance with a side of {size}"), format!("{n}, the number of parameters")));
    }
    let of_pair = |i: usize, j: usize| {
        let (entry, mirrored) = (covariance[i][j]?, covariance[j][i]?);
        let [a, b] = [i, j].map(|k: usize| parameters[k].standard_uncertainty);
        let most = a? * b?;
        let named =
            |what: &str, found: f64| format!("{what} of {} and {} {found:e}", parameters[i].name, parameters[j].name);
        if (entry - mirrored).abs() > ROUNDING * most {
            Some((named("covariance", entry), format!("{mirrored:e}, as on the other side of the diagonal")))
        } else if i == j && (entry - most).abs() > ROUNDING * most {
            Some((variance(&parameters[i], entry), format!("{most:e}, the square of its standard uncertainty")))
        } else if entry.abs() > (1.0 + ROUNDING) * most {
            Some((named("covariance", entry), format!("{most:e} at most, the product of their standard uncertainties")))
        } else {
            None
        }
    };
    let mut pairs = (0..n).flat_map(|i| (0..=i).map(move |j| (i, j)));
    pairs.find_map(|(i, j)| of_pair(i, j))
}

/// The budget has a number for each parameter, its sources make up the combined uncertainty, and that is the one of the estimate. The linear fit
/// has an estimate of its own; where the rank is short, products of two unknowns add what the undetermined combinations leave.
fn of_budget(result: &CalibrationResult) -> Option<Contradiction> {
    let (budget, n) = (result.budget.as_ref()?, result.parameters.len());
    let sources = || budget.sources.iter().map(|source| &source.standard_uncertainty);
    if let Some(row) = sources().chain([&budget.combined]).find(|row| row.len() != n) {
        return Some((format!("a budget of {} numbers", row.len()), format!("{n}, the number of parameters")));
    }
    let is_short = result.observability.rank < result.observability.columns;
    result.parameters.iter().zip(&budget.combined).enumerate().find_map(|(j, (parameter, combined))| {
        let (stated, combined) = (parameter.standard_uncertainty?, (*combined)?);
        let summed = sources().filter_map(|row| row[j]).map(|u| u * u).sum::<f64>().sqrt();
        let differs = |expected: f64| (combined - expected).abs() > BUDGET_ROUNDING * expected;
        let found = || format!("combined uncertainty of {} {combined:e} in the budget", parameter.name);
        if differs(summed) {
            Some((found(), format!("{summed:e}, the root of the sum of the squares of its sources")))
        } else if !result.fit.method.is_linear() && differs(stated) && !(is_short && combined < stated) {
            Some((found(), format!("{stated:e}, its standard uncertainty")))
        } else {
            None
        }
    })
}

fn variance(parameter: &ParameterEstimate, found: f64) -> String {
    format!("variance of {} {found:e}", parameter.name)
}
