//! The serial number of a unit, which not every session gives.

use centrical_session::SessionSummary;

use crate::language::Language;

/// The serial number, or that none is given.
pub(crate) fn serial(session: &SessionSummary, language: Language) -> &str {
    if session.unit_serial.is_empty() { language.messages().not_given } else { &session.unit_serial }
}
