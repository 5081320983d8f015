//! The exact model. Newtonometer `i` of the unit in position `k` is ideally pulled by
//!
//! `f_i = e_i^T B ( g u(alpha_3) + D (r + B^T rho e_i) )`,  `B = rotation(delta_k) P_k`,
//! `D = -w diag(1, 1, 0)`,  `u = carousel(alpha_3) rotation(alpha) e_3`,  `r = R0_k + dR_k`,  `rho = rho0 + drho`,
//!
//! [K3.1] and [K3.2] without their small-angle step. `w = Omega^2 + 2 Omega omega_E sin(latitude)` holds the
//! constant part of the Coriolis term, which the source takes for a term of zero mean. The reading is the
//! error model [K4.1] of `f`, averaged over a revolution while spinning, at the known `alpha_3` at rest.

use std::borrow::Cow;
use std::f64::consts::FRAC_PI_2;

use nalgebra::{Matrix3, Matrix3x2, Vector3};

use super::effect::{Effect, Share};
use super::experiment::SetPoint;
use super::frame::{carousel, hat, rotation, rotation_rate};
use super::measurement::MeasurementModel;
use super::parameters::OfPosition;
use super::plateau::Linearisation;

impl MeasurementModel {
    /// Mean reading `f'` [m/s^2] of a plateau at the unknowns `x` (in the order of [`super::Parameters`]).
    pub fn reading(&self, set_point: &SetPoint, x: &[f64]) -> Vector3<f64> {
        let geometry = self.geometry(set_point, x);
        let pull = geometry.pull();
        let coefficients = self.parameters.coefficients(x);
        let turns = self.turns(set_point);
        let sum: Vector3<f64> = turns
            .iter()
            .map(|turn| self.error_model.reading(coefficients, &(pull + geometry.weight_of(turn) * geometry.up)))
            .sum();
        sum / turns.len() as f64 + self.disturbance(set_point, x)
    }

    /// Mean reading `f'` [m/s^2] at the unknowns `x` of a fit: parameters, then influences in their standard uncertainties.
    pub(crate) fn reading_with_influences(&self, set_point: &SetPoint, x: &[f64]) -> Vector3<f64> {
        let parameters = &x[..self.parameters.len()];
        if self.influences().is_empty() {
            return self.reading(set_point, parameters);
        }
        self.linearise(set_point, parameters).with_influences(x).reading
    }

    /// Mean specific force `f` [m/s^2] along the three sensitive axes on a plateau at the unknowns `x`: what an
    /// instrument without errors would read.
    pub fn specific_force(&self, set_point: &SetPoint, x: &[f64]) -> Vector3<f64> {
        let geometry = self.geometry(set_point, x);
        let turns = self.turns(set_point);
        let weight: Vector3<f64> = turns.iter().map(|turn| geometry.weight_of(turn) * geometry.up).sum();
        geometry.pull() + weight / turns.len() as f64
    }

    /// Mean reading of a plateau with its analytic first derivatives by `x` and by the logarithm of the speed.
    pub fn linearise(&self, set_point: &SetPoint, x: &[f64]) -> Linearisation {
        let geometry = self.geometry(set_point, x);
        let pull = geometry.pull();
        let coefficients = self.parameters.coefficients(x);
        let turns = self.turns(set_point);
        let share = 1.0 / turns.len() as f64;

        let mut reading = Vector3::zeros();
        let mut gain_mean = Matrix3::zeros();
        let mut by_tilt = Matrix3x2::zeros();
        let mut by_weight_turn = Matrix3::zeros();
        let mut by_gravity = Vector3::zeros();
        let mut monomials = vec![0.0; self.error_model.terms.len()];
        let up_by_tilt = geometry.up_by_tilt();
        for turn in turns.iter() {
            let weight_of = geometry.weight_of(turn);
            let weight = weight_of * geometry.up;
            let at =
                self.error_model.expanded(coefficients, &(pull + weight), |t, value| monomials[t] += share * value);
            let gain = share * at.gain;
            reading += share * at.reading;
            gain_mean += gain;
            by_tilt += gain * (weight_of * up_by_tilt);
            by_weight_turn += gain * turned(&weight);
            by_gravity += gain * weight / geometry.gravity;
        }
        let partials = Partials {
            tilt: by_tilt,
            turn: (by_weight_turn + gain_mean * geometry.pull_by_turn()) * rotation_rate(&geometry.turn),
            arm: gain_mean * geometry.pull_by_arm(),
            proof_mass: gain_mean * Matrix3::from_diagonal(&geometry.pull_by_proof_mass()),
            coordinate: geometry.m() * geometry.rate_squared,
            rate: gain_mean * geometry.pull_by_rate(),
            gravity: by_gravity,
            gain: gain_mean,
        };
        let columns = self.columns(set_point, &partials, &monomials);
        Linearisation {
            reading: reading + self.disturbance(set_point, x),
            setting_error: self.setting_error(set_point, x, &geometry, &partials),
            rounding: self.own_rounding(set_point),
            normal: self.normal(set_point, &columns),
            columns,
            stated: self.stated_columns(set_point, &partials),
        }
    }

