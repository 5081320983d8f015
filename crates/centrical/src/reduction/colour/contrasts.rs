//! Contrasts of the plateaus, and what each component of the noise gives them.
//!
//! A contrast is a product of the readings with a cosine of whole half-periods in the window, orthogonal to the fitted terms and to the
//! time constant of the settling.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use super::markov::{Markov, gain};
use super::posterior::Power;
use crate::reduction::average::{CELLS, PlateauFit, Weights};
use crate::reduction::locate::TURNING;
use crate::statistics::chi_squared_tail;
use crate::statistics::whole;

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
    pub count: f64,
    /// Mean of `y y^T`.
    pub power: Matrix3<f64>,
    /// Mean of the variance under each component of unit density, white first.
    pub gains: Vec<f64>,
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
