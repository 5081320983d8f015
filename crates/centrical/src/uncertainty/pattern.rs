//! Patterns in the residuals: what they would follow if something is missing in the model, each tested.
//!
//! A pattern is a column `z` of readings per unit of its amplitude. With `z_r`, `e_r` what is redundant of it and of the
//! residuals (the part that no change of the unknowns can follow), the amplitude is `a = z_r . e_r / |z_r|^2` with standard
//! uncertainty `1 / |z_r|`: the value it would have as one more unknown of the fit. `(a/u)^2` over what is left of chi^2 per
//! degree of freedom is an F statistic, free of the scale of the weights.

use nalgebra::DMatrix;

use super::validity::f_tail;
use crate::fit::Calibration;
use crate::model::{Experiment, FitError, Observation, SetPoint};

/// What the residuals of one newtonometer could follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Trend {
    /// A step in one position.
    Position(usize),
    /// The square of the speed in one position.
    SpeedInPosition(usize),
    /// The square of the speed on the seat of this mounting.
    SpeedOnSeat(usize),
    /// The square of the speed in all positions.
    Speed,
    /// The load, square of the speed times radius, in all positions.
    Load,
    /// A step in one mounting.
    Mounting(usize),
    /// The order of the plateaus in the session.
    Time,
}

/// A pattern and how much of it is in the residuals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pattern {
    /// Newtonometer, 0 to 2.
    pub axis: usize,
    /// What is followed.
    pub trend: Trend,
    /// Amplitude [m/s^2]: of a step; at the highest speed or load; over the session.
    pub amplitude: f64,
    /// Its standard uncertainty [m/s^2].
    pub standard_uncertainty: f64,
    /// Probability of so large an amplitude by chance, for this pattern alone.
    pub probability: f64,
    /// The same, family-wise over all patterns tested (Holm).
    pub family_wise: f64,
}

/// A pattern is untestable when less than this part of it is redundant: the unknowns follow the rest.
const REDUNDANT: f64 = 1e-3;

impl Calibration<'_> {
    /// All patterns of the residuals, the likeliest to be real first. Patterns that the unknowns can follow are left out: the
    /// model has them already.
    ///
    /// # Errors
    /// [`FitError`] when numbers overflow.
    pub fn patterns(&self) -> Result<Vec<Pattern>, FitError> {
        self.patterns_of(&trends(self.data().model().experiment()))
    }

    /// Those of the patterns `trends` alone.
    ///
    /// # Errors
    /// As [`Calibration::patterns`].
    pub fn patterns_of(&self, trends: &[Trend]) -> Result<Vec<Pattern>, FitError> {
        let gain = self.gain()?;
        let e = gain.redundant_residuals();
        let candidates: Vec<(usize, Trend)> = trends.iter().flat_map(|t| (0..3).map(move |axis| (axis, *t))).collect();
        let columns = columns(&candidates, self.data().model().experiment(), self.data().observations());
        let (whitened, redundant) = (gain.whitened(&columns), gain.redundant(&columns));
        let mut list = Vec::new();
        for (n, (axis, trend)) in candidates.into_iter().enumerate() {
            let (z, size) = (redundant.column(n), redundant.column(n).norm());
            if size > REDUNDANT * whitened.column(n).norm() {
                let amplitude = z.dot(&e) / (size * size);
                let square = (amplitude * size).powi(2);
                let left = self.fit().degrees_of_freedom.saturating_sub(1);
                let f = square / ((self.fit().chi_squared - square).max(0.0) / left as f64);
                let probability = f_tail(f, 1, left);
                let standard_uncertainty = 1.0 / size;
                list.push(Pattern { axis, trend, amplitude, standard_uncertainty, probability, family_wise: 1.0 });
            }
        }
        list.sort_by(|a, b| a.probability.total_cmp(&b.probability));
        holm(&mut list);
        Ok(list)
    }
}

/// Holm's step-down probabilities of a list that rises in probability.
fn holm(list: &mut [Pattern]) {
    let count = list.len();
    let mut highest: f64 = 0.0;
    for (n, pattern) in list.iter_mut().enumerate() {
        highest = highest.max((count - n) as f64 * pattern.probability).min(1.0);
        pattern.family_wise = highest;
    }
}

/// Everything that is tested.
fn trends(experiment: &Experiment) -> Vec<Trend> {
    let mountings = 0..experiment.mountings.len();
    let mut list = vec![Trend::Speed, Trend::Load, Trend::Time];
    list.extend((0..experiment.positions.len()).flat_map(|k| [Trend::Position(k), Trend::SpeedInPosition(k)]));
    list.extend(mountings.clone().filter(|&m| experiment.seat_of(m) == m).map(Trend::SpeedOnSeat));
    list.extend(mountings.map(Trend::Mounting));
    list
}

/// The columns, `3 n x m`, each with a largest entry of 1.
fn columns(candidates: &[(usize, Trend)], experiment: &Experiment, observations: &[Observation]) -> DMatrix<f64> {
    let mut columns = DMatrix::zeros(3 * observations.len(), candidates.len());
    for ((axis, trend), mut column) in candidates.iter().zip(columns.column_iter_mut()) {
        for (n, observation) in observations.iter().enumerate() {
            column[3 * n + axis] = trend.value(experiment, observation.set_point);
        }
        let largest = column.amax();
        if largest > 0.0 {
            column /= largest;
        }
    }
    columns
}

impl Trend {
    /// Its value on a plateau, up to a factor.
    fn value(self, experiment: &Experiment, index: usize) -> f64 {
        let set_point: &SetPoint = &experiment.set_points[index];
        let position = experiment.mountings[set_point.mounting].position;
        let square = set_point.omega * set_point.omega;
        let on = |condition: bool, value: f64| if condition { value } else { 0.0 };
        match self {
            Self::Position(k) => on(k == position, 1.0),
            Self::SpeedInPosition(k) => on(k == position, square),
            Self::SpeedOnSeat(seat) => on(experiment.seat_of(set_point.mounting) == seat, square),
            Self::Speed => square,
            Self::Load => square * experiment.arm_of(set_point).x.abs(),
            Self::Mounting(m) => on(m == set_point.mounting, 1.0),
            Self::Time => index as f64 / experiment.set_points.len() as f64 - 0.5,
        }
    }
}
