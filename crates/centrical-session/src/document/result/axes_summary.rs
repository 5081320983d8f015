//! A result in other axes than those of the newtonometers: which ones, the error model there, and its covariance.

use centrical::is_rotation;
use nalgebra::Matrix3;
use serde::{Deserialize, Serialize};

/// The error model in other axes: `f' = bias + scale f_b + N(matrix f_b)`, with the terms `N` of the result beside bias, scale and
/// misalignment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AxesSummary {
    /// Which axes.
    pub name: AxesName,
    /// `c_zb` by rows: takes coordinates in these axes to coordinates in instrument axes.
    pub matrix: [[f64; 3]; 3],
    /// Bias, scale matrix by rows, the other terms of the error model, and the turn of the instrument axes from these axes.
    pub parameters: Vec<AxesParameter>,
    /// Covariance of these, SI.
    pub covariance: Vec<Vec<f64>>,
    /// Positions whose turns tell the attitude of the case; absent where none do.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub positions: Option<usize>,
}

/// Axes by their name.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AxesName {
    /// Those in which the scale matrix is lower triangular.
    LowerTriangular,
    /// Those in which the scale matrix is upper triangular.
    UpperTriangular,
    /// Those in which the scale matrix is symmetric.
    Symmetric,
    /// Those of the case.
    Case,
    /// Those that a file names.
    #[serde(untagged)]
    Other(String),
}

/// A quantity of the error model in other axes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AxesParameter {
    /// `df_i`, `scale_ij`, the name of another term, or `turn_i`.
    pub name: String,
    /// Estimate, SI.
    pub value: f64,
    /// Its standard uncertainty, SI.
    pub standard_uncertainty: f64,
    /// Unit of both.
    pub unit: String,
    /// Effective degrees of freedom (GUM, G.4.1), where the scatter of positions is a part; absent where they are infinite.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub degrees_of_freedom: Option<f64>,
}

impl AxesSummary {
    /// Whether the matrix is a rotation.
    pub(super) fn is_turned(&self) -> bool {
        is_rotation(&Matrix3::from_fn(|i, j| self.matrix[i][j]))
    }
}

impl AxesParameter {
    /// Whether it depends on the axes: bias, scale matrix and turn do, a coefficient of another term does not.
    pub fn is_of_axes(&self) -> bool {
        ["df_", "scale_", "turn_"].iter().any(|stem| self.name.starts_with(stem))
    }
}
