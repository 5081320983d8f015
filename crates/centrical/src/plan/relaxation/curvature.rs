//! The second derivatives of a smooth criterion.

use std::ops::Range;

use nalgebra::{DMatrix, DVector, MatrixXx3};

use super::point::ScenarioPoint;
use crate::plan::atom::Atoms;
use crate::plan::information::trace_of_product;

/// `-d ln Phi_s / d w_x` of the active atoms.
pub(super) fn slope(at: &ScenarioPoint, active: &[usize], atoms: Atoms) -> DVector<f64> {
    let of_atom = |&x: &usize| trace_of_product(at.scenario.precision(x), &at.weighed(atoms.at(x).candidate));
    DVector::from_iterator(active.len(), active.iter().map(of_atom))
}

/// Adds the contribution of the norm over scenarios, from their first derivatives: `q (sum pi_s l_s l_s^T - t t^T)`, `t = sum pi_s l_s`.
pub(super) fn add_norm(hessian: &mut DMatrix<f64>, slopes: &DMatrix<f64>, parts: &[f64], exponent: f64) {
    let total = slopes * DVector::from_column_slice(parts);
    for (slope, part) in slopes.column_iter().zip(parts) {
        let apart = slope - &total;
        hessian.ger(exponent * part, &apart, &apart, 1.0);
    }
}

/// Adds the second derivatives of a scenario: of a goal `2 tr(N A N' G')`, less `tr(N G N' G')` for a determinant, plus the
/// contribution of the norm over goals, less the product of the sensitivities for the logarithm.
pub(super) fn add_curvature(
    hessian: &mut DMatrix<f64>,
    at: &ScenarioPoint,
    exponent: f64,
    (active, groups, candidates): (&[usize], &[Range<usize>], &[usize]),
) {
    let ScenarioPoint { scenario, factor, smooth, part: weight } = at;
    let views = scenario.views(factor, candidates);
    let a = views.transpose() * &views;
    let responses: Vec<_> = candidates.iter().map(|&c| scenario.response(factor, c)).collect();
    let m = smooth.columns.len();
    let mut roots = DMatrix::zeros(m, 3 * candidates.len());
    for (n, response) in responses.iter().enumerate() {
        for (column, weight) in smooth.columns.iter().enumerate() {
            (0..3).for_each(|i| roots[(column, 3 * n + i)] = response[(column, i)] * weight.sqrt());
        }
    }
    let g = roots.transpose() * &roots;
    let by_goal = by_goal(at, &responses, active, groups);
    let block = |of: &DMatrix<f64>, i: usize, j: usize| of.fixed_view::<3, 3>(3 * i, 3 * j).into_owned();
    let s = m as f64;
    for i in 0..candidates.len() {
        for j in 0..=i {
            let (a_ij, g_ij) = (block(&a, i, j), block(&g, i, j));
            let mixed = if scenario.is_determinant() { 2.0 * a_ij - g_ij * s } else { 2.0 * a_ij };
            for k in groups[i].clone() {
                let left = scenario.precision(active[k]) * mixed;
                for l in groups[j].clone().filter(|&l| l <= k) {
                    // tr(N_k X_ij N_l G_ji), G_ji = G_ij^T
                    let value = weight * (left * scenario.precision(active[l])).component_mul(&g_ij).sum();
                    hessian[(k, l)] += value;
                    if l != k {
                        hessian[(l, k)] += value;
                    }
                }
            }
        }
    }
    if !scenario.is_determinant() {
        let total = &by_goal * DVector::from_column_slice(&smooth.parts);
        for (goal, part) in smooth.parts.iter().enumerate().filter(|(_, part)| **part > 1e-12) {
            let column = by_goal.column(goal);
            hessian.ger(weight * (exponent - 1.0) * part, &column, &column, 1.0);
        }
        hessian.ger(-weight * exponent, &total, &total, 1.0);
    }
}

/// `d ln r_j / d w_x` without its sign, active atoms by goals.
fn by_goal(
    ScenarioPoint { scenario, factor, .. }: &ScenarioPoint,
    responses: &[MatrixXx3<f64>],
    active: &[usize],
    groups: &[Range<usize>],
) -> DMatrix<f64> {
    let mut by_goal = DMatrix::zeros(active.len(), scenario.goals());
    if scenario.is_determinant() {
        return by_goal;
    }
    for (group, response) in groups.iter().zip(responses) {
        let of_goal = scenario.by_goal(response);
        for k in group.clone() {
            for (goal, g) in of_goal.iter().enumerate() {
                by_goal[(k, goal)] = trace_of_product(scenario.precision(active[k]), g) / factor.goals[goal];
            }
        }
    }
    by_goal
}
