//! The colour of the noise, pooled over all plateaus of a session.
//!
//! Model: white noise and first-order Markov processes, each with a 3x3 spectral density; it is the usual model
//! of inertial sensors (IEEE Std 952), and a sum of a few follows any falling spectrum. The data are contrasts: products
//! of the readings with cosines of whole half-periods in the window, orthogonal to the fitted terms and to the time
//! constant of the settling. They do not depend on these, and their expectation is known exactly.

use std::collections::BTreeMap;
use std::f64::consts::{PI, SQRT_2, TAU};

use nalgebra::{Matrix3, Vector3};
use pulp::{Simd, WithSimd};
use rayon::prelude::*;

use super::posterior::{Mixture, Power, posterior};
use crate::reduction::average::{CELLS, Cells, PlateauFit, ReducedMounting, Weights};
use crate::reduction::locate::TURNING;
use crate::reduction::simd::lanes::{dot, widest};
use crate::statistics::whole;

/// Cosines of nearly the same frequency are pooled: groups per octave.
const PER_OCTAVE: f64 = 4.0;

/// Steps of the likelihood's ascent for a candidate, and for the final model.
const STEPS: (usize, usize) = (100, 400);

/// Chance that noise is excluded which is there: a tenth of the level of an objection.
pub const EXCLUDED: f64 = 1e-5;

/// Noise of a unit, which gives the covariance of a mean.
#[derive(Debug, Clone, PartialEq)]
pub struct NoiseModel {
    components: Vec<Component>,
    /// Of rests: the part along the specific force, the third axis, by itself, in every direction alike.
    along: Option<Along>,
    /// Least variance of a sample on any plateau [m^2/s^4].
    quietest: Vector3<f64>,
}

/// Noise along the specific force of rests.
#[derive(Debug, Clone, PartialEq)]
struct Along {
    components: Vec<Component>,
    /// All noise that the rests do not exclude, and the correlation times that it names [s].
    not_excluded: Vec<Mixture>,
    times: Vec<f64>,
}

/// One component of the noise.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Component {
    /// Correlation time [s]; `None` for white noise.
    correlation_time: Option<f64>,
    /// Two-sided spectral density at zero frequency [m^2/s^4/Hz].
    density: Matrix3<f64>,
}

impl NoiseModel {
    /// Estimates the noise from all plateaus of a session.
    ///
    /// Components are added one by one, the likeliest first, as long as Schwarz's criterion accepts them.
    pub fn pool<'a>(mountings: impl IntoIterator<Item = &'a ReducedMounting>) -> Self {
        Self::of(&plateaus_of(mountings))
    }

    /// Estimates the noise from rests in free attitudes, in the axes of each. Along the specific force it is estimated by itself:
    /// this part alone enters a calibration by the size of gravity, and the trembling of a hand is across.
    ///
    /// Where the unit turns slowly, the noise along the force is that of the stretches `along`, in the third axis.
    pub fn pool_rests<'a>(mountings: impl IntoIterator<Item = &'a ReducedMounting>, along: &'a [PlateauFit]) -> Self {
        let plateaus = plateaus_of(mountings);
        let still = plateaus.iter().copied().filter(|plateau| !plateau.turns()).chain(along);
        let still: Vec<&PlateauFit> = still.collect();
        let times = correlation_times(&still);
        let groups = grouped_contrasts(&still, &times);
        let along = groups.iter().map(Group::along).collect::<Vec<Group>>();
        Self { along: Some(Along::of(&along, &times)), ..Self::of(&plateaus) }
    }

    fn of(plateaus: &[&PlateauFit]) -> Self {
        let quietest = plateaus.iter().map(|plateau| plateau.variance).reduce(|a, b| a.inf(&b)).unwrap_or_default();
        let times = correlation_times(plateaus);
        // A density has six entries.
        Self { components: components(&grouped_contrasts(plateaus, &times), &times, 6.0), along: None, quietest }
    }

    /// Variance of a sample on the quietest plateau [m^2/s^4]. Where the noise is below a digit, rounding shows its own spread
    /// and not that of the noise: the quietest plateau is nearest to the latter.
    pub(super) fn quietest(&self) -> Vector3<f64> {
        self.quietest
    }

    /// Two-sided spectral density at the frequency `f` [Hz]: `L_0 + sum_k L_k / (1 + (2 pi f tau_k)^2)` [m^2/s^4/Hz].
    pub fn density(&self, f: f64) -> Matrix3<f64> {
        let of = |component: &Component| {
            let x = component.correlation_time.map_or(0.0, |tau| TAU * f * tau);
            component.density / (1.0 + x * x)
        };
        self.components.iter().map(of).sum()
    }

    /// Covariance of a linear functional of the samples of a plateau. Of the arcs of slow rotation each counts as independent, with
    /// the noise at zero frequency: what they share is in their sums.
    pub(super) fn covariance(&self, weights: &Weights, plateau: &PlateauFit) -> Matrix3<f64> {
        let cells = &plateau.cells;
        let time = |part: &Component| if plateau.turns() { None } else { part.correlation_time };
        let of = |components: &[Component]| -> Matrix3<f64> {
            components.iter().map(|part| part.density * gain(time(part), weights, cells)).sum()
        };
        let mut covariance = of(&self.components);
        if let Some(along) = &self.along {
            // Which way the axes across point is arbitrary: no noise goes with them and along.
            for axis in 0..2 {
                (covariance[(axis, 2)], covariance[(2, axis)]) = (0.0, 0.0);
            }
            covariance[(2, 2)] = of(&along.components)[(2, 2)];
        }
        covariance
    }
}

