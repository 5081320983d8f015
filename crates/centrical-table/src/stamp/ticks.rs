//! Stamps as binary formats count them: whole numbers of a unit of time.

use jiff::Timestamp;
use jiff::tz::Offset;

/// How stamps are counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct TickForm {
    pub unit: TickUnit,
    /// Whether they count from 1970 in UTC, or in a time whose zone is not stated.
    pub is_utc: bool,
}

/// A unit of time in which stamps are whole numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TickUnit {
    Second,
    Millisecond,
    Microsecond,
    Nanosecond,
}

impl TickUnit {
    /// The unit in seconds.
    pub fn seconds(self) -> f64 {
        match self {
            Self::Second => 1.0,
            Self::Millisecond => 1e-3,
            Self::Microsecond => 1e-6,
            Self::Nanosecond => 1e-9,
        }
    }

    /// Decimals of a second.
    fn decimals(self) -> usize {
        match self {
            Self::Second => 0,
            Self::Millisecond => 3,
            Self::Microsecond => 6,
            Self::Nanosecond => 9,
        }
    }

    pub fn nanoseconds(self) -> i64 {
        match self {
            Self::Second => 1_000_000_000,
            Self::Millisecond => 1_000_000,
            Self::Microsecond => 1_000,
            Self::Nanosecond => 1,
        }
    }
}

impl TickForm {
    /// A stamp in ISO 8601, with all decimals of the unit; nothing for years of more than four digits.
    pub fn text(self, ticks: i64) -> Option<String> {
        let of_unit = self.unit.nanoseconds();
        let a_second = TickUnit::Second.nanoseconds() / of_unit;
        let nanoseconds = i32::try_from(ticks.rem_euclid(a_second) * of_unit).ok()?;
        // A second and its fraction are of one sign, or the second is zero.
        let stamp = Timestamp::new(ticks.div_euclid(a_second), nanoseconds).ok()?;
        let civil = Offset::UTC.to_datetime(stamp);
        let zone = if self.is_utc { "Z" } else { "" };
        (0..=9999).contains(&civil.year()).then(|| format!("{civil:.0$}{zone}", self.unit.decimals()))
    }
}
