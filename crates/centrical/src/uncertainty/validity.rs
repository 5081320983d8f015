//! Whether a fit can be believed: chi^2, residuals and leverage of every plateau, outliers, and hold-out by mounting.
//!
//! Let `e` be the whitened residuals and `H = Q Q^T` the hat matrix; then `cov e = E - H`. For a block of readings, three
//! of a plateau or all of a mounting, `(E - H_bb)^-1 e_b` is what the others would predict less what was read, and
//!
//! `T = e_b^T (E - H_bb)^-1 e_b`
//!
//! is the fall of chi^2 when the block is left out: chi^2 of as many degrees of freedom as the block has redundant
//! readings. Divided by the remaining chi^2 it is an F statistic that does not depend on the scale of the weights.

use nalgebra::{DMatrix, DMatrixView, DVector, SymmetricEigen, Vector3};

use super::rivals::chance_of_explaining;
use crate::fit::{Calibration, Data};
use crate::model::{FitError, Observation};
use crate::progress::{OnProgress, advance, unwatched};
use crate::statistics::{Test, chi_squared_tail};

/// A share of a reading below this is rounding: the reading is not redundant, nothing checks it.
const REDUNDANT: f64 = 1e-8;

/// Redundant part of a reading, below which no other reading checks it: all residuals together show less than a tenth of its error.
const CHECKED: f64 = 0.01;

/// Part of the variance of a parameter that comes from such readings, above which nothing checks the parameter.
const MOSTLY: f64 = 0.5;

/// The checks of a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Validity {
    /// Probability that chi^2 is as large by chance.
    pub probability: f64,
    /// By observation.
    pub plateaus: Vec<PlateauCheck>,
    /// Each mounting that has observations, by its index, and the test of its prediction from the others, as for a plateau.
    pub mountings: Vec<(usize, Test)>,
    /// Mean score per reading when each mounting is predicted from all others: 1 and a little more for a true model, more for one that lacks
    /// a term or has too many.
    ///
    /// The score of a mounting is `-2 ln` of the density of the prediction at what was read, less that constant which all models share: sum over
    /// the readings of squared difference over variance plus `ln` of the variance, in units of the noise. The lower the better: predictions
    /// that are wrong cost, and those that say little.
    pub hold_out_score: f64,
}

/// The check of one plateau.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlateauCheck {
    /// Index of its set point.
    pub set_point: usize,
    /// Residuals over their standard deviations, by newtonometer; zero where nothing is redundant.
    pub standardised: Vector3<f64>,
    /// Part of its three readings that the fit follows, 0 to 1.
    pub leverage: f64,
    /// Test of its prediction from the others: fall of chi^2 without it, the readings of it that the others predict at all, and the probability
    /// by what is stated and by the scatter of the others.
    pub test: Test,
}

