//! Mounting positions: nominal attitudes of the unit on the arm. Positions are data: any rotation
//! matrix, any number of them; the source's six are a preset.

use nalgebra::{Matrix3, Rotation3, Vector3};

/// One nominal attitude of the unit: on the arm, or at rest anywhere else.
#[derive(Debug, Clone, PartialEq)]
pub struct Position {
    /// Name used in parameter names: `delta_1[id]`.
    pub id: String,
    /// `P_k`: takes arm axes to instrument axes; its rows say where the instrument axes point in the arm frame.
    pub p_zy: Matrix3<f64>,
    /// Name of the pair of positions that share `dR`, turned from each other by 180 deg about the vertical.
    pub pair: String,
    /// Whether the unit rests here in an attitude of its own, on a table or in a hand, not on the arm: its attitude against
    /// the vertical is unknown, `theta_1[id]`, `theta_2[id]`, and only the size of gravity is known.
    pub is_free: bool,
    /// Standard uncertainty of a free attitude that is known, about each horizontal axis [rad]: `p_zy` takes the vertical to axes of
    /// the case, against which the instrument is turned by `case_turn`. `None` where only gravity shows the attitude, and on the arm.
    pub attitude_uncertainty: Option<f64>,
    /// Second derivative of the vertical in axes of the instrument, its mean over an arc of slow rotation [1/s^2]; zero in a rest. A proof
    /// mass in the place `r` from the axes of rotation is at the height `r . u`, and accelerates upwards by `r . d^2u/dt^2`.
    pub bend_z: Vector3<f64>,
    /// From when to when the unit was on without a break.
    pub switch_on: SwitchOn,
}

/// A time through which the unit was on without a break: its biases stay.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SwitchOn {
    /// Its number; 0 is that of the arm.
    pub number: usize,
    /// Standard uncertainty of the change of each bias against the reference, the switch-on of the arm or else of the first rest
    /// [m/s^2]; `None`: the one stated for all, [`TypeB::bias_change`](super::TypeB::bias_change).
    pub bias_change: Option<f64>,
    /// Standard uncertainty of each coordinate of the place of the proof masses from the axes of a slow rotation [m]; zero without one.
    pub from_axes: f64,
}

impl Position {
    /// Whether the attitudes of two rests are stated, and stated alike.
    pub(crate) fn shares_attitude(&self, other: &Self) -> bool {
        let is_stated = |position: &Self| position.attitude_uncertainty.is_some();
        is_stated(self) && is_stated(other) && self.p_zy == other.p_zy
    }

    /// A position on the arm.
    pub fn on_arm(id: impl Into<String>, p_zy: Matrix3<f64>, pair: impl Into<String>) -> Self {
        let (id, pair) = (id.into(), pair.into());
        let bend_z = Vector3::zeros();
        Self { id, p_zy, pair, is_free: false, attitude_uncertainty: None, bend_z, switch_on: SwitchOn::default() }
    }

    /// A rest in an attitude of its own, where the specific force points about along `f_z` (instrument axes, of any length
    /// but zero). Of the attitudes with this vertical it takes the one nearest to the reference axes. Rests are of one switch-on, another
    /// one than that of the arm.
    pub fn free(id: impl Into<String>, f_z: &Vector3<f64>) -> Self {
        let id = id.into();
        // Opposite vectors have no shortest rotation between them; half a turn about axis 1 is one of many.
        let half_turn = || Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
        let p_zy = Rotation3::rotation_between(&Vector3::z(), f_z).unwrap_or_else(half_turn).into_inner();
        let switch_on = SwitchOn { number: 1, bias_change: None, from_axes: 0.0 };
        Self { is_free: true, switch_on, ..Self::on_arm(id.clone(), p_zy, id) }
    }

    /// A rest in an attitude that is known to `standard_uncertainty` about each horizontal axis [rad]: the vertical points along
    /// `up_b`, axes of the case.
    pub fn known(id: impl Into<String>, up_b: &Vector3<f64>, standard_uncertainty: f64) -> Self {
        Self { attitude_uncertainty: Some(standard_uncertainty), ..Self::free(id, up_b) }
    }

    /// An arc of slow rotation, in which the mean second derivative of the vertical is `bend_z` [1/s^2].
    #[must_use]
    pub fn on_arc(self, bend_z: Vector3<f64>) -> Self {
        Self { bend_z, ..self }
    }

    /// The position in a switch-on.
    #[must_use]
    pub fn in_switch_on(self, switch_on: SwitchOn) -> Self {
        Self { switch_on, ..self }
    }
}

/// Which way newtonometer 1 points in positions 3 and 4, which the source's text leaves open.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ThirdPosition {
    /// `P_3 = [[0,0,1],[1,0,0],[0,1,0]]`: instrument axis 1 up.
    AxisOneUp,
    /// `P_3 = [[0,0,-1],[1,0,0],[0,-1,0]]`: instrument axis 1 down.
    AxisOneDown,
}

impl Position {
    /// The source's six positions "1" to "6" in the pairs A, B, C.
    ///
    /// `P_1`, `P_2` are printed; `P_6` follows from the printed `z^(6)`; the second of each pair is the first
    /// turned by 180 deg about the vertical, `P_2k = P_2k-1 diag(-1, -1, 1)`.
    pub fn kozlov_2017(third: ThirdPosition) -> Vec<Position> {
        let half_turn = Matrix3::from_diagonal(&nalgebra::Vector3::new(-1.0, -1.0, 1.0));
        let p_1 = Matrix3::identity();
        let p_3 = match third {
            ThirdPosition::AxisOneUp => Matrix3::new(0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0),
            ThirdPosition::AxisOneDown => Matrix3::new(0.0, 0.0, -1.0, 1.0, 0.0, 0.0, 0.0, -1.0, 0.0),
        };
        let p_6 = Matrix3::new(0.0, 1.0, 0.0, 0.0, 0.0, -1.0, -1.0, 0.0, 0.0);
        let turns = [p_1, p_1 * half_turn, p_3, p_3 * half_turn, p_6 * half_turn, p_6];
        let pairs = ["A", "A", "B", "B", "C", "C"];
        (1..)
            .zip(turns.into_iter().zip(pairs))
            .map(|(k, (p_zy, pair))| Position::on_arm(k.to_string(), p_zy, pair))
            .collect()
    }
}
