//! Groups of parameters: what is alike in kind and unit.

/// A group of parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Group {
    /// Bias of a newtonometer.
    Bias,
    /// Scale of a newtonometer.
    Scale,
    /// Direction of a sensitive axis.
    Misalignment,
    /// Terms of second degree in one component.
    Quadratic,
    /// Terms of third degree in one component.
    Cubic,
    /// Products of several components.
    CrossCoupling,
    /// Difference of the scales for positive and negative forces.
    Asymmetry,
    /// Terms of fourth degree and higher in one component.
    HigherOrder,
    /// Tilt of the rotation axis.
    Tilt,
    /// Turn of the unit in a position.
    Turn,
    /// Shift of the unit in a position.
    Shift,
    /// Attitude of a rest against the vertical.
    Attitude,
    /// Turn of the instrument against its case.
    CaseTurn,
    /// Place of a proof mass.
    ProofMass,
    /// Elastic turn of the unit.
    ElasticTurn,
    /// Stretch of the arm.
    ArmStretch,
    /// Common scale of all radii.
    RadiusScale,
    /// Common scale of all speeds.
    SpeedScale,
    /// Common offset of all speeds.
    SpeedOffset,
    /// The Earth's rotation.
    EarthRate,
    /// Error of the local gravity.
    Gravity,
    /// Elastic turn of the arm's end.
    ArmTurn,
    /// Turn of the unit while spinning.
    SpinTurn,
    /// Place of a seat.
    Seat,
    /// Shift of the unit in one mounting.
    MountingShift,
    /// Turn of the unit in one mounting.
    MountingTurn,
    /// Tilt of the axis in one mounting.
    MountingTilt,
    /// Tilt of the axis at one angle of rest.
    AngleTilt,
    /// Bias of a newtonometer in one mounting.
    MountingBias,
    /// Scale of a newtonometer in one mounting.
    MountingScale,
    /// Disturbance of the readings.
    Disturbance,
}

impl Group {
    /// All groups.
    pub const ALL: [Self; 31] = [
        Self::Bias,
        Self::Scale,
        Self::Misalignment,
        Self::Quadratic,
        Self::Cubic,
        Self::CrossCoupling,
        Self::Asymmetry,
        Self::HigherOrder,
        Self::Tilt,
        Self::Turn,
        Self::Shift,
        Self::Attitude,
        Self::CaseTurn,
        Self::ProofMass,
        Self::ElasticTurn,
        Self::ArmStretch,
        Self::RadiusScale,
        Self::SpeedScale,
        Self::SpeedOffset,
        Self::EarthRate,
        Self::Gravity,
        Self::ArmTurn,
        Self::SpinTurn,
        Self::Seat,
        Self::MountingShift,
        Self::MountingTurn,
        Self::MountingTilt,
        Self::AngleTilt,
        Self::MountingBias,
        Self::MountingScale,
        Self::Disturbance,
    ];

    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bias => "bias",
            Self::Scale => "scale",
            Self::Misalignment => "misalignment",
            Self::Quadratic => "quadratic",
            Self::Cubic => "cubic",
            Self::CrossCoupling => "cross-coupling",
            Self::Asymmetry => "asymmetry",
            Self::HigherOrder => "higher order",
            Self::Tilt => "tilt",
            Self::Turn => "turn",
            Self::Shift => "shift",
            Self::Attitude => "attitude",
            Self::CaseTurn => "turn against the case",
            Self::ProofMass => "proof mass",
            Self::ElasticTurn => "elastic turn",
            Self::ArmStretch => "arm stretch",
            Self::RadiusScale => "scale of radii",
            Self::SpeedScale => "scale of speed",
            Self::SpeedOffset => "offset of speed",
            Self::EarthRate => "Earth rate",
            Self::Gravity => "gravity",
            Self::ArmTurn => "turn of the arm's end",
            Self::SpinTurn => "turn while spinning",
            Self::Seat => "seat",
            Self::MountingShift => "shift of one mounting",
            Self::MountingTurn => "turn of one mounting",
            Self::MountingTilt => "tilt in one mounting",
            Self::AngleTilt => "tilt at one angle",
            Self::MountingBias => "bias of one mounting",
            Self::MountingScale => "scale of one mounting",
            Self::Disturbance => "disturbance",
        }
    }

    /// Whether its parameters describe how the unit was mounted: an axis each, of a position or of all.
    pub fn is_of_mounting(self) -> bool {
        matches!(self, Self::Tilt | Self::Turn | Self::Shift | Self::ProofMass)
    }
}
