//! Monte Carlo: the whole calibration repeated on drawn readings, to see whether its uncertainties are true.
//!
//! Each run draws the noise of the means, the speeds of the plateaus, every type B influence, and unknowns with a prior
//! from that prior. The exact model generates the readings, and the fit ignores the errors drawn. Run `n` uses stream
//! `n` of the seed, and runs are gathered in their order, so the outcome does not depend on the number of threads.

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use super::budget::Budget;
use super::comparison::weighted_square;
use super::coverage::Degrees;
use super::verdict::Level;
use crate::fit::batch::FitMethod;
use crate::fit::{Calibration, Data, Fit, Structure, Termination};
use crate::model::plateau::noise_factor;
use crate::model::{FitError, MeasurementModel, Observation, SetPoint};
use crate::progress::{OnProgress, advance};
use crate::statistics::{Random, chi_squared_tail, family_wise};

/// What to draw, and how often.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Calibrations.
    pub runs: usize,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Probability that the intervals are to cover, in (0, 1).
    pub coverage: f64,
    /// Whether the linear fit alone is repeated, and not the exact one.
    pub is_linear: bool,
}

/// What the runs show.
#[derive(Debug, Clone, PartialEq)]
pub struct MonteCarlo {
    /// Runs that converged: all figures are of these.
    pub runs: usize,
    /// Runs that did not.
    pub failures: usize,
    /// By parameter; `None` for those that the data do not determine, or for which what is stated is not informative
    /// ([`crate::Parameter::is_informative`]).
    pub parameters: Vec<Option<ParameterStatistics>>,
    /// `e^T C^-1 e` of the determined parameters with the covariance stated in each run.
    pub weighted_square: WeightedSquare,
    /// Sum of squared whitened residuals of each fit.
    pub chi_squared: WeightedSquare,
}

/// One parameter over all runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParameterStatistics {
    /// Mean error of the estimate [its unit].
    pub bias: f64,
    /// Standard deviation of the error about its mean [its unit].
    pub standard_deviation: f64,
    /// Combined standard uncertainty of the budget [its unit].
    pub stated: f64,
    /// Part of the runs whose interval covers the truth.
    pub coverage: f64,
    /// Whether the null space leaves doubt in it that is not in `stated`: see [`Budget::is_affected_by_null_space`].
    pub is_affected_by_null_space: bool,
}

/// A quadratic form over all runs, beside the chi^2 distribution it should have.
#[derive(Debug, Clone, PartialEq)]
pub struct WeightedSquare {
    /// Degrees of freedom it should have: its expected mean.
    pub degrees_of_freedom: usize,
    /// Mean over the runs.
    pub mean: f64,
    /// Standard deviation over the runs; `sqrt(2 nu)` is expected.
    pub standard_deviation: f64,
    /// All values, rising.
    pub sorted: Vec<f64>,
}

/// Root mean square error over stated uncertainty up to which the latter holds: what second-order terms add to a sound calibration is less.
const UNDERSTATED: f64 = 1.1;

/// Runs handed to the threads at a time: enough to keep any number busy, few enough for a smooth progress bar.
const BATCH: usize = 256;

impl MonteCarlo {
    /// Repeats the calibration of `data` for a unit with unknowns `truth`. The means of `data` are not used, only their weights.
    /// `progress` is called with the number of runs that were done.
    ///
    /// # Errors
    /// [`FitError`] when numbers overflow or the caller stops.
    pub fn of(
        data: &Data,
        truth: &[f64],
        settings: &Settings,
        progress: OnProgress<usize>,
    ) -> Result<MonteCarlo, FitError> {
        let laboratory = Laboratory::new(data, truth, settings)?;
        let mut tally = Tally::new(&laboratory);
        for first in (0..settings.runs).step_by(BATCH) {
            let batch = first..settings.runs.min(first + BATCH);
            let count = batch.len();
            let run = |n: usize| {
                advance(progress, 0)?;
                laboratory.run(n)
            };
            let runs: Vec<Option<Run>> = batch.into_par_iter().map(run).collect::<Result<_, _>>()?;
            for run in &runs {
                tally.add(run.as_ref());
            }
            advance(progress, count)?;
        }
        Ok(tally.into_monte_carlo(&laboratory))
    }

    /// Indices of the parameters whose stated uncertainty is too small: their root mean square error exceeds it by more than a
    /// tenth, and by more than chance allows (family-wise, at the level of an objection).
    pub fn understated(&self) -> Vec<usize> {
        let statistics = self.parameters.iter().enumerate();
        let ratios: Vec<(usize, f64)> = statistics.filter_map(|(j, s)| Some((j, s.as_ref()?.ratio()))).collect();
        let by_chance = |(_, ratio): &(usize, f64)| chi_squared_tail(self.runs as f64 * ratio.powi(2), self.runs);
        let chances = family_wise(&ratios.iter().map(by_chance).collect::<Vec<_>>());
        let judged = ratios.into_iter().zip(chances);
        let is_understated = |ratio: f64, chance: f64| ratio > UNDERSTATED && Level::Objection.is_passed_by(chance);
        judged.filter(|((_, ratio), chance)| is_understated(*ratio, *chance)).map(|((j, _), _)| j).collect()
    }

