//! The budget: the uncertainty that each source of uncertainty leaves in each parameter.
//!
//! A source of uncertainty is a set of independent errors: of single plateaus, of priors, of influences. The gain of
//! the fit takes one standard uncertainty of each to the parameters. With these changes as the columns of `S`, the
//! source leaves the covariance `S S^T`. Sources add, and their sum is the covariance of the fit.

use nalgebra::{DMatrix, Vector3};

use super::coverage::Degrees;
use crate::fit::{Calibration, Fit, Gain};
use crate::model::plateau::noise_factor;
use crate::model::{FitError, MeasurementModel, Observation, Source};

/// A parameter is affected by the null space when that leaves more than this part of its variance.
const AFFECTED: f64 = 0.1;

/// What every source of uncertainty leaves in every parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Budget {
    contributions: Vec<Contribution>,
    estimable: Vec<bool>,
    covariance: DMatrix<f64>,
    /// Degrees of freedom of the residuals, where they scale type A.
    residual_scale: Option<usize>,
}

/// What one source of uncertainty leaves.
#[derive(Debug, Clone, PartialEq)]
pub struct Contribution {
    /// The source.
    pub source: Source,
    /// Degrees of freedom of its standard uncertainties.
    pub degrees: Degrees,
    /// Changes of the parameters by each of the source's influences at one standard uncertainty, `p x m`.
    changes: DMatrix<f64>,
}

/// What would be gained at least if a source were perfect: the fit would then weigh the data anew.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Improvement {
    /// The source.
    pub source: Source,
    /// Its mean share of the variance of the parameters considered, 0 to 1.
    pub share: f64,
    /// The combined uncertainties without it over those with it: their mean over the parameters considered.
    pub mean_factor: f64,
    /// The parameter that gains most.
    pub most: usize,
    /// Its combined uncertainty without the source over that with it.
    pub most_factor: f64,
}

impl Calibration<'_> {
    /// The budget of the estimates.
    ///
    /// # Errors
    /// [`FitError`] when numbers overflow.
    pub fn budget(&self) -> Result<Budget, FitError> {
        let (gain, model, observations) = (self.gain()?, self.data().model(), self.data().observations());
        let (stated, of_influences) = (model.stated(), gain.apply_influences());
        let of_type_b =
            if stated.doubt > 0.0 { Degrees::Finite(0.5 / (stated.doubt * stated.doubt)) } else { Degrees::Infinite };
        let mut contributions = Vec::new();
        // Curvature counts to what determines the estimates poorly.
        let of_curvature = if model.priors().is_empty() { Source::Noise } else { Source::Priors };
        for source in Source::ALL {
            let own = match source {
                Source::Noise => gain.apply(&noise(gain, observations)?),
                Source::PlateauSpeed => gain.apply(&settings(gain, model, observations, false)),
                Source::RestAngle => gain.apply(&settings(gain, model, observations, true)),
                Source::Resolution => gain.apply(&rounding(gain)),
                Source::Priors => gain.apply_priors(),
                Source::Gravity
                | Source::Latitude
                | Source::Radius
                | Source::RadiusDifference
                | Source::SpeedScale
                | Source::ProofMasses
                | Source::Attitude
                | Source::BiasChange
                | Source::Turning
                | Source::Effects => DMatrix::zeros(model.parameters().len(), 0),
            };
            let own = if source == of_curvature { side_by_side(&own, &self.fit().curved()) } else { own };
            let of_source = model.influences().iter().enumerate().filter(|(_, influence)| influence.source == source);
            let shared: Vec<usize> = of_source.map(|(n, _)| n).collect();
            let changes = side_by_side(&own, &of_influences.select_columns(&shared));
            // A resolution that the noise dithers is stated all the same: it contributes nothing.
            let is_dithered = source == Source::Resolution && stated.resolution > 0.0;
            if changes.ncols() > 0 || is_dithered {
                let degrees = if source.is_weighed() { Degrees::Infinite } else { of_type_b };
                contributions.push(Contribution { source, degrees, changes });
            }
        }
        let p = model.parameters().len();
        let covariance = total(&contributions, p);
        let estimable = (0..p).map(|j| self.fit().value(j).is_some()).collect();
        Ok(Budget { contributions, estimable, covariance, residual_scale: None })
    }
}

