//! What differs from rest to rest beyond the noise within rests: scatter of the readings, and drift of the biases.
//!
//! Noise that is slower than a rest does not show in it, nor does a bias that warms up. Both show in the residuals of many rests, which
//! then have the covariance
//!
//! `E + v B K B^T + w D D^T`, `K_ij = (u_i . u_j) exp(-|i - j| / l)`.
//!
//! A column of `B` is a unit reading along the specific force `u_i` of one rest. `K` is the correlation of these where the readings of each
//! newtonometer are correlated over `l` rests. Flicker noise does that, and the arcs of slow rotation, which follow one another without a pause. A
//! column of `D` is the bias of one newtonometer that changes by one unit from the first rest to the last. All are whitened by the noise within
//! rests, and freed of what the unknowns of the fit follow. The variances `v` and `w` are posterior means over all strengths and lengths: absence of
//! either is as likely beforehand as all its strengths together, and no strength or length is preferred (as for the noise within rests,
//! `reduction/colour/posterior.rs`). So the uncertainties include what the residuals cannot exclude, and grow little where an effect is absent.
//!
//! A fit takes scatter as independent. That which is correlated moves the coefficients farther, and counts as the independent one that would move
//! them as far. A bias is its mean over the rests, so that the mean of the scatter moves none.

use nalgebra::{DMatrix, DVector, Matrix3, SymmetricEigen, Vector3};

use super::rivals::Rivals;
use super::rivals::columns::Columns;
use crate::fit::Calibration;
use crate::model::{Course, Extension, FitError, Observation, Rival, TypeB};
use crate::progress::{OnProgress, advance};

/// Strengths per decade, over the mean variance of a rest, and from where on. Below the first no standard uncertainty changes by more
/// than half a percent; above the last no fit passes its chi^2.
const PER_DECADE: usize = 3;
const SMALLEST: f64 = 1e-2;
const DECADES: usize = 6;

/// Correlation lengths of scatter [rests]: none, and from two rests to the course of a drift.
const LENGTHS: [f64; 4] = [0.0, 2.0, 6.0, 18.0];

/// A variance with this number of degrees of freedom or fewer has no posterior mean: its factor is `nu / (nu - 2)`.
const FEWEST: f64 = 2.0;

/// The drift of the biases.
const DRIFT: Rival = Rival::Effect(Extension::Disturbance(Course::Time));

/// Standard deviations of what differs from rest to rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BetweenRests {
    /// Scatter of the reading of a rest beside its noise, as large as independent scatter that would do as much [m/s^2].
    pub scatter: f64,
    /// Change of each bias from the first rest to the last [m/s^2]; zero where the model has or states one.
    pub drift: f64,
}

impl BetweenRests {
    /// The covariance of a rest, with its scatter [m^2/s^4].
    #[must_use]
    pub fn scattered(&self, covariance: &Matrix3<f64>) -> Matrix3<f64> {
        covariance + Matrix3::from_diagonal_element(self.scatter * self.scatter)
    }

    /// What is stated, and the drift.
    #[must_use]
    pub fn stated_beside(&self, mut stated: TypeB) -> TypeB {
        let drift = Rival::COMMON.iter().zip(&mut stated.effects).filter(|(rival, _)| **rival == DRIFT);
        drift.filter(|_| self.drift > 0.0).for_each(|(_, bound)| *bound = self.drift);
        stated
    }
}

