//! Rows of a table, and what holds from one to the next.

use crate::column::{ColumnName, Field, UnitsFound};

/// Rows read together from a binary table: long enough that their overhead vanishes, short enough for the cache.
pub(crate) const ROWS: usize = 16 * 1024;

/// Rows of a table: the values of each field, in columns of equal length.
pub type Rows = Vec<Vec<f64>>;

/// `(value - offset) factor` of each value of a column, in place.
pub fn to_scale(values: &mut [f64], offset: f64, factor: f64) {
    for value in values {
        *value = (*value - offset) * factor;
    }
}

/// The rows before those that are read next.
#[derive(Debug)]
pub(crate) struct Before {
    /// How many there are.
    pub count: u64,
    /// Last value of every field, to see that time does not run backwards.
    pub last: Vec<f64>,
}

/// A value that runs backwards: which field, and what was found.
pub(crate) struct Backwards {
    pub field: usize,
    pub found: String,
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
                return Some(Backwards { field, found: format!("{first} after {}", self.last[field]) });
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
pub(crate) const ASCENDING: &str = "a time that does not run backwards";
