//! The state of a filter as plain data, to be written down and gone on from.

use thiserror::Error;

use super::lives::Lives;

/// A filter's state between two plateaus. Its numbers have to be kept to the last bit for the rest of the run to be the
/// same; the shortest decimal form that reads back exactly does.
#[derive(Debug, Clone, PartialEq)]
pub struct Snapshot {
    /// Place in the order of the latest plateau.
    pub place: usize,
    /// Unknowns carried.
    pub carried: Vec<usize>,
    /// Squared length of the column of each of them in the readings so far.
    pub lengths: Vec<f64>,
    /// Rows of `[R b]`, each from its diagonal on.
    pub triangle: Vec<Vec<f64>>,
    /// Sum of squared whitened residuals.
    pub rest: f64,
    /// Sum of squared whitened readings of the model.
    pub magnitude: f64,
    /// Rows laid aside for retired states, oldest first.
    pub archive: Vec<Row>,
}

/// One whitened equation `sum coefficient x = misfit`.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Unknowns.
    pub columns: Vec<usize>,
    /// Their coefficients.
    pub coefficients: Vec<f64>,
    /// Right side.
    pub misfit: f64,
}

/// Why a snapshot cannot be gone on from.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum ResumeError {
    /// The order of plateaus is another one.
    #[error("state of the filter: found unknowns {found:?} at plateau {}, expected {expected:?}", place + 1)]
    Carried {
        /// Place in the order.
        place: usize,
        /// Unknowns of the snapshot.
        found: Vec<usize>,
        /// Unknowns that the order carries there.
        expected: Vec<usize>,
    },
    /// The rows are not those of a triangle, or name unknowns that there are not.
    #[error("state of the filter: found rows of other lengths, expected a triangle of its unknowns")]
    Shape,
    /// A number is none.
    #[error("state of the filter: found a number that is not finite, expected finite numbers")]
    NotFinite,
}

impl Snapshot {
    /// Whether it is a state of a filter with these lives.
    pub(super) fn check(&self, lives: &Lives) -> Result<(), ResumeError> {
        let expected = lives.carried(self.place);
        if self.carried != expected {
            return Err(ResumeError::Carried { place: self.place, found: self.carried.clone(), expected });
        }
        let whole = self.archive.iter().all(|row| {
            row.columns.len() == row.coefficients.len() && row.columns.iter().all(|&column| column < lives.unknowns())
        });
        if !whole || self.triangle.len() != expected.len() || self.lengths.len() != expected.len() {
            return Err(ResumeError::Shape);
        }
        let archived = self.archive.iter().flat_map(|row| row.coefficients.iter().chain([&row.misfit]));
        let proper = self.triangle.iter().flatten().chain(&self.lengths).chain([&self.rest, &self.magnitude]);
        let mut numbers = proper.chain(archived);
        if numbers.all(|number| number.is_finite()) { Ok(()) } else { Err(ResumeError::NotFinite) }
    }
}
