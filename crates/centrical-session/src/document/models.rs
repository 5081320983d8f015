//! Rival models compared, as a JSON document: schema `centrical-models/1`.

use centrical::Rival;
use centrical::uncertainty::{FittedCandidate, ModelSelection};
use serde::Serialize;

use super::json;
use super::result::Program;

/// Name of the schema's present version.
pub(crate) const MODELS_SCHEMA: &str = "centrical-models/1";

/// The models that were fitted, and the one that the data support.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelsReport {
    /// `centrical-models/1`.
    pub schema: &'static str,
    /// What made it.
    pub program: Program,
    /// Title of the session.
    pub title: String,
    /// The recommended model, counted from 0 among the candidates: the lowest BIC of those that converged and gain more than chance.
    pub recommended: usize,
    /// The models, in the order in which they were fitted.
    pub candidates: Vec<CandidateSummary>,
    /// Effects that are not fitted, since the data determine nothing of them where alignment errors vanish.
    pub undetermined: Vec<String>,
    /// The optional terms one by one.
    pub terms: Vec<TermSupport>,
}

/// A model after its fit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CandidateSummary {
    /// Its name.
    pub name: String,
    /// The effects that it adds to the model as stated, by their names in `experiment.toml`.
    pub adds: Vec<String>,
    /// Unknowns that the data determine.
    pub rank: usize,
    /// Unknowns.
    pub unknowns: usize,
    /// Whether the fit converged.
    pub converged: bool,
    /// Weighted sum of squared residuals.
    pub chi_squared: f64,
    /// Its degrees of freedom.
    pub degrees_of_freedom: usize,
    /// Combinations beyond the rank that second-order traces determine, in part or in whole.
    pub traced: f64,
    /// `chi^2 + (rank + traced) ln n` of `n` readings.
    pub bic: f64,
    /// Mean score per reading of the prediction of each mounting from the others: the lower the better.
    pub hold_out_score: Option<f64>,
    /// F test against the largest model nested in this one; null without a nested model or without degrees of freedom.
    pub nested_test: Option<NestedTestSummary>,
}

/// An F test of a model against one nested in it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct NestedTestSummary {
    /// The nested model, counted from 0 among the candidates.
    pub nested: usize,
    /// F statistic of the further unknowns.
    pub f: Option<f64>,
    /// Further unknowns that the data determine.
    pub further_unknowns: usize,
    /// Probability of so large a statistic if they are all zero.
    pub probability: f64,
}

/// Whether the data show a term.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TermSupport {
    /// Name of its coefficient.
    pub name: String,
    /// Estimate over standard uncertainty; null where it is not determined.
    pub significance: Option<f64>,
    /// Whether it is worth an unknown.
    pub kept: bool,
}

impl ModelsReport {
    /// The comparison of models for a session of that title.
    pub fn of(selection: &ModelSelection, title: &str) -> Self {
        let term = |t: &centrical::uncertainty::TermVerdict| TermSupport {
            name: t.name.clone(),
            significance: t.significance,
            kept: t.kept,
        };
        Self {
            schema: MODELS_SCHEMA,
            program: Program::this(),
            title: title.to_owned(),
            recommended: selection.recommended,
            candidates: selection.candidates.iter().map(CandidateSummary::of).collect(),
            undetermined: selection.undetermined.iter().map(|rival| rival.name()).collect(),
            terms: selection.terms.iter().map(term).collect(),
        }
    }
}

impl CandidateSummary {
    fn of(candidate: &FittedCandidate) -> Self {
        Self {
            name: candidate.name.clone(),
            adds: candidate.rivals.iter().map(|rival: &Rival| rival.name()).collect(),
            rank: candidate.rank,
            unknowns: candidate.unknowns,
            converged: candidate.converged,
            chi_squared: candidate.chi_squared,
            degrees_of_freedom: candidate.degrees_of_freedom,
            traced: candidate.traced,
            bic: candidate.bic,
            hold_out_score: json::finite(candidate.hold_out_score),
            nested_test: candidate.against.map(|(nested, test)| NestedTestSummary {
                nested,
                f: json::finite(test.statistic),
                further_unknowns: test.degrees_of_freedom,
                probability: test.probability,
            }),
        }
    }
}
