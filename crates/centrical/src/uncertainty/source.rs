//! The sources of uncertainty: what the laboratory states, split into independent influences, and how each of them
//! would change the experiment if it were off by so much.

use nalgebra::Vector3;

use crate::model::{Experiment, rotation};

/// Standard uncertainties that the data cannot show (GUM type B), SI; zero where there is none.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
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
    /// Smallest step of the reading [m/s^2], not a standard uncertainty: it leaves a rectangular error of `step/sqrt(12)`
    /// on each mean (GUM, F.2.2.1), independent of the others.
    pub resolution: f64,
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
    /// Resolution of the reading.
    Resolution,
}

impl Source {
    /// All sources in the order of the budget.
    pub const ALL: [Self; 12] = [
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
        Self::Resolution,
    ];

    /// Whether the fit weighs it: noise, speed of each plateau and priors make up the covariance of the fit.
    pub fn is_weighed(self) -> bool {
        matches!(self, Self::Noise | Self::PlateauSpeed | Self::Priors)
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
            Self::Resolution => "resolution",
        }
    }
}

/// One quantity that the fit takes as exact, with the standard uncertainty of its independent error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Influence {
    pub source: Source,
    pub quantity: Quantity,
    pub standard_uncertainty: f64,
}

/// What can be off in an experiment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Quantity {
    Gravity,
    Latitude,
    AllRadii,
    /// The radius of the seat of this mounting.
    Radius(usize),
    /// The speed of all plateaus, relative.
    SpeedScale,
    /// The speed of one plateau, relative.
    PlateauSpeed(usize),
    /// The carousel angle of one plateau.
    RestAngle(usize),
    /// Coordinate of a proof mass.
    ProofMass {
        coordinate: usize,
        mass: usize,
    },
    /// A turn of the nominal attitude of a position about an instrument axis.
    Attitude {
        position: usize,
        axis: usize,
    },
}

/// The independent influences on `experiment`, those of zero uncertainty left out.
pub(super) fn influences(experiment: &Experiment, stated: &TypeB) -> Vec<Influence> {
    let mut list = Vec::new();
    let mut add = |source, quantity, standard_uncertainty: f64| {
        if standard_uncertainty > 0.0 {
            list.push(Influence { source, quantity, standard_uncertainty });
        }
    };
    for (n, set_point) in experiment.set_points.iter().enumerate() {
        if set_point.is_rest() {
            add(Source::RestAngle, Quantity::RestAngle(n), stated.rest_angle);
        } else {
            add(Source::PlateauSpeed, Quantity::PlateauSpeed(n), experiment.speed_uncertainty_of(set_point));
        }
    }
    add(Source::Gravity, Quantity::Gravity, stated.gravity);
    if experiment.site.latitude.is_some() {
        add(Source::Latitude, Quantity::Latitude, stated.latitude);
    }
    let radii = Radii::of(stated);
    add(Source::Radius, Quantity::AllRadii, radii.common);
    for seat in (0..experiment.mountings.len()).filter(|&m| experiment.seat_of(m) == m) {
        add(radii.source, Quantity::Radius(seat), radii.own);
    }
    add(Source::SpeedScale, Quantity::SpeedScale, stated.speed_scale);
    for (mass, coordinate) in (0..3).flat_map(|mass| (0..3).map(move |coordinate| (mass, coordinate))) {
        if experiment.unit.is_coordinate_taken_as_exact(coordinate, mass) {
            add(Source::ProofMasses, Quantity::ProofMass { coordinate, mass }, stated.proof_masses);
        }
    }
    for (position, axis) in (0..experiment.positions.len()).flat_map(|k| (0..3).map(move |axis| (k, axis))) {
        add(Source::Attitude, Quantity::Attitude { position, axis }, stated.attitude);
    }
    list
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

impl Influence {
    /// Makes the experiment what it is if this quantity is `deviation` standard uncertainties larger than stated.
    pub fn apply(&self, experiment: &mut Experiment, deviation: f64) {
        let amount = deviation * self.standard_uncertainty;
        match self.quantity {
            Quantity::Gravity => experiment.site.gravity += amount,
            Quantity::Latitude => experiment.site.latitude.iter_mut().for_each(|latitude| *latitude += amount),
            Quantity::AllRadii => experiment.mountings.iter_mut().for_each(|m| m.arm_y.x += amount),
            Quantity::Radius(seat) => lengthen(experiment, seat, amount),
            Quantity::SpeedScale => experiment.set_points.iter_mut().for_each(|s| s.omega *= 1.0 + amount),
            Quantity::PlateauSpeed(n) => experiment.set_points[n].omega *= 1.0 + amount,
            Quantity::RestAngle(n) => experiment.set_points[n].angle += amount,
            Quantity::ProofMass { coordinate, mass } => experiment.unit.rho_z[(coordinate, mass)] += amount,
            Quantity::Attitude { position, axis } => {
                let p_zy = &mut experiment.positions[position].p_zy;
                *p_zy = rotation(&Vector3::ith(axis, amount)) * *p_zy;
            }
        }
    }
}

/// Lengthens the radius of all mountings on the seat of mounting `seat` [m].
fn lengthen(experiment: &mut Experiment, seat: usize, amount: f64) {
    let arm_y = experiment.mountings[seat].arm_y;
    experiment.mountings.iter_mut().filter(|m| m.arm_y == arm_y).for_each(|m| m.arm_y.x += amount);
}
