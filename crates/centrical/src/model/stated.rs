//! What the laboratory states of the quantities that the model takes as exact, split into independent influences.
//!
//! A fit takes every influence for one more unknown, zero with a standard uncertainty of 1: data that know it better sharpen
//! it, and chi^2, outliers and residuals know of it. The errors of one plateau alone, its speed, its angle at rest and its
//! rounding, are in the covariance of that plateau, which comes to the same.

use super::effect::Effect;
use super::error_model::ErrorModel;
use super::experiment::{Experiment, SetPoint};
use super::parameter::Kind;
use super::position::SwitchOn;
use super::rival::Rival;
use crate::statistics::bias_variance;

/// Standard uncertainties that a laboratory states (GUM type B), SI; zero if not stated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TypeB {
    /// Of local gravity [m/s^2].
    pub gravity: f64,
    /// Of the latitude [rad]; of no effect where the site states none.
    pub latitude: f64,
    /// Of the radius of each seat, common to all mountings there [m].
    pub radius: f64,
    /// Of the difference of the radii of any two seats [m]; `None` when the seats were measured independently.
    pub radius_difference: Option<f64>,
    /// Of the scale of the speed, common to all plateaus, relative.
    pub speed_scale: f64,
    /// Of the carousel angle of each plateau at rest [rad].
    pub rest_angle: f64,
    /// Of each coordinate of the proof masses that is not an unknown of the fit [m].
    pub proof_masses: f64,
    /// Of the nominal attitude of each position, about each instrument axis [rad].
    pub attitude: f64,
    /// Of the change of each bias between two switch-ons, of the arm and of rests in free attitudes, where the latter state none of their
    /// own [m/s^2].
    pub bias_change: f64,
    /// Of the bias of each newtonometer in each mounting: a unit that is switched off to be moved [m/s^2].
    pub mounting_bias: f64,
    /// Of the scale of each newtonometer in each mounting, relative.
    pub mounting_scale: f64,
    /// Smallest step of the reading [m/s^2], not a standard uncertainty: it leaves an error on each mean, see [`TypeB::rounding`],
    /// independent of the others.
    pub resolution: f64,
    /// Standard deviation of a single reading, rounding included, on the axis and the plateau with the least [m/s^2]; zero where it is
    /// unknown.
    pub reading_noise: f64,
    /// Of one unit of each effect that the model leaves out, in the order of [`Rival::COMMON`]: an engineer's bound.
    pub effects: [f64; Rival::COUNT],
    /// How doubtful these numbers themselves are: relative standard uncertainty of each, from which follow its
    /// degrees of freedom `1/(2 r^2)` (GUM, G.4.2). Zero: they are exact, with infinitely many.
    pub doubt: f64,
}

/// A source of uncertainty: one column of the budget.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// Noise of the plateau means (type A).
    Noise,
    /// Speed of each plateau, which the fit weighs with the noise.
    PlateauSpeed,
    /// Priors of the model.
    Priors,
    /// Local gravity.
    Gravity,
    /// Latitude.
    Latitude,
    /// Radius: its part common to all seats when their difference is stated, each seat by itself otherwise.
    Radius,
    /// Difference of the radii of the seats.
    RadiusDifference,
    /// Scale of the speed.
    SpeedScale,
    /// Carousel angle at rest.
    RestAngle,
    /// Coordinates of the proof masses.
    ProofMasses,
    /// Nominal attitudes.
    Attitude,
    /// Change of bias and scale from one switch-on to another, of mountings and of rests in free attitudes.
    BiasChange,
    /// Acceleration about the axes of a slow rotation.
    Turning,
    /// Resolution of the reading.
    Resolution,
    /// Effects that the model leaves out, as stated.
    Effects,
}

impl Source {
    /// All sources in the order of the budget.
    pub const ALL: [Self; 15] = [
        Self::Noise,
        Self::PlateauSpeed,
        Self::Priors,
        Self::Gravity,
        Self::Latitude,
        Self::Radius,
        Self::RadiusDifference,
        Self::SpeedScale,
        Self::RestAngle,
        Self::ProofMasses,
        Self::Attitude,
        Self::BiasChange,
        Self::Turning,
        Self::Resolution,
        Self::Effects,
    ];

    /// Whether it is not stated: noise, speed of each plateau and priors.
    pub fn is_weighed(self) -> bool {
        matches!(self, Self::Noise | Self::PlateauSpeed | Self::Priors)
    }