impl NoiseModel {
    /// Variance of the means of rests along the specific force, at most, over that which this model gives them: the largest mean
    /// ratio by noise that the rests do not exclude, 1 or more.
    pub fn at_most<'a>(&self, mountings: impl IntoIterator<Item = &'a ReducedMounting>) -> f64 {
        let Some(Along { not_excluded, times, .. }) = &self.along else { return 1.0 };
        let plateaus = plateaus_of(mountings);
        let (mut white, mut slow) = (0.0, vec![0.0; times.len()]);
        for plateau in &plateaus {
            let (cells, weights) = (&plateau.cells, plateau.cells.mean_weights());
            let share = 1.0 / (self.covariance(&weights, plateau)[(2, 2)] * plateaus.len() as f64);
            white += share * gain(None, &weights, cells);
            let gains = if plateau.turns() {
                vec![gain(None, &weights, cells); times.len()]
            } else {
                widest(Gains { markov: &Markov::new(times, cells.width), weights: &weights })
            };
            slow.iter_mut().zip(gains).for_each(|(sum, gain)| *sum += share * gain);
        }
        let ratios = not_excluded.iter().map(|noise| noise.white * white + noise.slow * slow[noise.time]);
        ratios.filter(|ratio| ratio.is_finite()).fold(1.0, f64::max)
    }
}

fn plateaus_of<'a>(mountings: impl IntoIterator<Item = &'a ReducedMounting>) -> Vec<&'a PlateauFit> {
    mountings.into_iter().flat_map(|mounting| &mounting.plateaus).collect()
}

/// The components of the contrasts, added one by one as long as Schwarz's criterion accepts the `entries` of each.
fn components(groups: &[Group], times: &[f64], entries: f64) -> Vec<Component> {
    let contrasts: f64 = groups.iter().map(|group| group.count).sum();
    if contrasts == 0.0 {
        return Vec::new();
    }
    let penalty = 0.5 * entries * contrasts.ln();
    let mut fit = Fit::white(groups);
    loop {
        let best = fit.with_best_time(times.len(), groups);
        if best.likelihood > fit.likelihood + penalty {
            fit = best;
        } else {
            break;
        }
    }
    fit.climb(groups, STEPS.1);
    let part = |(time, density): &(usize, Matrix3<f64>)| Component {
        correlation_time: time.checked_sub(1).map(|time| times[time]),
        density: *density,
    };
    fit.parts.iter().map(part).collect()
}

