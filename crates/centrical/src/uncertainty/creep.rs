//! Creep: readings that still change after the unit was turned, by the material, slow damping, a temperature that follows the attitude.
//!
//! It leaves slopes in rests in proportion to the change `x` of the reading before each, along the force:
//!
//! `s_n = n_n^T b + c x_n + noise`, `x_n = n_n^T (m_n - m_{n-1})`,
//!
//! with the direction `n` of the force, the mean `m` of a rest, and a drift `b` of the biases. Across the force a slope is one of the attitude.

use nalgebra::{DMatrix, DVector, Vector3};

use super::drift::Slope;
use crate::statistics::{Test, f_tail};

/// A drift of three biases, and the creep.
const TERMS: usize = 4;

/// A column shorter than this part of what it was is a combination of those before it.
const DEPENDENT: f64 = 1e-3;

impl Slope {
    /// Creep of rests that follow another one in their record, from slope [m/s^3], mean reading and its change since the previous rest [m/s^2].
    ///
    /// Returns creep, its standard uncertainty [1/s] and its F test. Creep is slope over change, positive if the reading continues in the
    /// direction of the change. Its uncertainty follows from the noise within rests or the scatter of the slopes, whichever is larger. `None` if
    /// the rests are too few, or drift and creep cannot be separated.
    pub fn creep(rests: &[(Slope, Vector3<f64>, Vector3<f64>)]) -> Option<([f64; 2], Test)> {
        let degrees_of_freedom = rests.len().checked_sub(TERMS).filter(|count| *count > 0)?;
        let mut design = DMatrix::zeros(rests.len(), TERMS);
        let mut slopes = DVector::zeros(rests.len());
        for (n, (slope, mean, change)) in rests.iter().enumerate() {
            let along = mean.normalize();
            let [size, u] = slope.in_direction(&along);
            let row = [along.x, along.y, along.z, along.dot(change)].map(|value| value / u);
            design.row_mut(n).copy_from_slice(&row);
            slopes[n] = size / u;
        }
        let whole = design.column(TERMS - 1).norm();
        let factor = design.qr();
        let of_rate = factor.r()[(TERMS - 1, TERMS - 1)];
        factor.q_tr_mul(&mut slopes);
        let remaining: f64 = slopes.rows_range(TERMS..).norm_squared();
        let scatter = (remaining / degrees_of_freedom as f64).max(1.0);
        let along_rate = slopes[TERMS - 1];
        let is_seen = along_rate.is_finite() && of_rate.abs() > DEPENDENT * whole;
        let statistic = along_rate * along_rate / scatter;
        let probability = f_tail(statistic, 1.0, degrees_of_freedom as f64);
        let test = Test { statistic, degrees_of_freedom: 1, probability };
        is_seen.then(|| ([along_rate / of_rate, scatter.sqrt() / of_rate.abs()], test))
    }
}
