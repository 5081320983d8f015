//! Time stamps as text.

use std::fmt;

use jiff::civil::{Date, DateTime, Time};
use jiff::tz::Offset;
use jiff::{SignedDuration, Timestamp};

/// How a stamp is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StampKind {
    /// ISO 8601: `2026-10-05T10:00:00.25Z`.
    Iso,
    /// The year first, with points or slashes: `2026/10/05 10:00:00.25`.
    YearFirst,
    /// The day first, with points: `05.10.2026 10:00:00,25`.
    DayFirst,
    /// The time of the day alone: `10:00:00,25`.
    TimeOfDay,
}

impl fmt::Display for StampKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Iso => "2026-10-05T10:00:00.25",
            Self::YearFirst => "2026/10/05 10:00:00.25",
            Self::DayFirst => "05.10.2026 10:00:00,25",
            Self::TimeOfDay => "10:00:00,25",
        })
    }
}

/// Seconds since 1970 of a stamp, in UTC where it gives no offset; of a time of the day since midnight.
///
/// A number of seconds of this size resolves a quarter of a microsecond.
pub(crate) fn seconds(text: &[u8]) -> Option<f64> {
    parsed(text).map(|stamp| stamp.since.as_secs_f64())
}

/// Seconds since 1970 of a stamp with a date, as [`joined`] makes it.
pub(crate) fn dated_seconds(text: &[u8]) -> Option<f64> {
    parsed(text).filter(|stamp| stamp.kind != StampKind::TimeOfDay).map(|stamp| stamp.since.as_secs_f64())
}

/// Nanoseconds since 1970 of a stamp with a date, and whether it gives an offset from UTC; nothing for a time of the day, and outside
/// the years 1678 to 2261, which 64 bits count.
pub(crate) fn nanoseconds(text: &[u8]) -> Option<(i64, bool)> {
    let stamp = parsed(text).filter(|stamp| stamp.kind != StampKind::TimeOfDay)?;
    Some((i64::try_from(stamp.since.as_nanos()).ok()?, stamp.has_offset))
}

/// The stamp of a date and a time of the day. The date may be a stamp at midnight, as workbooks have it.
pub(crate) fn joined(date: &[u8], time: &[u8]) -> Vec<u8> {
    const MIDNIGHT: [&[u8]; 3] = [b"T00:00:00.000", b"T00:00:00", b" 00:00:00"];
    let day = MIDNIGHT.iter().find_map(|end| date.strip_suffix(*end)).unwrap_or(date);
    [day, time].join(&b' ')
}

/// How a stamp is written.
pub(crate) fn kind(text: &[u8]) -> Option<StampKind> {
    parsed(text).map(|stamp| stamp.kind)
}

/// What a text says.
struct Parsed {
    kind: StampKind,
    /// Since 1970, in UTC without an offset; of a time of the day since midnight.
    since: SignedDuration,
    has_offset: bool,
}

fn parsed(text: &[u8]) -> Option<Parsed> {
    // No number is a stamp, and most texts that are neither have no such sign.
    if !text.contains(&b':') && !text.contains(&b'-') {
        return None;
    }
    let text = std::str::from_utf8(text).ok()?.trim();
    iso(text)
        .or_else(|| with_date(text))
        .or_else(|| Some(Parsed { kind: StampKind::TimeOfDay, since: since_midnight(text)?, has_offset: false }))
}

fn iso(text: &str) -> Option<Parsed> {
    let stamp = text.parse::<Timestamp>().ok();
    let has_offset = stamp.is_some();
    let since = stamp.or_else(|| in_utc(text.parse::<DateTime>().ok()?)).map(since_1970)?;
    Some(Parsed { kind: StampKind::Iso, since, has_offset })
}

fn in_utc(stamp: DateTime) -> Option<Timestamp> {
    Offset::UTC.to_timestamp(stamp).ok()
}

fn since_1970(stamp: Timestamp) -> SignedDuration {
    stamp.duration_since(Timestamp::UNIX_EPOCH)
}