impl Budget {
    /// The budget with what the fit weighs, noise, speed of each plateau and priors, scaled by the residuals of `fit`: times
    /// `sqrt(chi^2 / nu)`, with `nu` degrees of freedom instead of infinitely many. For weights that are known up to a
    /// factor only. Unchanged if nothing is redundant.
    #[must_use]
    pub fn scaled_by_residuals(mut self, fit: &Fit) -> Self {
        if let Some(reduced) = fit.reduced_chi_squared().filter(|_| self.residual_scale.is_none()) {
            for contribution in &mut self.contributions {
                if contribution.source.is_weighed() {
                    contribution.changes *= reduced.sqrt();
                    contribution.degrees = Degrees::Finite(fit.degrees_of_freedom as f64);
                }
            }
            self.covariance = total(&self.contributions, self.estimable.len());
            self.residual_scale = Some(fit.degrees_of_freedom);
        }
        self
    }

    /// The sources that leave anything, in the order of [`Source::ALL`].
    pub fn contributions(&self) -> &[Contribution] {
        &self.contributions
    }

    /// Combined covariance of parameters `i` and `j`, if both are determined [product of their units].
    pub fn covariance(&self, i: usize, j: usize) -> Option<f64> {
        (self.estimable[i] && self.estimable[j]).then(|| self.covariance[(i, j)])
    }

    /// Combined standard uncertainty of parameter `j`, if it is determined [its unit].
    pub fn standard_uncertainty(&self, j: usize) -> Option<f64> {
        self.covariance(j, j).map(f64::sqrt)
    }

    /// Whether the null space leaves more doubt in parameter `j` than a tenth of the variance of all sources, which `fit` knows. Products of two
    /// unknowns let the lost combinations in, and only the hold keeps them ([`crate::Parameter::NULL_HOLD`] typical magnitudes), which is
    /// not a source of the budget. `fit` is the fit of this budget.
    pub fn is_affected_by_null_space(&self, fit: &Fit, j: usize) -> bool {
        let known: f64 = self.contributions.iter().map(|c| c.variance(j)).sum();
        fit.covariance(j, j).is_some_and(|all| all > (1.0 + AFFECTED) * known)
    }

    /// Correlation of the estimates of parameters `i` and `j`, if both are determined.
    pub fn correlation(&self, i: usize, j: usize) -> Option<f64> {
        let product = self.standard_uncertainty(i)? * self.standard_uncertainty(j)?;
        if i == j { Some(1.0) } else { Some(self.covariance(i, j)? / product) }
    }

    /// Effective degrees of freedom of the combined uncertainty of parameter `j` (Welch-Satterthwaite), if it is
    /// determined. What the fit weighs, noise, speed of each plateau and priors, is one contribution.
    pub fn degrees_of_freedom(&self, j: usize) -> Option<Degrees> {
        let weights: f64 = self.contributions.iter().filter(|c| c.source.is_weighed()).map(|c| c.variance(j)).sum();
        let of_residuals = self.residual_scale.map_or(Degrees::Infinite, |nu| Degrees::Finite(nu as f64));
        let others = self.contributions.iter().filter(|c| !c.source.is_weighed());
        let mut list = vec![(weights.sqrt(), of_residuals)];
        list.extend(others.map(|c| (c.standard_uncertainty(j), c.degrees)));
        self.estimable[j].then(|| Degrees::effective(&list))
    }