    /// Whether its errors stay the same from session to session on one station: stated, and not drawn anew for every plateau.
    pub fn is_shared(self) -> bool {
        !self.is_weighed() && !matches!(self, Self::RestAngle | Self::BiasChange | Self::Turning | Self::Resolution)
    }

    /// Its name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Noise => "noise",
            Self::PlateauSpeed => "speed of each plateau",
            Self::Priors => "priors",
            Self::Gravity => "gravity",
            Self::Latitude => "latitude",
            Self::Radius => "radius",
            Self::RadiusDifference => "difference of radii",
            Self::SpeedScale => "scale of the speed",
            Self::RestAngle => "angle at rest",
            Self::ProofMasses => "proof masses",
            Self::Attitude => "attitudes",
            Self::BiasChange => "change of bias",
            Self::Turning => "slow rotation",
            Self::Resolution => "resolution",
            Self::Effects => "effects left out",
        }
    }
}

/// An independent error of a quantity that the model takes as exact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Influence {
    /// What it belongs to.
    pub source: Source,
    /// What it does to a plateau, per unit.
    pub effect: Effect,
    /// Its standard uncertainty, in units of the effect.
    pub standard_uncertainty: f64,
}

// Arrays of more than 32 have no default of their own.
impl Default for TypeB {
    fn default() -> Self {
        Self {
            gravity: 0.0,
            latitude: 0.0,
            radius: 0.0,
            radius_difference: None,
            speed_scale: 0.0,
            rest_angle: 0.0,
            proof_masses: 0.0,
            attitude: 0.0,
            bias_change: 0.0,
            mounting_bias: 0.0,
            mounting_scale: 0.0,
            resolution: 0.0,
            reading_noise: 0.0,
            effects: [0.0; Rival::COUNT],
            doubt: 0.0,
        }
    }
}

impl TypeB {
    /// The influences on more than one plateau, those of zero uncertainty left out.
    pub(super) fn influences(&self, experiment: &Experiment, error_model: &ErrorModel) -> Vec<Influence> {
        let mut list = Vec::new();
        let mut add = |source, effect, standard_uncertainty: f64| {
            if standard_uncertainty > 0.0 {
                list.push(Influence { source, effect, standard_uncertainty });
            }
        };
        add(Source::Gravity, Effect::Gravity, self.gravity);
        if experiment.site.latitude.is_some() {
            add(Source::Latitude, Effect::Latitude, self.latitude);
        }
        let radii = Radii::of(self);
        if experiment.has_arm() {
            add(Source::Radius, Effect::SeatPlace { axis: 0, seat: None }, radii.common);
        }
        for seat in experiment.seats() {
            add(radii.source, Effect::SeatPlace { axis: 0, seat: Some(seat) }, radii.own);
        }
        // The effect is one on the square of the speed.
        add(Source::SpeedScale, Effect::SpeedScale, 2.0 * self.speed_scale);
        for (mass, coordinate) in (0..3).flat_map(|mass| (0..3).map(move |coordinate| (mass, coordinate))) {
            if experiment.unit.is_coordinate_taken_as_exact(coordinate, mass) {
                add(Source::ProofMasses, Effect::Coordinate { coordinate, mass }, self.proof_masses);
            }
        }
        let on_arm = (0..experiment.positions.len()).filter(|&k| !experiment.positions[k].is_free);
        for (position, axis) in on_arm.flat_map(|k| (0..3).map(move |axis| (k, axis))) {
            add(Source::Attitude, Effect::PositionTurn { position, axis }, self.attitude);
        }
        for (mounting, axis) in experiment.mountings_on_arm().flat_map(|m| (0..3).map(move |axis| (m, axis))) {
            add(Source::BiasChange, Effect::bias_of_mounting(axis, mounting), self.mounting_bias);
            add(Source::BiasChange, Effect::scale_of_mounting(axis, mounting), self.mounting_scale);
        }
        for SwitchOn { number: switch_on, bias_change, .. } in experiment.other_switch_ons() {
            for axis in 0..3 {
                let u = bias_change.unwrap_or(self.bias_change);
                add(Source::BiasChange, Effect::change_of_bias(axis, switch_on), u);
            }
        }
        for SwitchOn { number: switch_on, from_axes, .. } in experiment.turned_switch_ons() {
            for axis in 0..3 {
                add(Source::Turning, Effect::Turning { axis, switch_on }, from_axes);
            }
        }
        for first in repeated_rests(experiment) {
            for axis in 0..3 {
                add(Source::Resolution, Effect::Rounding { axis, first }, self.rounding());
            }
        }
        for (rival, u) in Rival::COMMON.iter().zip(self.effects) {
            for unknown in rival.parameters(experiment, error_model) {
                if let Kind::Effect(effect) = unknown.kind {
                    add(Source::Effects, effect, u);
                }
            }
        }
        list
    }

