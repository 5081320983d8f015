//! A term with its name, and text that may stand in a comment.

use centrical_compensate::Term;
use centrical_session::{CalibrationResult, NoErrorModel, harmless_line};

/// A term and the name of its coefficient, for the comments.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedTerm {
    /// Name of the coefficient: `G0_21`.
    pub name: String,
    /// The term.
    pub term: Term,
}

impl NamedTerm {
    /// The terms of a result with their estimated coefficients.
    ///
    /// # Errors
    /// [`NoErrorModel`] as [`CalibrationResult::error_terms`].
    pub fn of(result: &CalibrationResult) -> Result<Vec<Self>, NoErrorModel> {
        let names = result.model.error_model.iter().map(|term| term.name.clone());
        Ok(names.zip(result.error_terms()?).map(|(name, term)| Self { name, term }).collect())
    }
}

/// Text that stays within a comment of any of the languages, whatever a session calls itself.
pub(super) fn harmless(text: &str) -> String {
    let line = harmless_line(text).replace('\\', " ");
    // The ends of a C comment, what begins a trigraph, and the marks of the templates.
    line.replace("*/", "* /").replace("/*", "/ *").replace("??", "? ?").replace('@', "(at)")
}