    /// What each source costs the `parameters` considered, the costliest first: which one to improve, and what it
    /// would bring at most.
    pub fn improvements(&self, parameters: &[usize]) -> Vec<Improvement> {
        let considered: Vec<usize> = parameters.iter().copied().filter(|&j| self.estimable[j]).collect();
        let mut list: Vec<Improvement> =
            self.contributions.iter().filter_map(|c| self.improvement(c, &considered)).collect();
        list.sort_by(|a, b| b.share.total_cmp(&a.share));
        list
    }

    fn improvement(&self, contribution: &Contribution, considered: &[usize]) -> Option<Improvement> {
        let share = |j: usize| (contribution.variance(j) / self.covariance[(j, j)]).min(1.0);
        let most = considered.iter().copied().max_by(|&a, &b| share(a).total_cmp(&share(b)))?;
        let mean = |f: &dyn Fn(usize) -> f64| considered.iter().map(|&j| f(j)).sum::<f64>() / considered.len() as f64;
        let factor = |j: usize| (1.0 - share(j)).sqrt();
        Some(Improvement {
            source: contribution.source,
            share: mean(&share),
            mean_factor: mean(&factor),
            most,
            most_factor: factor(most),
        })
    }
}

impl Contribution {
    /// Standard uncertainty that the source leaves in parameter `j` [its unit]; of no meaning if it is not determined.
    pub fn standard_uncertainty(&self, j: usize) -> f64 {
        self.variance(j).sqrt()
    }

    /// `S`: signed changes of the parameters by each independent influence of the source at one standard uncertainty, `p x m`
    /// [units of the parameters].
    pub fn changes(&self) -> &DMatrix<f64> {
        &self.changes
    }

    /// Covariance that the source leaves, `S S^T`.
    pub(crate) fn covariance(&self) -> DMatrix<f64> {
        &self.changes * self.changes.transpose()
    }

    fn variance(&self, j: usize) -> f64 {
        self.changes.row(j).norm_squared()
    }
}

fn total(contributions: &[Contribution], p: usize) -> DMatrix<f64> {
    contributions.iter().fold(DMatrix::zeros(p, p), |sum, c| sum + c.covariance())
}

/// Changes of single readings: index of the observation, and the change [m/s^2].
type Changes = Vec<(usize, Vector3<f64>)>;

/// The columns of the Cholesky factors of the covariances of the means.
fn noise(gain: &Gain, observations: &[Observation]) -> Result<Changes, FitError> {
    let mut changes = Vec::with_capacity(3 * observations.len());
    for (n, (observation, at)) in observations.iter().zip(gain.linearisations()).enumerate() {
        let factor = noise_factor(observation, at)?;
        changes.extend(factor.column_iter().map(|column| (n, column.into_owned())));
    }
    Ok(changes)
}

/// One standard uncertainty of the speed of each plateau, or of the angle of each at rest.
fn settings(gain: &Gain, model: &MeasurementModel, observations: &[Observation], at_rest: bool) -> Changes {
    let set_points = &model.experiment().set_points;
    (gain.linearisations().iter().zip(observations).enumerate())
        .filter(|(_, (at, o))| set_points[o.set_point].is_rest() == at_rest && at.setting_error != Vector3::zeros())
        .map(|(n, (at, _))| (n, at.setting_error))
        .collect()
}

/// One standard uncertainty of the rounding of each mean that is a plateau's own.
fn rounding(gain: &Gain) -> Changes {
    let rounded = gain.linearisations().iter().enumerate().filter(|(_, at)| at.rounding > 0.0);
    rounded.flat_map(|(n, at)| (0..3).map(move |axis| (n, Vector3::ith(axis, at.rounding)))).collect()
}

fn side_by_side(left: &DMatrix<f64>, right: &DMatrix<f64>) -> DMatrix<f64> {
    let mut both = left.clone().resize_horizontally(left.ncols() + right.ncols(), 0.0);
    both.columns_mut(left.ncols(), right.ncols()).copy_from(right);
    both
}
