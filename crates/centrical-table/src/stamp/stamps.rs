//! Stamps of rows, as they were read: texts, or as binary formats count them, whole numbers of a unit of time.

use std::borrow::Cow;

use jiff::Timestamp;
use jiff::tz::Offset;

use super::written::nanoseconds;

/// Stamps of rows as they were read, where the first field of a row is one.
#[derive(Debug, Clone)]
pub struct Stamps(Kept);

#[derive(Debug, Clone)]
enum Kept {
    /// As a text writes them: row, and end of its stamp in the text.
    Texts { text: Vec<u8>, ends: Vec<(u32, u32)> },
    /// As a binary format counts them: of every row.
    Ticks { form: TickForm, ticks: Vec<i64> },
}

impl Default for Stamps {
    /// No row has one.
    fn default() -> Self {
        Self(Kept::Texts { text: Vec::new(), ends: Vec::new() })
    }
}

impl Stamps {
    /// Stamps of all rows, counted so.
    pub(crate) fn counted(form: TickForm, ticks: Vec<i64>) -> Self {
        Self(Kept::Ticks { form, ticks })
    }

    /// Whether no row has one.
    pub fn is_empty(&self) -> bool {
        match &self.0 {
            Kept::Texts { ends, .. } => ends.is_empty(),
            Kept::Ticks { ticks, .. } => ticks.is_empty(),
        }
    }

    /// The stamp of a row as text, if it has one: as it was written, or in ISO 8601 with all decimals of its unit.
    pub fn text(&self, row: usize) -> Option<Cow<'_, [u8]>> {
        match &self.0 {
            Kept::Texts { text, ends } => written(text, ends, row).map(Cow::Borrowed),
            Kept::Ticks { form, ticks } => Some(Cow::Owned(form.text(*ticks.get(row)?)?.into_bytes())),
        }
    }

    /// How the stamp of the first row can be counted; a text in nanoseconds. Nothing for a time of the day.
    pub(crate) fn form(&self) -> Option<TickForm> {
        match &self.0 {
            Kept::Texts { text, ends } => {
                let (_, has_offset) = nanoseconds(written(text, ends, 0)?)?;
                Some(TickForm { unit: TickUnit::Nanosecond, is_utc: has_offset })
            }
            Kept::Ticks { form, .. } => Some(*form),
        }
    }

    /// The stamp of a row, counted so, if that is how it can be counted.
    pub(crate) fn ticks(&self, row: usize, wanted: TickForm) -> Option<i64> {
        match &self.0 {
            Kept::Texts { text, ends } => {
                let (ticks, has_offset) = nanoseconds(written(text, ends, row)?)?;
                (wanted == TickForm { unit: TickUnit::Nanosecond, is_utc: has_offset }).then_some(ticks)
            }
            Kept::Ticks { form, ticks } => ticks.get(row).copied().filter(|_| *form == wanted),
        }
    }

    /// Those of the rows that are kept, in their order.
    #[must_use]
    pub fn of_rows(self, is_kept: &[bool]) -> Self {
        let rows = (0..is_kept.len()).filter(|row| is_kept[*row]);
        match &self.0 {
            Kept::Ticks { form, ticks } => {
                Self::counted(*form, rows.filter_map(|row| ticks.get(row).copied()).collect())
            }
            Kept::Texts { text, ends } => {
                let mut kept = Self::default();
                for (place, row) in rows.enumerate() {
                    if let Some(stamp) = written(text, ends, row) {
                        kept.push(place, stamp);
                    }
                }
                kept
            }
        }
    }

    /// Notes the text of a later row.
    pub(crate) fn push(&mut self, row: usize, stamp: &[u8]) {
        if let Kept::Texts { text, ends } = &mut self.0
            && let Ok(row) = u32::try_from(row)
            && let Ok(end) = u32::try_from(text.len() + stamp.len())
        {
            text.extend_from_slice(stamp);
            ends.push((row, end));
        }
    }
}

/// The text of a row, if it has one.
fn written<'a>(text: &'a [u8], ends: &[(u32, u32)], row: usize) -> Option<&'a [u8]> {
    let place = ends.binary_search_by_key(&row, |(row, _)| *row as usize).ok()?;
    let start = place.checked_sub(1).map_or(0, |before| ends[before].1);
    Some(&text[start as usize..ends[place].1 as usize])
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_become_texts_that_read_back() {
        use TickUnit::{Microsecond, Millisecond, Nanosecond, Second};
        for (unit, is_utc, ticks, text) in [
            (Second, true, 1_791_194_400, "2026-10-05T10:00:00Z"),
            (Second, false, -1, "1969-12-31T23:59:59"),
            (Millisecond, true, 1_791_194_400_250, "2026-10-05T10:00:00.250Z"),
            (Microsecond, false, -1, "1969-12-31T23:59:59.999999"),
            (Nanosecond, true, 1_791_194_400_000_000_001, "2026-10-05T10:00:00.000000001Z"),
            (Nanosecond, false, i64::MAX, "2262-04-11T23:47:16.854775807"),
            (Nanosecond, true, i64::MIN, "1677-09-21T00:12:43.145224192Z"),
        ] {
            let form = TickForm { unit, is_utc };
            assert_eq!(form.text(ticks).as_deref(), Some(text));
            assert_eq!(nanoseconds(text.as_bytes()), Some((ticks * unit.nanoseconds(), is_utc)));
            let stamps = Stamps::counted(form, vec![ticks]);
            assert_eq!((stamps.form(), stamps.ticks(0, form)), (Some(form), Some(ticks)));
        }
        assert_eq!(TickForm { unit: Second, is_utc: true }.text(i64::MAX), None);
        assert_eq!(TickForm { unit: Millisecond, is_utc: true }.text(i64::MIN), None);
    }

    #[test]
    fn texts_are_counted_in_nanoseconds() {
        let mut stamps = Stamps::default();
        for (row, text) in
            ["05.10.2026 10:00:00,0000000017", "2026-10-05T12:00:00+02:00", "10:00:00"].iter().enumerate()
        {
            stamps.push(row + row / 2, text.as_bytes());
        }
        let [civil, utc] = [false, true].map(|is_utc| TickForm { unit: TickUnit::Nanosecond, is_utc });
        assert_eq!(stamps.form(), Some(civil));
        assert_eq!(stamps.ticks(0, civil), Some(1_791_194_400_000_000_001));
        assert_eq!((stamps.ticks(1, civil), stamps.ticks(1, utc)), (None, Some(1_791_194_400_000_000_000)));
        assert_eq!((stamps.text(2), stamps.ticks(2, civil)), (None, None));
        assert_eq!((stamps.text(3).as_deref(), stamps.ticks(3, civil)), (Some(b"10:00:00".as_slice()), None));
    }
}
