//! The noise terms of IEEE Std 952 and 1293, fitted to a record.

use std::f64::consts::{LN_2, PI};

use nalgebra::{DMatrix, DVector};

use super::error::NoiseError;
use super::estimator::Estimator;
use super::log_fit::LogFit;
use super::log_moments::MomentModel;
use super::phase::Phase;
use super::stochastic_terms::{STOCHASTIC, hadamard_shares};
use crate::progress::{OnProgress, Watch, advance};
use crate::statistics::chi_squared_tail;

/// A noise term: its two-sided spectrum and its share of the Allan variance.
///
/// | term | coefficient, unit for a newtonometer | spectrum | Allan variance |
/// |---|---|---|---|
/// | quantisation | Q, m/s | `tau0 Q^2 (2 pi f)^2` | `3 Q^2 / tau^2` |
/// | white (velocity random walk) | N, m/s/sqrt(s) | `N^2` | `N^2 / tau` |
/// | bias instability | B, m/s^2 | `B^2 / (2 pi f)` | `(2 ln 2 / pi) B^2` |
/// | random walk (acceleration random walk) | K, m/s^2/sqrt(s) | `K^2 / (2 pi f)^2` | `K^2 tau / 3` |
/// | ramp (drift) | R, m/s^3 | none | `R^2 tau^2 / 2` |
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum NoiseTerm {
    /// Quantisation Q of the integrated reading: white phase.
    Quantisation,
    /// White noise N of the reading.
    White,
    /// Bias instability B: flicker of the reading. The floor of the Allan deviation is `sqrt(2 ln 2 / pi) B`.
    BiasInstability,
    /// Random walk K of the reading.
    RandomWalk,
    /// Ramp R: steady drift of the reading.
    Ramp,
}

impl NoiseTerm {
    /// Every term, in the order of the slopes -1, -1/2, 0, 1/2, 1 of the Allan deviation.
    pub const ALL: [Self; 5] = [Self::Quantisation, Self::White, Self::BiasInstability, Self::RandomWalk, Self::Ramp];

    /// The source's letter.
    pub fn symbol(self) -> char {
        match self {
            Self::Quantisation => 'Q',
            Self::White => 'N',
            Self::BiasInstability => 'B',
            Self::RandomWalk => 'K',
            Self::Ramp => 'R',
        }
    }

    /// Its name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Quantisation => "quantisation",
            Self::White => "white noise",
            Self::BiasInstability => "bias instability",
            Self::RandomWalk => "random walk",
            Self::Ramp => "ramp",
        }
    }

    /// Allan variance at `tau` (s) of the term with this coefficient.
    pub fn allan_variance(self, coefficient: f64, tau: f64) -> f64 {
        let square = coefficient * coefficient;
        match self {
            Self::Quantisation => 3.0 * square / (tau * tau),
            Self::White => square / tau,
            Self::BiasInstability => 2.0 * LN_2 / PI * square,
            Self::RandomWalk => square * tau / 3.0,
            Self::Ramp => square * tau * tau / 2.0,
        }
    }
}

/// A coefficient as far as the record determines it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Coefficient {
    /// The record shows the term.
    Determined {
        /// Estimate; positive, but for the ramp, which has its sign.
        value: f64,
        /// Standard uncertainty.
        standard_uncertainty: f64,
    },
    /// The record is described as well without the term.
    NotDetermined {
        /// The size it may still have, at 95 % confidence.
        upper_bound: f64,
    },
}

/// The noise terms of a record.
#[derive(Debug, Clone, PartialEq)]
pub struct NoiseTerms {
    /// The coefficients, in the order of [`NoiseTerm::ALL`].
    pub coefficients: [Coefficient; 5],
    /// Averaging times the fit rests on, s.
    pub taus: Vec<f64>,
    /// Squared residuals of the logarithms of the variances, weighted by their inverse covariance.
    pub chi_squared: f64,
    /// Averaging times less terms present in the best fit. See [`NoiseTerms::is_consistent`].
    pub degrees_of_freedom: usize,
    /// Squared Q, N, B, K of the best fit, determined or not.
    best: [f64; STOCHASTIC],
}

impl NoiseTerms {
    /// The coefficient of a term.
    pub fn coefficient(&self, term: NoiseTerm) -> Coefficient {
        self.coefficients[term as usize]
    }

