//! Expanded uncertainties, as all documents state them: for one probability, with the coverage factor that belongs to it.

use centrical::uncertainty::Degrees;
use centrical_session::{CalibrationResult, ParameterEstimate, PredictionReport};

/// Coverage factor where the degrees of freedom are infinite.
const COVERAGE_FACTOR: f64 = 2.0;

/// Degrees of freedom above these are shown as such: no table of Student's distribution has them.
const MANY_DEGREES: f64 = 1000.0;

/// Whether documents show degrees of freedom as more than a thousand.
pub(crate) fn is_nearly_infinite(degrees_of_freedom: f64) -> bool {
    degrees_of_freedom > MANY_DEGREES
}

/// Probability that expanded uncertainties cover.
pub(crate) const COVERAGE_PROBABILITY: f64 = PredictionReport::COVERAGE;

/// An expanded uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Expanded {
    /// Coverage factor `k`: 2, or that of Student's distribution of the same probability where the effective degrees of
    /// freedom are finite (GUM, G.6.4).
    pub factor: f64,
    /// Effective degrees of freedom (Welch-Satterthwaite), a whole number; `None` if they are infinite.
    pub degrees_of_freedom: Option<f64>,
    /// `U = k u` [unit of the parameter].
    pub uncertainty: f64,
}

/// `U = 2 u` of a quantity of infinite degrees of freedom.
pub(crate) fn expanded_of_normal(standard_uncertainty: f64) -> f64 {
    COVERAGE_FACTOR * standard_uncertainty
}

/// Expanded uncertainty of a parameter of the result; `None` if it is not determined. The standard uncertainty is that of the estimate, with
/// what the session states; the budget gives the degrees of freedom.
pub(crate) fn expanded(result: &CalibrationResult, parameter: &ParameterEstimate) -> Option<Expanded> {
    Some(expanded_of(parameter.standard_uncertainty?, result.degrees_of_freedom(&parameter.name)))
}

/// `U = k u` of independent contributions, standard uncertainties with their degrees of freedom (Welch-Satterthwaite; GUM, G.4).
pub(crate) fn expanded_of_independent(contributions: &[(f64, Degrees)]) -> f64 {
    let combined = contributions.iter().fold(0.0, |sum: f64, (u, _)| sum.hypot(*u));
    let degrees = match Degrees::effective(contributions) {
        Degrees::Finite(nu) => Some(nu),
        Degrees::Infinite => None,
    };
    expanded_of(combined, degrees).uncertainty
}

/// `U = k u` of a quantity with these effective degrees of freedom, infinite if none are given.
pub(crate) fn expanded_of(standard_uncertainty: f64, degrees_of_freedom: Option<f64>) -> Expanded {
    // Cut to a whole number, which a reader finds in the published table (EA-4/02, E.3).
    let degrees_of_freedom = degrees_of_freedom.map(|nu| nu.floor().max(1.0));
    let factor =
        degrees_of_freedom.map_or(COVERAGE_FACTOR, |nu| Degrees::Finite(nu).coverage_factor(COVERAGE_PROBABILITY));
    Expanded { factor, degrees_of_freedom, uncertainty: factor * standard_uncertainty }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// EA-4/02 M:2022, table in annex E: k for a coverage probability of 95.45 %.
    #[test]
    fn factors_of_the_published_table() {
        let table = [(1.0, 13.97), (2.0, 4.53), (5.0, 2.65), (8.0, 2.37), (10.0, 2.28), (20.0, 2.13), (50.0, 2.05)];
        for (nu, k) in table {
            let found = Degrees::Finite(nu).coverage_factor(COVERAGE_PROBABILITY);
            assert!((found - k).abs() <= 0.005 + 1e-9, "{nu}: {found}");
        }
        let normal = Degrees::Infinite.coverage_factor(COVERAGE_PROBABILITY);
        assert!((normal - COVERAGE_FACTOR).abs() < 1e-9, "{normal}");
    }
}
