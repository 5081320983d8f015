//! The figures of a report: each a drawing, and a sentence that says what to see in it.

mod attitudes;
mod correlation;
mod drawing;
mod fit;
mod frontier;
mod live;
mod noise;
mod past;
mod positions;
mod record;

use centrical_session::CalibrationResult;

pub use self::drawing::Figure;
pub use self::frontier::frontier_plot;
pub use self::live::{history_figure, live_readings_figure, live_speeds_figure, live_uncertainties_figure};
pub use self::noise::noise_plots;
pub use self::past::{batches_plot, chart_plots, comparison_plot, distribution_plot, unit_history_plots};
pub(crate) use self::positions::positions;
pub use self::positions::positions_figure;
use crate::language::Language;

/// All figures that can be drawn from a result, in the order of the report.
pub fn figures(result: &CalibrationResult, language: Language) -> Vec<Figure> {
    attitudes::attitudes(result, language)
        .into_iter()
        .chain(fit::figures(result, language))
        .chain(fit::prediction(result, language))
        .chain(correlation::figure(result, language))
        .chain(fit::singular_values(result, language))
        .chain(fit::convergence(result, language))
        .chain(record::figure(result, language))
        .collect()
}
