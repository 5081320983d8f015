//! Units counted from their middle, with the law that sound ones like them have.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::correlations::factors;
use super::scale::Counted;
use crate::statistics::Random;

/// What does not depend on the values of units.
#[derive(Debug, Clone)]
pub struct Known {
    /// Normal scores of as many units.
    pub normal_scores: Vec<f64>,
    /// Correlations `W_i` of the errors of each unit, `p x p`.
    pub errors: Vec<DMatrix<f64>>,
}

/// Units as they are beside each other.
#[derive(Debug, Clone)]
pub struct Described {
    /// `z_ij`, `n x p`.
    pub scores: DMatrix<f64>,
    /// Variances of the means by errors of sessions, `n x p`, as the scatter allows for them.
    pub variances: DMatrix<f64>,
    /// `D_ij`, `n x p`.
    deviations: DMatrix<f64>,
    /// Cholesky factors of `R_i`.
    factors: Vec<Cholesky<f64, Dyn>>,
}

impl Described {
    /// Units with `values` and the `variances` of their errors, `n x p`, and what is `known` of as many. `None` where a parameter does not vary.
    pub fn of(values: &DMatrix<f64>, variances: &DMatrix<f64>, known: &Known) -> Option<Self> {
        let mut described = Self {
            scores: values.clone(),
            variances: variances.clone(),
            deviations: values.clone(),
            factors: Vec::new(),
        };
        for j in 0..values.ncols() {
            let counted = Counted::of(values.column(j).as_slice(), variances.column(j).as_slice())?;
            described.scores.column_mut(j).copy_from_slice(&counted.scores);
            described.deviations.column_mut(j).copy_from_slice(&counted.deviations);
            described.variances.column_mut(j).scale_mut(counted.factor);
        }
        let part = |variance: f64, deviation: f64| (variance.sqrt() / deviation).min(1.0);
        let parts = described.variances.zip_map(&described.deviations, part);
        described.factors = factors(&described.scores, &known.normal_scores, &known.errors, &parts)?;
        Some(described)
    }

    /// `d_i^2`.
    pub fn squared_distances(&self) -> Option<Vec<f64>> {
        let by_unit = self.scores.transpose();
        let whitened = |(unit, scores): (usize, _)| self.factors[unit].l_dirty().solve_lower_triangular(&scores);
        by_unit.column_iter().enumerate().map(|unit| Some(whitened(unit)?.norm_squared())).collect()
    }

    /// Sound units with these deviations and correlations, `n x p`.
    pub fn drawn(&self, random: &mut Random) -> DMatrix<f64> {
        let (n, p) = self.scores.shape();
        let mut drawn = DMatrix::zeros(p, n);
        for (unit, mut drawn) in drawn.column_iter_mut().enumerate() {
            let mut normal = DVector::from_fn(p, |_, _| random.normal());
            // Row by row from the last: `L x` in the place of `x`.
            let lower = self.factors[unit].l_dirty();
            for j in (0..p).rev() {
                normal[j] = (0..=j).map(|k| lower[(j, k)] * normal[k]).sum();
            }
            drawn.copy_from(&normal);
        }
        drawn.transpose().component_mul(&self.deviations)
    }
}
