//! The columns to read of a table, their rows, and what holds from one row to the next.

use std::fmt;

/// Numbers above this have no place in a record or a calibration: their squares, summed, would leave `f64`.
pub const LARGEST_NUMBER: f64 = 1e100;

/// How a column is found in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ColumnName {
    /// By its name in the header.
    Name(String),
    /// By its number from 1, for files without a header.
    Number(usize),
    /// Two columns of a text, of Parquet or of Arrow that make one stamp: of the date, and of the time of the day.
    DateAndTime(Box<[Self; 2]>),
    /// It is not in the file: the number of the row, from 0.
    Row,
}

/// A column to read.
#[derive(Debug, Clone)]
pub struct Field {
    /// How it is found.
    pub name: ColumnName,
    /// What its values are, for messages: "a number in m/s^2".
    pub expected: String,
    /// The rule that its values keep beyond being numbers.
    pub rule: Rule,
}

/// The rule that the values of a column keep beyond being numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// Nothing.
    Any,
    /// They never decrease; repeated values are allowed. With `stamps`, a stamp such as `2026-10-05T10:00:00.25`
    /// stands for its seconds since 1970.
    Ascending {
        /// Whether stamps are allowed beside numbers.
        stamps: bool,
    },
    /// A value may be missing ([`is_missing`]), and is NaN then.
    OrMissing,
    /// Dates, as Parquet and Arrow count them.
    Date,
    /// Times of the day, as they count them.
    TimeOfDay,
}

/// How programs write a value that they lack, in small letters.
const MISSING: [&str; 12] =
    ["", "nan", "-nan", "nan(ind)", "-nan(ind)", "1.#qnan", "-1.#ind", "na", "n/a", "#n/a", "null", "none"];

/// Whether a field stands for a value that is missing: it is empty, or a word for no number, such as `NaN`, `null` or `#N/A`.
pub fn is_missing(field: &str) -> bool {
    MISSING.iter().any(|word| field.trim().eq_ignore_ascii_case(word))
}

impl Rule {
    pub(crate) fn ascends(self) -> bool {
        matches!(self, Self::Ascending { .. })
    }

    /// Whether plain numbers are asked for, or may be.
    pub(crate) fn takes_numbers(self) -> bool {
        !matches!(self, Self::Date | Self::TimeOfDay)
    }
}

/// Where a table begins in a text, where it is not to be recognised: lines of the file, counted from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct TableLines {
    /// The line with the names of the columns.
    pub header: Option<u64>,
    /// The first row.
    pub first_row: Option<u64>,
}

/// Units that a text names beside or below the names of its columns.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnitsFound {
    /// The line, counted from 1.
    pub line: u64,
    /// Of every field the unit, in the spelling of settings (`m/s^2`, `ms`, `V`), if it is understood.
    pub units: Vec<Option<&'static str>>,
}

impl fmt::Display for ColumnName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Name(name) => f.write_str(name),
            Self::Number(number) => write!(f, "column {number}"),
            Self::DateAndTime(parts) => write!(f, "{} and {}", parts[0], parts[1]),
            Self::Row => f.write_str("row"),
        }
    }
}

impl ColumnName {
    /// The column of dates, if there is one, and the column itself or that of the times of the day.
    pub(crate) fn date_and_column(&self) -> (Option<&Self>, &Self) {
        match self {
            Self::DateAndTime(parts) => (Some(&parts[0]), &parts[1]),
            own => (None, own),
        }
    }

    /// Whether it is found by a name in the header.
    pub(crate) fn is_named(&self) -> bool {
        let (date, own) = self.date_and_column();
        [date, Some(own)].into_iter().flatten().any(|column| matches!(column, Self::Name(_)))
    }
}

/// Rows read together from a binary table: long enough that their overhead vanishes, short enough for the cache.
pub(crate) const ROWS: usize = 16 * 1024;

/// Rows of a table: the values of each field, in columns of equal length.
pub type Rows = Vec<Vec<f64>>;

/// The rows before those that are read next.
#[derive(Debug)]
pub(crate) struct Before {
    /// How many there are.
    pub count: u64,
    /// Last value of every field, to see that time does not run backwards.
    pub last: Vec<f64>,
}

/// A value that runs backwards: which field, and the value before it.
pub(crate) struct Backwards {
    pub field: usize,
    pub value: f64,
    pub before: f64,
}

