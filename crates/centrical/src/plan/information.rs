//! The information of a design, as a triangular factor, and how the criterion answers to more of it.
//!
//! Unknowns are in units of ten typical magnitudes, influences in their standard uncertainties: the hold is the identity.
//! Over the visits `M = E + priors + sum J^T N J`, `N = Sigma^-1`. With `M = R^T R` by QR of the stacked rows and `P = R^-1`, the covariance is `P P^T` and
//! is never formed. A change `dN` at candidate `c` changes it by `-C J^T Q J C`, `Q = dN (E + A dN)^-1`, `A = J C J^T`, so a
//! goal `r = sum |P^T k|^2` changes by `-tr(Q G)`, `G = sum (J C k)(J C k)^T`: all in 3x3.

use nalgebra::{Cholesky, DMatrix, DVector, Matrix3, MatrixXx3, Vector3};

use super::atom::Atoms;
use super::candidates::{Candidates, Scenario};
use super::criterion::{Columns, Criterion};
use super::error::PlanError;
use crate::linalg::fold::fold;
use crate::model::plateau::total_covariance;
use crate::model::{Linearisation, MeasurementModel, Parameter, SetPoint, Weight};

/// Candidates whose rows are folded in at once: as many as stay in the nearest cache with the triangle.
const AT_ONCE: usize = 16;

/// Fewer visits than this give no information.
const NOTHING: f64 = 1e-9;

/// A scenario linearised at its expected unknowns: rows of all candidates, precisions of all atoms, columns of the criterion.
#[derive(Debug, Clone)]
pub(super) struct LinearisedScenario {
    /// Its part among the scenarios; they sum to 1.
    pub weight: f64,
    /// By candidate: non-zero columns of `J`, scaled.
    jacobians: Vec<Vec<(usize, Vector3<f64>)>>,
    /// By atom: `Sigma^-1`.
    precisions: Vec<Matrix3<f64>>,
    /// Roots of the diagonal of `M_0`.
    prior: Vec<f64>,
    columns: Columns,
    goals: usize,
}

/// A design's information in one scenario.
#[derive(Debug, Clone)]
pub(super) struct Factor {
    triangle: DMatrix<f64>,
    /// `P^T = R^-T`: its columns are the unknowns.
    root: DMatrix<f64>,
    /// `(C K)^T`, with `K` whitened by its own covariance for a determinant, `m x p`.
    reach: DMatrix<f64>,
    /// `r_j`; for a determinant its `s`-th root.
    pub goals: Vec<f64>,
}

/// How a smooth criterion weighs the columns: its logarithm changes by `-sum_c tr(N_c sum_m v_m f_m f_m^T)`.
#[derive(Debug, Clone)]
pub(super) struct Smooth {
    /// Logarithm of the smooth criterion.
    pub value: f64,
    /// The same with the weights of the goals held: the bound of the true criterion starts from it.
    pub support: f64,
    /// `v` by column.
    pub columns: Vec<f64>,
    /// Parts of the goals, which sum to 1.
    pub parts: Vec<f64>,
}

impl LinearisedScenario {
    /// The scenario with its criterion; `total` is the sum of the weights of all.
    pub fn new(
        scenario: &Scenario,
        candidates: &Candidates,
        criterion: &Criterion,
        total: f64,
    ) -> Result<Self, PlanError> {
        let model = &scenario.model;
        let mut precisions = Vec::with_capacity(candidates.atoms().count());
        for n in 0..candidates.len() {
            for &duration in &candidates.durations {
                let weight = scenario.noise.weight(n, duration);
                precisions.push(precision(model, &scenario.nominal, &weight)?);
            }
        }
        Ok(Self { weight: scenario.weight / total, precisions, ..Self::of(model, &scenario.nominal, criterion)? })
    }

