//! What in a `result.json` contradicts itself: a file that was edited by hand or put together.

use std::collections::HashSet;

use super::schema::{CalibrationResult, ParameterEstimate};

/// Units of raw output.
const RAW_UNITS: [&str; 2] = ["counts", "V"];

/// Rounding of numbers that were written, read and squared.
const ROUNDING: f64 = 1e-9;

/// The first contradiction: what was found, and what was expected. A covariance is symmetric, and has the squares of the standard uncertainties on its
/// diagonal and no correlation above 1; a parameter has both numbers or none; chi^2 is no less than zero; raw output has a unit that sessions know.
pub(super) fn contradiction(result: &CalibrationResult) -> Option<(String, String)> {
    let (parameters, covariance) = (&result.parameters, &result.covariance);
    let n = parameters.len();
    if let Some(size) = std::iter::once(covariance.len()).chain(covariance.iter().map(Vec::len)).find(|size| *size != n)
    {
        return Some((format!("a covariance with a side of {size}"), format!("{n}, the number of parameters")));
    }
    if let Some(output) = result.output.as_ref().filter(|output| !RAW_UNITS.contains(&output.unit.as_str())) {
        return Some((format!("raw output in {:?}", output.unit), format!("one of {}", RAW_UNITS.join(", "))));
    }
    let mut names = HashSet::new();
    if let Some(twice) = parameters.iter().find(|parameter| !names.insert(&parameter.name)) {
        return Some((format!("the parameter {:?} twice", twice.name), "each once".to_owned()));
    }
    if let Some(half) = parameters.iter().find(|p| p.value.is_some() != p.standard_uncertainty.is_some()) {
        let found = format!("{} with one of value and standard_uncertainty", half.name);
        return Some((found, "both or neither".to_owned()));
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
    let pairs = (0..n).flat_map(|i| (0..=i).map(move |j| (i, j)));
    let negative = (result.fit.chi_squared < 0.0)
        .then(|| (format!("chi^2 {}", result.fit.chi_squared), "zero or more".to_owned()));
    pairs.into_iter().find_map(|(i, j)| of_pair(i, j)).or(negative)
}

fn variance(parameter: &ParameterEstimate, found: f64) -> String {
    format!("variance of {} {found:e}", parameter.name)
}