impl Backwards {
    /// What was found.
    pub fn found(&self) -> String {
        format!("{} after {}", self.value, self.before)
    }

    /// What is expected of a value, with the cause where clocks run backwards so. `is_of_day`: whether it stands for a time of the day.
    pub fn expected(&self, is_of_day: bool) -> String {
        const DAY: f64 = 86_400.0;
        const HOUR: f64 = 3600.0;
        /// Numbers at which clocks begin anew, in s or ms.
        const ENDS: [(f64, &str); 9] = [
            (65_536.0, "a counter of 16 bits"),
            (65.536, "a counter of 16 bits"),
            (4_294_967_296.0, "a counter of 32 bits"),
            (4_294_967.296, "a counter of 32 bits"),
            (4_294.967_296, "a counter of 32 bits"),
            (DAY, "a day"),
            (1e3 * DAY, "a day"),
            (7.0 * DAY, "a week"),
            (7e3 * DAY, "a week"),
        ];
        let &Self { value, before, .. } = self;
        if is_of_day && before < DAY && before - value > DAY / 2.0 {
            return ASCENDING_OVER_MIDNIGHT.to_owned();
        }
        // A thousandth about the end is there by chance once in a thousand clocks.
        let is_over = |end: f64| (0.0..end).contains(&value) && before < end && end - before + value < 1e-3 * end;
        match ENDS.into_iter().find(|(end, _)| is_over(*end)) {
            Some((end, what)) => format!("{ASCENDING}: {what} ends at {end}, add {end} to the times after it"),
            None if (HOUR - 60.0..=HOUR).contains(&(before - value)) => {
                format!(
                    "{ASCENDING}: after an hour that comes twice, as summer time ends, stamps need UTC or an offset"
                )
            }
            None => ASCENDING.to_owned(),
        }
    }
}

impl Before {
    /// No rows of that many fields.
    pub fn new(fields: usize) -> Self {
        Self { count: 0, last: vec![f64::NEG_INFINITY; fields] }
    }

    /// Counts the next rows, in which time does not run backwards, and sees that it did not before them.
    pub fn next(&mut self, rows: &Rows, fields: &[Field]) -> Option<Backwards> {
        for (field, column) in rows.iter().enumerate() {
            let (first, last) = (column.first()?, column.last()?);
            if *first < self.last[field] && fields[field].rule.ascends() {
                return Some(Backwards { field, value: *first, before: self.last[field] });
            }
            self.last[field] = *last;
        }
        self.count += rows[0].len() as u64;
        None
    }
}

/// The field that asks for the number of the row, which is not in the file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RowNumber(Option<usize>);

impl RowNumber {
    /// Takes that field out of the others.
    pub fn take_out(fields: &mut Vec<Field>) -> Self {
        let place = fields.iter().position(|field| field.name == ColumnName::Row);
        if let Some(place) = place {
            fields.remove(place);
        }
        Self(place)
    }

    /// Units of all fields from those of the fields in the file.
    pub fn in_all(self, mut found: UnitsFound) -> UnitsFound {
        if let Some(place) = self.0 {
            found.units.insert(place.min(found.units.len()), None);
        }
        found
    }

    /// Puts the numbers of the rows from `first` on into their place.
    pub fn put(self, first: u64, rows: &mut Rows) {
        if let Some(place) = self.0 {
            let numbers = first..first + rows[0].len() as u64;
            rows.insert(place, numbers.map(|number| number as f64).collect());
        }
    }

    /// Takes them out of rows that are to be filled again.
    pub fn remove(self, rows: &mut [Rows]) {
        if let Some(place) = self.0 {
            for rows in rows {
                drop(rows.remove(place));
            }
        }
    }
}

/// Whether any value is below the one before. All are looked at, several at a time.
pub(crate) fn runs_backwards(values: &[f64]) -> bool {
    values.windows(2).map(|pair| usize::from(pair[1] < pair[0])).sum::<usize>() > 0
}

/// What an ascending column should be.
const ASCENDING: &str = "a time that does not run backwards";

/// The same of a time of the day that ran over midnight.
const ASCENDING_OVER_MIDNIGHT: &str = "a time that does not run backwards: after midnight a time of the day needs a \
                                                  date, as in time = { date = \"Date\", column = \"Time\" } under [columns]";
