//! A pattern in the residuals and what may cause it, in words.

use centrical_session::{Follows, MICRO_G, PatternSummary};

use crate::number::with_uncertainty;

/// "residuals of newtonometer 2 grow with the square of the speed in position 3 ...: an elastic turn or a loose seat".
pub(super) fn pattern_in_words(pattern: &PatternSummary) -> String {
    let (what, cause) = match &pattern.follows {
        Follows::Position { position } => {
            (format!("have a step in position {position}"), "a seat that moved or a thermal shift")
        }
        Follows::SpeedInPosition { position } => {
            (format!("grow with the square of the speed in position {position}"), "an elastic turn or a loose seat")
        }
        Follows::SpeedOnSeat { radius } => (
            format!("grow with the square of the speed at radius {radius} m"),
            "a wrong radius or a stretch of the arm",
        ),
        Follows::Speed => ("grow with the square of the speed".to_owned(), "a wrong speed or a missing term"),
        Follows::Load => ("grow with the load".to_owned(), "a missing term of the error model or an elastic arm"),
        Follows::Mounting { mounting } => {
            (format!("have a step in mounting {mounting}"), "a drift of the bias or a loose mounting")
        }
        Follows::Time => ("drift over the session".to_owned(), "a drift of the bias"),
    };
    let (amplitude, uncertainty) =
        with_uncertainty(pattern.amplitude / MICRO_G, pattern.standard_uncertainty / MICRO_G);
    format!(
        "residuals of newtonometer {} {what} ({amplitude} ± {uncertainty} ug, probability {:.1e}): {cause}",
        pattern.axis, pattern.probability
    )
}
