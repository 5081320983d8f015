//! The colour of the noise, pooled over all plateaus of a session.
//!
//! Model: white noise and first-order Markov processes, each with a 3x3 spectral density; it is the usual model
//! of inertial sensors (IEEE Std 952), and a sum of a few follows any falling spectrum. The data are contrasts: products
//! of the readings with cosines of whole half-periods in the window, orthogonal to the fitted terms and to the time
//! constant of the settling. They do not depend on these, and their expectation is known exactly.

use std::collections::BTreeMap;
use std::f64::consts::{SQRT_2, TAU};

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use super::contrasts::{Fit, Group, OfPlateau, contrasts, count, grouped, own_scale};
use super::posterior::{Mixture, Power, posterior};
use crate::reduction::average::{CELLS, Markov, PlateauFit, ReducedMounting, Weights};

/// Noise of a unit, which gives the covariance of a mean.
#[derive(Debug, Clone, PartialEq)]
pub struct NoiseModel {
    components: Vec<Component>,
    /// Where the noise of plateaus differs: what distinguishes them, and the components of each class.
    by_class: Option<(Alike, BTreeMap<Class, Vec<Component>>)>,
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

/// What distinguishes plateaus whose noise is not alike.
///
/// Drives and bearings shake an arm more the faster it turns, and what jitters in the speed or in the scale of a unit acts along the specific
/// force. So the noise may be that of the speed, or that of the speed and of the axis on which most of the force acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Alike {
    /// By their speeds.
    Speed,
    /// By their speeds and the axis on which most of the specific force acts.
    SpeedAndForce,
}

/// A class of plateaus with noise of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Class {
    /// Speed in parts of an octave; `None` at rest.
    speed: Option<i32>,
    /// Axis on which most of the force acts, where it counts.
    axis: Option<usize>,
}

impl NoiseModel {
    /// Chance that noise is excluded which is there: a tenth of the level of an objection.
    pub const EXCLUDED: f64 = 1e-5;

    /// Estimates the noise from all plateaus of a session.
    ///
    /// Components are added one by one, the likeliest first, as long as Schwarz's criterion accepts them. By the same criterion the noise is
    /// one for all plateaus, or that of each speed, or that of each speed and each axis of the force.
    pub fn pool<'a>(mountings: impl IntoIterator<Item = &'a ReducedMounting>) -> Self {
        let plateaus = plateaus_of(mountings);
        let times = correlation_times(&plateaus);
        let contrasts = contrasts(&plateaus, &times);
        let groups = grouped(&contrasts);
        let Some(fit) = Fit::likeliest(&groups, times.len(), ENTRIES) else { return Self::of(Vec::new(), &plateaus) };
        let by_class = noise_by_class(&fit, &groups, &plateaus, &contrasts, &times);
        Self { by_class, ..Self::of(components(&fit, &times), &plateaus) }
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
        let groups = grouped(&contrasts(&still, &times));
        let along = groups.iter().map(Group::along).collect::<Vec<Group>>();
        let of_all = correlation_times(&plateaus);
        let all = likeliest_components(&grouped(&contrasts(&plateaus, &of_all)), &of_all, ENTRIES);
        Self { along: Some(Along::of(&along, &times)), ..Self::of(all, &plateaus) }
    }

    fn of(components: Vec<Component>, plateaus: &[&PlateauFit]) -> Self {
        let quietest = plateaus.iter().map(|plateau| plateau.variance).reduce(|a, b| a.inf(&b)).unwrap_or_default();
        Self { components, by_class: None, along: None, quietest }
    }

    /// Variance of a sample on the quietest plateau [m^2/s^4]. Where the noise is below a digit, rounding shows its own spread
    /// and not that of the noise: the quietest plateau is nearest to the latter.
    pub(super) fn quietest(&self) -> Vector3<f64> {
        self.quietest
    }

    /// Two-sided spectral density at the frequency `f` [Hz], of all plateaus together: `L_0 + sum_k L_k / (1 + (2 pi f tau_k)^2)`
    /// [m^2/s^4/Hz].
    pub fn density(&self, f: f64) -> Matrix3<f64> {
        density(&self.components, f)
    }

    /// The same on one plateau.
    pub(super) fn density_on(&self, plateau: &PlateauFit, f: f64) -> Matrix3<f64> {
        density(self.components_on(plateau), f)
    }

    /// Scale of the noise of one plateau on each axis over that of the others of its class. The trembling of a hand is another on each rest, and
    /// where readings show rounding alone, nothing shows the noise.
    pub(super) fn own_scale(&self, plateau: &PlateauFit, cosines: &[Vec<f64>]) -> Vector3<f64> {
        if self.along.is_some() || plateau.variance.min() <= 0.0 {
            return Vector3::repeat(1.0);
        }
        own_scale(plateau, cosines, |weights| self.covariance(weights, plateau))
    }

    fn components_on(&self, plateau: &PlateauFit) -> &[Component] {
        let of_class = self.by_class.as_ref().and_then(|(alike, classes)| classes.get(&alike.class(plateau)));
        of_class.unwrap_or(&self.components)
    }

    /// Covariance of a linear functional of the samples of a plateau. Of the arcs of slow rotation each counts as independent, with
    /// the noise at zero frequency: what they share is in their sums.
    pub(super) fn covariance(&self, weights: &Weights, plateau: &PlateauFit) -> Matrix3<f64> {
        self.covariance_by(self.components_on(plateau), weights, plateau)
    }

    /// The same by the noise of all plateaus together. What drifts alike on all plateaus of a speed would count as their noise.
    pub(super) fn covariance_by_all(&self, weights: &Weights, plateau: &PlateauFit) -> Matrix3<f64> {
        self.covariance_by(&self.components, weights, plateau)
    }

    fn covariance_by(&self, components: &[Component], weights: &Weights, plateau: &PlateauFit) -> Matrix3<f64> {
        let cells = &plateau.cells;
        let time = |part: &Component| if plateau.turns() { None } else { part.correlation_time };
        let of = |components: &[Component]| -> Matrix3<f64> {
            components.iter().map(|part| part.density * cells.gain(time(part), weights)).sum()
        };
        let mut covariance = of(components);
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
            white += share * cells.gain(None, &weights);
            let gains = if plateau.turns() {
                vec![cells.gain(None, &weights); times.len()]
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

/// Entries of a density.
const ENTRIES: f64 = 6.0;

/// The noise of each class of plateaus, if it differs by more than Schwarz's criterion asks for from the `fit` of all contrasts together.
fn noise_by_class(
    fit: &Fit,
    groups: &[Group],
    plateaus: &[&PlateauFit],
    contrasts: &[OfPlateau],
    times: &[f64],
) -> Option<(Alike, BTreeMap<Class, Vec<Component>>)> {
    let penalty = 0.5 * count(groups).ln();
    let criterion = |fit: &Fit| fit.likelihood - penalty * ENTRIES * fit.parts.len() as f64;
    let of_all = criterion(fit);
    let by_class = |alike: Alike| {
        let classes = alike.classes(plateaus);
        let grouped: Vec<Vec<Group>> =
            classes.values().map(|class| grouped(class.iter().map(|index| &contrasts[*index]))).collect();
        // Scales alone show whether the noise differs, over all frequencies or over the lowest: the fits take a hundred times longer.
        let least = penalty * 3.0 * classes.len().saturating_sub(1) as f64;
        let gain = |most: usize| grouped.iter().map(|of| fit.gain_by_scale(&of[..of.len().min(most)])).sum::<f64>();
        if gain(usize::MAX).max(gain(LOWEST)) <= least {
            return None;
        }
        let fits = grouped
            .par_iter()
            .map(|groups| Fit::likeliest(groups, times.len(), ENTRIES))
            .collect::<Option<Vec<Fit>>>()?;
        let gain = fits.iter().map(criterion).sum::<f64>() - of_all;
        let noise = classes.into_keys().zip(fits.iter().map(|fit| components(fit, times))).collect();
        (gain > 0.0).then_some((gain, (alike, noise)))
    };
    let both = [Alike::Speed, Alike::SpeedAndForce].into_iter().filter_map(by_class);
    both.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, noise)| noise)
}

