//! Contrasts of the plateaus, what each component of the noise gives them, and the likeliest densities of the components by them.
//!
//! A contrast is a product of the readings with a cosine of whole half-periods in the window, orthogonal to the fitted terms and to the
//! time constant of the settling.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use super::posterior::Power;
use crate::reduction::average::{CELLS, Markov, PlateauFit, Weights};
use crate::reduction::terms::TURNING;
use crate::statistics::{chi_squared_tail, whole};

/// Cosines of nearly the same frequency are pooled: groups per octave.
const PER_OCTAVE: f64 = 4.0;

/// The contrasts of one plateau, each with its group.
pub struct OfPlateau(Vec<(usize, Contrast)>);

/// A contrast of one plateau, scaled to unit variance under white noise of unit density.
struct Contrast {
    /// `y y^T`.
    power: Matrix3<f64>,
    /// Variance under each Markov process of unit density.
    gains: Vec<f64>,
}

/// Contrasts of nearly one frequency, each scaled to unit variance under white noise of unit density.
pub struct Group {
    /// Number of contrasts.
    count: f64,
    /// Mean of `y y^T`.
    power: Matrix3<f64>,
    /// Mean of the variance under each component of unit density, white first.
    gains: Vec<f64>,
}

/// The contrasts of each plateau.
pub fn contrasts(plateaus: &[&PlateauFit], times: &[f64]) -> Vec<OfPlateau> {
    let longest = plateaus.iter().map(|plateau| plateau.cells.width).fold(0.0, f64::max);
    let cosines: Vec<(usize, Vec<f64>)> = half_periods().into_iter().map(|number| (number, cosine(number))).collect();
    let of = |plateau: &&PlateauFit| {
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
        OfPlateau(cosines.iter().filter(|(number, _)| *number > absorbed).filter_map(contrast).collect())
    };
    plateaus.par_iter().map(of).collect()
}

/// The contrasts of some plateaus, grouped by frequency, the lowest first.
pub fn grouped<'a>(plateaus: impl IntoIterator<Item = &'a OfPlateau>) -> Vec<Group> {
    let mut groups = BTreeMap::new();
    for (group, contrast) in plateaus.into_iter().flat_map(|OfPlateau(contrasts)| contrasts) {
        let empty = || Group { count: 0.0, power: Matrix3::zeros(), gains: vec![0.0; 1 + contrast.gains.len()] };
        groups.entry(*group).or_insert_with(empty).add(contrast);
    }
    groups.into_values().map(Group::averaged).collect()
}

/// Cosines that no drift over a plateau reaches.
pub fn fast_cosines() -> Vec<Vec<f64>> {
    half_periods().into_iter().filter(|number| *number > DRIFTS).map(cosine).collect()
}

/// Scale of the noise of one plateau on each axis, over that of a model by which functionals have the `covariance`: of a noisy cable, or of one
/// mounting. It is that of the contrasts with `cosines`; what chance explains is 1.
pub fn own_scale(
    plateau: &PlateauFit,
    cosines: &[Vec<f64>],
    covariance: impl Fn(&Weights) -> Matrix3<f64>,
) -> Vector3<f64> {
    let squares = cosines.iter().map(|cosine| {
        let (weights, y) = plateau.cells.contrast(cosine);
        let y = plateau.noise_axes * y;
        y.component_mul(&y).component_div(&covariance(&weights).diagonal())
    });
    let (sums, count): (Vector3<f64>, usize) = (squares.sum(), cosines.len());
    sums.map(|sum| {
        let above = chi_squared_tail(sum, count);
        let is_chance = above.min(1.0 - above) > BY_CHANCE;
        if is_chance || !sum.is_finite() || sum <= 0.0 { 1.0 } else { (sum / count as f64).sqrt() }
    })
}

/// Half-periods of contrasts that a drift over the plateau may reach.
const DRIFTS: usize = 8;

/// Probability of a scale that is taken to be one of its own, of a plateau like the others.
const BY_CHANCE: f64 = 1e-6;

/// Number of the contrasts of some groups.
pub fn count(groups: &[Group]) -> f64 {
    groups.iter().map(|group| group.count).sum()
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
        let white = cells.gain(None, &weights);
        let gains = || markov.gains(&weights).into_iter().map(|gain| gain / white).collect();
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
    pub fn along(&self) -> Self {
        let power = Matrix3::identity() * self.power[(2, 2)];
        Self { count: self.count / 3.0, power, gains: self.gains.clone() }
    }

    /// Of the third axis by itself.
    pub fn as_power(&self) -> Power<'_> {
        Power { count: 3.0 * self.count, square: self.power[(2, 2)], gains: &self.gains[1..] }
    }

    fn averaged(mut self) -> Self {
        let count = self.count.max(1.0);
        self.power /= count;
        self.gains.iter_mut().for_each(|gain| *gain /= count);
        self
    }
}

/// Steps of the ascent for a candidate, and for the final model.
const STEPS: (usize, usize) = (100, 400);

/// Densities by component, and their log-likelihood.
///
/// The densities `L_k` maximise the Gaussian likelihood of the contrasts `y_j ~ N(0, S_j)`, `S_j = sum_k B_jk L_k`, by
/// minorisation and maximisation (Zhou, Hu, Qiao and Lange 2019, J. Comput. Graph. Stat. 28, 350), which never
/// descends and keeps every `L_k` non-negative.
#[derive(Clone)]
pub struct Fit {
    /// Index of the correlation time, and the density.
    pub parts: Vec<(usize, Matrix3<f64>)>,
    pub likelihood: f64,
}

impl Fit {
    /// By components that are added one by one, as long as Schwarz's criterion accepts the `entries` of each; of correlation times 1 to `times`.
    /// `None` without contrasts.
    pub fn likeliest(groups: &[Group], times: usize, entries: f64) -> Option<Self> {
        let contrasts = count(groups);
        if contrasts == 0.0 {
            return None;
        }
        let penalty = 0.5 * entries * contrasts.ln();
        let mut fit = Self::white(groups);
        loop {
            let best = fit.with_best_time(times, groups);
            if best.likelihood > fit.likelihood + penalty {
                fit = best;
            } else {
                break;
            }
        }
        fit.climb(groups, STEPS.1);
        Some(fit)
    }

    /// White noise alone.
    fn white(groups: &[Group]) -> Self {
        let count = count(groups);
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

    /// What the log-likelihood of other contrasts gains if these have noise of the same colour, and a scale of their own on each axis.
    pub fn gain_by_scale(&self, groups: &[Group]) -> f64 {
        let (mut count, mut squares) = (0.0, Vector3::zeros());
        for group in groups {
            let Some(factor) = self.covariance(group).cholesky() else { continue };
            let Some(half) = factor.l().solve_lower_triangular(&group.power) else { continue };
            let Some(whitened) = factor.l().solve_lower_triangular(&half.transpose()) else { continue };
            count += group.count;
            squares += whitened.diagonal() * group.count;
        }
        let of_axis = |square: f64| if square > 0.0 { square - 1.0 - square.ln() } else { 0.0 };
        0.5 * count * squares.iter().map(|sum| of_axis(sum / count.max(1.0))).sum::<f64>()
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
