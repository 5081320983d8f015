//! Two columns of a record with the same readings: one newtonometer was written twice.

use std::path::Path;

use crate::error::{Error, Place};

/// Rows that two newtonometers with few digits may have in common from the start.
const FEW: usize = 100;

/// Pairs of newtonometers.
const PAIRS: [(usize, usize); 3] = [(0, 1), (0, 2), (1, 2)];

/// Which of the three readings have been equal in every row.
#[derive(Debug, Clone)]
pub(crate) struct EqualColumns {
    names: [String; 3],
    are_equal: [bool; 3],
    /// Whether a reading has changed: newtonometers that stand still are another mistake.
    varies: bool,
    first: Option<[u64; 3]>,
    rows: usize,
}

impl EqualColumns {
    /// Before the first row of the readings of these names.
    pub fn of(names: [String; 3]) -> Self {
        Self { names, are_equal: [true; 3], varies: false, first: None, rows: 0 }
    }

    /// Takes further rows in, as they are written or in SI by one scale.
    pub fn see(&mut self, f: [&[f64]; 3]) {
        if !self.are_equal.contains(&true) || f[0].is_empty() {
            return;
        }
        let first = *self.first.get_or_insert_with(|| f.map(|f| f[0].to_bits()));
        for (is_equal, (i, j)) in self.are_equal.iter_mut().zip(PAIRS) {
            *is_equal = *is_equal && f[i].iter().zip(f[j]).all(|(a, b)| a.to_bits() == b.to_bits());
        }
        let equal = PAIRS.iter().zip(self.are_equal).filter(|(_, is_equal)| *is_equal);
        for ((i, _), _) in equal {
            self.varies |= f[*i].iter().any(|reading| reading.to_bits() != first[*i]);
        }
        self.rows += f[0].len();
    }

    /// After the last row of `file`.
    ///
    /// # Errors
    /// If two columns are equal.
    pub fn refuse(&self, file: &Path) -> Result<(), Error> {
        let equal = PAIRS.iter().zip(self.are_equal).find(|(_, is_equal)| *is_equal);
        match equal {
            Some(((i, j), _)) if self.varies && self.rows >= FEW => {
                let (one, other) = (&self.names[*i], &self.names[*j]);
                let found = format!("the same readings in columns {one} and {other} in all {} rows", self.rows);
                Err(Error::content(file, Place::Whole, found, "a column of its own for each newtonometer"))
            }
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(f: [&[f64]; 3]) -> Option<String> {
        let mut equal = EqualColumns::of(["f1", "f2", "f3"].map(str::to_owned));
        for part in 0..2 {
            equal.see(f.map(|f| &f[part * f.len() / 2..(part + 1) * f.len() / 2]));
        }
        equal.refuse(Path::new("a.csv")).err().map(|error| error.to_string())
    }

    #[test]
    fn equal_columns_are_named() {
        let rising: Vec<f64> = (0..200).map(f64::from).collect();
        let falling: Vec<f64> = (0..200).map(|i| -f64::from(i)).collect();
        let still = vec![1.0; 200];
        let expected = "a.csv: found the same readings in columns f1 and f3 in all 200 rows, expected a column of its own for each newtonometer";
        assert_eq!(refused([&rising, &falling, &rising]).as_deref(), Some(expected));
        assert_eq!(refused([&rising, &falling, &still]), None);
        // Two that stand still, and few rows, say nothing.
        assert_eq!(refused([&still, &falling, &still]), None);
        assert_eq!(refused([&rising[..50], &rising[..50], &falling[..50]]), None);
        let mut late = rising.clone();
        late[199] = 0.5;
        assert_eq!(refused([&rising, &late, &falling]), None);
    }
}