/// Groups of the lowest three octaves, four each, where a mean feels the noise.
const LOWEST: usize = 12;

fn density(components: &[Component], f: f64) -> Matrix3<f64> {
    let of = |component: &Component| {
        let x = component.correlation_time.map_or(0.0, |tau| TAU * f * tau);
        component.density / (1.0 + x * x)
    };
    components.iter().map(of).sum()
}

/// The components of the likeliest fit; none without contrasts.
fn likeliest_components(groups: &[Group], times: &[f64], entries: f64) -> Vec<Component> {
    Fit::likeliest(groups, times.len(), entries).map_or_else(Vec::new, |fit| components(&fit, times))
}

fn components(fit: &Fit, times: &[f64]) -> Vec<Component> {
    let part = |(time, density): &(usize, Matrix3<f64>)| Component {
        correlation_time: time.checked_sub(1).map(|time| times[time]),
        density: *density,
    };
    fit.parts.iter().map(part).collect()
}

/// Speeds within a fiftieth of each other are one.
const PER_OCTAVE: f64 = 32.0;

impl Alike {
    /// The class of a plateau.
    #[expect(clippy::cast_possible_truncation)]
    fn class(self, plateau: &PlateauFit) -> Class {
        let omega = plateau.shape.omega.abs();
        let speed = (omega > 0.0).then(|| (omega.log2() * PER_OCTAVE).round() as i32);
        let axis = match self {
            Self::Speed => None,
            Self::SpeedAndForce => Some(plateau.mean.iamax()),
        };
        Class { speed, axis }
    }

    /// Indices of the plateaus of each class.
    fn classes(self, plateaus: &[&PlateauFit]) -> BTreeMap<Class, Vec<usize>> {
        let mut classes = BTreeMap::<Class, Vec<usize>>::new();
        for (index, plateau) in plateaus.iter().enumerate() {
            classes.entry(self.class(plateau)).or_default().push(index);
        }
        classes
    }
}

impl Along {
    /// The posterior mean, if one Markov process at most is found beside white noise, and the likeliest components otherwise.
    fn of(groups: &[Group], times: &[f64]) -> Self {
        let likeliest = likeliest_components(groups, times, 1.0);
        let powers: Vec<Power> = groups.iter().map(Group::as_power).collect();
        let times = times.to_vec();
        let Some(posterior) = posterior(&powers, NoiseModel::EXCLUDED) else {
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