    /// The rows of all set points of `model` and the columns of the criterion, without precisions.
    pub fn of(model: &MeasurementModel, nominal: &[f64], criterion: &Criterion) -> Result<Self, PlanError> {
        // An influence is known to its standard uncertainty, 1: the hold is its prior.
        let influences = model.influences().iter().map(|_| 1.0);
        let scale: Vec<f64> =
            model.parameters().iter().map(|p| Parameter::NULL_HOLD * p.typical).chain(influences).collect();
        let jacobian = |set_point| {
            let at = linearised(model, nominal, set_point);
            at.by_unknowns().map(|(j, column)| (j, column * scale[j])).collect::<Vec<_>>()
        };
        let jacobians: Vec<_> = model.experiment().set_points.iter().map(jacobian).collect();
        let mut squares = vec![1.0; scale.len()];
        for prior in model.priors() {
            squares[prior.parameter] += (scale[prior.parameter] / prior.standard_uncertainty).powi(2);
        }
        let mut columns = criterion.columns(model)?;
        columns.k = columns.k.resize_vertically(scale.len(), 0.0);
        columns.k.row_iter_mut().zip(&scale).for_each(|(mut row, scale)| row *= *scale);
        let goals = columns.goal.iter().max().map_or(0, |last| last + 1);
        let prior = squares.into_iter().map(f64::sqrt).collect();
        Ok(Self { weight: 1.0, jacobians, precisions: Vec::new(), prior, columns, goals })
    }

    /// The scenario with some of the candidates, which it numbers anew.
    pub fn part(&self, candidates: &[usize], atoms: Atoms) -> Self {
        Self {
            weight: self.weight,
            jacobians: candidates.iter().map(|&c| self.jacobians[c].clone()).collect(),
            precisions: candidates.iter().flat_map(|&c| atoms.of(c)).map(|x| self.precisions[x]).collect(),
            prior: self.prior.clone(),
            columns: self.columns.clone(),
            goals: self.goals,
        }
    }

    /// `N` of an atom.
    pub fn precision(&self, atom: usize) -> &Matrix3<f64> {
        &self.precisions[atom]
    }

    /// Information of a design, by candidate.
    pub fn information(&self, atoms: Atoms, visits: impl Fn(usize) -> f64) -> Vec<(usize, Matrix3<f64>)> {
        let of_candidate = |c: usize| {
            let mut visited = atoms.of(c).filter(|&x| visits(x) > NOTHING).peekable();
            visited.peek()?;
            Some((c, visited.fold(Matrix3::zeros(), |sum, x| sum + self.precisions[x] * visits(x))))
        };
        (0..atoms.candidates).filter_map(of_candidate).collect()
    }

    /// The factor of `M_0` and the information at some candidates.
    pub fn factor(&self, information: &[(usize, Matrix3<f64>)]) -> Factor {
        self.factor_of(self.stacked(self.held(), information))
    }

    /// The factor with more information at some candidates.
    pub fn with(&self, factor: &Factor, information: &[(usize, Matrix3<f64>)]) -> Factor {
        self.factor_of(self.stacked(factor.triangle.clone(), information))
    }

    /// `R` of `M_0`.
    pub fn held(&self) -> DMatrix<f64> {
        DMatrix::from_diagonal(&DVector::from_column_slice(&self.prior))
    }

    /// `R` with more information at some candidates.
    pub fn stacked(&self, mut triangle: DMatrix<f64>, information: &[(usize, Matrix3<f64>)]) -> DMatrix<f64> {
        let p = self.prior.len();
        for some in information.chunks(AT_ONCE) {
            let mut rows = DMatrix::zeros(3 * some.len(), p);
            for (n, (candidate, precision)) in some.iter().enumerate() {
                // A zero precision adds no rows.
                let Some(half) = Cholesky::new(*precision).map(|factor| factor.l().transpose()) else { continue };
                for (column, derivative) in &self.jacobians[*candidate] {
                    rows.fixed_view_mut::<3, 1>(3 * n, *column).copy_from(&(half * derivative));
                }
            }
            fold(&mut triangle, &mut rows);
        }
        triangle
    }

    /// The factor with this `R`.
    pub fn factor_of(&self, triangle: DMatrix<f64>) -> Factor {
        let mut root = DMatrix::identity(triangle.nrows(), triangle.ncols());
        // The hold leaves no zero on the diagonal.
        let solved = triangle.solve_upper_triangular_mut(&mut root);
        debug_assert!(solved, "the hold makes every factor regular");
        let transposed = root.transpose();
        let mut seen = &transposed * &self.columns.k;
        let goals = if self.columns.is_determinant { Self::whiten(&mut seen) } else { self.sums(&seen) };
        Factor { triangle, reach: seen.transpose() * &transposed, root: transposed, goals }
    }

