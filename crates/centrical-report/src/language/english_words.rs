//! English: words for what is one of several.

use centrical::{
    Course, Difference, Extension, Extra, Group, Law, PairRelation, ReferencePoint, Rival, Source, Termination,
};
use centrical_session::{AxesName, Follows, Method, NextAttitudeSummary, Redundancy};

use crate::number::counted;

pub(super) fn axes(name: &AxesName) -> String {
    match name {
        AxesName::LowerTriangular => "axes of a lower triangular scale matrix".to_owned(),
        AxesName::UpperTriangular => "axes of an upper triangular scale matrix".to_owned(),
        AxesName::Symmetric => "axes of a symmetric scale matrix".to_owned(),
        AxesName::Case => "axes of the case".to_owned(),
        AxesName::Other(name) => format!("axes “{name}”"),
    }
}

pub(super) fn standard_uncertainties(number: &str) -> String {
    format!("{number} standard uncertainties")
}

pub(super) fn group(group: Group) -> &'static str {
    match group {
        Group::Bias => "Bias",
        Group::Scale => "Scale error",
        Group::Misalignment => "Misalignment",
        Group::Quadratic => "Quadratic",
        Group::Cubic => "Cubic",
        Group::CrossCoupling => "Cross-coupling",
        Group::Asymmetry => "Asymmetry of the scale",
        Group::HigherOrder => "Higher order",
        Group::Tilt => "Tilt of the rotation axis",
        Group::Turn => "Turn of the unit",
        Group::Shift => "Shift of the unit",
        Group::Attitude => "Attitude of a rest",
        Group::CaseTurn => "Turn of the instrument against its case",
        Group::ProofMass => "Place of a proof mass",
        Group::ElasticTurn => "Elastic turn",
        Group::ArmStretch => "Stretch of the arm",
        Group::RadiusScale => "Scale of the radii",
        Group::SpeedScale => "Scale of the speed",
        Group::SpeedOffset => "Offset of the speed",
        Group::EarthRate => "The Earth's rotation",
        Group::Gravity => "Error of gravity",
        Group::ArmTurn => "Elastic turn of the arm's end",
        Group::SpinTurn => "Turn of the unit while spinning",
        Group::Seat => "Place of a seat",
        Group::MountingShift => "Shift of one mounting",
        Group::MountingTurn => "Turn of one mounting",
        Group::MountingTilt => "Tilt of the axis in one mounting",
        Group::AngleTilt => "Tilt of the axis at one angle of rest",
        Group::MountingBias => "Bias of one mounting",
        Group::MountingScale => "Scale of one mounting",
        Group::Disturbance => "Disturbance of the readings",
    }
}

pub(super) fn meaning(of: Group) -> &'static str {
    match of {
        Group::Bias => "bias: reading at no specific force",
        Group::Scale => "scale error: relative error of the slope along the own axis",
        Group::Misalignment => "misalignment: part of a force along another axis that is read, an angle",
        Group::Quadratic => "quadratic coefficient: reading for the square of the force along axis j",
        Group::Cubic => "cubic coefficient along the own axis",
        Group::CrossCoupling => "cross-coupling: reading for the product of two forces",
        Group::Asymmetry => "asymmetry: scale that differs with the sign of the force",
        Group::HigherOrder => "coefficient of a higher power",
        _ => group(of),
    }
}

pub(super) fn source(source: Source) -> &'static str {
    match source {
        Source::Noise => "Noise",
        Source::PlateauSpeed => "Speed of each plateau",
        Source::Priors => "Priors",
        Source::Gravity => "Gravity",
        Source::Latitude => "Latitude",
        Source::Radius => "Radius",
        Source::RadiusDifference => "Difference of radii",
        Source::SpeedScale => "Scale of the speed",
        Source::RestAngle => "Angle at rest",
        Source::ProofMasses => "Proof masses",
        Source::Attitude => "Attitudes",
        Source::BiasChange => "Change of bias at a switch-off",
        Source::Turning => "Acceleration about the axes of a slow rotation",
        Source::Resolution => "Resolution",
        Source::Effects => "Effects left out",
    }
}

pub(super) fn method(method: Method) -> &'static str {
    match method {
        Method::Exact => "exact, Gauss-Newton",
        Method::Recursive => "exact, recursive filter",
        Method::Linear => "linear [K5.3]",
        Method::RecursiveLinear => "linear [K5.3], recursive filter",
    }
}