    /// Whether chi-squared is below the value that the terms alone stay below in 999 of 1000 records. If not, the record
    /// holds other noise (a line, a colour of its own), and neither coefficients nor uncertainties should be quoted as they are.
    pub fn is_consistent(&self) -> bool {
        self.degrees_of_freedom > 0 && chi_squared_tail(self.chi_squared, self.degrees_of_freedom) >= 1e-3
    }

    /// Whether nothing slower than white noise shows.
    pub(super) fn is_white(&self) -> bool {
        let slow = &self.coefficients[NoiseTerm::BiasInstability as usize..];
        self.is_consistent() && slow.iter().all(|term| matches!(term, Coefficient::NotDetermined { .. }))
    }

    /// Allan deviation at `tau` (s) of the best fit: a determined ramp, and the other terms at their most likely
    /// values even where the record cannot separate them.
    pub fn allan_deviation(&self, tau: f64) -> f64 {
        let stochastic =
            NoiseTerm::ALL.iter().zip(&self.best).map(|(term, square)| term.allan_variance(square.sqrt(), tau));
        let ramp = match self.coefficient(NoiseTerm::Ramp) {
            Coefficient::Determined { value, .. } => NoiseTerm::Ramp.allan_variance(value, tau),
            Coefficient::NotDetermined { .. } => 0.0,
        };
        (stochastic.sum::<f64>() + ramp).sqrt()
    }
}

impl NoiseTerms {
    /// Fits the noise terms to a record.
    ///
    /// Q, N, B, K come from the overlapping Hadamard variances at tau0, 2 tau0, 4 tau0, ... (the Allan variance would
    /// take a ramp for random walk): their logarithms are fitted by least squares with the full covariance that the
    /// fitted spectrum implies, the squared coefficients held non-negative. All four are always free, so the
    /// uncertainty of each allows for any of the others. A term is determined if a fit without it, the others free to
    /// take its place, costs 3^2 or more in chi-squared. For Gaussian residuals an absent term reaches that once in 700
    /// records. Otherwise its upper bound is where chi-squared has risen by 1.645^2.
    ///
    /// The ramp is the least-squares slope of the readings, with the uncertainty that the fitted noise gives a slope; it
    /// is determined if it exceeds three times what the other terms, undetermined ones at their upper bounds, explain. `progress` is asked
    /// again and again.
    ///
    /// # Errors
    /// [`NoiseError::TooShort`] below 512 readings, [`NoiseError::TooManyGaps`] if gaps leave variances at fewer than four
    /// averaging times, [`NoiseError::Constant`] if a variance vanishes, [`NoiseError::Indescribable`] if no sum of
    /// the terms comes near them; [`NoiseError::Stopped`].
    pub fn of(phase: &Phase, progress: OnProgress<()>) -> Result<NoiseTerms, NoiseError> {
        /// Three standard deviations, squared.
        const SHOWN: f64 = 9.0;
        let (fit, units) = prepare(phase, progress)?;
        let model = fit.best().ok_or(NoiseError::Indescribable)?;
        let deviations = fit.standard_deviations(&model).ok_or(NoiseError::Indescribable)?;
        let mut coefficients = [Coefficient::NotDetermined { upper_bound: f64::INFINITY }; 5];
        for k in 0..STOCHASTIC {
            advance(progress, ())?;
            let cost = fit.cost_of_absence(&model, k).ok_or(NoiseError::Indescribable)?;
            let unit = units[k].sqrt();
            coefficients[k] = if cost >= SHOWN {
                let value = model.theta[k].sqrt();
                Coefficient::Determined {
                    value: unit * value,
                    standard_uncertainty: unit * deviations[k] / (2.0 * value),
                }
            } else {
                Coefficient::NotDetermined { upper_bound: unit * fit.upper_bound(&model, k).sqrt() }
            };
        }
        let best = std::array::from_fn(|k| model.theta[k] * units[k]);
        coefficients[STOCHASTIC] = ramp(phase, &coefficients, &best);
        let present = model.theta.iter().filter(|theta| **theta > 0.0).count();
        Ok(NoiseTerms {
            coefficients,
            best,
            degrees_of_freedom: fit.factors.len().saturating_sub(present),
            taus: fit.factors.iter().map(|m| *m as f64 * phase.tau0()).collect(),
            chi_squared: model.chi_squared,
        })
    }
}