impl Along {
    /// The posterior mean, if one Markov process at most is found beside white noise, and the likeliest components otherwise.
    fn of(groups: &[Group], times: &[f64]) -> Self {
        let likeliest = components(groups, times, 1.0);
        let powers: Vec<Power> = groups.iter().map(Group::as_power).collect();
        let times = times.to_vec();
        let Some(posterior) = posterior(&powers, EXCLUDED) else {
            return Self { components: likeliest, not_excluded: Vec::new(), times };
        };
        let part =
            |correlation_time, density: f64| Component { correlation_time, density: Matrix3::identity() * density };
        let markov = times.iter().zip(&posterior.slow).map(|(time, density)| part(Some(*time), *density));
        let mean = std::iter::once(part(None, posterior.white)).chain(markov).collect();
        let components = if likeliest.len() > 2 { likeliest } else { mean };
        Self { components, not_excluded: posterior.not_excluded, times }
    }
}

/// Quarter-octaves from an eighth of a cell of the shortest window to a quarter of the longest: noise slower than
/// that is drift.
fn correlation_times(plateaus: &[&PlateauFit]) -> Vec<f64> {
    let widths = plateaus.iter().map(|plateau| plateau.cells.width);
    let (shortest, longest) = widths.fold((f64::INFINITY, 0.0_f64), |(a, b), width| (a.min(width), b.max(width)));
    let mut times = Vec::new();
    let mut time = 0.125 * shortest;
    while time <= 0.25 * longest * CELLS as f64 {
        times.push(time);
        time *= SQRT_2.sqrt();
    }
    times
}

/// Variance of a functional under a component of unit density.
///
/// White: `sum w^2 / interval`. Markov: `sum_ab w_a w_b exp(-|t_a - t_b| / tau) / (2 tau)` over cells, by a recursion.
fn gain(correlation_time: Option<f64>, weights: &Weights, cells: &Cells) -> f64 {
    let Some(tau) = correlation_time else { return weights.squares / cells.interval };
    widest(Gains { markov: &Markov::new(&[tau], cells.width), weights })[0]
}

/// Markov processes of several correlation times, over cells of one width.
struct Markov {
    /// Correlation from one cell to the next.
    decay: Vec<f64>,
    /// Mean correlation inside a cell, over twice the correlation time.
    within: Vec<f64>,
    /// Mean correlation between neighbouring cells, over the correlation time.
    between: Vec<f64>,
}

impl Markov {
    fn new(times: &[f64], width: f64) -> Self {
        let of = |law: fn(f64) -> f64| times.iter().map(|tau| law(width / tau) / tau).collect();
        Self {
            decay: times.iter().map(|tau| (-width / tau).exp()).collect(),
            within: of(|x| (x - 1.0 + (-x).exp()) / (x * x)),
            // By its own exponential: the sinh of cells that are a thousand correlation times wide overflows.
            between: of(|x| (-(-x).exp_m1() / x).powi(2)),
        }
    }
}

/// Variances of a functional under Markov processes of unit density.
struct Gains<'a> {
    markov: &'a Markov,
    weights: &'a Weights,
}

impl WithSimd for Gains<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Vec<f64> {
        let Markov { decay, within, between } = self.markov;
        let by_cell = &self.weights.by_cell;
        let mut past = vec![0.0; decay.len()];
        let mut products = past.clone();
        for w in by_cell {
            for ((past, product), decay) in past.iter_mut().zip(&mut products).zip(decay) {
                *product += w * *past;
                *past = decay * *past + w;
            }
        }
        let squares = dot(simd, by_cell, by_cell);
        for ((product, within), between) in products.iter_mut().zip(within).zip(between) {
            *product = within * squares + between * *product;
        }
        products
    }
}

/// A contrast of one plateau, scaled to unit variance under white noise of unit density.
struct Contrast {
    /// `y y^T`.
    power: Matrix3<f64>,
    /// Variance under each Markov process of unit density.
    gains: Vec<f64>,
}

/// Contrasts of nearly one frequency, each scaled to unit variance under white noise of unit density.
struct Group {
    /// Number of contrasts.
    count: f64,
    /// Mean of `y y^T`.
    power: Matrix3<f64>,
    /// Mean of the variance under each component of unit density, white first.
    gains: Vec<f64>,
}