pub(super) fn termination(termination: Termination) -> &'static str {
    match termination {
        Termination::Linear => "linear",
        Termination::Converged => "converged",
        Termination::Stalled => "stalled",
        Termination::IterationLimit => "iteration limit",
    }
}

pub(super) fn pair_relation(pair_relation: PairRelation) -> &'static str {
    match pair_relation {
        PairRelation::Common => "common",
        PairRelation::Opposite => "opposite",
        PairRelation::Free => "free",
    }
}

pub(super) fn reference(reference: ReferencePoint) -> &'static str {
    match reference {
        ReferencePoint::FirstProofMass => "proof mass 1",
        ReferencePoint::OwnAxes => "no displacement along own axes",
    }
}

pub(super) fn follows(follows: &Follows) -> &'static str {
    match follows {
        Follows::Position { .. } => "step in position",
        Follows::SpeedInPosition { .. } => "square of the speed in position",
        Follows::SpeedOnSeat { .. } => "square of the speed at radius",
        Follows::Speed => "square of the speed",
        Follows::Load => "load",
        Follows::Mounting { .. } => "step in mounting",
        Follows::Time => "drift over the session",
    }
}

pub(super) fn rival(rival: Rival) -> &'static str {
    match rival {
        Rival::Terms(Extra::CrossProducts) => "products of two components of the force",
        Rival::Terms(Extra::CrossCubes) => "cubes of the other components of the force",
        Rival::Terms(Extra::CubicProducts) => "products of three components of the force",
        Rival::Terms(Extra::OddQuadratic) => "odd square of the force",
        Rival::Terms(Extra::Asymmetry) => "scale that differs with the sign of the force",
        Rival::Terms(Extra::FourthPower) => "fourth power of the force",
        Rival::Terms(Extra::FifthPower) => "fifth power of the force",
        Rival::Terms(Extra::OwnSquares) => "square of the force",
        Rival::Terms(Extra::CrossSquares) => "squares of the other components of the force",
        Rival::Terms(Extra::OwnCubes) => "cube of the force",
        Rival::Terms(Extra::Jump) => "jump of the bias at zero force",
        Rival::Effect(extension) => match extension {
            Extension::ElasticTurn(Law::Speed) => {
                "elastic turn of the unit by position, growing with the square of the speed"
            }
            Extension::ElasticTurn(Law::Load) => "elastic turn of the unit by position, growing with the load",
            Extension::ArmStretch(Law::Speed) => "stretch of the arm with the square of the speed",
            Extension::ArmStretch(Law::Load) => "stretch of the arm with the load",
            Extension::SeatStretch(Law::Speed) => "stretch of the arm by seat with the square of the speed",
            Extension::SeatStretch(Law::Load) => "stretch of the arm by seat with the load",
            Extension::RadiusScale => "common scale of the radii",
            Extension::SpeedScale => "common scale of the speeds",
            Extension::SpeedOffset => "common offset of the speeds",
            Extension::EarthRate => "the Earth's rotation, without a latitude",
            Extension::Gravity => "gravity other than stated",
            Extension::ArmTurn(Law::Speed) => "turn of the arm's end with the square of the speed",
            Extension::ArmTurn(Law::Load) => "turn of the arm's end with the load: an arm that is not rigid",
            Extension::SeatRadius => "radius of a seat",
            Extension::SeatLateral => "lateral place of a seat",
            Extension::PositionShift => "shift of its own in each position: another relation of the pairs",
            Extension::MountingShift => "shift of its own in each mounting",
            Extension::MountingTurn => "turn of its own in each mounting",
            Extension::MountingTilt => "tilt of the axis that differs by mounting",
            Extension::AngleTilt => "tilt of the axis that differs by angle of rest, or an angle other than stated",
            Extension::MountingBias => "bias that differs by mounting",
            Extension::MountingScale => "scale that differs by mounting",
            Extension::RestsBias => {
                "bias of the rests of [[tumble]] that differs by more than bias_change: another switch-on"
            }
            Extension::RestsScale => {
                "scale of the rests of [[tumble]] that differs from the arm's: another temperature or gravity"
            }
            Extension::RestsUnit => "another unit, or axes in another order, in the rests of [[tumble]]",
            Extension::AttitudesTilt => {
                "stated attitudes that are off by more than is stated, alike in all rests that share one"
            }
            Extension::RestsTilt => "attitudes of rests that are off by more than is stated of them",
            Extension::SpinTurn => "turn of the unit between rest and spinning",
            Extension::Disturbance(Course::Spinning) => {
                "step between rest and spinning: an aliased line or rectified vibration"
            }
            Extension::ProofMasses => "places of proof masses that are taken as exact",
            Extension::Disturbance(Course::Speed) => "disturbance with the speed: rectified vibration",
            Extension::Disturbance(Course::SquaredSpeed) => {
                "disturbance with the square of the speed: rectified vibration"
            }
            Extension::Disturbance(Course::FourthPowerOfSpeed) => {
                "disturbance with the fourth power of the speed: rectified vibration of an imbalance"
            }
            Extension::Disturbance(Course::OwnRate) => "disturbance with the angular rate about the own axis",
            Extension::Disturbance(Course::Yield) => "proof mass that yields to its force",
            Extension::Disturbance(Course::Time) => "bias that changes over the session",
            Extension::Disturbance(Course::TimeScale) => "scale that changes over the session",
            Extension::Disturbance(Course::WarmUp) => "bias that warms up in each mounting",
            Extension::Disturbance(Course::WarmUpScale) => "scale that warms up in each mounting",
            Extension::Disturbance(Course::Heat(Law::Speed)) => {
                "bias with the heat that a mounting gathers, by the speed"
            }
            Extension::Disturbance(Course::Heat(Law::Load)) => {
                "bias with the heat that a mounting gathers, by the load"
            }
            Extension::Resonance(_) | Extension::Disturbance(Course::AtSpeedOf(_)) => {
                "disturbance at one set speed: vibration in resonance"
            }
            Extension::Disturbance(Course::Rise) => "difference after a rise and after a fall of the speed",
            Extension::Disturbance(Course::Memory) => "memory of earlier forces",
            Extension::Disturbance(Course::Turn) => "hysteresis: a bias by the sense of the last change of the force",
            Extension::BiasWander | Extension::Disturbance(Course::Wander(_)) => {
                "bias that wanders over the session: warm-up, or a slow wave"
            }
            Extension::Disturbance(Course::From(_)) => "step of the bias before rest",
            Extension::OneSpeed(_) => "one set speed that is off",
            Extension::OneMounting(Difference::Shift, _) => "shift of the unit in one mounting",
            Extension::OneMounting(Difference::Turn, _) => "turn of the unit in one mounting",
            Extension::OneMounting(Difference::Unit, _) => "another unit in one mounting",
        },
    }
}