    /// The plateau's geometry at `x`.
    pub(super) fn geometry(&self, set_point: &SetPoint, x: &[f64]) -> Geometry {
        let (experiment, parameters) = (&self.experiment, &self.parameters);
        let mounting = &experiment.mountings[set_point.mounting];
        let pair = |column: usize| Vector3::new(x[column], x[column + 1], 0.0);
        let (tilt, turn, shift_y) = match parameters.of_position(mounting.position) {
            OfPosition::OnArm { turn, shift } => (
                parameters.tilt().map_or_else(Vector3::zeros, pair),
                Vector3::new(x[turn], x[turn + 1], x[turn + 2]),
                pair(shift.column) * shift.sign,
            ),
            OfPosition::Free { attitude, case_turn } => {
                let turn = case_turn.map_or_else(Vector3::zeros, |c| Vector3::new(x[c], x[c + 1], x[c + 2]));
                (pair(attitude), turn, Vector3::zeros())
            }
        };
        let mut geometry = Geometry {
            gravity: experiment.site.gravity,
            p_zy: experiment.positions[mounting.position].p_zy,
            tilt,
            up: Vector3::z(),
            turn,
            arm_y: mounting.arm_y + shift_y,
            rho_z: experiment.unit.rho_z,
            rate_squared: experiment.rate_squared(set_point),
            c_zy: Matrix3::zeros(),
        };
        if let Some(column) = parameters.proof_mass() {
            geometry.rho_z[(1, 1)] += x[column];
            geometry.rho_z[(2, 2)] += x[column + 1];
        }
        for (effect, size) in self.acting(x) {
            match effect.share(&self.experiment, set_point) {
                Share::Tilt(axis) => geometry.tilt[axis] += size,
                Share::Turn(turn) => geometry.turn += turn * size,
                Share::Arm(displacement) => geometry.arm_y += displacement * size,
                Share::Coordinate { coordinate, mass } => geometry.rho_z[(coordinate, mass)] += size,
                Share::Rate(rate) => geometry.rate_squared += rate * size,
                Share::Gravity => geometry.gravity += size,
                // Readings are added behind the error model.
                Share::None | Share::Reading(_) => {}
            }
        }
        geometry.up = rotation(&geometry.tilt) * Vector3::z();
        geometry.c_zy = rotation(&geometry.turn) * geometry.p_zy;
        geometry
    }

    /// Effects beyond the source's unknowns with their sizes: those that are unknowns, and influences that are off.
    pub(super) fn acting<'a>(&'a self, x: &'a [f64]) -> impl Iterator<Item = (Effect, f64)> + 'a {
        let unknown = self.parameters.effects().map(|(column, effect)| (effect, x[column]));
        unknown.chain(self.deviating())
    }

    /// What the effects add to the readings behind the error model [m/s^2].
    pub(super) fn disturbance(&self, set_point: &SetPoint, x: &[f64]) -> Vector3<f64> {
        let mut sum = Vector3::zeros();
        for (effect, size) in self.acting(x) {
            if let Share::Reading(reading) = effect.share(&self.experiment, set_point) {
                sum += reading * size;
            }
        }
        sum
    }