/// The Hadamard variances of the record, in units of the first of them and of tau0, and those units of the squared
/// Q, N, B, K: `s^2 (tau0^2, tau0, 1, 1 / tau0)`.
fn prepare(phase: &Phase, progress: OnProgress<()>) -> Result<(LogFit, [f64; STOCHASTIC]), NoiseError> {
    /// With fewer the white noise alone is said not to be seen in one record of four.
    const SHORTEST: usize = 512;
    /// Intervals the longest tau leaves: fewer and the third differences have hardly two degrees of freedom.
    const INTERVALS: usize = 5;
    let readings = phase.points().len() - 1;
    if readings < SHORTEST {
        return Err(NoiseError::TooShort { found: readings, expected: SHORTEST });
    }
    let watch = Watch::new(progress);
    let variances = phase
        .octaves(INTERVALS)
        .into_iter()
        .filter_map(|m| Some((m, Estimator::OverlappingHadamard.watched_variance(phase, m, &watch)?)));
    let variances: Vec<_> = watch.found(variances.collect())?;
    if variances.len() < STOCHASTIC {
        return Err(NoiseError::TooManyGaps { missing: phase.gaps().missing, readings });
    }
    if variances.iter().any(|(_, variance)| variance.value <= 0.0) {
        return Err(NoiseError::Constant);
    }
    let scale = variances[0].1.value;
    let shares: Vec<_> = variances.iter().map(|(m, _)| hadamard_shares(*m)).collect();
    let logarithms = variances.iter().map(|(_, variance)| (variance.value / scale).ln());
    let (factors, terms): (Vec<_>, Vec<_>) = variances.iter().map(|(m, variance)| (*m, variance.terms)).unzip();
    let fit = LogFit {
        logarithms: DVector::from_iterator(factors.len(), logarithms),
        shares: DMatrix::from_fn(factors.len(), STOCHASTIC, |j, k| shares[j][k]),
        moments: MomentModel::new(factors.clone(), terms),
        factors,
    };
    let tau0 = phase.tau0();
    Ok((fit, [scale * tau0 * tau0, scale * tau0, scale, scale / tau0]))
}

/// The least-squares slope of the readings.
///
/// Its variance over the record's length T is `72 Q^2/T^4 + 12 N^2/T^3 + 9 B^2/(pi T^2) + 6 K^2/(5 T)`: the double
/// integral of the weights `12 t / T^3` with each noise's generalised autocovariance.
fn ramp(phase: &Phase, stochastic: &[Coefficient; 5], best: &[f64; STOCHASTIC]) -> Coefficient {
    let variance = |squares: [f64; STOCHASTIC]| {
        let length = (phase.points().len() - 1) as f64 * phase.tau0();
        let shares = [72.0 / length.powi(4), 12.0 / length.powi(3), 9.0 / (PI * length * length), 1.2 / length];
        squares.iter().zip(shares).map(|(square, share)| square * share).sum::<f64>()
    };
    let at_most: [f64; STOCHASTIC] = std::array::from_fn(|k| match stochastic[k] {
        Coefficient::Determined { value, .. } => value * value,
        Coefficient::NotDetermined { upper_bound } => upper_bound * upper_bound,
    });
    let value = slope(phase);
    let cautious = variance(at_most).sqrt();
    if value.abs() > 3.0 * cautious {
        Coefficient::Determined { value, standard_uncertainty: variance(*best).sqrt() }
    } else {
        Coefficient::NotDetermined { upper_bound: value.abs() + 1.645 * cautious }
    }
}

/// Least-squares slope of the readings, from their phase: `sum t_k (x_(k+1) - x_k) / (tau0 sum t_k^2)`.
fn slope(phase: &Phase) -> f64 {
    let (x, tau0) = (phase.points(), phase.tau0());
    let n = (x.len() - 1) as f64;
    let moment: f64 = x.windows(2).enumerate().map(|(k, x)| (k as f64 - (n - 1.0) / 2.0) * (x[1] - x[0])).sum();
    moment / (tau0 * tau0 * n * (n * n - 1.0) / 12.0)
}
