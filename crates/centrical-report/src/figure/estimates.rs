//! Which estimates the figures show.

use centrical::Group;
use centrical_session::ParameterEstimate;

/// Whether a figure of parameters shows this one: an estimate, and not the attitude of a rest, which is determined with that rest alone.
pub(super) fn is_charted(parameter: &ParameterEstimate) -> bool {
    parameter.estimable && parameter.group != Group::Attitude
}
