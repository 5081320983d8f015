//! Time stamps as text.

use jiff::civil::DateTime;
use jiff::tz::Offset;
use jiff::{SignedDuration, Timestamp};

/// Seconds since 1970 of an ISO 8601 stamp, in UTC where it gives no offset.
///
/// A number of seconds of this size resolves a quarter of a microsecond.
pub(crate) fn seconds(text: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(text).ok()?;
    let stamp = text.parse::<Timestamp>().ok();
    let stamp = stamp.or_else(|| Offset::UTC.to_timestamp(text.parse::<DateTime>().ok()?).ok())?;
    Some(stamp.duration_since(Timestamp::UNIX_EPOCH)).map(|d: SignedDuration| d.as_secs_f64())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stamps_are_seconds_since_1970() {
        for (text, expected) in [
            ("1970-01-01T00:00:00Z", 0.0),
            ("2026-10-05T10:00:00.25Z", 1_791_194_400.25),
            ("2026-10-05 10:00:00.25", 1_791_194_400.25),
            ("2026-10-05T13:00:00,25+03:00", 1_791_194_400.25),
        ] {
            assert_eq!(seconds(text.as_bytes()), Some(expected), "{text}");
        }
        for text in ["", "yesterday", "2026-13-05T10:00:00", "10:00:00", "2026-10-05T10:00:00+3"] {
            assert_eq!(seconds(text.as_bytes()), None, "{text}");
        }
    }
}
