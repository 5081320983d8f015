//! One unknown: its name, unit and meaning.

use centrical_compensate::Monomial;

use super::effect::{Effect, Scope};
use super::error_model::Term;
use super::experiment::STANDARD_GRAVITY;
use super::group::Group;

/// One unknown.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Name in results: `delta_2[4]`, `G1_31`.
    pub name: String,
    /// Unit of its value, SI.
    pub unit: String,
    /// The group it belongs to.
    pub group: Group,
    /// What it is.
    pub kind: Kind,
    /// Power of acceleration in its unit, which people are shown in g to that power: -1 for s^2/m.
    pub power_of_acceleration: i32,
    /// Order of magnitude it has in real units [its unit]: 1 mrad, 0.5 mm, 5 mg, 1e-3, 1e-5 /g, 1e-7 /g^2. Used to
    /// scale columns before any is measured and to hold null directions; never as knowledge about a value.
    pub typical: f64,
}

/// What a parameter is in the measurement model. Axes are 0, 1, 2.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Kind {
    /// `alpha_1`, `alpha_2`: tilt of the rotation axis [rad].
    Tilt(usize),
    /// `delta_ik`: turn of the unit in position `k` about instrument axis `i` [rad].
    Turn {
        /// Instrument axis.
        axis: usize,
        /// Index of the position.
        position: usize,
    },
    /// `dR_ik`: error of the place of the reference point along arm axis `i` [m].
    Shift {
        /// Arm axis, 0 or 1.
        axis: usize,
        /// Index of the position, the first of its pair, whose `dR` this is.
        position: usize,
    },
    /// `theta_1`, `theta_2` of a rest in a free attitude: tilt of the vertical, seen from the nominal attitude [rad].
    Attitude {
        /// Reference axis, 0 or 1.
        axis: usize,
        /// Index of the position.
        position: usize,
    },
    /// `case_turn_i`: turn of the instrument against its case about instrument axis `i` [rad]: what rests in known attitudes share.
    CaseTurn(usize),
    /// `drho_ii`: error of the place of proof mass `i` along its own axis [m].
    ProofMass(usize),
    /// Coefficient of a term of the error model, by its index.
    Term(usize),
    /// What acts on the readings beyond the source's unknowns.
    Effect(Effect),
}

impl Parameter {
    /// Standard deviation with which null directions are held about zero, in typical magnitudes of the parameters
    /// (5 mm, 10 mrad, 1e-2 of scale): ten times what any real unit shows, so that it holds and does not inform.
    pub const NULL_HOLD: f64 = 10.0;

    /// Whether a standard uncertainty [its unit] is informative: one of [`Self::NULL_HOLD`] typical magnitudes or more is known
    /// without any data, and so far from the estimate the model is not linear.
    pub fn is_informative(&self, standard_uncertainty: f64) -> bool {
        standard_uncertainty < Self::NULL_HOLD * self.typical
    }

    /// Whether it belongs to the instrument: a coefficient of its error model, as opposed to the geometry.
    pub fn is_of_instrument(&self) -> bool {
        matches!(self.kind, Kind::Term(_))
    }
}

impl Kind {
    /// Whether it belongs to a position or to a pair of positions.
    pub(crate) fn is_of_position(self) -> bool {
        match self {
            Self::Turn { .. } | Self::Shift { .. } | Self::Attitude { .. } => true,
            Self::Effect(effect) => matches!(effect.scope(), Scope::Position(_)),
            Self::Tilt(_) | Self::CaseTurn(_) | Self::ProofMass(_) | Self::Term(_) => false,
        }
    }
}

pub(super) fn parameter(name: String, unit: &str, group: Group, kind: Kind, typical: f64) -> Parameter {
    Parameter { name, unit: unit.to_owned(), group, kind, power_of_acceleration: 0, typical }
}

/// The coefficient of a term, as an effect of its own.
pub(super) fn coefficient(term: &Term) -> Parameter {
    let Term { axis, monomial, .. } = *term;
    let kind = Kind::Effect(Effect::Monomial { axis, monomial, scope: Scope::Session });
    let unknown = parameter(term.name.clone(), &term.unit(), term.group, kind, typical_coefficient(&monomial));
    Parameter { power_of_acceleration: 1 - i32::from(monomial.degree()), ..unknown }
}

fn typical_coefficient(monomial: &Monomial) -> f64 {
    match monomial.degree() {
        0 => 5e-3 * STANDARD_GRAVITY,
        1 => 1e-3,
        d => 1e-3 / (100.0 * STANDARD_GRAVITY).powi(i32::from(d) - 1),
    }
}