impl Calibration<'_> {
    /// What the residuals of a calibration by rests alone cannot exclude beside the noise within rests; `None` with an arm, and where
    /// two rests or fewer are redundant. `progress` is asked again and again.
    ///
    /// # Errors
    /// [`FitError`] when numbers overflow or the caller stops.
    pub fn between_rests(&self, progress: OnProgress<()>) -> Result<Option<BetweenRests>, FitError> {
        if self.data().model().experiment().has_arm() {
            return Ok(None);
        }
        let (rests, gain) = (self.data().observations(), self.gain()?);
        let scatter = Columns::along_forces(gain, rests);
        advance(progress, ())?;
        let redundancy = scatter.redundancy();
        advance(progress, ())?;
        if redundancy.trace() <= FEWEST {
            return Ok(None);
        }
        // Of a whitened column along the force the length is the inverse of the standard deviation.
        let variances = scatter.lengths.iter().map(|length| 1.0 / (length * length));
        let unit = (variances.sum::<f64>() / rests.len() as f64).sqrt();
        let rivals = Rivals::of(self, progress)?;
        let drift = rivals.get(DRIFT).map(|drift| &drift.columns);
        let moved = self.moved(&scatter)?;
        let mut scatters = Vec::with_capacity(LENGTHS.len());
        for length in LENGTHS {
            let correlation = correlation(rests.len(), length);
            let about_mean = if length > 0.0 { about_mean(&correlation) } else { correlation.clone() };
            let harm =
                (&moved * along_forces(rests, &about_mean)).dot(&moved) / moved.norm_squared().max(f64::MIN_POSITIVE);
            let residuals = Residuals::of(&scatter, &redundancy, along_forces(rests, &correlation), drift, unit);
            scatters.push(Correlated { residuals: residuals.ok_or(FitError::Overflow)?, harm });
            advance(progress, ())?;
        }
        let (scatter, drift) = posterior_mean(&scatters);
        Ok(Some(BetweenRests { scatter: unit * scatter.sqrt(), drift: unit * drift.sqrt() }))
    }

    /// How far each rest moves the coefficients of the unit, in their standard uncertainties, by a unit reading along its force.
    fn moved(&self, scatter: &Columns) -> Result<DMatrix<f64>, FitError> {
        let (fit, parameters) = (self.fit(), self.data().model().parameters());
        let shifts = self.gain()?.shifts(&scatter.followed);
        let u = |j: &usize| fit.standard_uncertainty(*j).filter(|u| parameters[*j].is_of_instrument() && *u > 0.0);
        let rows: Vec<(usize, f64)> = (0..parameters.len()).filter_map(|j| Some((j, u(&j)?))).collect();
        Ok(DMatrix::from_fn(rows.len(), scatter.lengths.len(), |i, n| {
            let (j, u) = rows[i];
            shifts[(j, n)] * scatter.lengths[n] / u
        }))
    }
}

/// Covariance of the readings along the forces when those of each newtonometer have the covariance `of_rests`.
fn along_forces(rests: &[Observation], of_rests: &DMatrix<f64>) -> DMatrix<f64> {
    let forces: Vec<Vector3<f64>> = rests.iter().map(|rest| rest.mean.normalize()).collect();
    DMatrix::from_fn(rests.len(), rests.len(), |i, j| {
        of_rests[(i, j)] * if i == j { 1.0 } else { forces[i].dot(&forces[j]) }
    })
}

/// Correlation of `count` rests over `length` of them.
fn correlation(count: usize, length: f64) -> DMatrix<f64> {
    DMatrix::from_fn(count, count, |i, j| if i == j { 1.0 } else { (-(i.abs_diff(j) as f64) / length).exp() })
}

/// The covariance of deviations from the mean of all rests. A bias is that mean.
fn about_mean(correlation: &DMatrix<f64>) -> DMatrix<f64> {
    let (of_row, all) = (correlation.row_mean(), correlation.mean());
    DMatrix::from_fn(correlation.nrows(), correlation.ncols(), |i, j| correlation[(i, j)] - of_row[i] - of_row[j] + all)
}

/// Scatter of one correlation length.
struct Correlated {
    residuals: Residuals,
    /// Variance of independent scatter that moves the coefficients as far, over its own.
    harm: f64,
}

/// The residuals as they answer to both effects, in the principal directions of the scatter.
struct Residuals {
    /// `B^T B` by its eigenvalues, and `B^T e`.
    scatter: (DVector<f64>, DVector<f64>),
    /// `B^T D`.
    across: DMatrix<f64>,
    /// `D^T D` and `D^T e`; zero unless drift is asked for.
    drift: (DMatrix<f64>, DVector<f64>),
    is_drift_asked: bool,
}

