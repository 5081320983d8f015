//! The budget: the uncertainty that each source leaves in each parameter.
//!
//! A source is a set of independent influences. The effect of each on the readings, for one standard uncertainty, is
//! half the difference of the exact model's readings with the quantity one standard uncertainty up and down (GUM,
//! 5.1.3, note 2); the gain of the fit takes it to the parameters. With these changes as the columns of `S`, the source
//! leaves the covariance `S S^T`, and sources add.

use nalgebra::DMatrix;

use super::coverage::{Degrees, effective_degrees_of_freedom};
use super::source::{Influence, Quantity, Source, TypeB, influences};
use crate::fit::{Calibration, Fit};
use crate::model::{FitError, MeasurementModel, Observation};

/// A parameter is affected by the null space when that leaves more than this part of its variance.
const AFFECTED: f64 = 0.1;

/// What every source leaves in every parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Budget {
    contributions: Vec<Contribution>,
    estimable: Vec<bool>,
    covariance: DMatrix<f64>,
    residual_scale: Option<ResidualScale>,
}

/// What one source leaves.
#[derive(Debug, Clone, PartialEq)]
pub struct Contribution {
    /// The source.
    pub source: Source,
    /// Degrees of freedom of its standard uncertainties.
    pub degrees: Degrees,
    /// Changes of the parameters by each of the source's influences at one standard uncertainty, `p x m`.
    changes: DMatrix<f64>,
}

/// What would be gained if a source were perfect.
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

/// Type A scaled by the residuals.
#[derive(Debug, Clone, Copy, PartialEq)]
struct ResidualScale {
    degrees_of_freedom: usize,
}

impl Calibration<'_> {
    /// The budget of the estimates with what the laboratory states.
    ///
    /// # Errors
    /// [`FitError`] when numbers overflow.
    pub fn budget(&self, stated: &TypeB) -> Result<Budget, FitError> {
        let (gain, model, observations) = (self.gain()?, self.data().model(), self.data().observations());
        let influences = influences(model.experiment(), stated);
        let of_type_b =
            if stated.doubt > 0.0 { Degrees::Finite(0.5 / (stated.doubt * stated.doubt)) } else { Degrees::Infinite };
        let mut contributions = Vec::new();
        for source in Source::ALL {
            let changes = match source {
                Source::Noise => gain.apply(&noise(observations)?),
                Source::Priors => gain.apply_priors(),
                Source::Resolution => gain.apply(&resolution(stated.resolution, observations.len())),
                _ => gain.apply(&effects_of(source, &influences, model, self.fit().state(), observations)),
            };
            if changes.ncols() > 0 {
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
            self.residual_scale = Some(ResidualScale { degrees_of_freedom: fit.degrees_of_freedom });
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

    /// Whether the null space leaves more doubt in parameter `j` than a tenth of the variance that `fit` weighs. Products of two
    /// unknowns let the lost combinations in, and only the hold keeps them ([`crate::NULL_HOLD`] typical magnitudes), which is
    /// not a source of the budget. `fit` is the fit of this budget.
    pub fn is_affected_by_null_space(&self, fit: &Fit, j: usize) -> bool {
        let weighed: f64 = self.contributions.iter().filter(|c| c.source.is_weighed()).map(|c| c.variance(j)).sum();
        fit.covariance(j, j).is_some_and(|all| all > (1.0 + AFFECTED) * weighed)
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
        let of_residuals =
            self.residual_scale.map_or(Degrees::Infinite, |s| Degrees::Finite(s.degrees_of_freedom as f64));
        let others = self.contributions.iter().filter(|c| !c.source.is_weighed());
        let mut list = vec![(weights.sqrt(), of_residuals)];
        list.extend(others.map(|c| (c.standard_uncertainty(j), c.degrees)));
        self.estimable[j].then(|| effective_degrees_of_freedom(&list))
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

/// The Cholesky factors of the covariances of the means, block by block, `3 n x 3 n`.
fn noise(observations: &[Observation]) -> Result<DMatrix<f64>, FitError> {
    let mut effects = DMatrix::zeros(3 * observations.len(), 3 * observations.len());
    for (n, observation) in observations.iter().enumerate() {
        effects.fixed_view_mut::<3, 3>(3 * n, 3 * n).copy_from(&observation.noise_factor()?);
    }
    Ok(effects)
}

/// A rectangular error of each mean.
fn resolution(step: f64, observations: usize) -> DMatrix<f64> {
    let u = step / 12.0_f64.sqrt();
    if u > 0.0 {
        DMatrix::from_diagonal_element(3 * observations, 3 * observations, u)
    } else {
        DMatrix::zeros(3 * observations, 0)
    }
}

/// Half the differences of the readings with each influence of `source` up and down.
fn effects_of(
    source: Source,
    influences: &[Influence],
    model: &MeasurementModel,
    x: &[f64],
    observations: &[Observation],
) -> DMatrix<f64> {
    let own: Vec<&Influence> = influences.iter().filter(|i| i.source == source).collect();
    let mut effects = DMatrix::zeros(3 * observations.len(), own.len());
    for (influence, mut column) in own.into_iter().zip(effects.column_iter_mut()) {
        let off = |deviation| {
            let mut experiment = model.experiment().clone();
            influence.apply(&mut experiment, deviation);
            model.in_experiment(experiment)
        };
        let (up, down) = (off(1.0), off(-1.0));
        for (n, observation) in observations.iter().enumerate().filter(|(_, o)| influence.quantity.acts_on(o)) {
            let reading =
                |model: &MeasurementModel| model.reading(&model.experiment().set_points[observation.set_point], x);
            column.fixed_rows_mut::<3>(3 * n).copy_from(&(0.5 * (reading(&up) - reading(&down))));
        }
    }
    effects
}

impl Quantity {
    /// Whether it can change this reading at all.
    fn acts_on(self, observation: &Observation) -> bool {
        match self {
            Self::PlateauSpeed(n) | Self::RestAngle(n) => n == observation.set_point,
            _ => true,
        }
    }
}
