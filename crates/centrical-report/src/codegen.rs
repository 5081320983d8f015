//! Compensation as source code for others to build into their systems: C99, MATLAB and Octave, Python.
//!
//! Each file stands alone, allocates nothing that its language does not force it to, and holds test vectors with a
//! function that runs them. All three do what [`centrical_compensate`] does, statement by statement: the same start,
//! the same certified number of Newton steps, the same refusal out of range.

mod c;
mod octave;
mod python;
mod statement;
mod vectors;

use centrical_compensate::{Compensation, NotInvertible, Term};
use centrical_session::{CalibrationResult, NoErrorModel};

use self::statement::Language;

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

/// What the first comment says of a result.
pub fn heading(result: &CalibrationResult) -> Vec<String> {
    let session = &result.session;
    let serial = if session.unit_serial.is_empty() { String::new() } else { format!(" No. {}", session.unit_serial) };
    vec![
        format!("Compensation of {}{serial}, calibrated {}.", session.unit_model, session.date),
        session.title.clone(),
        format!("Made by {} {}; not to be edited.", result.program.name, result.program.version),
    ]
}

/// A file of source code.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SourceFile {
    /// Name of the file.
    pub name: &'static str,
    /// Its text.
    pub text: String,
}

/// The compensation of a unit as `centrical_compensate.h`, `.c`, `.m` (MATLAB and Octave) and `.py`, for specific
/// forces up to `range` [m/s^2] on each axis. `heading` goes into the first comment of each, a line each.
///
/// # Errors
/// [`NotInvertible`] as [`Compensation::new`].
pub fn compensation_source(
    heading: &[String],
    terms: &[NamedTerm],
    range: f64,
) -> Result<Vec<SourceFile>, NotInvertible> {
    let plain: Vec<Term> = terms.iter().map(|named| named.term).collect();
    let compensation = Compensation::new(&plain, range)?;
    let model = Model { heading, terms, plain: &plain, compensation: &compensation };
    Ok(vec![
        SourceFile { name: "centrical_compensate.h", text: c::header(&model) },
        SourceFile { name: "centrical_compensate.c", text: c::source(&model) },
        SourceFile { name: "centrical_compensate.m", text: octave::function(&model) },
        SourceFile { name: "centrical_compensate.py", text: python::module(&model) },
    ])
}

/// What the files are made from.
struct Model<'a> {
    heading: &'a [String],
    terms: &'a [NamedTerm],
    plain: &'a [Term],
    compensation: &'a Compensation<'a>,
}

impl Model<'_> {
    /// Fills what all templates have in common.
    fn fill(&self, template: &str, language: &dyn Language) -> String {
        let linear = self.compensation.linear();
        let row = |numbers: &[f64]| numbers.iter().map(|x| language.number(*x)).collect::<Vec<_>>().join(", ");
        let steps = self.compensation.certificate().newton_steps(0.5 * language.epsilon());
        let filled = template
            .replace("@heading@", &self.heading(language.comment()))
            .replace("@range@", &language.number(self.range()))
            .replace("@start_region@", &language.number(centrical_compensate::START_REGION))
            .replace("@edge@", &language.number(1.0 + 8.0 * language.epsilon()))
            .replace("@steps@", &steps.to_string())
            .replace("@coefficients@", &statement::coefficients(language, self.terms))
            .replace("@statements@", &statement::error_and_gain(language, self.terms))
            .replace("@bias@", &row(&linear.bias));
        let inverse = linear.inverse.iter().enumerate();
        inverse.fold(filled, |text, (i, numbers)| text.replace(&format!("@inverse_{}@", i + 1), &row(numbers)))
    }

    fn range(&self) -> f64 {
        self.compensation.certificate().range
    }

    /// The heading as lines of comment.
    fn heading(&self, comment: &str) -> String {
        let lines: Vec<String> =
            self.heading.iter().map(|line| format!("{comment} {}", harmless(line)).trim_end().to_owned()).collect();
        lines.join("\n")
    }
}

/// Text that stays within a comment of any of the languages, whatever a session calls itself.
fn harmless(text: &str) -> String {
    let line: String = text.chars().map(|c| if c.is_control() || c == '\\' { ' ' } else { c }).collect();
    // The ends of a C comment, what begins a trigraph, and the marks of the templates.
    line.replace("*/", "* /").replace("/*", "/ *").replace("??", "? ?").replace('@', "(at)")
}
