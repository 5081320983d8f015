//! A day, as the dates of a certificate are.

use std::borrow::Cow;
use std::fmt;
use std::str::FromStr;
use std::time::SystemTime;

use centrical::history::DAYS_IN_YEAR;
use jiff::civil;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{self, Deserializer};
use serde::{Deserialize, Serialize, Serializer};

/// A day.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Date {
    /// Year.
    pub year: u16,
    /// Month, 1 to 12.
    pub month: u8,
    /// Day, 1 to 31.
    pub day: u8,
}

impl Date {
    /// The day of a stamp without a time.
    fn of(stamp: toml::value::Datetime) -> Option<Self> {
        let date = stamp.date.filter(|_| stamp.time.is_none())?;
        Some(Self { year: date.year, month: date.month, day: date.day })
    }

    /// Today, of the clock of this machine, in UTC.
    pub fn today() -> Self {
        let passed = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        Self { year: 1970, month: 1, day: 1 }.after((passed.as_secs() / 86_400) as f64)
    }

    /// The day in years, for the axis of a plot: 2026.76.
    pub fn in_years(self) -> f64 {
        let first = Self { year: self.year, month: 1, day: 1 };
        f64::from(self.year) + self.days_since(first).map_or(0.0, f64::from) / 366.0
    }

    /// The day a number of whole days later; the last day of the calendar where that is beyond it.
    pub(crate) fn after(self, days: f64) -> Self {
        let civil = self.civil().unwrap_or(civil::Date::MAX);
        #[expect(clippy::cast_possible_truncation, reason = "a span of days saturates")]
        let days = days.clamp(-4e6, 4e6) as i32;
        let later = civil.saturating_add(jiff::Span::new().days(days));
        let [year, month, day] =
            [later.year(), i16::from(later.month()), i16::from(later.day())].map(i16::unsigned_abs);
        let small = |number: u16| u8::try_from(number).unwrap_or(u8::MAX);
        Self { year, month: small(month), day: small(day) }
    }

    fn civil(self) -> Option<civil::Date> {
        let [month, day] = [self.month, self.day].map(|number| i8::try_from(number).ok());
        civil::Date::new(i16::try_from(self.year).ok()?, month?, day?).ok()
    }

    /// Days from an earlier day to this one; none where one of them is not in the calendar.
    pub(crate) fn days_since(self, earlier: Self) -> Option<i32> {
        Some((self.civil()? - earlier.civil()?).get_days())
    }

    /// The same in years.
    pub(crate) fn years_since(self, earlier: Self) -> Option<f64> {
        Some(f64::from(self.days_since(earlier)?) / DAYS_IN_YEAR)
    }
}

impl fmt::Display for Date {
    /// ISO 8601.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:04}-{:02}-{:02}", self.year, self.month, self.day)
    }
}

impl JsonSchema for Date {
    fn schema_name() -> Cow<'static, str> {
        "Date".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "description": "A day such as 2026-10-05.", "type": "string", "format": "date" })
    }
}

impl Serialize for Date {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Date {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let stamp = toml::value::Datetime::deserialize(deserializer)?;
        Self::of(stamp).ok_or_else(|| de::Error::custom(format!("{stamp} is no day, expected one such as 2026-10-05")))
    }
}

/// A text that is not a day.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("expected a day such as 2026-10-05")]
pub struct NotADay;

impl FromStr for Date {
    type Err = NotADay;

    /// A day of ISO 8601, or the day of a time there.
    fn from_str(text: &str) -> Result<Self, NotADay> {
        let stamp = text.trim().parse::<toml::value::Datetime>().map_err(|_| NotADay)?;
        Self::of(toml::value::Datetime { time: None, ..stamp }).ok_or(NotADay)
    }
}