    /// Turns of the carousel whose mean is the mean of the reading: the known one at rest, equal steps while spinning.
    fn turns(&self, set_point: &SetPoint) -> Cow<'_, [Matrix3<f64>]> {
        if set_point.is_rest() { Cow::Owned(vec![carousel(set_point.angle)]) } else { Cow::Borrowed(&self.revolution) }
    }

    /// Change of the reading by one standard uncertainty of what the plateau was set to.
    fn setting_error(&self, set_point: &SetPoint, x: &[f64], geometry: &Geometry, partials: &Partials) -> Vector3<f64> {
        if !self.experiment.is_on_arm(set_point.mounting) {
            return Vector3::zeros();
        }
        if set_point.is_rest() {
            // d carousel(a) / da = carousel(a + pi/2) without the axis.
            let mut rate = carousel(set_point.angle + FRAC_PI_2);
            rate[(2, 2)] = 0.0;
            return partials.gain * (geometry.weight_of(&rate) * geometry.up) * self.stated().rest_angle;
        }
        self.by_log_speed(set_point, x, partials) * self.experiment.speed_uncertainty_of(set_point)
    }

    /// `d f' / d ln Omega`: through the rate and through every effect that changes with it.
    fn by_log_speed(&self, set_point: &SetPoint, x: &[f64], partials: &Partials) -> Vector3<f64> {
        let omega = set_point.omega;
        let mut speed = partials.rate * (omega * (2.0 * omega + self.experiment.site.coriolis()));
        for (effect, size) in self.acting(x) {
            speed += match effect.share(&self.experiment, set_point) {
                Share::Turn(turn) if effect.is_elastic() => partials.turn * turn * (2.0 * size),
                Share::Arm(displacement) if effect.is_elastic() => partials.arm * displacement * (2.0 * size),
                // The Earth's rotation and an offset act with `Omega`, a scale of the speeds with its square.
                Share::Rate(rate) if matches!(effect, Effect::EarthRate | Effect::Latitude | Effect::SpeedOffset) => {
                    partials.rate * (rate * size)
                }
                Share::Rate(rate) => partials.rate * (2.0 * rate * size),
                Share::Reading(_) => self.reading_by_log_speed(set_point, effect) * size,
                Share::Tilt(_)
                | Share::Turn(_)
                | Share::Arm(_)
                | Share::Coordinate { .. }
                | Share::Gravity
                | Share::None => Vector3::zeros(),
            };
        }
        speed
    }

    /// Derivative of what one unit of an effect adds to the readings, by the logarithm of the speed.
    fn reading_by_log_speed(&self, set_point: &SetPoint, effect: Effect) -> Vector3<f64> {
        /// Polynomials of low degree in `Omega^2` are differenced to some 1e-8.
        const STEP: f64 = 1e-4;
        let at = |factor: f64| match effect
            .share(&self.experiment, &SetPoint { omega: set_point.omega * factor, ..*set_point })
        {
            Share::Reading(reading) => reading,
            _ => Vector3::zeros(),
        };
        (at(1.0 + STEP) - at(1.0 - STEP)) / (2.0 * STEP)
    }

    /// Changes of the reading by one standard uncertainty of each influence, an unknown behind the parameters.
    fn stated_columns(&self, set_point: &SetPoint, partials: &Partials) -> Vec<(usize, Vector3<f64>)> {
        let influences = (self.parameters.len()..).zip(self.influences());
        let changes = influences.filter_map(|(unknown, influence)| {
            let change = partials.by_share(&influence.effect.share(&self.experiment, set_point))?;
            Some((unknown, change * influence.standard_uncertainty))
        });
        changes.collect()
    }

    fn columns(&self, set_point: &SetPoint, partials: &Partials, monomials: &[f64]) -> Vec<(usize, Vector3<f64>)> {
        let parameters = &self.parameters;
        let position = self.experiment.mountings[set_point.mounting].position;
        let mut columns = Vec::with_capacity(10 + monomials.len());
        let (tilt, turn, shift) = match parameters.of_position(position) {
            OfPosition::OnArm { turn, shift } => (parameters.tilt(), Some(turn), Some(shift)),
            OfPosition::Free { attitude, case_turn } => (Some(attitude), case_turn, None),
        };
        for (column, axis) in tilt.into_iter().flat_map(|c| [(c, 0), (c + 1, 1)]) {
            columns.push((column, partials.tilt.column(axis).into_owned()));
        }
        for (column, axis) in turn.into_iter().flat_map(|c| [(c, 0), (c + 1, 1), (c + 2, 2)]) {
            columns.push((column, partials.turn.column(axis).into_owned()));
        }
        if let Some(shift) = shift.filter(|_| !set_point.is_rest()) {
            for axis in 0..2 {
                columns.push((shift.column + axis, partials.arm.column(axis) * shift.sign));
            }
            for (column, axis) in parameters.proof_mass().into_iter().flat_map(|c| [(c, 1), (c + 1, 2)]) {
                columns.push((column, partials.proof_mass.column(axis).into_owned()));
            }
        }
        for ((column, term), monomial) in (parameters.first_term()..).zip(&self.error_model.terms).zip(monomials) {
            columns.push((column, Vector3::from_fn(|axis, _| if axis == term.axis { *monomial } else { 0.0 })));
        }
        for (column, effect) in parameters.effects() {
            if let Some(change) = partials.by_share(&effect.share(&self.experiment, set_point)) {
                columns.push((column, change));
            }
        }
        columns
    }
}