/// The scatter from rest to rest and the drift of the biases that the uncertainties include.
pub(super) fn between_rests(scatter: &str, drift: &str) -> String {
    format!(
        "They include what the residuals of the rests do not exclude: a scatter of {scatter} from rest to rest, and a drift of the biases by {drift}."
    )
}

/// Arcs of slow rotation that count as rests.
pub(super) fn turning(arcs: usize, share: &str, [rate, radius, acceleration]: [&str; 3]) -> String {
    format!(
        "Of the rests {arcs} are arcs of slow rotation, at {rate} and less; they have {share} % of the weight. At {radius} from the axes of rotation the proof masses accelerate along the vertical, uncertain by {acceleration} at most in an arc."
    )
}

/// What no redundant reading checks.
pub(super) fn not_checked(redundancy: Redundancy) -> Option<String> {
    match redundancy {
        Redundancy::Everywhere => None,
        Redundancy::ButFor(parameters) => Some(format!("No redundant reading checks {}.", parameters.join(", "))),
        Redundancy::Nowhere => Some("No reading is redundant: nothing checks the stated uncertainties.".to_owned()),
    }
}

/// How many attitudes of all rests are known, and to what standard uncertainty at most.
pub(super) fn known_attitudes(known: usize, all: usize, uncertainty: &str) -> String {
    match known {
        0 => "The attitudes are not known beforehand.".to_owned(),
        _ => format!("Of {all} attitudes {known} are known, with a standard uncertainty of at most {uncertainty}."),
    }
}

pub(super) fn next_rest(next: &NextAttitudeSummary) -> String {
    format!("The best rest to add: {}; {}.", next.text, next_rest_brings(next))
}

/// What the attitude to add brings, without a full stop.
pub(crate) fn next_rest_brings(next: &NextAttitudeSummary) -> String {
    match (&next.parameter, next.parameter_factor) {
        (Some(parameter), Some(factor)) if next.gain == 0 => {
            format!("uncertainties become {:.2} of these on average, that of {parameter} {factor:.2}", next.factor)
        }
        _ => format!("it brings back {}", counted(next.gain, "combination")),
    }
}
