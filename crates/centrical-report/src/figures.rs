//! The figures of a report: each a drawing, and a sentence that says what to see in it.

mod correlation;
mod fit;
mod history;
mod prediction;
mod record;

use centrical::Position;
use centrical_session::CalibrationResult;
use nalgebra::Matrix3;

pub use self::history::history_figure;
use crate::language::Language;
use crate::plot::Plot;
use crate::positions_figure::position_drawings;

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
}

/// All figures that can be drawn from a result, in the order of the report.
pub fn figures(result: &CalibrationResult, language: Language) -> Vec<Figure> {
    let of_fit = fit::figures(result, language);
    let correlation = correlation::figure(result, language);
    let records = record::figure(result, language);
    of_fit
        .into_iter()
        .chain(prediction::figure(result, language))
        .chain(correlation)
        .chain(fit::singular_values(result, language))
        .chain([fit::convergence(result, language), records, fit::stability(result, language)].into_iter().flatten())
        .collect()
}

/// The drawing of the mounting positions; none if the result does not have them.
pub(crate) fn positions(result: &CalibrationResult, language: Language) -> Option<Figure> {
    let messages = language.messages();
    let positions: Vec<Position> = result
        .model
        .positions
        .iter()
        .map(|position| Position {
            id: position.id.clone(),
            p_zy: Matrix3::from_fn(|i, j| position.matrix[i][j]),
            pair: position.pair.clone(),
        })
        .collect();
    (!positions.is_empty()).then(|| Figure {
        name: "positions",
        title: messages.positions.to_owned(),
        caption: messages.positions_caption.to_owned(),
        drawings: position_drawings(&positions, language),
    })
}

/// A figure of one plot, in the numbers of the language.
fn of_plot(name: &'static str, caption: &str, plot: Plot, language: Language) -> Figure {
    Figure { name, title: plot.title.clone(), caption: caption.to_owned(), drawings: vec![drawn(plot, language)] }
}

/// A plot in the numbers of the language.
fn drawn(plot: Plot, language: Language) -> String {
    if language == Language::Russian { plot.with_decimal_comma() } else { plot }.to_svg()
}