/// A date with points, slashes or dashes, a blank or `T`, and a time. With slashes and dashes the year comes first: day and month in
/// `05/10/2026` are ambiguous.
fn with_date(text: &str) -> Option<Parsed> {
    let (date, time) = text.split_once([' ', 'T'])?;
    let mark = ['.', '/', '-'].into_iter().find(|mark| date.contains(*mark))?;
    let mut parts = date.split(mark);
    let [a, b, c] = [parts.next()?, parts.next()?, parts.next()?];
    if parts.next().is_some() {
        return None;
    }
    let (kind, [year, month, day]) = match (a.len(), c.len(), mark) {
        (4, 1..=2, _) => (StampKind::YearFirst, [a, b, c]),
        (1..=2, 4, '.') => (StampKind::DayFirst, [c, b, a]),
        _ => return None,
    };
    let date = Date::new(digits(year)?, digits(month)?, digits(day)?).ok()?;
    let stamp = in_utc(date.to_datetime(time_of_day(time)?))?;
    Some(Parsed { kind, since: since_1970(stamp), has_offset: false })
}

fn since_midnight(text: &str) -> Option<SignedDuration> {
    let time = time_of_day(text)?;
    let [hour, minute, second, nanosecond] =
        [i64::from(time.hour()), time.minute().into(), time.second().into(), time.subsec_nanosecond().into()];
    Some(SignedDuration::from_secs(60 * (60 * hour + minute) + second) + SignedDuration::from_nanos(nanosecond))
}

/// A time such as `9:10:00,0100`; digits beyond a nanosecond are left out.
fn time_of_day(text: &str) -> Option<Time> {
    let mut parts = text.trim().split(':');
    let [hour, minute, second] = [parts.next()?, parts.next()?, parts.next()?];
    if parts.next().is_some() {
        return None;
    }
    let (second, fraction) = second.split_once(['.', ',']).unwrap_or((second, "0"));
    if fraction.is_empty() || !fraction.bytes().all(|byte| byte.is_ascii_digit()) {
        return None;
    }
    let nanoseconds: i32 = format!("{:0<9}", &fraction[..fraction.len().min(9)]).parse().ok()?;
    Time::new(digits(hour)?, digits(minute)?, digits(second)?, nanoseconds).ok()
}

/// A whole number of one to four digits.
fn digits<T: std::str::FromStr>(text: &str) -> Option<T> {
    let is_plain = (1..=4).contains(&text.len()) && text.bytes().all(|byte| byte.is_ascii_digit());
    if is_plain { text.parse().ok() } else { None }
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
            ("05.10.2026 10:00:00,2500", 1_791_194_400.25),
            ("5.10.2026 10:00:00.25", 1_791_194_400.25),
            ("2026/10/05 10:00:00,250000000000001", 1_791_194_400.25),
            ("2026.10.05 10:00:00", 1_791_194_400.0),
            ("2026-10-05 9:10:00,25", 1_791_191_400.25),
            ("10:00:00,25", 36_000.25),
        ] {
            assert_eq!(seconds(text.as_bytes()), Some(expected), "{text}");
        }
        for text in [
            "",
            "yesterday",
            "2026-13-05T10:00:00",
            "10:00",
            "2026-10-05T10:00:00+3",
            "05/10/2026 10:00:00",
            "05-10-2026 10:00:00",
            "31.02.2026 10:00:00",
            "05.10.26 10:00:00",
            "05.10.2026",
            "24:00:01",
            "1.5",
            "10:00:00,",
            "1:2:3:4",
        ] {
            assert_eq!(seconds(text.as_bytes()), None, "{text}");
        }
    }

    #[test]
    fn a_date_and_a_time_make_a_stamp() {
        for date in ["2026-10-05", "05.10.2026", "2026/10/05", "2026-10-05T00:00:00.000", "2026-10-05 00:00:00"] {
            for time in ["10:00:00.250", "10:00:00,250"] {
                let stamp = joined(date.as_bytes(), time.as_bytes());
                assert_eq!(dated_seconds(&stamp), Some(1_791_194_400.25), "{date} {time}");
            }
        }
        for (date, time) in [("05/10/2026", "10:00:00"), ("", "10:00:00"), ("2026-10-05", "1.5"), ("10:00:00", "")] {
            assert_eq!(dated_seconds(&joined(date.as_bytes(), time.as_bytes())), None, "{date} {time}");
        }
    }

    #[test]
    fn kinds_of_stamps() {
        for kind in [StampKind::Iso, StampKind::YearFirst, StampKind::DayFirst, StampKind::TimeOfDay] {
            assert_eq!(super::kind(kind.to_string().as_bytes()), Some(kind));
        }
    }
}