impl Residuals {
    /// Of effects of the size `unit`; `redundancy` is that of the scatter, and `correlation` that of its readings; `None` where that is
    /// not positive definite, as of numbers that are not finite.
    fn of(
        scatter: &Columns,
        redundancy: &DMatrix<f64>,
        correlation: DMatrix<f64>,
        drift: Option<&Columns>,
        unit: f64,
    ) -> Option<Self> {
        let sizes = |columns: &Columns| DMatrix::from_diagonal(&DVector::from_column_slice(&columns.lengths)) * unit;
        let of_scatter = correlation.cholesky()?.l().transpose() * sizes(scatter);
        let eigen = SymmetricEigen::new(&of_scatter * redundancy * of_scatter.transpose());
        let turned = eigen.eigenvectors.transpose() * of_scatter;
        let count = scatter.lengths.len();
        let (across, of_drift) = match drift {
            Some(drift) => {
                let size = sizes(drift);
                let across = &turned * scatter.redundancy_with(drift) * &size;
                (across, (&size * drift.redundancy() * &size, &size * &drift.along))
            }
            None => (DMatrix::zeros(count, 3), (DMatrix::zeros(3, 3), DVector::zeros(3))),
        };
        // Rounding leaves eigenvalues of zero a sign.
        let values = eigen.eigenvalues.map(|value| value.max(0.0));
        let scatter = (values, turned * &scatter.along);
        Some(Self { scatter, across, drift: of_drift, is_drift_asked: drift.is_some() })
    }

    /// Logarithm of the likelihood of the residuals, less that without either: by `(E + v B B^T)^-1 = E - v B (E + v B^T B)^-1 B^T`
    /// and the same for the drift.
    fn log_likelihood(&self, v: f64, w: f64) -> f64 {
        let (values, along) = &self.scatter;
        let shares = values.map(|value| v / (1.0 + v * value));
        let explained = shares.component_mul(along);
        let weighed = DMatrix::from_fn(self.across.nrows(), 3, |i, j| shares[i] * self.across[(i, j)]);
        let (square, product) = &self.drift;
        let square = DMatrix::identity(3, 3) + (square - self.across.tr_mul(&weighed)) * w;
        let product = product - self.across.tr_mul(&explained);
        let eigen = SymmetricEigen::new(square);
        // The identity and what is not negative: below one is rounding.
        let of_drift = eigen.eigenvalues.map(|value| value.max(1.0));
        let components = eigen.eigenvectors.tr_mul(&product);
        let of_scatter: f64 = values.iter().map(|value| (v * value).ln_1p()).sum();
        let squares = along.dot(&explained) + w * components.component_div(&of_drift).dot(&components);
        0.5 * (squares - of_scatter - of_drift.iter().map(|value| value.ln()).sum::<f64>())
    }
}

/// Posterior means of both variances, in units of that of a rest.
fn posterior_mean(scatters: &[Correlated]) -> (f64, f64) {
    let strengths = (0..=PER_DECADE * DECADES).map(|k| SMALLEST * 10_f64.powf(k as f64 / PER_DECADE as f64));
    let slab: Vec<f64> = strengths.collect();
    let none = &scatters[0].residuals;
    // Each strength has its share of what absence has, and of that of a scatter each length.
    let share = 1.0 / slab.len() as f64;
    let drifts = std::iter::once((0.0, 1.0)).chain(slab.iter().map(|w| (*w, share)));
    let mut points = Vec::new();
    for (w, prior) in drifts.filter(|(w, _)| *w == 0.0 || none.is_drift_asked) {
        points.push((0.0, w, prior, none.log_likelihood(0.0, w)));
        let prior = prior * share / scatters.len() as f64;
        for (Correlated { residuals, harm }, v) in
            scatters.iter().flat_map(|scatter| slab.iter().map(move |v| (scatter, v)))
        {
            points.push((v * harm, w, prior, residuals.log_likelihood(*v, w)));
        }
    }
    let highest = points.iter().map(|(.., logarithm)| *logarithm).fold(f64::NEG_INFINITY, f64::max);
    let (mut sum, mut scatter, mut drift) = (0.0, 0.0, 0.0);
    for (v, w, prior, logarithm) in points {
        let weight = prior * (logarithm - highest).exp();
        sum += weight;
        scatter += weight * v;
        drift += weight * w;
    }
    (scatter / sum, drift / sum)
}