fn grouped_contrasts(plateaus: &[&PlateauFit], times: &[f64]) -> Vec<Group> {
    let longest = plateaus.iter().map(|plateau| plateau.cells.width).fold(0.0, f64::max);
    let cosines: Vec<(usize, Vec<f64>)> = half_periods().into_iter().map(|number| (number, cosine(number))).collect();
    let of = |plateau: &&PlateauFit| -> Vec<(usize, Contrast)> {
        let cells = &plateau.cells;
        let markov = Markov::new(times, cells.width);
        // The time constant of the settling is not final yet: its error is not noise.
        let rate = plateau.settling_rate();
        let contrast = |(number, cosine): &(usize, Vec<f64>)| {
            let frequency = *number as f64 * longest / cells.width;
            let group = whole((frequency.log2() * PER_OCTAVE).round());
            let function = rate.as_ref().map(|rate| cells.free_of(cosine, rate));
            Some((group, Contrast::of(plateau, function.as_ref().unwrap_or(cosine), &markov)?))
        };
        // The polynomials of an arc that turns absorb the lowest.
        let absorbed = if plateau.turns() { TURNING } else { 0 };
        cosines.iter().filter(|(number, _)| *number > absorbed).filter_map(contrast).collect()
    };
    let mut groups = BTreeMap::new();
    for (group, contrast) in plateaus.par_iter().map(of).collect::<Vec<_>>().into_iter().flatten() {
        let empty = || Group { count: 0.0, power: Matrix3::zeros(), gains: vec![0.0; 1 + times.len()] };
        groups.entry(group).or_insert_with(empty).add(&contrast);
    }
    groups.into_values().map(Group::averaged).collect()
}

/// All of the lowest, where a mean feels the noise, and eight an octave further up.
fn half_periods() -> Vec<usize> {
    let next = |number: &usize| Some(number + (number / 8).max(1));
    std::iter::successors(Some(1), next).take_while(|number| *number <= CELLS / 2).collect()
}

fn cosine(half_periods: usize) -> Vec<f64> {
    (0..CELLS).map(|cell| (PI * half_periods as f64 * (cell as f64 + 0.5) / CELLS as f64).cos()).collect()
}

impl Contrast {
    /// The part of a function that the fit does not absorb; `None` if it absorbs all of it.
    fn of(plateau: &PlateauFit, function: &[f64], markov: &Markov) -> Option<Self> {
        let cells = &plateau.cells;
        let (weights, y) = cells.contrast(function);
        let y = plateau.noise_axes * y;
        let white = gain(None, &weights, cells);
        let gains = || widest(Gains { markov, weights: &weights }).into_iter().map(|gain| gain / white).collect();
        (white > 0.0).then(|| Self { power: y * y.transpose() / white, gains: gains() })
    }
}

impl Group {
    fn add(&mut self, contrast: &Contrast) {
        self.count += 1.0;
        self.power += contrast.power;
        self.gains[0] += 1.0;
        for (sum, gain) in self.gains[1..].iter_mut().zip(&contrast.gains) {
            *sum += gain;
        }
    }

    /// The third axis by itself, as if it were each of three independent ones a third as often.
    fn along(&self) -> Self {
        let power = Matrix3::identity() * self.power[(2, 2)];
        Self { count: self.count / 3.0, power, gains: self.gains.clone() }
    }

    /// Of the third axis by itself.
    fn as_power(&self) -> Power<'_> {
        Power { count: 3.0 * self.count, square: self.power[(2, 2)], gains: &self.gains[1..] }
    }

    fn averaged(mut self) -> Self {
        let count = self.count.max(1.0);
        self.power /= count;
        self.gains.iter_mut().for_each(|gain| *gain /= count);
        self
    }
}

/// Densities by component, and their log-likelihood.
///
/// The densities `L_k` maximise the Gaussian likelihood of the contrasts `y_j ~ N(0, S_j)`, `S_j = sum_k B_jk L_k`, by
/// minorisation and maximisation (Zhou, Hu, Qiao and Lange 2019, J. Comput. Graph. Stat. 28, 350), which never
/// descends and keeps every `L_k` non-negative.
#[derive(Clone)]
struct Fit {
    /// Index of the correlation time, and the density.
    parts: Vec<(usize, Matrix3<f64>)>,
    likelihood: f64,
}

