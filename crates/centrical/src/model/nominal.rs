//! The source's letters for one plateau, and its nominal reading [K5.1].

use nalgebra::{Matrix3, Vector3};

use super::experiment::{Experiment, SetPoint};
use super::frame::hat;

impl Experiment {
    /// Nominal ideal reading `f0_z` [m/s^2] of a plateau [K5.1]:
    /// `P_k (g e3 + D R0_k) + sum_i e_i e_i^T M_k rho0 e_i`.
    pub fn nominal(&self, set_point: &SetPoint) -> Vector3<f64> {
        let Nominal { g_e3, d, p, m, r0, rho0 } = Nominal::of(self, set_point);
        p * (g_e3 + d * r0) + (m * rho0).diagonal()
    }
}

/// The source's letters for one plateau.
pub(super) struct Nominal {
    pub g_e3: Vector3<f64>,
    /// `D = -Omega^2 diag(1, 1, 0)`.
    pub d: Matrix3<f64>,
    /// `P_k`.
    pub p: Matrix3<f64>,
    /// `M_k = P_k D P_k^T`.
    pub m: Matrix3<f64>,
    /// `R0_k`.
    pub r0: Vector3<f64>,
    pub rho0: Matrix3<f64>,
}

impl Nominal {
    pub fn of(experiment: &Experiment, set_point: &SetPoint) -> Self {
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
    pub fn by_rate(&self) -> Vector3<f64> {
        let d = Matrix3::from_diagonal(&Vector3::new(-1.0, -1.0, 0.0));
        self.p * d * self.r0 + (self.p * d * self.p.transpose() * self.rho0).diagonal()
    }

    /// `g P_k (u(alpha) - e3)`, at rest only; its mean over a revolution is zero.
    pub fn by_tilt(&self, axis: usize, set_point: &SetPoint) -> Vector3<f64> {
        if !set_point.is_rest() {
            return Vector3::zeros();
        }
        let (s, c) = set_point.angle.sin_cos();
        let u = if axis == 0 { Vector3::new(s, c, 0.0) } else { Vector3::new(-c, s, 0.0) };
        self.p * u * self.g_e3.z
    }

    /// `hat(delta_k) P_k (g e3 + D R0_k) + sum_i e_i e_i^T (hat(delta_k) M_k - M_k hat(delta_k)) rho0 e_i`.
    pub fn by_turn(&self, axis: usize) -> Vector3<f64> {
        let hat_delta = hat(&Vector3::ith(axis, 1.0));
        let spread = (hat_delta * self.m - self.m * hat_delta) * self.rho0;
        hat_delta * self.p * (self.g_e3 + self.d * self.r0) + spread.diagonal()
    }
}
