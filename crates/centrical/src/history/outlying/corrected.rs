//! The errors of sessions as neighbouring sessions show them.
//!
//! Session `t` states errors of covariance `C_t`; it has `f C_t + h_t T`, where `f <= 1` lowers what is stated too large, and `T` is what
//! sessions differ by beside it. `h_t` is 1, as of what a switch-on changes, or the size of stated errors, where they are too small by a factor:
//! the mean over the parameters of a variance over that of all sessions. The more likely of both is taken.

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::component::{Component, Known};
use super::rows::{Rows, add_scaled};
use super::sessions::UnitSessions;
use crate::history::together::SessionEstimates;
use crate::statistics::median;

/// Fewer differences say nothing.
const FEWEST_DIFFERENCES: usize = 10;

/// As many differences, evenly taken, know a variance to 2 %.
const MOST_DIFFERENCES: usize = 5000;

/// What differences of sessions correct.
#[derive(Debug, Clone)]
pub struct Corrected {
    /// `f`.
    factor: f64,
    /// `T`.
    beside: DMatrix<f64>,
    /// Mean variances of sessions, if `h_t` is the size of stated errors.
    mean_variances: Option<DVector<f64>>,
}

impl Corrected {
    /// By the `sessions` of units, of `p` values; as stated where there are too few, or they do not differ.
    pub fn of(sessions: &UnitSessions, p: usize) -> Self {
        let pairs_of = |(unit, count): (usize, &usize)| (1..*count).map(move |t| (unit, t));
        let all: Vec<(usize, usize)> = sessions.counts.iter().enumerate().flat_map(pairs_of).collect();
        let pairs: Vec<(usize, usize)> =
            all.iter().step_by(all.len().div_ceil(MOST_DIFFERENCES).max(1)).copied().collect();
        let as_stated = Self { factor: 1.0, beside: DMatrix::zeros(p, p), mean_variances: None };
        if pairs.len() < FEWEST_DIFFERENCES {
            return as_stated;
        }
        let differences = Differences { sessions, pairs: &pairs, p };
        let factor = differences.stated_too_large().unwrap_or(1.0);
        let with = |mean_variances| differences.corrected(Self { factor, mean_variances, ..as_stated.clone() });
        let found = [None, Some(differences.mean_variances())].map(with);
        let likely = found.into_iter().flatten().min_by(|a, b| a.1.total_cmp(&b.1));
        likely.map_or(as_stated, |(corrected, _)| corrected)
    }

    /// Adds the covariance of the errors of a session, times a weight, to a sum.
    pub fn add_errors(&self, session: &SessionEstimates, weight: f64, sum: &mut DMatrix<f64>) {
        add_scaled(&session.covariance, weight * self.factor, sum);
        add_scaled(&self.beside, weight * self.size(session), sum);
    }

    /// `h_t`.
    fn size(&self, session: &SessionEstimates) -> f64 {
        let of_mean = |means: &DVector<f64>| session.covariance.diagonal().component_div(means).mean();
        self.mean_variances.as_ref().map_or(1.0, of_mean)
    }
}

/// The differences of neighbouring sessions.
struct Differences<'a> {
    sessions: &'a UnitSessions<'a>,
    /// Units, and the numbers of the later sessions.
    pairs: &'a [(usize, usize)],
    p: usize,
}

impl Differences<'_> {
    fn of_pair(&self, pair: usize) -> [SessionEstimates; 2] {
        let (unit, t) = self.pairs[pair];
        [t - 1, t].map(|t| (self.sessions.session)(unit, t))
    }

    /// The differences over the roots of `sizes`, with `factor` times their stated errors.
    fn rows<R>(&self, factor: f64, sizes: &[f64], then: impl FnOnce(&Rows) -> R) -> R {
        let (mut values, mut variances) = (DMatrix::zeros(sizes.len(), self.p), DMatrix::zeros(sizes.len(), self.p));
        for (pair, size) in sizes.iter().enumerate() {
            let [before, after] = self.of_pair(pair);
            values.set_row(pair, &((after.values - before.values) / size.sqrt()).transpose());
            let variance = (after.covariance.diagonal() + before.covariance.diagonal()) * (factor / size);
            variances.set_row(pair, &variance.transpose());
        }
        let add_errors = |pair: usize, weight: f64, sum: &mut DMatrix<f64>| {
            for session in self.of_pair(pair) {
                add_scaled(&session.covariance, weight * factor / sizes[pair], sum);
            }
        };
        then(&Rows { values, variances, add_errors: &add_errors })
    }

    /// The median of `d_i^2` by stated errors alone over that of its law, if it is below 1.
    fn stated_too_large(&self) -> Option<f64> {
        let nothing = (DVector::zeros(self.p), DMatrix::zeros(self.p, self.p));
        let mut squares =
            self.rows(1.0, &vec![1.0; self.pairs.len()], |rows| rows.squared_distances(&nothing.0, &nothing.1))?;
        let ratio = median(&mut squares) / ChiSquared::new(self.p as f64).ok()?.inverse_cdf(0.5);
        (ratio > 0.0 && ratio < 1.0).then_some(ratio)
    }

    /// The stated variances of sessions in the mean over all pairs.
    fn mean_variances(&self) -> DVector<f64> {
        let variances = (0..self.pairs.len()).flat_map(|pair| self.of_pair(pair)).map(|s| s.covariance.diagonal());
        variances.sum::<DVector<f64>>() / (2 * self.pairs.len()) as f64
    }

    /// With `T`, and twice the negative logarithm of the likelihood, to which no difference adds more than the farthest of sound ones.
    fn corrected(&self, with: Corrected) -> Option<(Corrected, f64)> {
        let size = |pair| self.of_pair(pair).iter().map(|session| with.size(session)).sum();
        let sizes: Vec<f64> = (0..self.pairs.len()).map(size).collect();
        let known = Known::of(sizes.len(), self.p)?;
        let (found, terms) = self.rows(with.factor, &sizes, |rows| {
            let found = Component::of(rows, &known)?;
            let terms = rows.likelihoods(&found.centre, &found.between)?;
            Some((found, terms))
        })?;
        let of_scale: f64 = sizes.iter().map(|size| self.p as f64 * size.ln()).sum();
        let unlikely: f64 = terms.iter().map(|(square, log_det)| square.min(known.farthest) + log_det).sum();
        Some((Corrected { beside: found.between, ..with }, of_scale + unlikely))
    }
}
