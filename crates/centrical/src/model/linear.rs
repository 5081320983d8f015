//! The source's linear model `Z = H X + r` [K5.3]: nominal readings, and the columns of `H`, term by term
//! as printed, for any number of positions and any pair relation.
//!
//! Unlike the source, `Omega^2` here stands for `Omega^2 + 2 Omega omega_E sin(latitude)` when the site gives
//! a latitude (docs/source-and-findings.md): the Coriolis term is not of zero mean in the arm frame.

use nalgebra::{Matrix3, Vector3};

use super::exact::Share;
use super::experiment::{Experiment, SetPoint};
use super::frame::hat;
use super::measurement::{Linearisation, MeasurementModel};
use super::parameter::Kind;

/// Nominal ideal reading `f0_z` [m/s^2] of a plateau [K5.1]:
/// `P_k (g e3 + D R0_k) + sum_i e_i e_i^T M_k rho0 e_i`.
pub fn nominal(experiment: &Experiment, set_point: &SetPoint) -> Vector3<f64> {
    let Nominal { g_e3, d, p, m, r0, rho0 } = Nominal::of(experiment, set_point);
    p * (g_e3 + d * r0) + (m * rho0).diagonal()
}

/// The source's small measurement `z = (mean f' - f0_z) / g` [K5.2], dimensionless.
pub fn small_measurement(experiment: &Experiment, set_point: &SetPoint, mean: &Vector3<f64>) -> Vector3<f64> {
    (mean - nominal(experiment, set_point)) / experiment.site.gravity
}

impl MeasurementModel {
    /// Three rows of `g H` [K5.3] about the nominal reading `f0_z` [K5.1], with the direction `d f0_z / d ln Omega`
    /// of a speed error: the linearisation of a plateau at `X = 0`, from the source's formulas alone.
    pub fn linearise_at_zero(&self, set_point: &SetPoint) -> Linearisation {
        let experiment = &self.experiment;
        let n = Nominal::of(experiment, set_point);
        let f0 = nominal(experiment, set_point);
        let columns = (0..self.parameters.len())
            .map(|column| (column, self.column_of_gh(column, set_point, &n, &f0)))
            .filter(|(_, derivative)| *derivative != Vector3::zeros())
            .collect();
        let omega = set_point.omega;
        let by_log_speed = n.by_rate() * (omega * (2.0 * omega + experiment.site.coriolis()));
        let speed_error = by_log_speed * experiment.speed_uncertainty_of(set_point);
        Linearisation { reading: f0, speed_error, columns }
    }

    /// Column of `g H`, by what the parameter is.
    fn column_of_gh(&self, column: usize, set_point: &SetPoint, n: &Nominal, f0: &Vector3<f64>) -> Vector3<f64> {
        let parameters = &self.parameters;
        let position = self.experiment.mountings[set_point.mounting].position;
        let kind = parameters[column].kind;
        match kind {
            Kind::Tilt(axis) => n.by_tilt(axis, set_point),
            Kind::Turn { axis, position: k } if k == position => n.by_turn(axis),
            Kind::Shift { axis, .. } if parameters.shift_of(position).column + axis == column => {
                n.p * n.d * Vector3::ith(axis, parameters.shift_of(position).sign)
            }
            // sum_i e_i e_i^T M_k drho e_i
            Kind::ProofMass(axis) => Vector3::ith(axis, n.m[(axis, axis)]),
            Kind::Term(index) => {
                // df0 + Gamma(f0) f0
                let term = &self.error_model.terms[index];
                Vector3::ith(term.axis, term.monomial.value((*f0).into()))
            }
            // Of another position or pair.
            Kind::Turn { .. } | Kind::Shift { .. } => Vector3::zeros(),
            Kind::ElasticTurn { .. } | Kind::ArmStretch { .. } | Kind::RadiusScale | Kind::SpeedScale => {
                match self.extension_share(set_point, kind) {
                    Share::None => Vector3::zeros(),
                    Share::Turn(axis, per_unit) => n.by_turn(axis) * per_unit,
                    Share::Arm(per_unit) => n.p * n.d * per_unit,
                    Share::Rate => n.by_rate() * (set_point.omega * set_point.omega),
                }
            }
        }
    }
}

/// The source's letters for one plateau.
struct Nominal {
    g_e3: Vector3<f64>,
    /// `D = -Omega^2 diag(1, 1, 0)`.
    d: Matrix3<f64>,
    /// `P_k`.
    p: Matrix3<f64>,
    /// `M_k = P_k D P_k^T`.
    m: Matrix3<f64>,
    /// `R0_k`.
    r0: Vector3<f64>,
    rho0: Matrix3<f64>,
}

impl Nominal {
    fn of(experiment: &Experiment, set_point: &SetPoint) -> Self {
        let w = experiment.rate_squared(set_point);
        let d = Matrix3::from_diagonal(&Vector3::new(-w, -w, 0.0));
        let p = experiment.position_of(set_point).p_zy;
        Self {
            g_e3: Vector3::z() * experiment.site.gravity,
            d,
            p,
            m: p * d * p.transpose(),
            r0: *experiment.arm_of(set_point),
            rho0: experiment.unit.rho_z,
        }
    }

    /// Centripetal part of `f0_z` for a unit of `Omega^2`.
    fn by_rate(&self) -> Vector3<f64> {
        let d = Matrix3::from_diagonal(&Vector3::new(-1.0, -1.0, 0.0));
        self.p * d * self.r0 + (self.p * d * self.p.transpose() * self.rho0).diagonal()
    }

    /// `g P_k (u(alpha) - e3)`, at rest only; its mean over a revolution is zero.
    fn by_tilt(&self, axis: usize, set_point: &SetPoint) -> Vector3<f64> {
        if !set_point.is_rest() {
            return Vector3::zeros();
        }
        let (s, c) = set_point.angle.sin_cos();
        let u = if axis == 0 { Vector3::new(s, c, 0.0) } else { Vector3::new(-c, s, 0.0) };
        self.p * u * self.g_e3.z
    }

    /// `hat(delta_k) P_k (g e3 + D R0_k) + sum_i e_i e_i^T (hat(delta_k) M_k - M_k hat(delta_k)) rho0 e_i`.
    fn by_turn(&self, axis: usize) -> Vector3<f64> {
        let hat_delta = hat(&Vector3::ith(axis, 1.0));
        let spread = (hat_delta * self.m - self.m * hat_delta) * self.rho0;
        hat_delta * self.p * (self.g_e3 + self.d * self.r0) + spread.diagonal()
    }
}