    /// Whether the stated uncertainties hold: too few fits fail to alter the coverage, and no uncertainty is too small.
    pub fn is_acceptable(&self, coverage: f64) -> bool {
        let all = (self.runs + self.failures) as f64;
        self.runs > 0 && self.failures as f64 <= (1.0 - coverage) * all && self.understated().is_empty()
    }
}

impl ParameterStatistics {
    /// Root mean square error over the stated uncertainty.
    pub fn ratio(&self) -> f64 {
        self.standard_deviation.hypot(self.bias) / self.stated
    }
}

/// Everything that does not change from run to run.
struct Laboratory<'a> {
    data: &'a Data<'a>,
    truth: &'a [f64],
    noise_factors: Vec<Matrix3<f64>>,
    structure: Structure,
    /// Indices of the parameters that the data determine.
    determined: Vec<usize>,
    budget: Budget,
    /// By parameter: whether the null space affects it.
    affected: Vec<bool>,
    coverage_factor: f64,
    settings: &'a Settings,
}

/// One calibration.
struct Run {
    /// Estimate less truth, by determined parameter.
    errors: Vec<f64>,
    /// Combined standard uncertainties stated in this run.
    stated: Vec<f64>,
    weighted_square: f64,
    chi_squared: f64,
    degrees_of_freedom: usize,
}

impl<'a> Laboratory<'a> {
    fn new(data: &'a Data<'a>, truth: &'a [f64], settings: &'a Settings) -> Result<Self, FitError> {
        let (model, observations) = (data.model(), data.observations());
        let perfect = Data::new(model, readings_of(model, truth, observations))?;
        let calibration = Calibration::exact(&perfect)?;
        let (budget, fit) = (calibration.budget()?, calibration.fit());
        let determined: Vec<usize> = (0..truth.len()).filter(|&j| fit.value(j).is_some()).collect();
        let pairs = observations.iter().zip(calibration.gain()?.linearisations());
        let noise_factors = pairs.map(|(o, at)| noise_factor(o, at)).collect::<Result<_, _>>()?;
        Ok(Self {
            data,
            truth,
            noise_factors,
            structure: calibration.structure().clone(),
            determined,
            affected: (0..truth.len()).map(|j| budget.is_affected_by_null_space(fit, j)).collect(),
            budget,
            coverage_factor: Degrees::Infinite.coverage_factor(settings.coverage),
            settings,
        })
    }

    /// Run number `n`; `None` if its fit did not converge.
    fn run(&self, n: usize) -> Result<Option<Run>, FitError> {
        let mut random = Random::stream(self.settings.seed, n as u64);
        let truth = self.draw_truth(&mut random);
        let drawn = self.draw(&truth, &mut random);
        let drawn = Data::new(self.data.model(), drawn)?;
        let method = if self.settings.is_linear { FitMethod::Linear } else { FitMethod::Exact };
        Ok(self.judge(&self.structure.fit(method, &drawn)?, &truth))
    }

    /// The unknowns, those with a prior drawn from it.
    fn draw_truth(&self, random: &mut Random) -> Vec<f64> {
        let mut truth = self.truth.to_vec();
        for prior in self.data.model().priors() {
            truth[prior.parameter] = prior.mean + prior.standard_uncertainty * random.normal();
        }
        truth
    }

    /// Readings with everything drawn.
    fn draw(&self, truth: &[f64], random: &mut Random) -> Vec<Observation> {
        let model = self.data.model();
        let set_points = self.draw_settings(random);
        let deviations = model.influences().iter().map(|_| random.normal()).collect();
        let deviated = model.clone().deviated(deviations);
        let half_width = 3.0_f64.sqrt() * model.stated().rounding();
        let pairs = self.data.observations().iter().zip(&self.noise_factors);
        let drawn = pairs.map(|(observation, factor)| {
            let set_point = &set_points[observation.set_point];
            let noise = Vector3::from_fn(|_, _| random.normal());
            let mut mean = deviated.reading(set_point, truth) + factor * noise;
            // Rests that round alike share an influence.
            if half_width > 0.0 && set_point.history.repeats.is_none() {
                mean += Vector3::from_fn(|_, _| half_width * random.symmetric());
            }
            Observation { mean, ..observation.clone() }
        });
        drawn.collect()
    }

