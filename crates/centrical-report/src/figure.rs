//! The figures of a report: each a drawing, and a sentence that says what to see in it.

mod attitudes;
mod comparison;
mod correlation;
mod drawing;
mod estimates;
mod fit;
mod frontier;
mod history;
mod live;
mod noise;
mod past;
mod positions;
mod prediction;
mod record;
mod units;

use centrical::Position;
use centrical_session::CalibrationResult;
use nalgebra::Matrix3;

pub use self::comparison::comparison_plot;
pub use self::drawing::Figure;
pub use self::frontier::frontier_plot;
pub use self::history::history_figure;
pub use self::live::{live_readings_figure, live_speeds_figure, live_uncertainties_figure};
pub use self::noise::noise_plots;
pub use self::past::{chart_plots, unit_history_plots};
use self::positions::position_drawings;
pub use self::positions::positions_figure;
pub use self::units::{batches_plot, distribution_plot};
use crate::language::Language;

/// All figures that can be drawn from a result, in the order of the report.
pub fn figures(result: &CalibrationResult, language: Language) -> Vec<Figure> {
    let of_attitudes = attitudes::attitudes(result, language);
    let of_fit = fit::figures(result, language);
    let correlation = correlation::figure(result, language);
    let records = record::figure(result, language);
    of_attitudes
        .into_iter()
        .chain(of_fit)
        .chain(prediction::figure(result, language))
        .chain(correlation)
        .chain(fit::singular_values(result, language))
        .chain(fit::convergence(result, language))
        .chain(records)
        .collect()
}

/// The drawing of the mounting positions; `None` if the result does not have them.
pub(crate) fn positions(result: &CalibrationResult, language: Language) -> Option<Figure> {
    let messages = language.messages();
    let positions: Vec<Position> = result
        .model
        .positions
        .iter()
        .filter(|position| !position.is_free)
        .map(|position| Position::on_arm(&position.id, Matrix3::from_fn(|i, j| position.matrix[i][j]), &position.pair))
        .collect();
    (!positions.is_empty()).then(|| {
        let drawings = position_drawings(&positions, language);
        Figure::new("positions", messages.positions, messages.positions_caption, drawings)
    })
}
