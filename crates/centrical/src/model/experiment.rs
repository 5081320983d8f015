//! The experiment as data: where the laboratory is, what the unit is, how it was mounted and what was set.

use nalgebra::{Matrix3, Vector3};

use super::position::{Position, SwitchOn};

/// Standard gravity, exact by definition [m/s^2]: what "1 g" means in every quantity shown to people.
pub const STANDARD_GRAVITY: f64 = 9.80665;

/// Relative difference of two measured speeds that were set alike: far above the stability of a precision centrifuge, far
/// below the steps between the speeds of a schedule.
const SAME_SPEED: f64 = 1e-3;

/// Angles of rest that are nearer are one [rad].
const SAME_ANGLE: f64 = 1e-3;

/// An experiment: everything that is known before any reading is taken.
#[derive(Debug, Clone, PartialEq)]
pub struct Experiment {
    /// The laboratory.
    pub site: Site,
    /// The unit's geometry.
    pub unit: Unit,
    /// The centrifuge.
    pub centrifuge: Centrifuge,
    /// Nominal attitudes.
    pub positions: Vec<Position>,
    /// How `dR` of the positions of one pair are related.
    pub pair_relation: PairRelation,
    /// Installations of the unit on the arm, in the order of the session.
    pub mountings: Vec<Mounting>,
    /// All plateaus, mounting by mounting in the order of the schedule.
    pub set_points: Vec<SetPoint>,
}

/// The laboratory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Site {
    /// Local gravity `g` [m/s^2].
    pub gravity: f64,
    /// Geodetic latitude [rad]; with it the Earth-rate term is applied.
    pub latitude: Option<f64>,
}

/// Geometry of the unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// `rho0`: column `j` is the point of proof mass `j` from the reference point, instrument axes [m].
    pub rho_z: Matrix3<f64>,
    /// What the reference point is.
    pub reference: ReferencePoint,
}

/// The centrifuge.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Centrifuge {
    /// Sense of its rotation.
    pub rotation: Rotation,
    /// Relative standard uncertainty of the speed of a plateau that states none of its own.
    pub speed_uncertainty: f64,
}

/// Sense of rotation about the third arm axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Rotation {
    /// Right-handed about Up.
    #[default]
    Positive,
    /// Left-handed about Up.
    Negative,
}

/// The two conventions of the source for the unit's reference point, which decide the form of `rho0`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReferencePoint {
    /// Proof mass 1: the first column of `rho0` is zero and `drho_22`, `drho_33` are unknown.
    FirstProofMass,
    /// The point from which no proof mass is displaced along its own axis: the diagonal of `rho0` is zero
    /// by definition and no `drho` acts on the readings.
    OwnAxes,
}

/// How the errors `dR` of the two positions of a pair are related.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PairRelation {
    /// The shift is fixed to the seat on the arm: `dR` of the second position `= + dR` of the first.
    Common,
    /// As the source prints: `dR` of the second position `= - dR` of the first (the shift is fixed to the unit).
    Opposite,
    /// Every position has its own `dR`.
    Free,
}

/// One installation of the unit on the arm.
#[derive(Debug, Clone, PartialEq)]
pub struct Mounting {
    /// Index of its position in [`Experiment::positions`].
    pub position: usize,
    /// `R0`: nominal place of the reference point, arm axes [m].
    pub arm_y: Vector3<f64>,
}

/// What was set for one plateau.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SetPoint {
    /// Index of its mounting in [`Experiment::mountings`].
    pub mounting: usize,
    /// Angular speed `Omega` about the third arm axis [rad/s], positive when right-handed about Up; 0 at rest.
    pub omega: f64,
    /// Carousel angle `alpha_3` at rest [rad]; of no meaning while spinning.
    pub angle: f64,
    /// Relative standard uncertainty of this speed, as of a speed that was measured; `None`: that of the centrifuge.
    pub speed_uncertainty: Option<f64>,
    /// What came before it in the session; a [`MeasurementModel`](super::MeasurementModel) fills it in for its set points.
    pub history: History,
}

