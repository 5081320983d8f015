//! What differs from rest to rest beyond the noise within rests: scatter of the readings, and drift of the biases.
//!
//! Noise that is slower than a rest does not show in it, nor does a bias that warms up. Both show in the residuals of many rests, which
//! then have the covariance
//!
//! `E + v B B^T + w D D^T`.
//!
//! A column of `B` is a unit reading along the specific force of one rest. A column of `D` is the bias of one newtonometer that changes by
//! one unit from the first rest to the last. All are whitened by the noise within rests, and freed of what the unknowns
//! of the fit follow. The variances `v` and `w` are posterior means: absence of either is as likely beforehand as all its strengths
//! together, and no strength is preferred (as for the noise within rests, `reduction/colour/posterior.rs`). So the uncertainties
//! include what the residuals cannot exclude, and grow little where an effect is absent.

use nalgebra::{DMatrix, DVector, Matrix3, SymmetricEigen};

use super::rivals::Rivals;
use super::rivals::columns::Columns;
use crate::fit::Calibration;
use crate::model::{Course, Extension, FitError, Rival, TypeB};
use crate::progress::{OnProgress, advance};

/// Strengths per decade, over the mean variance of a rest, and from where on. Below the first no standard uncertainty changes by more
/// than half a percent; above the last no fit passes its chi^2.
const PER_DECADE: usize = 3;
const SMALLEST: f64 = 1e-2;
const DECADES: usize = 6;

/// A variance with this number of degrees of freedom or fewer has no posterior mean: its factor is `nu / (nu - 2)`.
const FEWEST: f64 = 2.0;

/// The drift of the biases.
const DRIFT: Rival = Rival::Effect(Extension::Disturbance(Course::Time));

/// Standard deviations of what differs from rest to rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BetweenRests {
    /// Scatter of the reading of a rest beside its noise [m/s^2].
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
        let residuals = Residuals::of(&scatter, &redundancy, drift, unit);
        advance(progress, ())?;
        let (scatter, drift) = residuals.posterior_mean();
        Ok(Some(BetweenRests { scatter: unit * scatter.sqrt(), drift: unit * drift.sqrt() }))
    }
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
    /// Of effects of the size `unit`; `redundancy` is that of the scatter.
    fn of(scatter: &Columns, redundancy: &DMatrix<f64>, drift: Option<&Columns>, unit: f64) -> Self {
        let sizes = |columns: &Columns| DMatrix::from_diagonal(&DVector::from_column_slice(&columns.lengths)) * unit;
        let of_scatter = sizes(scatter);
        let eigen = SymmetricEigen::new(&of_scatter * redundancy * &of_scatter);
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
        Self { scatter: (values, turned * &scatter.along), across, drift: of_drift, is_drift_asked: drift.is_some() }
    }

    /// Posterior means of both variances, in units of that of a rest.
    fn posterior_mean(&self) -> (f64, f64) {
        let strengths = (0..=PER_DECADE * DECADES).map(|k| SMALLEST * 10_f64.powf(k as f64 / PER_DECADE as f64));
        let slab: Vec<f64> = strengths.collect();
        // Each strength has its share of what absence has.
        let prior = |strength: f64| if strength > 0.0 { 1.0 / slab.len() as f64 } else { 1.0 };
        let all = || std::iter::once(0.0).chain(slab.iter().copied());
        let is_asked = |w: &f64| *w == 0.0 || self.is_drift_asked;
        let points: Vec<(f64, f64)> = all().flat_map(|v| all().filter(is_asked).map(move |w| (v, w))).collect();
        let logarithms: Vec<f64> = points.iter().map(|&(v, w)| self.log_likelihood(v, w)).collect();
        let highest = logarithms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let (mut sum, mut scatter, mut drift) = (0.0, 0.0, 0.0);
        for ((v, w), logarithm) in points.into_iter().zip(logarithms) {
            let weight = prior(v) * prior(w) * (logarithm - highest).exp();
            sum += weight;
            scatter += weight * v;
            drift += weight * w;
        }
        (scatter / sum, drift / sum)
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