/// Derivatives of the mean reading by the geometry.
struct Partials {
    /// By `alpha_1, alpha_2`.
    tilt: Matrix3x2<f64>,
    /// By the turn about the three instrument axes.
    turn: Matrix3<f64>,
    /// By the place of the reference point, arm axes.
    arm: Matrix3<f64>,
    /// By `rho_11, rho_22, rho_33`.
    proof_mass: Matrix3<f64>,
    /// `w M`: pull along axis `j` by coordinate `i` of proof mass `j`, as entry `(j, i)`.
    coordinate: Matrix3<f64>,
    /// By `w`.
    rate: Vector3<f64>,
    /// By gravity.
    gravity: Vector3<f64>,
    /// By the specific force.
    gain: Matrix3<f64>,
}

impl Partials {
    /// Change of the reading by one unit of an effect.
    fn by_share(&self, share: &Share) -> Option<Vector3<f64>> {
        match *share {
            Share::None => None,
            Share::Tilt(axis) => Some(self.tilt.column(axis).into_owned()),
            Share::Turn(turn) => Some(self.turn * turn),
            Share::Arm(displacement) => Some(self.arm * displacement),
            Share::Coordinate { coordinate, mass } => {
                Some(self.gain.column(mass) * self.coordinate[(mass, coordinate)])
            }
            Share::Rate(rate) => Some(self.rate * rate),
            Share::Gravity => Some(self.gravity),
            Share::Reading(reading) => Some(reading),
        }
    }
}

/// Geometry of one plateau.
pub(super) struct Geometry {
    pub gravity: f64,
    pub p_zy: Matrix3<f64>,
    pub tilt: Vector3<f64>,
    /// `rotation(alpha) e_3`.
    pub up: Vector3<f64>,
    pub turn: Vector3<f64>,
    pub arm_y: Vector3<f64>,
    pub rho_z: Matrix3<f64>,
    /// `w` [rad^2/s^2].
    pub rate_squared: f64,
    /// `B`.
    pub c_zy: Matrix3<f64>,
}

impl Geometry {
    /// `g B carousel(alpha_3)`: takes the vertical to gravity's reaction.
    fn weight_of(&self, turn: &Matrix3<f64>) -> Matrix3<f64> {
        self.c_zy * turn * self.gravity
    }

    /// `d rotation(alpha) e_3 / d (alpha_1, alpha_2)`.
    fn up_by_tilt(&self) -> Matrix3x2<f64> {
        (turned(&self.up) * rotation_rate(&self.tilt)).fixed_columns::<2>(0).into_owned()
    }

    /// Centripetal part: `w ( B d r + diag(M rho) )` with `d = -diag(1, 1, 0)`, `M = B d B^T`.
    fn pull(&self) -> Vector3<f64> {
        self.pull_by_rate() * self.rate_squared
    }

    pub fn pull_by_rate(&self) -> Vector3<f64> {
        self.c_zy * horizontal(&self.arm_y) + (self.m() * self.rho_z).diagonal()
    }

    fn pull_by_arm(&self) -> Matrix3<f64> {
        self.c_zy * Matrix3::from_diagonal(&horizontal(&Vector3::repeat(1.0))) * self.rate_squared
    }

    fn pull_by_proof_mass(&self) -> Vector3<f64> {
        self.m().diagonal() * self.rate_squared
    }

    /// By a small turn `psi` on top of `B`: `dB = hat(psi) B`, `dM = hat(psi) M - M hat(psi)`.
    fn pull_by_turn(&self) -> Matrix3<f64> {
        let m = self.m();
        let mut by_turn = turned(&(self.c_zy * horizontal(&self.arm_y)));
        for axis in 0..3 {
            let h = hat(&Vector3::ith(axis, 1.0));
            let own = ((h * m - m * h) * self.rho_z).diagonal();
            let mut column = by_turn.column_mut(axis);
            column += own;
        }
        by_turn * self.rate_squared
    }

    /// `M = B d B^T`, the source's `M_k` for a unit rate.
    fn m(&self) -> Matrix3<f64> {
        let axis_z = self.c_zy.column(2);
        axis_z * axis_z.transpose() - Matrix3::identity()
    }
}

/// `-diag(1, 1, 0) r`.
fn horizontal(r_y: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(-r_y.x, -r_y.y, 0.0)
}

/// The matrix that takes a small turn `psi` to its effect on a vector, `hat(psi) v = -hat(v) psi`.
fn turned(v: &Vector3<f64>) -> Matrix3<f64> {
    -hat(v)
}