impl Calibration<'_> {
    /// The checks of the fit.
    ///
    /// # Errors
    /// [`FitError`] when numbers overflow.
    pub fn validity(&self) -> Result<Validity, FitError> {
        let gain = self.gain()?;
        let (fit, experiment) = (self.fit(), self.data().model().experiment());
        let observations = self.data().observations();
        let blocks = Blocks {
            residuals: gain.whitened_residuals().into_owned(),
            basis: gain.basis(),
            chi_squared: fit.chi_squared,
            degrees_of_freedom: fit.degrees_of_freedom,
        };
        let mounting_of = |n: usize| experiment.set_points[observations[n].set_point].mounting;
        let predicted = (0..experiment.mountings.len()).filter_map(|mounting| {
            let members: Vec<usize> = (0..observations.len()).filter(|&n| mounting_of(n) == mounting).collect();
            (!members.is_empty()).then(|| (mounting, blocks.predict(&members)))
        });
        let predicted: Vec<(usize, (Test, f64))> = predicted.collect();
        let score: f64 = predicted.iter().map(|(_, (_, score))| score).sum();
        Ok(Validity {
            probability: chi_squared_tail(fit.chi_squared, fit.degrees_of_freedom),
            plateaus: (0..observations.len()).map(|n| blocks.plateau(n, observations[n].set_point)).collect(),
            mountings: predicted.into_iter().map(|(mounting, (test, _))| (mounting, test)).collect(),
            hold_out_score: score / (3.0 * observations.len() as f64),
        })
    }

    /// Parameters of the instrument with more than half of their variance from readings which no other reading checks: errors of these
    /// readings move them and leave no residual.
    ///
    /// # Errors
    /// [`FitError`] when numbers overflow.
    pub fn unchecked(&self) -> Result<Vec<usize>, FitError> {
        let gain = self.gain()?;
        let (fit, parameters) = (self.fit(), self.data().model().parameters());
        let mut variances = vec![0.0; parameters.len()];
        for n in 0..self.data().observations().len() {
            let followed = followed_alone(gain.basis().rows(3 * n, 3));
            if followed.ncols() > 0 {
                let shifts = gain.shifts(&followed);
                variances.iter_mut().zip(shifts.row_iter()).for_each(|(sum, shift)| *sum += shift.norm_squared());
            }
        }
        let is_unchecked = |&j: &usize| {
            let u = fit.standard_uncertainty(j).filter(|_| parameters[j].is_of_instrument());
            u.is_some_and(|u| variances[j] > MOSTLY * u * u)
        };
        Ok((0..parameters.len()).filter(is_unchecked).collect())
    }

    /// chi^2 of a fit of the same data whose noise has `times` the variance. What is stated of attitudes and speeds stays.
    ///
    /// # Errors
    /// [`FitError`] when numbers overflow.
    pub fn chi_squared_of_noise(&self, times: f64) -> Result<f64, FitError> {
        let scaled = |o: &Observation| Observation { covariance: o.covariance * times, ..*o };
        let data = Data::new(self.data().model(), self.data().observations().iter().map(scaled).collect())?;
        Ok(Calibration::exact(&data)?.fit().chi_squared)
    }
}

impl Validity {
    /// The plateau that stands out most, if it does so at the family-wise error `alpha` over all plateaus (Bonferroni):
    /// its place among the observations.
    pub fn outlier(&self, alpha: f64) -> Option<usize> {
        let each = alpha / self.plateaus.len() as f64;
        let place = |a: &usize, b: &usize| {
            let p = |n: usize| self.plateaus[n].test.probability;
            p(*a).total_cmp(&p(*b))
        };
        (0..self.plateaus.len()).min_by(place).filter(|&n| self.plateaus[n].test.probability < each)
    }
}

impl Data<'_> {
    /// Fits, leaves out the plateau that stands out most at the family-wise error `alpha`, and fits again, until none does.
    /// Never more than a tenth of the plateaus: beyond that it is not plateaus that are wrong. The data that remain, and the set points left
    /// out, the most outlying first, each with its probability at the time.
    ///
    /// # Errors
    /// [`FitError`] when numbers overflow.
    pub fn without_outliers(&self, alpha: f64) -> Result<(Self, Vec<(usize, f64)>), FitError> {
        self.without_most_outlying(alpha, self.observations().len(), &unwatched)
    }

    /// The same with no more than `most` left out. `progress` is asked before each fit.
    ///
    /// # Errors
    /// As [`Data::without_outliers`]; [`FitError::Stopped`].
    pub fn without_most_outlying(
        &self,
        alpha: f64,
        most: usize,
        progress: OnProgress<()>,
    ) -> Result<(Self, Vec<(usize, f64)>), FitError> {
        let mut data = self.clone();
        let mut left_out = Vec::new();
        let most = most.min(data.observations().len() / 10);
        loop {
            advance(progress, ())?;
            let validity = Calibration::exact(&data)?.validity()?;
            let Some(n) = validity.outlier(alpha).filter(|_| left_out.len() < most) else {
                return Ok((data, left_out));
            };
            left_out.push((validity.plateaus[n].set_point, validity.plateaus[n].test.probability));
            data = data.without(n)?;
        }
    }
}

