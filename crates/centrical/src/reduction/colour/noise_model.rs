//! The colour of the noise, pooled over all plateaus of a session.
//!
//! Model: white noise and first-order Markov processes, each with a 3x3 spectral density; it is the usual model
//! of inertial sensors (IEEE Std 952), and a sum of a few follows any falling spectrum. The data are contrasts: products
//! of the readings with cosines of whole half-periods in the window, orthogonal to the fitted terms and to the time
//! constant of the settling. They do not depend on these, and their expectation is known exactly.

use std::f64::consts::{SQRT_2, TAU};

use nalgebra::{Matrix3, Vector3};

use super::contrasts::{Group, grouped_contrasts};
use super::likelihood::{Fit, STEPS};
use super::markov::{Markov, gain};
use super::posterior::{Mixture, Power, posterior};
use crate::reduction::average::{CELLS, PlateauFit, ReducedMounting, Weights};

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
                Markov::new(times, cells.width).gains(&weights)
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
