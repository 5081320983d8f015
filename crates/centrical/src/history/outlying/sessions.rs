//! The sessions of units.

use crate::history::together::SessionEstimates;

/// The sessions of units of one type.
pub struct UnitSessions<'a> {
    /// Number of sessions of each unit, one or more.
    pub counts: &'a [usize],
    /// Session `t` of a unit, in the order of time: `p` values and the covariance of their errors as it states them, made when it is asked for.
    pub session: &'a (dyn Fn(usize, usize) -> SessionEstimates + Sync),
}
