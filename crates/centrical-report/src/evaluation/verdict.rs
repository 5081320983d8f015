//! Whether a result can be accepted as it stands, and why not.

use centrical::Termination;
use centrical::uncertainty::chi_squared_tail;
use centrical_session::{CalibrationResult, PatternSummary, ValiditySummary};

/// Residuals as large as these arise by chance once in ten thousand sessions.
const CHANCE: f64 = 1e-4;

/// An objection to a result.
#[derive(Debug, Clone, PartialEq)]
pub enum Objection {
    /// The fit did not converge.
    NotConverged {
        /// How it ended, as the result says it.
        termination: Termination,
        /// Linearisations made.
        iterations: usize,
    },
    /// Residuals are larger than the stated uncertainties explain (chi^2 beyond its 99.99 % quantile).
    Residuals {
        /// chi^2.
        chi_squared: f64,
        /// Its degrees of freedom.
        degrees_of_freedom: usize,
        /// Probability of so large a chi^2.
        chance: f64,
    },
    /// Plateaus that stand out from the others, as `mounting:plateau` counted from 1, and the chance of the first.
    Outlying(Vec<String>, f64),
    /// Residuals follow something that the model does not have.
    Patterns(Vec<PatternSummary>),
    /// Parameters of the instrument are not determined. Lost geometry alone is no objection.
    NotDetermined(Vec<String>),
}

/// The objections to the result; empty if it is acceptable.
pub fn objections(result: &CalibrationResult) -> Vec<Objection> {
    let fit = &result.fit;
    let mut objections = Vec::new();
    if matches!(fit.termination, Termination::Stalled | Termination::IterationLimit) {
        objections.push(Objection::NotConverged { termination: fit.termination, iterations: fit.iterations });
    }
    let (chi_squared, degrees_of_freedom) = (fit.chi_squared, fit.degrees_of_freedom);
    let chance = chi_squared_tail(chi_squared, degrees_of_freedom);
    if chance < CHANCE {
        objections.push(Objection::Residuals { chi_squared, degrees_of_freedom, chance });
    }
    objections.extend(result.validity.iter().flat_map(of_validity));
    let names = result.model.error_model.iter().map(|term| &term.name);
    let lost: Vec<String> = names.filter(|name| result.parameter(name).is_none_or(|p| !p.estimable)).cloned().collect();
    if !lost.is_empty() {
        objections.push(Objection::NotDetermined(lost));
    }
    objections
}

/// Plateaus and patterns that arise by chance less than once in ten thousand sessions.
fn of_validity(validity: &ValiditySummary) -> Vec<Objection> {
    let outlying: Vec<_> = validity.outlying.iter().filter(|plateau| plateau.probability < CHANCE).collect();
    let patterns: Vec<_> = validity.patterns.iter().filter(|p| p.probability < CHANCE).cloned().collect();
    let names = outlying.iter().map(|plateau| format!("{}:{}", plateau.mounting, plateau.index + 1)).collect();
    let of_plateaus = outlying.first().map(|first| Objection::Outlying(names, first.probability));
    let of_patterns = (!patterns.is_empty()).then_some(Objection::Patterns(patterns));
    of_plateaus.into_iter().chain(of_patterns).collect()
}