/// What came before a plateau, as far as a unit or a machine may remember it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct History {
    /// Place in the order of the session, -1/2 to 1/2.
    pub time: f64,
    /// The remainder of a warm-up: 1 on the first plateau of a mounting on the arm, and half of the preceding value on each further one.
    pub warm_up: f64,
    /// Sum of `|Omega|^3` over the plateaus of the mounting before, and half of it on this one, over that of 10 rev/s.
    pub heat: f64,
    /// +1 after a rise of the speed, -1 after a fall, 0 before the first.
    pub rise: f64,
    /// Nominal specific force of the plateaus before, each half as much as the next [m/s^2].
    pub memory: Vector3<f64>,
    /// `d / sqrt(d^2 + d0^2)` of the change `d` of the nominal specific force since the plateau before, on each axis; zero for the first
    /// plateau of a mounting on the arm. Below `d0`, a twentieth of g, no force turns by intent.
    pub turn: Vector3<f64>,
    /// Index of the first of the rests of this mounting at this angle, where there are several: equal forces round alike.
    pub repeats: Option<usize>,
}

impl ReferencePoint {
    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::FirstProofMass => "first-proof-mass",
            Self::OwnAxes => "own-axes",
        }
    }
}

impl Rotation {
    /// Sign of the angular speed.
    pub fn sign(self) -> f64 {
        match self {
            Self::Positive => 1.0,
            Self::Negative => -1.0,
        }
    }
}

impl PairRelation {
    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Common => "common",
            Self::Opposite => "opposite",
            Self::Free => "free",
        }
    }
}

impl Unit {
    /// Whether coordinate `i` of proof mass `j` is taken as exact: neither zero by the choice of the reference point
    /// nor an unknown of the fit, as `rho_22` and `rho_33` are when the reference is proof mass 1.
    pub fn is_coordinate_taken_as_exact(&self, i: usize, j: usize) -> bool {
        i != j && (self.reference == ReferencePoint::OwnAxes || j != 0)
    }
}

impl SetPoint {
    /// A plateau at rest at `angle` [rad].
    pub fn at_rest(mounting: usize, angle: f64) -> Self {
        Self { mounting, angle, ..Self::default() }
    }

    /// A plateau at the speed `omega` [rad/s], as uncertain as the centrifuge states.
    pub fn spinning(mounting: usize, omega: f64) -> Self {
        Self { mounting, omega, ..Self::default() }
    }

    /// Whether it is the same plateau run again: equal set points, or speeds that agree to a thousandth, at least one of
    /// them measured.
    pub fn repeats(&self, other: &Self) -> bool {
        let is_measured = self.speed_uncertainty.is_some() || other.speed_uncertainty.is_some();
        let close = (self.omega - other.omega).abs() <= SAME_SPEED * other.omega.abs();
        let is_same_speed = self.omega == other.omega || (is_measured && close);
        self.mounting == other.mounting && self.angle == other.angle && is_same_speed
    }

    /// Whether the centrifuge stands still.
    pub fn is_rest(&self) -> bool {
        self.omega == 0.0
    }

    /// Whether the plateau is a rest at an angle [rad], whole turns apart or not.
    pub(crate) fn rests_at(&self, angle: f64) -> bool {
        let apart = self.angle - angle;
        self.is_rest() && apart.sin().abs() < SAME_ANGLE && apart.cos() > 0.0
    }

    /// The angles of some rests in their order: of each the index of its first rest, and the angle [rad].
    pub(crate) fn distinct_angles<'s>(rests: impl Iterator<Item = (usize, &'s Self)>) -> Vec<(usize, f64)> {
        let mut angles: Vec<(usize, f64)> = Vec::new();
        for (n, rest) in rests {
            if !angles.iter().any(|(_, angle)| rest.rests_at(*angle)) {
                angles.push((n, rest.angle));
            }
        }
        angles
    }

    /// Whether the plateau spins at a speed, whatever the sense, that was set and not measured.
    pub(crate) fn has_speed(&self, omega: f64) -> bool {
        let (own, other) = (self.omega.abs(), omega.abs());
        !self.is_rest() && self.speed_uncertainty.is_none() && (own - other).abs() <= SAME_SPEED * own
    }
}

impl Site {
    /// Mean sidereal rate of the Earth's rotation [rad/s], IERS conventions.
    pub const EARTH_RATE: f64 = 7.292_115e-5;

    /// `2 omega_E sin(latitude)` [rad/s]: with it `Omega^2` becomes `Omega^2 + coriolis Omega`, the constant
    /// part of the Coriolis term in the arm frame (`docs/source-and-findings.md`). Zero when no latitude is given.
    pub fn coriolis(&self) -> f64 {
        self.latitude.map_or(0.0, |latitude| 2.0 * Self::EARTH_RATE * latitude.sin())
    }
}

impl Experiment {
    /// Position of a plateau.
    pub fn position_of(&self, set_point: &SetPoint) -> &Position {
        &self.positions[self.mountings[set_point.mounting].position]
    }