    fn sums(&self, seen: &DMatrix<f64>) -> Vec<f64> {
        let mut goals = vec![0.0; self.goals];
        seen.column_iter().zip(&self.columns.goal).for_each(|(column, goal)| goals[*goal] += column.norm_squared());
        goals
    }

    /// Makes the columns orthonormal and returns `det(K^T C K)^(1/s)`.
    fn whiten(seen: &mut DMatrix<f64>) -> Vec<f64> {
        let s = seen.ncols();
        let qr = seen.clone().qr();
        let log: f64 = qr.r().diagonal().iter().map(|d| 2.0 * d.abs().ln()).sum();
        *seen = qr.q();
        vec![(log / s as f64).exp()]
    }

    /// Logarithm of the criterion itself: of the worst goal, of the only one, of the determinant.
    pub fn value(factor: &Factor) -> f64 {
        factor.goals.iter().copied().fold(f64::MIN_POSITIVE, f64::max).ln()
    }

    /// The criterion with the worst goal replaced by the `exponent`-norm of all, `(sum r_j^q)^(1/q)`.
    pub fn smooth(&self, factor: &Factor, exponent: f64) -> Smooth {
        let s = self.columns.goal.len() as f64;
        if self.columns.is_determinant {
            let value = factor.goals[0].ln();
            return Smooth { value, support: value, columns: vec![1.0 / s; self.columns.goal.len()], parts: vec![1.0] };
        }
        let worst = factor.goals.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let powers: Vec<f64> = factor.goals.iter().map(|r| (r / worst).powf(exponent)).collect();
        let sum: f64 = powers.iter().sum();
        let parts: Vec<f64> = powers.iter().map(|power| power / sum).collect();
        let of_goal: Vec<f64> =
            parts.iter().zip(&factor.goals).map(|(part, r)| part / r.max(f64::MIN_POSITIVE)).collect();
        // Weights lambda_j in proportion to part_j / r_j make sum lambda_j r_j = 1 / sum (part_j / r_j).
        let support = -of_goal.iter().sum::<f64>().ln();
        Smooth {
            value: worst.ln() + sum.ln() / exponent,
            support,
            columns: self.columns.goal.iter().map(|&j| of_goal[j]).collect(),
            parts,
        }
    }

    /// `f_m = J C k_m` of a candidate in rows, `m x 3`.
    pub fn response(&self, factor: &Factor, candidate: usize) -> MatrixXx3<f64> {
        let mut response = MatrixXx3::zeros(factor.reach.nrows());
        for (column, derivative) in &self.jacobians[candidate] {
            for i in (0..3).filter(|&i| derivative[i] != 0.0) {
                response.column_mut(i).axpy(derivative[i], &factor.reach.column(*column), 1.0);
            }
        }
        response
    }

    /// `J P` of some candidates, `p x 3` each, side by side.
    pub fn views(&self, factor: &Factor, candidates: &[usize]) -> DMatrix<f64> {
        let p = self.prior.len();
        let mut views = DMatrix::zeros(p, 3 * candidates.len());
        for (n, &candidate) in candidates.iter().enumerate() {
            for (column, derivative) in &self.jacobians[candidate] {
                for i in 0..3 {
                    if derivative[i] != 0.0 {
                        views.column_mut(3 * n + i).axpy(derivative[i], &factor.root.column(*column), 1.0);
                    }
                }
            }
        }
        views
    }

    /// `G = sum v_m f_m f_m^T`.
    pub fn weighed(response: &MatrixXx3<f64>, weights: &[f64]) -> Matrix3<f64> {
        Self::weighed_rows(response, 0..weights.len(), |m| weights[m])
    }

    /// `G` of each goal, all columns weighing the same.
    pub fn by_goal(&self, response: &MatrixXx3<f64>) -> Vec<Matrix3<f64>> {
        let of_goal = |goal: usize| {
            let columns = (0..response.nrows()).filter(move |&m| self.columns.goal[m] == goal);
            Self::weighed_rows(response, columns, |_| 1.0)
        };
        (0..self.goals).map(of_goal).collect()
    }

