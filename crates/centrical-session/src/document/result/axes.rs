//! From a result to its error model in other axes, the attitude of its case, and what known attitudes show.

use centrical::reduction::Mistake;
use centrical::uncertainty::ModelInAxes;
use centrical::{Group, rotation, rotation_rate};
use centrical_compensate::Term;
use nalgebra::{DMatrix, Matrix3, Matrix3xX, Rotation3, Vector3};

use super::axes_summary::{AxesName, AxesParameter, AxesSummary};
use super::schema::{CalibrationResult, PositionSummary};
use crate::error::NoErrorModel;

/// Where axes lie, and how well that is known.
pub(crate) struct Attitude {
    /// What they are called.
    pub name: AxesName,
    /// Takes coordinates in them to coordinates in instrument axes.
    pub c_zb: Matrix3<f64>,
    /// Change of their turn by each parameter of the result, 3 rows [rad per unit].
    pub turn: Matrix3xX<f64>,
    /// Covariance of the turn from what a file states [rad^2].
    pub stated: Matrix3<f64>,
    /// Covariance of the turn from the scatter of the positions [rad^2].
    pub scatter: Matrix3<f64>,
    /// Positions that it follows from.
    pub positions: Option<usize>,
}

impl Attitude {
    /// The attitude of the case by the rotation vector `v` from it, its change by each parameter of the result, and its scatter.
    fn of_case(v: &Vector3<f64>, change: Matrix3xX<f64>, scatter: Matrix3<f64>, positions: Option<usize>) -> Self {
        // From a change of the rotation vector to a small further turn in the axes of the case.
        let c_zb = rotation(v);
        let to_case = c_zb.transpose() * rotation_rate(v);
        Self {
            name: AxesName::Case,
            c_zb,
            turn: to_case * change,
            stated: Matrix3::zeros(),
            scatter: to_case * scatter * to_case.transpose(),
            positions,
        }
    }
}

impl AxesSummary {
    /// The error model of `result` in the axes of `attitude`.
    ///
    /// # Errors
    /// [`NoErrorModel`] naming a coefficient that the data do not determine.
    pub(crate) fn new(result: &CalibrationResult, attitude: Attitude) -> Result<Self, NoErrorModel> {
        let Attitude { name, c_zb, turn, stated, scatter, positions } = attitude;
        let model = in_axes(result, c_zb, &turn, &(stated + scatter))?;
        let names = &result.model.error_model;
        let unit_of = |name: &str| result.parameter(name).map_or_else(String::new, |p| p.unit.clone());
        let mut quantities: Vec<(String, f64, String)> = Vec::new();
        for i in 1..=3 {
            quantities.push((format!("df_{i}"), model.bias()[i - 1], "m/s^2".to_owned()));
        }
        for (i, j) in [1, 2, 3].into_iter().flat_map(|i| [1, 2, 3].map(|j| (i, j))) {
            quantities.push((format!("scale_{i}{j}"), model.scale()[(i - 1, j - 1)], "1".to_owned()));
        }
        let is_other = |term: &Term| model.others().any(|other| other == term);
        for (term, summary) in result.error_terms()?.iter().zip(names).filter(|(term, _)| is_other(term)) {
            quantities.push((summary.name.clone(), term.coefficient, unit_of(&summary.name)));
        }
        // `rotation(v)` is the transpose of the usual one.
        let turned = Rotation3::from_matrix_unchecked(c_zb.transpose()).scaled_axis();
        for i in 1..=3 {
            quantities.push((format!("turn_{i}"), turned[i - 1], "rad".to_owned()));
        }
        let mut covariance = model.covariance();
        // By definition of the form: rounding leaves neither a value nor a variance.
        for (j, (_, value, _)) in quantities.iter_mut().enumerate().filter(|(j, _)| is_zero_by_form(&name, *j)) {
            *value = 0.0;
            covariance.row_mut(j).fill(0.0);
            covariance.column_mut(j).fill(0.0);
        }
        let without_scatter = in_axes(result, c_zb, &turn, &stated)?.covariance();
        let degrees = |j: usize| {
            let from_scatter = covariance[(j, j)] - without_scatter[(j, j)];
            let degrees = (positions? as f64 - 1.0) * (covariance[(j, j)] / from_scatter).powi(2);
            (from_scatter > 0.0 && degrees < MANY_DEGREES).then_some(degrees)
        };
        let parameter = |(j, (name, value, unit)): (usize, (String, f64, String))| AxesParameter {
            name,
            value,
            standard_uncertainty: covariance[(j, j)].max(0.0).sqrt(),
            unit,
            degrees_of_freedom: degrees(j),
        };
        Ok(Self {
            name,
            matrix: [0, 1, 2].map(|i| [0, 1, 2].map(|j| c_zb[(i, j)])),
            parameters: quantities.into_iter().enumerate().map(parameter).collect(),
            covariance: covariance.row_iter().map(|row| row.iter().copied().collect()).collect(),
            positions,
        })
    }

