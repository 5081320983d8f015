//! A figure: drawings, and a sentence that says what to see in them.

use centrical::Group;
use centrical_session::ParameterEstimate;

use crate::language::Language;
use crate::plot::Plot;

/// A figure of the report.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Name, for a file or an anchor: `residuals`.
    pub name: &'static str,
    /// Title.
    pub title: String,
    /// What to see in it, one sentence.
    pub caption: String,
    /// The drawings, SVG: one, or one for each record.
    pub drawings: Vec<String>,
    /// Combinations of parameters that the figure shows as undetermined.
    pub combinations: Vec<String>,
}

/// A figure of one plot, in the numbers of the language.
pub(super) fn of_plot(name: &'static str, caption: &str, plot: Plot, language: Language) -> Figure {
    Figure::new(name, &plot.title.clone(), caption, vec![drawn(plot, language)])
}

/// A plot in the numbers of the language.
pub(super) fn drawn(plot: Plot, language: Language) -> String {
    if language == Language::Russian { plot.with_decimal_comma() } else { plot }.to_svg()
}

/// Whether a figure of parameters shows this one: an estimate, and not the attitude of a rest, which is determined with that rest alone.
pub(super) fn is_charted(parameter: &ParameterEstimate) -> bool {
    parameter.estimable && parameter.group != Group::Attitude
}

impl Figure {
    /// A figure without combinations.
    pub(super) fn new(name: &'static str, title: &str, caption: &str, drawings: Vec<String>) -> Self {
        Self { name, title: title.to_owned(), caption: caption.to_owned(), drawings, combinations: Vec::new() }
    }
}
