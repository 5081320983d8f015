//! What rows scatter by beside their errors: centre and covariance, hardly moved by a few rows that are far off.
//!
//! First by ranks: each parameter counted from its median in its own deviations gives normal scores, which bound what one row can do. Rows
//! that are then farther off than the farthest of as many normal ones, at a level of 5 %, are left out, and the others give the means. A row has
//! the weight `1 / g_i^2`, where `g_i` is its variance over that of the mean row, averaged over the parameters.

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

use super::between::between;
use super::rows::Rows;
use super::scale::Counted;
use crate::uncertainty::Level;

/// What does not depend on the values of rows.
#[derive(Debug, Clone)]
pub struct Known {
    /// Blom's normal scores, of unit mean square.
    normal_scores: Vec<f64>,
    /// The squared distance of the farthest of as many normal rows, at 5 %.
    pub farthest: f64,
}

/// What rows `x_i ~ N(m, B + V_i)` have in common.
#[derive(Debug, Clone)]
pub struct Component {
    /// `m`.
    pub centre: DVector<f64>,
    /// `B`.
    pub between: DMatrix<f64>,
}

/// Probability of leaving out any of sound rows.
const LEVEL: f64 = Level::Reported.probability();

impl Known {
    /// Of `n` rows of `p` values; `None` if `p` is zero.
    pub fn of(n: usize, p: usize) -> Option<Self> {
        let normal = Normal::standard();
        let score = |rank: usize| normal.inverse_cdf((rank as f64 + 0.625) / (n as f64 + 0.25));
        let scores: Vec<f64> = (0..n).map(score).collect();
        let size = (scores.iter().map(|s| s * s).sum::<f64>() / n as f64).sqrt();
        let farthest = ChiSquared::new(p as f64).ok()?.inverse_cdf(1.0 - LEVEL / n as f64);
        Some(Self { normal_scores: scores.into_iter().map(|score| score / size).collect(), farthest })
    }
}

impl Component {
    /// That of `rows`; `None` where a parameter does not vary.
    pub fn of(rows: &Rows, known: &Known) -> Option<Self> {
        let first = Self::by_ranks(rows, known)?;
        let squares = first.squared_distances(rows)?;
        let variances = first.variances(rows);
        let is_near = |square: f64| f64::from(u8::from(square <= known.farthest));
        let weights = |power: i32| -> Vec<f64> {
            sizes(&variances).iter().zip(&squares).map(|(size, square)| is_near(*square) / size.powi(power)).collect()
        };
        let of_mean = DVector::from_vec(weights(1));
        let centre = rows.values.tr_mul(&of_mean) / of_mean.sum();
        let mut residuals = rows.values.clone();
        residuals.row_iter_mut().for_each(|mut row| row -= centre.transpose());
        Self::by_residuals(rows, centre, residuals, &weights(2))
    }

    fn by_ranks(rows: &Rows, known: &Known) -> Option<Self> {
        let (n, p) = rows.values.shape();
        let (mut centre, mut variances) = (DVector::zeros(p), DMatrix::zeros(n, p));
        let mut residuals = DMatrix::zeros(n, p);
        for j in 0..p {
            let counted = Counted::of(rows.values.column(j).as_slice(), rows.variances.column(j).as_slice())?;
            centre[j] = counted.centre;
            let mut order: Vec<usize> = (0..n).collect();
            order.sort_by(|&a, &b| counted.scores[a].total_cmp(&counted.scores[b]));
            for (score, row) in known.normal_scores.iter().zip(order) {
                residuals[(row, j)] = score * counted.deviations[row];
                variances[(row, j)] = counted.deviations[row].powi(2);
            }
        }
        let weights: Vec<f64> = sizes(&variances).iter().map(|size| 1.0 / (size * size)).collect();
        Self::by_residuals(rows, centre, residuals, &weights)
    }

    fn by_residuals(rows: &Rows, centre: DVector<f64>, mut residuals: DMatrix<f64>, weights: &[f64]) -> Option<Self> {
        residuals.row_iter_mut().zip(weights).for_each(|(mut row, weight)| row *= weight.sqrt());
        let scatter = residuals.tr_mul(&residuals) / weights.iter().sum::<f64>();
        let between = between(&scatter, &rows.mean_errors(weights), rows.values.nrows())?;
        Some(Self { centre, between })
    }

    /// `d_i^2` of `rows`; `None` where a covariance is not positive definite.
    pub fn squared_distances(&self, rows: &Rows) -> Option<Vec<f64>> {
        rows.squared_distances(&self.centre, &self.between)
    }

    /// `(x_ij - m_j) / S_ijj^(1/2)`, `n x p`.
    pub fn scores(&self, rows: &Rows) -> DMatrix<f64> {
        let mut scores = rows.values.clone();
        scores.row_iter_mut().for_each(|mut row| row -= self.centre.transpose());
        scores.zip_map(&self.variances(rows), |residual, variance| residual / variance.sqrt())
    }

    /// `S_ijj`, `n x p`.
    fn variances(&self, rows: &Rows) -> DMatrix<f64> {
        let mut variances = rows.variances.clone();
        variances.row_iter_mut().for_each(|mut row| row += self.between.diagonal().transpose());
        variances
    }
}

/// `g_i`: the variances of each row over their means, averaged.
fn sizes(variances: &DMatrix<f64>) -> Vec<f64> {
    let p = variances.ncols();
    let inverse_means = DVector::from_iterator(p, variances.column_iter().map(|column| 1.0 / column.mean()));
    (variances * inverse_means / p as f64).as_slice().to_vec()
}
