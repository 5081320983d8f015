//! Patterns in the residuals: what they would follow if something is missing in the model, each tested.
//!
//! A pattern is a column `z` of readings per unit of its amplitude. Let `z_r`, `e_r` be the redundant part of it and of
//! the residuals, which no change of the unknowns can follow. The amplitude is `a = z_r . e_r / |z_r|^2` with standard
//! uncertainty `1 / |z_r|`: the value it would have as one more unknown of the fit. `(a/u)^2` over the remaining chi^2
//! per degree of freedom is an F statistic, free of the scale of the weights.

use nalgebra::Vector3;

use super::rivals::columns::Columns;
use super::rivals::{Rivals, Scatter, Suspect};
use crate::fit::Calibration;
use crate::model::{Experiment, FitError, Rival, SetPoint};
use crate::statistics::holm;

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
        self.tested(trends, None, &Scatter::of(self)?)
    }

    /// The patterns of what `rival`, one of `rivals`, does not explain.
    ///
    /// # Errors
    /// As [`Calibration::patterns`].
    pub fn patterns_beside(&self, rivals: &Rivals, rival: Rival) -> Result<Vec<Pattern>, FitError> {
        self.tested(&trends(self.data().model().experiment()), rivals.get(rival), &rivals.scatter)
    }

    /// The patterns of what `explained` does not explain, against the scatter of all residuals.
    fn tested(
        &self,
        trends: &[Trend],
        explained: Option<&Suspect>,
        scatter: &Scatter,
    ) -> Result<Vec<Pattern>, FitError> {
        let (gain, experiment) = (self.gain()?, self.data().model().experiment());
        let (rank, statistic) = explained.map_or((0, 0.0), |rival| (rival.seen.rank(), rival.statistic()));
        let explained = explained.map(|rival| (&rival.columns, rival.seen.inverse()));
        let scatter = scatter.without(statistic, rank);
        let observations = self.data().observations();
        let all: Vec<usize> = (0..observations.len()).collect();
        let of_mounting = self.by_mounting();
        let mut list = Vec::new();
        for &trend in trends {
            let value = |n: usize| trend.value(experiment, observations[n].set_point);
            // A step in one mounting acts on its own plateaus alone: with many mountings the others would take most of the time.
            let asked = if let Trend::Mounting(m) = trend { &of_mounting[m] } else { &all };
            let acting: Vec<usize> = asked.iter().copied().filter(|&n| value(n) != 0.0).collect();
            let largest = acting.iter().fold(0.0_f64, |most, &n| most.max(value(n).abs()));
            for axis in 0..3 {
                let column = acting.iter().map(|&n| (n, Vector3::ith(axis, value(n) / largest))).collect();
                let columns = Columns::new(gain, [column]);
                let (redundancy, along) = match &explained {
                    Some((other, inverse)) => columns.beside(other, inverse),
                    None => (columns.redundancy(), columns.along.clone()),
                };
                let (square, along) = (redundancy[(0, 0)], along[0]);
                if square <= REDUNDANT.powi(2) {
                    continue;
                }
                let statistic = along * along / square;
                let probability = scatter.chance_of_explaining(statistic, 1);
                let (amplitude, standard_uncertainty) = (along / square, 1.0 / square.sqrt());
                let length = columns.lengths[0];
                list.push(Pattern {
                    axis,
                    trend,
                    amplitude: amplitude / length,
                    standard_uncertainty: standard_uncertainty / length,
                    probability,
                    family_wise: 1.0,
                });
            }
        }
        list.sort_by(|a, b| a.probability.total_cmp(&b.probability));
        let family_wise = holm(list.iter().map(|pattern| pattern.probability));
        list.iter_mut().zip(family_wise).for_each(|(pattern, probability)| pattern.family_wise = probability);
        Ok(list)
    }

    /// The observations of each mounting.
    fn by_mounting(&self) -> Vec<Vec<usize>> {
        let experiment = self.data().model().experiment();
        let mut of_mounting = vec![Vec::new(); experiment.mountings.len()];
        for (n, observation) in self.data().observations().iter().enumerate() {
            of_mounting[experiment.set_points[observation.set_point].mounting].push(n);
        }
        of_mounting
    }
}

/// Everything that is tested.
fn trends(experiment: &Experiment) -> Vec<Trend> {
    let on_arm = (0..experiment.positions.len()).filter(|&k| !experiment.positions[k].is_free);
    let mut list = vec![Trend::Speed, Trend::Load, Trend::Time];
    list.extend(on_arm.flat_map(|k| [Trend::Position(k), Trend::SpeedInPosition(k)]));
    list.extend(experiment.seats().map(Trend::SpeedOnSeat));
    list.extend(experiment.mountings_on_arm().map(Trend::Mounting));
    list
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
