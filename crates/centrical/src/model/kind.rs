//! What an unknown is in the measurement model.

use super::effect::{Effect, Scope};

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