    /// Whether any position is on the arm.
    pub fn has_arm(&self) -> bool {
        self.positions.iter().any(|position| !position.is_free)
    }

    /// The switch-ons whose biases may differ from those of the reference, each once: of the arm if there is one, or else of the first
    /// rest.
    pub fn other_switch_ons(&self) -> Vec<SwitchOn> {
        let reference = if self.has_arm() { Some(0) } else { self.positions.first().map(|p| p.switch_on.number) };
        let mut others: Vec<SwitchOn> = Vec::new();
        for switch_on in self.positions.iter().map(|position| position.switch_on) {
            let is_known = others.iter().any(|other| other.number == switch_on.number);
            if Some(switch_on.number) != reference && !is_known {
                others.push(switch_on);
            }
        }
        others
    }

    /// The switch-ons in which the unit turned slowly, each once, with its largest distance from the axes.
    pub fn turned_switch_ons(&self) -> Vec<SwitchOn> {
        let mut turned: Vec<SwitchOn> = Vec::new();
        let switch_ons = self.positions.iter().map(|position| position.switch_on);
        for switch_on in switch_ons.filter(|switch_on| switch_on.from_axes > 0.0) {
            match turned.iter_mut().find(|other| other.number == switch_on.number) {
                Some(same) => same.from_axes = same.from_axes.max(switch_on.from_axes),
                None => turned.push(switch_on),
            }
        }
        turned
    }

    /// Whether there are rests in free attitudes.
    pub fn has_free_attitudes(&self) -> bool {
        self.positions.iter().any(|position| position.is_free)
    }

    /// Whether a mounting is on the arm, and not a rest in a free attitude.
    pub fn is_on_arm(&self, mounting: usize) -> bool {
        !self.positions[self.mountings[mounting].position].is_free
    }

    /// The mountings on the arm.
    pub fn mountings_on_arm(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.mountings.len()).filter(|&m| self.is_on_arm(m))
    }

    /// The seats: the first mounting on the arm at each place `R0`.
    pub fn seats(&self) -> impl Iterator<Item = usize> + '_ {
        self.mountings_on_arm().filter(|&m| self.seat_of(m) == m)
    }

    /// The speeds that were set and not measured, the lowest first: of each the index of its first set point, and the number of plateaus.
    pub fn set_speeds(&self) -> Vec<(usize, usize)> {
        let set = |(_, s): &(usize, &SetPoint)| s.has_speed(s.omega) && self.is_on_arm(s.mounting);
        let mut all: Vec<(usize, &SetPoint)> = self.set_points.iter().enumerate().filter(set).collect();
        all.sort_by(|(a, one), (b, other)| one.omega.abs().total_cmp(&other.omega.abs()).then(a.cmp(b)));
        let same = all.chunk_by(|(_, one), (_, other)| one.has_speed(other.omega));
        same.map(|same| (same.iter().map(|(n, _)| *n).min().unwrap_or(0), same.len())).collect()
    }

    /// The angles at which the arm rests, in the order of the session: of each the index of its first set point, and the angle [rad].
    pub(crate) fn rest_angles(&self) -> Vec<(usize, f64)> {
        SetPoint::distinct_angles(
            self.set_points.iter().enumerate().filter(|(_, s)| s.is_rest() && self.is_on_arm(s.mounting)),
        )
    }

    /// Nominal place `R0` of a plateau, arm axes [m].
    pub fn arm_of(&self, set_point: &SetPoint) -> &Vector3<f64> {
        &self.mountings[set_point.mounting].arm_y
    }

    /// Relative standard uncertainty of the speed of a plateau: its own, or that of the centrifuge.
    pub fn speed_uncertainty_of(&self, set_point: &SetPoint) -> f64 {
        set_point.speed_uncertainty.unwrap_or(self.centrifuge.speed_uncertainty)
    }

    /// Index of the first mounting on the same seat (same `R0`) as mounting `m`.
    pub fn seat_of(&self, m: usize) -> usize {
        let arm = self.mountings[m].arm_y;
        self.mountings_on_arm().find(|&other| self.mountings[other].arm_y == arm).unwrap_or(m)
    }

    /// `Omega^2 + 2 Omega omega_E sin(latitude)` of a plateau [rad^2/s^2].
    pub fn rate_squared(&self, set_point: &SetPoint) -> f64 {
        set_point.omega * (set_point.omega + self.site.coriolis())
    }
}