/// Whitened residuals, and the basis whose products are the hat matrix.
struct Blocks<'g> {
    residuals: DVector<f64>,
    basis: &'g DMatrix<f64>,
    chi_squared: f64,
    degrees_of_freedom: usize,
}

impl Blocks<'_> {
    fn plateau(&self, n: usize, set_point: usize) -> PlateauCheck {
        let hat = |i: usize| self.basis.row(3 * n + i).norm_squared();
        let standardised = Vector3::from_fn(|i, _| {
            let free = 1.0 - hat(i);
            if free > REDUNDANT { self.residuals[3 * n + i] / free.sqrt() } else { 0.0 }
        });
        let leverage = (0..3).map(hat).sum::<f64>() / 3.0;
        PlateauCheck { set_point, standardised, leverage, test: self.predict(&[n]).0 }
    }

    /// Test and score of the readings of the observations `members`, as the others predict them, along the principal directions of
    /// `E - H_bb`; those in which nothing is redundant are left out.
    fn predict(&self, members: &[usize]) -> (Test, f64) {
        let rows: Vec<usize> = members.iter().flat_map(|n| 3 * n..3 * n + 3).collect();
        let residuals = DVector::from_fn(rows.len(), |a, _| self.residuals[rows[a]]);
        let Principal { components, shares, beyond } = Principal::of(&self.basis.select_rows(&rows), &residuals);
        // Directions that the fit does not follow at all are redundant as a whole.
        let mut statistic = beyond;
        let mut degrees_of_freedom = rows.len() - shares.len();
        let mut score = 0.0;
        for (component, share) in components.iter().zip(shares) {
            if share > REDUNDANT {
                statistic += component * component / share;
                degrees_of_freedom += 1;
            }
            // Not predicted at all costs as much as predicted ten thousand times worse than read.
            score -= share.max(REDUNDANT).ln();
        }
        score += statistic;
        let left = self.degrees_of_freedom.saturating_sub(degrees_of_freedom);
        let probability = chance_of_explaining(statistic, degrees_of_freedom, self.chi_squared - statistic, left);
        (Test { statistic, degrees_of_freedom, probability }, score)
    }
}

/// `Q_b^T v` of the directions `v` of an observation's readings, with these rows of the basis, in which no other reading checks them.
fn followed_alone(rows: DMatrixView<f64>) -> DMatrix<f64> {
    let eigen = SymmetricEigen::new(DMatrix::identity(3, 3) - rows * rows.transpose());
    let unchecked: Vec<usize> = (0..3).filter(|i| eigen.eigenvalues[*i] < CHECKED).collect();
    rows.transpose() * eigen.eigenvectors.select_columns(&unchecked)
}

/// The principal directions of `E - H_bb = E - Q_b Q_b^T` of a block.
struct Principal {
    /// Of the residuals along the directions that the fit follows at least in part.
    components: DVector<f64>,
    /// Part of each that is redundant.
    shares: Vec<f64>,
    /// Sum of squares of the residuals in all other directions.
    beyond: f64,
}

impl Principal {
    /// Of a block with the rows `q` of the basis: by the eigenvectors of `E - Q_b Q_b^T` where it has fewer rows than there are
    /// unknowns, else by the left singular vectors of `Q_b`, in time linear in the rows.
    fn of(q: &DMatrix<f64>, residuals: &DVector<f64>) -> Self {
        if q.nrows() <= q.ncols() {
            let eigen = SymmetricEigen::new(DMatrix::identity(q.nrows(), q.nrows()) - q * q.transpose());
            let components = eigen.eigenvectors.transpose() * residuals;
            return Self { components, shares: eigen.eigenvalues.as_slice().to_vec(), beyond: 0.0 };
        }
        let svd = q.clone().svd(true, false);
        let components = svd.u.map_or_else(|| DVector::zeros(q.ncols()), |u| u.tr_mul(residuals));
        let beyond = (residuals.norm_squared() - components.norm_squared()).max(0.0);
        Self { components, shares: svd.singular_values.iter().map(|s| 1.0 - s * s).collect(), beyond }
    }
}