    /// The error model of `result` in these axes, with its covariance.
    ///
    /// # Errors
    /// [`NoErrorModel`] when a coefficient is not known or the covariance is not that of these quantities.
    pub fn model(&self, result: &CalibrationResult) -> Result<ModelInAxes, NoErrorModel> {
        let size = self.parameters.len();
        let is_square = self.covariance.len() == size && self.covariance.iter().all(|row| row.len() == size);
        let found = || NoErrorModel::Axes { found: format!("a covariance that is not one of {size} quantities") };
        let covariance = is_square.then(|| DMatrix::from_fn(size, size, |i, j| self.covariance[i][j]));
        let c_zb = Matrix3::from_fn(|i, j| self.matrix[i][j]);
        let model = ModelInAxes::with_covariance(result.error_terms()?, c_zb, &covariance.ok_or_else(found)?);
        model.ok_or_else(found)
    }
}

/// Standard uncertainties by which two attitudes of one case differ on any axis by chance in one of 5,000 results.
const CONTRADICTORY: f64 = 4.0;

/// Whether quantity `j` is an element of the scale matrix that is zero in every unit by the form that names the axes.
fn is_zero_by_form(name: &AxesName, j: usize) -> bool {
    let Some(element) = j.checked_sub(3).filter(|element| *element < 9) else { return false };
    let (row, column) = (element / 3, element % 3);
    match name {
        AxesName::LowerTriangular => row < column,
        AxesName::UpperTriangular => row > column,
        AxesName::Symmetric | AxesName::Case | AxesName::Other(_) => false,
    }
}

/// Effective degrees of freedom from which on they count as infinite.
const MANY_DEGREES: f64 = 1e6;

/// The error model of `result` at the attitude `c_zb`, whose turn changes with the parameters by `turn` and has the covariance `own`
/// beside these.
fn in_axes(
    result: &CalibrationResult,
    c_zb: Matrix3<f64>,
    turn: &Matrix3xX<f64>,
    own: &Matrix3<f64>,
) -> Result<ModelInAxes, NoErrorModel> {
    let terms = result.error_terms()?;
    let (count, all) = (terms.len(), result.parameters.len());
    let mut by = DMatrix::zeros(count + 3, all);
    for (row, term) in result.model.error_model.iter().enumerate() {
        if let Some(column) = result.parameters.iter().position(|p| p.name == term.name) {
            by[(row, column)] = 1.0;
        }
    }
    by.rows_mut(count, 3).copy_from(turn);
    // What is not determined takes no part: its column is zero, or the attitude had been refused.
    let covariance = result.covariance_matrix();
    let mut joint = &by * covariance * by.transpose();
    let mut of_turn = joint.view_mut((count, count), (3, 3));
    of_turn += own;
    let size = count + 3;
    ModelInAxes::new(terms, c_zb, joint)
        .ok_or(NoErrorModel::Axes { found: format!("a covariance of {size} quantities") })
}

impl CalibrationResult {
    /// The attitude of the instrument against its case: the mean of its turns `delta` over the positions on the arm, which seat the
    /// same case at different faces, or `case_turn` of rests in known attitudes. The scatter of the turns beyond that of the estimates is
    /// the seats' and the faces'; it counts as uncertainty.
    ///
    /// # Errors
    /// [`NoErrorModel::Case`] when less than two positions determine all three turns, and no rests do; [`NoErrorModel::TwoCases`] when both do, and
    /// contradict each other. Where they agree, the better one is taken.
    pub(crate) fn of_case(&self) -> Result<Attitude, NoErrorModel> {
        match (self.of_case_by_positions(), self.of_case_by_rests()) {
            (Err(NoErrorModel::Case { .. }), Some(by_rests)) => Ok(by_rests),
            (Ok(by_positions), Some(by_rests)) => self.one_case(by_positions, by_rests),
            (by_positions, _) => by_positions,
        }
    }

    /// The covariance of all parameters; zero where one is not determined.
    fn covariance_matrix(&self) -> DMatrix<f64> {
        let all = self.parameters.len();
        DMatrix::from_fn(all, all, |i, j| self.covariance[i][j].unwrap_or(0.0))
    }

