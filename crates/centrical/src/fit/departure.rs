//! How far the model departs from its linearisation along given directions.

use std::cmp::Ordering;

use nalgebra::{DMatrix, DVector};

use super::data::Data;
use crate::model::plateau::Whitener;
use crate::model::{FitError, Linearisation};

/// A model that misses readings by less than this part of a standard uncertainty, all together, is linear.
const LINEAR: f64 = 0.1;

/// Whether the model at `X = 0`, which has these linearisations, misses readings over the length of that direction.
pub(super) fn departs(data: &Data, linearisations: &[Linearisation], x: &DVector<f64>) -> Result<bool, FitError> {
    let missed = missed(data, &DVector::zeros(x.len()), std::slice::from_ref(x));
    let length = whitened(data, linearisations, &missed[1..])?.norm();
    // Also where the length is NaN.
    Ok(!matches!(length.partial_cmp(&LINEAR), Some(Ordering::Less)))
}

/// Columns of `3 n` readings [m/s^2], counted in standard uncertainties.
pub(super) fn whitened(
    data: &Data,
    linearisations: &[Linearisation],
    columns: &[DVector<f64>],
) -> Result<DMatrix<f64>, FitError> {
    let mut whitened = DMatrix::zeros(3 * linearisations.len(), columns.len());
    for (n, (observation, at)) in data.observations().iter().zip(linearisations).enumerate() {
        let whitener = Whitener::new(observation, at)?;
        for (mut of_all, column) in whitened.column_iter_mut().zip(columns) {
            of_all.fixed_rows_mut::<3>(3 * n).copy_from(&whitener.apply(&column.fixed_rows::<3>(3 * n).into_owned()));
        }
    }
    Ok(whitened)
}

/// `sum_k e_k`, `sqrt(2) e_k` of every direction and `e_kl` of every two, `3 n` each [m/s^2].
pub(super) fn missed(data: &Data, x: &DVector<f64>, directions: &[DVector<f64>]) -> Vec<DVector<f64>> {
    let reading = |x: DVector<f64>| {
        let residuals = data.residuals(x.as_slice());
        -DVector::from_iterator(3 * residuals.len(), residuals.iter().flat_map(|r| r.iter().copied()))
    };
    let mut columns = Vec::new();
    let here = reading(x.clone());
    let mut mean = DVector::zeros(here.len());
    for (k, d) in directions.iter().enumerate() {
        let square = (reading(x + d) + reading(x - d)) * 0.5 - &here;
        mean += &square;
        columns.push(square * std::f64::consts::SQRT_2);
        for e in &directions[k + 1..] {
            let [sum, difference] = [d + e, d - e];
            let alike = reading(x + &sum) + reading(x - sum);
            let apart = reading(x + &difference) + reading(x - difference);
            columns.push((alike - apart) * 0.25);
        }
    }
    columns.push(mean);
    columns
}