    /// The set points with their own errors drawn: speeds, and angles at rest.
    fn draw_settings(&self, random: &mut Random) -> Vec<SetPoint> {
        let (experiment, stated) = (self.data.model().experiment(), self.data.model().stated());
        let mut set_points = experiment.set_points.clone();
        for set_point in &mut set_points {
            let speed = experiment.speed_uncertainty_of(set_point);
            if set_point.is_rest() && stated.rest_angle > 0.0 {
                set_point.angle += stated.rest_angle * random.normal();
            } else if !set_point.is_rest() && speed > 0.0 {
                set_point.omega *= 1.0 + speed * random.normal();
            }
        }
        set_points
    }

    fn judge(&self, fit: &Fit, truth: &[f64]) -> Option<Run> {
        let errors = self.determined.iter().map(|&j| Some(fit.value(j)? - truth[j])).collect::<Option<Vec<f64>>>()?;
        let covariance = fit.covariance_of(&self.determined)?;
        let converged = matches!(fit.termination, Termination::Converged | Termination::Linear);
        let run = Run {
            weighted_square: weighted_square(errors.iter().copied(), &covariance)?,
            stated: covariance.diagonal().iter().map(|v| v.sqrt()).collect(),
            errors,
            chi_squared: fit.chi_squared,
            degrees_of_freedom: fit.degrees_of_freedom,
        };
        converged.then_some(run)
    }
}

/// The observations with the means that `model` gives at `x`.
fn readings_of(model: &MeasurementModel, x: &[f64], observations: &[Observation]) -> Vec<Observation> {
    let set_points = &model.experiment().set_points;
    let reading = |o: &Observation| Observation { mean: model.reading(&set_points[o.set_point], x), ..o.clone() };
    observations.iter().map(reading).collect()
}

/// Sums over the runs, in their order.
struct Tally {
    runs: usize,
    failures: usize,
    mean: Vec<f64>,
    squares: Vec<f64>,
    covered: Vec<usize>,
    weighted_squares: Vec<f64>,
    chi_squares: Vec<f64>,
    degrees_of_freedom: usize,
    coverage_factor: f64,
}

impl Tally {
    fn new(laboratory: &Laboratory) -> Self {
        let count = laboratory.determined.len();
        Self {
            coverage_factor: laboratory.coverage_factor,
            runs: 0,
            failures: 0,
            mean: vec![0.0; count],
            squares: vec![0.0; count],
            covered: vec![0; count],
            weighted_squares: Vec::new(),
            chi_squares: Vec::new(),
            degrees_of_freedom: 0,
        }
    }
    /// Welford's recursion, which does not cancel.
    fn add(&mut self, run: Option<&Run>) {
        let Some(run) = run else {
            self.failures += 1;
            return;
        };
        self.runs += 1;
        for (a, error) in run.errors.iter().enumerate() {
            let before = error - self.mean[a];
            self.mean[a] += before / self.runs as f64;
            self.squares[a] += before * (error - self.mean[a]);
            self.covered[a] += usize::from(error.abs() <= self.coverage_factor * run.stated[a]);
        }
        self.weighted_squares.push(run.weighted_square);
        self.chi_squares.push(run.chi_squared);
        self.degrees_of_freedom = run.degrees_of_freedom;
    }

    fn into_monte_carlo(self, laboratory: &Laboratory) -> MonteCarlo {
        let mut parameters = vec![None; laboratory.truth.len()];
        for (a, &j) in laboratory.determined.iter().enumerate() {
            let stated = laboratory.budget.standard_uncertainty(j);
            let informative = stated.filter(|stated| laboratory.data.model().parameters()[j].is_informative(*stated));
            parameters[j] = informative.map(|stated| ParameterStatistics {
                bias: self.mean[a],
                standard_deviation: (self.squares[a] / (self.runs.max(2) - 1) as f64).sqrt(),
                stated,
                coverage: self.covered[a] as f64 / self.runs.max(1) as f64,
                is_affected_by_null_space: laboratory.affected[j],
            });
        }
        MonteCarlo {
            runs: self.runs,
            failures: self.failures,
            parameters,
            weighted_square: WeightedSquare::of(self.weighted_squares, laboratory.determined.len()),
            chi_squared: WeightedSquare::of(self.chi_squares, self.degrees_of_freedom),
        }
    }
}

impl WeightedSquare {
    fn of(mut values: Vec<f64>, degrees_of_freedom: usize) -> Self {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
        values.sort_by(f64::total_cmp);
        Self { degrees_of_freedom, mean, standard_deviation: (squares / (count - 1.0)).sqrt(), sorted: values }
    }

    /// Largest distance of the distribution of the runs from that of chi^2 (Kolmogorov): beyond `1.36/sqrt(runs)` by
    /// chance once in twenty.
    pub fn distance_from_chi_squared(&self) -> f64 {
        let count = self.sorted.len() as f64;
        let below = self.sorted.iter().map(|v| 1.0 - chi_squared_tail(*v, self.degrees_of_freedom));
        let distance = |(n, p): (usize, f64)| (p - n as f64 / count).abs().max((p - (n + 1) as f64 / count).abs());
        below.enumerate().map(distance).fold(0.0, f64::max)
    }
}
