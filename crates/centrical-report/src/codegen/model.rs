//! What the files are made from.

use centrical_compensate::{Compensation, Term};
use centrical_session::OutputSummary;

use super::statement::{self, Language};
use super::term::{NamedTerm, harmless};

/// What the files are made from.
pub(super) struct Model<'a> {
    pub heading: &'a [String],
    pub terms: &'a [NamedTerm],
    pub output: Option<&'a OutputSummary>,
    pub plain: &'a [Term],
    pub compensation: &'a Compensation<&'a [Term]>,
}

impl Model<'_> {
    /// Fills what all templates have in common.
    pub fn fill(&self, template: &str, language: &dyn Language) -> String {
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

    /// A template for a unit with raw output of its own, filled; nothing for another.
    pub fn of_raw(&self, template: &str, language: &dyn Language) -> String {
        let Some(OutputSummary { unit, scale, bias }) = self.output else { return String::new() };
        let row = |numbers: &[f64; 3]| numbers.map(|x| language.number(x)).join(", ");
        template
            .replace("@raw_unit@", &harmless(unit))
            .replace("@raw_scale@", &row(scale))
            .replace("@raw_bias@", &row(bias))
    }

    /// A template for specific forces in other axes, filled; `otherwise` for those of the newtonometers.
    pub fn in_axes(&self, template: &str, otherwise: &str, language: &dyn Language) -> String {
        let Some(matrix) = self.compensation.axes() else { return otherwise.to_owned() };
        let row = |numbers: &[f64; 3]| numbers.map(|x| language.number(x)).join(", ");
        let rows = matrix.iter().enumerate();
        rows.fold(template.to_owned(), |text, (i, numbers)| text.replace(&format!("@axes_{}@", i + 1), &row(numbers)))
    }

    /// Range of the compensation [m/s^2].
    pub fn range(&self) -> f64 {
        self.compensation.certificate().range
    }

    /// The heading as lines of comment.
    fn heading(&self, comment: &str) -> String {
        let lines: Vec<String> =
            self.heading.iter().map(|line| format!("{comment} {}", harmless(line)).trim_end().to_owned()).collect();
        lines.join("\n")
    }
}