    fn weighed_rows(
        response: &MatrixXx3<f64>,
        rows: impl Iterator<Item = usize>,
        weight: impl Fn(usize) -> f64,
    ) -> Matrix3<f64> {
        let mut sum = Matrix3::zeros();
        for m in rows {
            let f = response.fixed_view::<1, 3>(m, 0);
            sum += f.transpose() * (f * weight(m));
        }
        sum
    }

    /// Number of goals.
    pub fn goals(&self) -> usize {
        self.goals
    }

    /// Whether the criterion is a determinant.
    pub fn is_determinant(&self) -> bool {
        self.columns.is_determinant
    }

    /// The matrices by which changes at one candidate are judged.
    pub fn insight(&self, factor: &Factor, candidate: usize) -> Insight {
        let view = self.views(factor, &[candidate]);
        let response = self.response(factor, candidate);
        let a = view.transpose() * &view;
        Insight { a: Matrix3::from_fn(|i, j| a[(i, j)]), by_goal: self.by_goal(&response) }
    }

    /// Logarithm of the criterion after a change `dn` of the information at a candidate; infinite if it would take away more
    /// than there is.
    pub fn value_after(&self, factor: &Factor, insight: &Insight, dn: &Matrix3<f64>) -> f64 {
        let system = Matrix3::identity() + insight.a * dn;
        // Positive for any gain; a loss of nearly all that is known along a direction is not a reliable number.
        if system.determinant() < 1e-9 {
            return f64::INFINITY;
        }
        let Some(q) = system.try_inverse().map(|inverse| dn * inverse) else { return f64::INFINITY };
        if self.columns.is_determinant {
            let rest = (Matrix3::identity() - q * insight.by_goal[0]).determinant();
            return factor.goals[0].ln() + rest.max(f64::MIN_POSITIVE).ln() / self.columns.goal.len() as f64;
        }
        let after = factor.goals.iter().zip(&insight.by_goal).map(|(r, g)| r - trace_of_product(&q, g));
        after.fold(f64::MIN_POSITIVE, f64::max).ln()
    }

    /// Part of the priors and the hold in the sensitivities: `sum v_m |M_0^(1/2) C k_m|^2`.
    pub fn prior_part(&self, factor: &Factor, weights: &[f64]) -> f64 {
        let column = |m: usize| {
            factor.reach.row(m).iter().zip(&self.prior).map(|(reach, prior)| (reach * prior).powi(2)).sum::<f64>()
        };
        weights.iter().enumerate().map(|(m, weight)| weight * column(m)).sum()
    }
}

/// The matrices by which changes at one candidate are judged: `A`, and `G` by goal.
#[derive(Debug, Clone)]
pub(super) struct Insight {
    a: Matrix3<f64>,
    by_goal: Vec<Matrix3<f64>>,
}

/// At the expected unknowns by the exact model; at zero by [K5.3], which is the same there.
fn linearised(model: &MeasurementModel, nominal: &[f64], set_point: &SetPoint) -> Linearisation {
    if nominal.iter().all(|value| *value == 0.0) {
        model.linearise_at_zero(set_point)
    } else {
        model.linearise(set_point, nominal)
    }
}

/// `Sigma^-1` of the mean of a plateau, its speed error included.
pub(super) fn precision(model: &MeasurementModel, nominal: &[f64], weight: &Weight) -> Result<Matrix3<f64>, PlanError> {
    let set_points = &model.experiment().set_points;
    let at = linearised(model, nominal, &set_points[weight.set_point]);
    let total = total_covariance(&weight.covariance, &at);
    let precision = total.cholesky().map(|factor| factor.inverse());
    precision.filter(|p| p.iter().all(|v| v.is_finite())).ok_or(PlanError::Noise { candidate: weight.set_point })
}

/// `tr(A B)` of two matrices, the second symmetric.
pub(super) fn trace_of_product(a: &Matrix3<f64>, b: &Matrix3<f64>) -> f64 {
    a.component_mul(b).sum()
}