impl Fit {
    /// White noise alone.
    fn white(groups: &[Group]) -> Self {
        let count: f64 = groups.iter().map(|group| group.count).sum();
        let power: Matrix3<f64> = groups.iter().map(|group| group.power * group.count).sum();
        let mut fit = Self { parts: vec![(0, power / count)], likelihood: f64::NEG_INFINITY };
        fit.likelihood = fit.log_likelihood(groups);
        fit
    }

    /// With one component more, of the likeliest correlation time out of 1 to `times`: by octaves first, then by
    /// neighbours.
    fn with_best_time(&self, times: usize, groups: &[Group]) -> Self {
        let octaves: Vec<usize> = (1..=times).step_by(4).collect();
        let octaves: Vec<Self> = octaves.into_par_iter().map(|time| self.with(time, groups)).collect();
        let best = octaves.into_iter().max_by(|a, b| a.likelihood.total_cmp(&b.likelihood));
        let mut best = best.unwrap_or_else(|| self.clone());
        for step in [2, 1] {
            let time = best.parts[best.parts.len() - 1].0;
            for near in [time.saturating_sub(step), time + step].into_iter().filter(|near| (1..=times).contains(near)) {
                let candidate = self.with(near, groups);
                if candidate.likelihood > best.likelihood {
                    best = candidate;
                }
            }
        }
        best
    }

    /// With one component more. It starts too large: the ascent shrinks a component fast and raises one slowly.
    fn with(&self, time: usize, groups: &[Group]) -> Self {
        let mut fit = self.clone();
        let largest = self.parts.iter().max_by(|a, b| a.1.trace().total_cmp(&b.1.trace()));
        fit.parts.extend(largest.map(|(_, density)| (time, *density)));
        fit.climb(groups, STEPS.0);
        fit
    }

    fn climb(&mut self, groups: &[Group], steps: usize) {
        for _ in 0..steps {
            self.step(groups);
        }
        self.likelihood = self.log_likelihood(groups);
    }

    fn covariance(&self, group: &Group) -> Matrix3<f64> {
        self.parts.iter().map(|(time, density)| density * group.gains[*time]).sum()
    }

    fn log_likelihood(&self, groups: &[Group]) -> f64 {
        let of = |group: &Group| match self.covariance(group).cholesky() {
            Some(factor) => -0.5 * group.count * (factor.ln_determinant() + factor.solve(&group.power).trace()),
            None => f64::NEG_INFINITY,
        };
        groups.iter().map(of).sum()
    }

    /// `L_k` becomes the solution of `L A L = L_k B L_k`, `A = sum_j B_jk S_j^-1`, `B = sum_j B_jk S_j^-1 y_j y_j^T
    /// S_j^-1`.
    fn step(&mut self, groups: &[Group]) {
        let mut sums = vec![(Matrix3::zeros(), Matrix3::zeros()); self.parts.len()];
        for group in groups {
            let Some(factor) = self.covariance(group).cholesky() else { continue };
            let inverse = factor.inverse();
            let seen = inverse * group.power * inverse;
            for ((a, b), (time, _)) in sums.iter_mut().zip(&self.parts) {
                let weight = group.gains[*time] * group.count;
                *a += inverse * weight;
                *b += seen * weight;
            }
        }
        for ((a, b), (_, density)) in sums.iter().zip(&mut self.parts) {
            *density = geometric_mean(a, &(*density * b * *density)).unwrap_or(*density);
        }
    }
}

/// The symmetric non-negative `L` with `L a L = b`: `C^-T (C^T b C)^1/2 C^-1` with `a = C C^T`.
fn geometric_mean(a: &Matrix3<f64>, b: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    let c = a.cholesky()?.l();
    let root = (c.transpose() * b * c).symmetric_eigen();
    let half = root.eigenvectors * Matrix3::from_diagonal(&root.eigenvalues.map(|value| value.max(0.0).sqrt().sqrt()));
    let left = c.transpose().solve_upper_triangular(&half)?;
    Some(left * left.transpose())
}