    /// Standard uncertainty of the rounding of one mean [m/s^2]: without noise that of a rectangular error of one step, `step / sqrt(12)`
    /// (GUM, F.2.2.1), and less where noise dithers it. Rounding adds a quarter of the squared step to the variance of a reading at most:
    /// what is above it is noise.
    pub fn rounding(&self) -> f64 {
        let step = self.resolution;
        let noise_variance = self.reading_noise * self.reading_noise - 0.25 * step * step;
        if step > 0.0 && noise_variance > 0.0 {
            bias_variance(step, noise_variance, 0.0).sqrt()
        } else {
            step / 12.0_f64.sqrt()
        }
    }

    /// That part of it which is independent of all other plateaus: none for a rest that is repeated, since equal forces round
    /// alike.
    pub(super) fn own_rounding(&self, set_point: &SetPoint) -> f64 {
        if set_point.history.repeats.is_some() { 0.0 } else { self.rounding() }
    }
}

/// The first of each group of repeated rests.
fn repeated_rests(experiment: &Experiment) -> impl Iterator<Item = usize> + '_ {
    let set_points = experiment.set_points.iter().enumerate();
    set_points.filter(|(n, set_point)| set_point.history.repeats == Some(*n)).map(|(n, _)| n)
}

/// The error of a radius as a common part and an own part of each seat.
struct Radii {
    common: f64,
    own: f64,
    source: Source,
}

impl Radii {
    /// Own parts of `u_D / sqrt 2` give the difference of two seats the uncertainty `u_D`; the common part makes up
    /// the rest of `u_R^2`. A difference beyond `sqrt 2 u_R`, that of independent seats, leaves no common part.
    fn of(stated: &TypeB) -> Self {
        let Some(difference) = stated.radius_difference else {
            return Self { common: 0.0, own: stated.radius, source: Source::Radius };
        };
        let own = difference / std::f64::consts::SQRT_2;
        let common = (stated.radius * stated.radius - own * own).max(0.0).sqrt();
        Self { common, own, source: Source::RadiusDifference }
    }
}

#[cfg(test)]
mod tests {
    use super::TypeB;
    use crate::statistics::Random;

    /// Errors of means of rounded readings are as large as stated, or smaller, since the least noise is taken. The error is rectangular without
    /// noise, and vanishes with a noise of one step.
    #[test]
    fn rounding_is_as_large_as_stated_or_smaller() {
        const READINGS: usize = 4000;
        const LEVELS: usize = 400;
        let mut random = Random::stream(11, 0);
        for noise in [0.0, 0.2, 0.35, 0.5, 0.7] {
            let (mut squares, mut least) = (0.0, f64::INFINITY);
            for _ in 0..LEVELS {
                let level = random.uniform();
                // Without their own mean, the noise of the readings leaves rounding alone.
                let drawn: Vec<f64> = (0..READINGS).map(|_| noise * random.normal()).collect();
                let own = drawn.iter().sum::<f64>() / READINGS as f64;
                let readings: Vec<f64> = drawn.iter().map(|drawn| (level + drawn).round()).collect();
                let mean = readings.iter().sum::<f64>() / READINGS as f64;
                let variance = readings.iter().map(|reading| (reading - mean).powi(2)).sum::<f64>() / READINGS as f64;
                squares += (mean - level - own).powi(2) / LEVELS as f64;
                least = variance.min(least);
            }
            let stated = TypeB { resolution: 1.0, reading_noise: least.sqrt(), ..TypeB::default() }.rounding();
            // Of `READINGS` roundings, each off by a step's deviation, and of `LEVELS` squares.
            let chance = 1.0 / 12.0 / READINGS as f64;
            assert!(squares < 1.25 * stated * stated + 2.0 * chance, "{noise}: {squares} against {stated}^2");
        }
        let at = |reading_noise: f64| TypeB { resolution: 1.0, reading_noise, ..TypeB::default() }.rounding();
        assert!((at(0.0) - 12.0_f64.sqrt().recip()).abs() < 1e-15 && at(1.04) < 1e-7, "{} {}", at(0.0), at(1.04));
        // Where noise begins to be known the series is that of a rectangle.
        assert!((at(0.5 + 1e-9) / at(0.0) - 1.0).abs() < 0.02);
    }
}