    /// The better known of two attitudes that should be of one case.
    fn one_case(&self, by_positions: Attitude, by_rests: Attitude) -> Result<Attitude, NoErrorModel> {
        let covariance = self.covariance_matrix();
        let apart = Rotation3::from_matrix_unchecked(by_positions.c_zb.transpose() * by_rests.c_zb).scaled_axis();
        let of = |turn: &Matrix3xX<f64>| (turn * &covariance * turn.transpose()).diagonal();
        let between = of(&(&by_positions.turn - &by_rests.turn)) + by_positions.scatter.diagonal();
        let uncertainties =
            (0..3).map(|i| apart[i].abs() / between[i].max(f64::MIN_POSITIVE).sqrt()).fold(0.0, f64::max);
        if uncertainties > CONTRADICTORY {
            let apart = format!("{:.2} mrad, {uncertainties:.0} standard uncertainties", apart.norm() * 1e3);
            return Err(NoErrorModel::TwoCases { apart });
        }
        let better = of(&by_rests.turn).sum() < (of(&by_positions.turn) + by_positions.scatter.diagonal()).sum();
        Ok(if better { by_rests } else { by_positions })
    }

    /// The attitude of the case by `case_turn`; `None` where a component is not determined.
    fn of_case_by_rests(&self) -> Option<Attitude> {
        let mut turn = Matrix3xX::zeros(self.parameters.len());
        let mut value = Vector3::zeros();
        for i in 0..3 {
            let name = format!("case_turn_{}", i + 1);
            let j = self.parameters.iter().position(|p| p.group == Group::CaseTurn && p.name == name)?;
            value[i] = self.parameters[j].value?;
            turn[(i, j)] = 1.0;
        }
        Some(Attitude::of_case(&value, turn, Matrix3::zeros(), None))
    }

    fn of_case_by_positions(&self) -> Result<Attitude, NoErrorModel> {
        let all = self.parameters.len();
        let place = |i: usize, id: &str| {
            let name = format!("delta_{i}[{id}]");
            self.parameters.iter().position(|p| p.group == Group::Turn && p.name == name && p.value.is_some())
        };
        let on_arm = self.model.positions.iter().filter(|position| !position.is_free);
        let turns: Vec<[usize; 3]> =
            on_arm.filter_map(|p| Some([place(1, &p.id)?, place(2, &p.id)?, place(3, &p.id)?])).collect();
        if turns.len() < 2 {
            return Err(NoErrorModel::Case { positions: turns.len() });
        }
        let count = turns.len() as f64;
        let value = |j: usize| -> f64 { self.parameters[j].value.unwrap_or(0.0) };
        let covariance = self.covariance_matrix();
        let mut turn = Matrix3xX::zeros(all);
        let mut scatter = Matrix3::zeros();
        let mut mean = Vector3::zeros();
        for i in 0..3 {
            for of in &turns {
                mean[i] += value(of[i]) / count;
                turn[(i, of[i])] = 1.0 / count;
            }
            let of_mean = turn.row(i).into_owned();
            let (mut squares, mut expected) = (0.0, 0.0);
            for of in &turns {
                let deviation: f64 = value(of[i]) - mean[i];
                squares += deviation.powi(2);
                let mut deviation = -of_mean.clone();
                deviation[of[i]] += 1.0;
                expected += (&deviation * &covariance * deviation.transpose())[0];
            }
            scatter[(i, i)] = ((squares - expected) / (count - 1.0)).max(0.0) / count;
        }
        Ok(Attitude::of_case(&mean, turn, scatter, Some(turns.len())))
    }
}

/// Attitudes nearer than this are taken for one: a rest takes the nearest.
const NEAR: f64 = 0.1;

impl CalibrationResult {
    /// Whether the known attitudes show the sign of each axis and which column is which. Gravity alone does not; nor do attitudes
    /// that another sign or order of the columns takes to one another, as it does the faces of a cube.
    pub fn attitudes_show_columns(&self) -> bool {
        let is_known = |position: &&PositionSummary| position.attitude_uncertainty.is_some();
        let ups: Vec<Vector3<f64>> = self.model.positions.iter().filter(is_known).map(up).collect();
        let is_near = |up: &Vector3<f64>| ups.iter().any(|other| (up - other).norm() < NEAR);
        !ups.is_empty() && !Mistake::of_columns().any(|columns| ups.iter().all(|up| is_near(&columns.reading(up))))
    }
}

/// The vertical in instrument axes, which the matrix of a position takes from the third axis.
fn up(position: &PositionSummary) -> Vector3<f64> {
    Vector3::from_fn(|axis, _| position.matrix[axis][2])
}
