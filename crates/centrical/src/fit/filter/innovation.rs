//! Testing a plateau as it comes: does it read what the plateaus before it predict?
//!
//! Taking up three readings raises the least sum of squares by the normalised innovation squared, `v^T S^-1 v` with
//! `v` the innovation and `S` its covariance. Before everything is determined the readings partly serve to
//! determine: then the rank rises, and only the other combinations of the three are predicted and can be tested. So
//!
//! `squared = min |[R; A] x - [b; misfit]|^2 - min |R x - b|^2`, `degrees of freedom = 3 - (rank [R; A] - rank R)`,
//!
//! distributed as chi^2. Summed over the plateaus these are the chi^2 and the degrees of freedom of the batch. Ranks
//! are those of [`crate::Observability`]: the same tolerance, the columns scaled by their lengths in all readings so far. Not in
//! `R` itself: a column that the retired states took up entirely is rounding, and has to stay small.

use nalgebra::{DMatrix, DVector, SVD};

use super::information::Filter;
use crate::model::FitError;
use crate::model::plateau::Readings;
use crate::observability::Observability;
use crate::statistics::Test;

impl Filter<'_> {
    /// Tests the plateau at `place` of the order against the plateaus before, without taking it up.
    ///
    /// # Errors
    /// As [`Filter::update`].
    pub fn innovation(&mut self, place: usize, readings: &Readings) -> Result<Test, FitError> {
        self.advance(place)?;
        let states = self.factor().states();
        let (mut rows, mut misfit) = (self.factor().triangle(), self.factor().right_side());
        let mut lengths = DVector::from_column_slice(self.lengths());
        let before = Unexplained::of(rows.clone(), &lengths, &misfit);
        rows = rows.resize_vertically(states + 3, 0.0);
        misfit = misfit.resize_vertically(states + 3, 0.0);
        for (column, derivative) in &readings.columns {
            let slot = self.slot(*column, place)?;
            rows.fixed_view_mut::<3, 1>(states, slot).copy_from(derivative);
            lengths[slot] += derivative.norm_squared();
        }
        misfit.fixed_rows_mut::<3>(states).copy_from(&readings.misfit);
        let after = Unexplained::of(rows, &lengths, &misfit);
        Ok(before.innovation(&after))
    }
}

/// Least sum of squares of equations, and their rank.
pub(in crate::fit) struct Unexplained {
    pub squared: f64,
    pub rank: usize,
}

impl Unexplained {
    /// What a plateau brings that takes the equations from `self` to `after`.
    pub fn innovation(&self, after: &Self) -> Test {
        let degrees_of_freedom = (self.rank + 3).saturating_sub(after.rank).min(3);
        let growth = (after.squared - self.squared).max(0.0);
        Test::chi_squared(if degrees_of_freedom > 0 { growth } else { 0.0 }, degrees_of_freedom)
    }

    fn of(mut rows: DMatrix<f64>, lengths: &DVector<f64>, misfit: &DVector<f64>) -> Self {
        let scaled = rows.column_iter_mut().zip(lengths.iter()).filter(|(_, length)| **length > 0.0);
        scaled.for_each(|(mut column, length)| column /= length.sqrt());
        let svd = SVD::new(rows, true, false);
        // A scaled design has its largest singular value at 1 or somewhat above; what the retired left may be less.
        let tolerance = Observability::RANK_TOLERANCE * svd.singular_values.max().max(1.0);
        let seen: Vec<usize> = (0..svd.singular_values.len()).filter(|&k| svd.singular_values[k] > tolerance).collect();
        let range = svd.u.unwrap_or_default().select_columns(&seen);
        let rest = misfit - &range * range.tr_mul(misfit);
        Self { squared: rest.norm_squared(), rank: seen.len() }
    }
}
