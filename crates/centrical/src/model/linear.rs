//! The source's linear model `Z = H X + r` [K5.3]: nominal readings, and the columns of `H`, term by term
//! as printed, for any number of positions and any pair relation.
//!
//! Unlike the source, `Omega^2` here stands for `Omega^2 + 2 Omega omega_E sin(latitude)` when the site gives
//! a latitude (docs/source-and-findings.md): the Coriolis term is not of zero mean in the arm frame.

use nalgebra::Vector3;

use super::effect::Share;
use super::experiment::SetPoint;
use super::measurement::MeasurementModel;
use super::nominal::Nominal;
use super::parameter::Kind;
use super::plateau::Linearisation;

impl MeasurementModel {
    /// Three rows of `g H` [K5.3] about the nominal reading `f0_z` [K5.1], with the direction `d f0_z / d ln Omega`
    /// of a speed error: the linearisation of a plateau at `X = 0`, from the source's formulas alone.
    pub fn linearise_at_zero(&self, set_point: &SetPoint) -> Linearisation {
        let experiment = &self.experiment;
        let n = Nominal::of(experiment, set_point);
        let f0 = experiment.nominal(set_point);
        let columns = (0..self.parameters.len())
            .map(|column| (column, self.column_of_gh(column, set_point, &n, &f0)))
            .filter(|(_, derivative)| *derivative != Vector3::zeros())
            .collect::<Vec<_>>();
        let omega = set_point.omega;
        // A tilt turns gravity over the carousel angle; without one, the angle at rest changes nothing.
        let by_log_speed = n.by_rate() * (omega * (2.0 * omega + experiment.site.coriolis()));
        let setting_error = by_log_speed * experiment.speed_uncertainty_of(set_point);
        let stated = (self.parameters.len()..).zip(self.influences());
        let stated = stated.map(|(unknown, influence)| {
            (
                unknown,
                by_share(&n, &influence.effect.share(&self.experiment, set_point), set_point)
                    * influence.standard_uncertainty,
            )
        });
        let stated = stated.filter(|(_, derivative)| *derivative != Vector3::zeros()).collect();
        let (rounding, normal) = (self.own_rounding(set_point), self.normal(set_point, &columns));
        Linearisation { reading: f0, setting_error, rounding, normal, columns, stated }
    }

    /// Column of `g H`, by what the parameter is.
    fn column_of_gh(&self, column: usize, set_point: &SetPoint, n: &Nominal, f0: &Vector3<f64>) -> Vector3<f64> {
        let parameters = &self.parameters;
        let position = self.experiment.mountings[set_point.mounting].position;
        let kind = parameters[column].kind;
        match kind {
            Kind::Tilt(axis) if self.experiment.is_on_arm(set_point.mounting) => n.by_tilt(axis, set_point),
            Kind::Attitude { axis, position: k } if k == position => n.by_tilt(axis, set_point),
            Kind::Turn { axis, position: k } if k == position => n.by_turn(axis),
            Kind::CaseTurn(axis) if self.experiment.positions[position].attitude_uncertainty.is_some() => {
                n.by_turn(axis)
            }
            Kind::Shift { axis, .. } => match parameters.shift_of(position) {
                Some(shift) if shift.column + axis == column => n.p * n.d * Vector3::ith(axis, shift.sign),
                _ => Vector3::zeros(),
            },
            // sum_i e_i e_i^T M_k drho e_i
            Kind::ProofMass(axis) => Vector3::ith(axis, n.m[(axis, axis)]),
            Kind::Term(index) => {
                // df0 + Gamma(f0) f0
                let term = &self.error_model.terms[index];
                Vector3::ith(term.axis, term.monomial.value((*f0).into()))
            }
            // Of another position; the tilt of the arm's axis where the unit is not on the arm; of an attitude that is not known.
            Kind::Turn { .. } | Kind::Attitude { .. } | Kind::Tilt(_) | Kind::CaseTurn(_) => Vector3::zeros(),
            Kind::Effect(effect) => by_share(n, &effect.share(&self.experiment, set_point), set_point),
        }
    }
}

/// Change of the nominal reading by one unit of an effect.
fn by_share(n: &Nominal, share: &Share, set_point: &SetPoint) -> Vector3<f64> {
    match *share {
        Share::None => Vector3::zeros(),
        Share::Tilt(axis) => n.by_tilt(axis, set_point),
        Share::Turn(turn) => (0..3).map(|axis| n.by_turn(axis) * turn[axis]).sum(),
        Share::Arm(displacement) => n.p * n.d * displacement,
        Share::Coordinate { coordinate, mass } => Vector3::ith(mass, n.m[(mass, coordinate)]),
        Share::Rate(rate) => n.by_rate() * rate,
        Share::Gravity => n.p * Vector3::z(),
        Share::Reading(reading) => reading,
    }
}
