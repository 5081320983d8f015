//! Raw output and its nominal values, which the estimates of a calibration are relative to.
//!
//! With the nominal scale `k` and bias `b` a raw output `c` gives the reading `y = (c - b) / k`. Other nominal values `k'`, `b'` give
//! `y' = g y + h` with `g = k / k'`, `h = (b - b') / k'`. The error model `y = f + sum c_n m_n(f)` then has the coefficients `g c_n`, the bias
//! `g c + h`, and the scale error `g c + g - 1`.

use super::kinds::Role;
use crate::document::OutputSummary;
use crate::store::Row;

/// What other nominal values make of a coefficient `c`: `gain c + shift`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Restated {
    pub gain: f64,
    pub shift: f64,
}

impl OutputSummary {
    /// The nominal raw output of a row; `None` if its readings are in m/s^2, or of an older program.
    pub fn of_row(row: &Row) -> Option<Self> {
        let three = |list: &[f64]| <[f64; 3]>::try_from(list).ok();
        let is_raw = !row.output_unit.is_empty();
        let (scale, bias) = (three(&row.output_scale)?, three(&row.output_bias)?);
        is_raw.then(|| Self { unit: row.output_unit.clone(), scale, bias })
    }

    /// What a coefficient of `axis` becomes that is relative to these nominal values, relative to those of `other`.
    pub fn restated(&self, other: &Self, axis: usize, role: Role) -> Restated {
        let gain = self.scale[axis] / other.scale[axis];
        let shift = match role {
            Role::Bias => (self.bias[axis] - other.bias[axis]) / other.scale[axis],
            Role::Scale => gain - 1.0,
            Role::Other => 0.0,
        };
        Restated { gain, shift }
    }
}

/// Restates estimates.
pub fn in_values(values: &mut [f64], restated: &[Restated]) {
    values.iter_mut().zip(restated).for_each(|(value, Restated { gain, shift })| *value = gain * *value + shift);
}

/// Restates changes, or uncertainties.
pub fn in_changes(changes: &mut [f64], restated: &[Restated]) {
    changes.iter_mut().zip(restated).for_each(|(change, restated)| *change *= restated.gain);
}

/// Restates a covariance, the lower triangle by rows.
pub fn in_covariance(triangle: &mut [f64], restated: &[Restated]) {
    let pairs = restated.iter().enumerate().flat_map(|(i, a)| restated[..=i].iter().map(move |b| a.gain * b.gain));
    triangle.iter_mut().zip(pairs).for_each(|(covariance, gains)| *covariance *= gains);
}
