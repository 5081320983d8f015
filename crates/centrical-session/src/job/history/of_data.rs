//! What the data of a session say by themselves, where parameters of the unit had priors.
//!
//! A prior draws every session towards the same mean `m`: of a change of the unit between sessions an estimate `x` shows a part alone, and
//! the error of the prior is the same in all of them. Let `A` be the changes of the estimates by each of `q` priors at one standard
//! uncertainty `u`, and `A_q` its rows of the parameters with priors. Then `kappa = U^-1 A_q` is the part of the information that comes
//! from priors, and
//!
//! `x_d = x + A (1 - kappa)^-1 U^-1 (x_q - m)`
//!
//! is the estimate by the data alone. Its covariance is `T (C - A A^T) T^T` with `T = 1 + A (1 - kappa)^-1 U^-1 E_q`: the priors are weighted
//! equations of the fit, which this takes out again.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use crate::store::{Row, SharedInfluence, packed};

/// Estimates by the data alone. Combinations that priors alone determine stay as they are; the error of the priors in them is shared.
#[derive(Debug, Clone)]
pub struct OfData {
    /// Estimates, SI; NaN where they are not determined even with priors.
    pub values: Vec<f64>,
    /// Their combined covariance, the lower triangle by rows.
    pub covariance: Vec<f64>,
    /// What sessions share, the errors of such priors too.
    pub shared: Vec<SharedInfluence>,
    /// Parameters that rest on priors.
    pub rests_on_priors: Vec<bool>,
}

/// Name of the shared error of priors that no data correct.
pub const PRIORS: &str = "priors";

/// A combination rests on priors if the data have less than this part of its information.
const LEAST: f64 = 1e-6;

/// A parameter rests on priors if they leave more than this part of its variance in combinations that do.
const NEGLIGIBLE: f64 = 1e-6;

impl OfData {
    /// Takes the priors out of a row that was read whole; `None` if it has none.
    pub fn of(row: &Row) -> Option<Self> {
        let determined: Vec<usize> = (0..row.values.len()).filter(|&j| row.values[j].is_finite()).collect();
        let place = |name: &str| determined.iter().position(|&j| row.parameters[j] == name);
        let priors: Vec<_> = row.priors.iter().filter_map(|prior| Some((place(&prior.parameter)?, prior))).collect();
        let n = determined.len();
        if priors.is_empty() || row.covariance.is_empty() {
            return None;
        }
        let take = |changes: &[f64]| DVector::from_fn(n, |i, _| changes[determined[i]]);
        let by_priors: Vec<DVector<f64>> = priors.iter().map(|(_, prior)| take(&prior.changes)).collect();
        let a = DMatrix::from_columns(&by_priors);
        let missed = DVector::from_fn(priors.len(), |k, _| {
            let (at, prior) = priors[k];
            (row.values[determined[at]] - prior.mean) / prior.standard_uncertainty
        });
        let by_prior = DMatrix::from_fn(priors.len(), n, |k, i| {
            if priors[k].0 == i { 1.0 / priors[k].1.standard_uncertainty } else { 0.0 }
        });
        let Split { kept, lost } = Split::of(&(&by_prior * &a));
        let values = take(&row.values) + &a * &kept * missed;
        let taken_out = DMatrix::identity(n, n) + &a * &kept * &by_prior;
        let shared: Vec<DVector<f64>> = row.shared.iter().map(|influence| take(&influence.changes)).collect();
        let covariance =
            DMatrix::from_fn(n, n, |i, j| row.covariance_of(determined[i], determined[j]).unwrap_or(f64::NAN));
        let lost = &a * lost;
        let covariance =
            &taken_out * (&covariance - &a * a.transpose()) * taken_out.transpose() + &lost * lost.transpose();
        let rests = |i: usize| lost.row(i).norm_squared() > NEGLIGIBLE * covariance[(i, i)];
        let all = Scattered { determined: &determined, count: row.values.len() };
        let named = row.shared.iter().zip(&shared);
        let mut influences: Vec<SharedInfluence> = named
            .map(|(influence, changes)| SharedInfluence {
                source: influence.source.clone(),
                changes: all.list(&(&taken_out * changes)),
            })
            .collect();
        influences.extend(
            lost.column_iter()
                .map(|changes| SharedInfluence { source: PRIORS.to_owned(), changes: all.list(&changes.into_owned()) }),
        );
        let mut rests_on_priors = vec![false; row.values.len()];
        determined.iter().enumerate().for_each(|(i, &j)| rests_on_priors[j] = rests(i));
        Some(Self {
            values: all.list(&values),
            covariance: all.triangle(&covariance),
            shared: influences,
            rests_on_priors,
        })
    }
}

/// The combinations of priors: `(1 - kappa)^-1` of those to which the data add, and a basis of those to which they do not.
struct Split {
    kept: DMatrix<f64>,
    lost: DMatrix<f64>,
}

impl Split {
    fn of(kappa: &DMatrix<f64>) -> Self {
        let eigen = SymmetricEigen::new(0.5 * (kappa + kappa.transpose()));
        let of_data = eigen.eigenvalues.map(|of_priors| 1.0 - of_priors);
        let inverse = of_data.map(|part| if part > LEAST { 1.0 / part } else { 0.0 });
        let lost: Vec<usize> = (0..of_data.len()).filter(|&k| of_data[k] <= LEAST).collect();
        Self {
            kept: &eigen.eigenvectors * DMatrix::from_diagonal(&inverse) * eigen.eigenvectors.transpose(),
            lost: eigen.eigenvectors.select_columns(&lost),
        }
    }
}

/// Numbers of the determined parameters among all.
struct Scattered<'a> {
    determined: &'a [usize],
    count: usize,
}

impl Scattered<'_> {
    fn list(&self, values: &DVector<f64>) -> Vec<f64> {
        let mut list = vec![f64::NAN; self.count];
        for (value, &j) in values.iter().zip(self.determined) {
            list[j] = *value;
        }
        list
    }

    fn triangle(&self, matrix: &DMatrix<f64>) -> Vec<f64> {
        let mut triangle = vec![f64::NAN; self.count * (self.count + 1) / 2];
        for (a, &i) in self.determined.iter().enumerate() {
            for (b, &j) in self.determined.iter().enumerate().take(a + 1) {
                triangle[packed(i, j)] = matrix[(a, b)];
            }
        }
        triangle
    }
}
