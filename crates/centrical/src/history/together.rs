//! All quantities of a unit together, with their full covariances.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use crate::linalg::least_squares::LeastSquares;
use crate::statistics::{Test, chi_squared_tail, f_tail};
use crate::uncertainty::Estimates;

/// A session held against the others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FarthestSession {
    /// Its index.
    pub session: usize,
    /// Probability that by the stated errors any session deviates as much (Bonferroni).
    pub probability: f64,
    /// Probability of so large a chi^2 of the others without it.
    pub probability_of_others: f64,
    /// Probability that by the scatter of the others any session deviates as much (Bonferroni), as if all of it were in one quantity: F with 1
    /// and `k - 2` degrees of freedom.
    pub probability_by_scatter: f64,
}

impl Estimates {
    /// Whether the unit was the same in all sessions, by `sum_i (x_i - mu - B_i s)^T C_i^-1 (x_i - mu - B_i s) + |s|^2` at the best common `mu` and
    /// shared errors `s`; with the session that deviates most from the others, of three or more. `None` below two sessions, where all quantities are of one session each, or where a covariance is not positive
    /// definite.
    ///
    /// `quantities` has for each session the numbers of the quantities that its values are of, `0..p`, each of two sessions or more. `shared` has a
    /// matrix for each session: the changes of its values by errors that some sessions share, a column for each of `m` independent errors at one
    /// standard uncertainty, zero where a session does not have it. They are unknowns, each `0 +- 1`.
    pub fn sameness(
        sessions: &[Estimates],
        quantities: &[Vec<usize>],
        shared: &[DMatrix<f64>],
    ) -> Option<(Test, Option<FarthestSession>)> {
        let p = 1 + *quantities.iter().flatten().max()?;
        let m = shared.first().map_or(0, DMatrix::ncols);
        let blocks = blocks(sessions);
        let rows = blocks.last()?.end;
        let (mut design, mut values) = (DMatrix::zeros(rows + m, p + m), DVector::zeros(rows + m));
        design.view_mut((rows, p), (m, m)).fill_with_identity();
        let sizes = sizes(sessions, quantities, p);
        for (n, session) in sessions.iter().enumerate() {
            // Rows of C = D R D with the correlations R: `R = L L^T`, whitened by `L^-1 D^-1`.
            let (block, count) = (&blocks[n], blocks[n].len());
            let scale = session.covariance.diagonal().map(|v| 1.0 / v.sqrt());
            let correlation = DMatrix::from_fn(count, count, |i, j| session.covariance[(i, j)] * scale[i] * scale[j]);
            let factor = correlation.cholesky()?.unpack();
            let mut unknowns = DMatrix::zeros(count, p);
            for (i, &quantity) in quantities[n].iter().enumerate() {
                unknowns[(i, quantity)] = sizes[quantity] * scale[i];
            }
            let whitened = session.values.component_mul(&scale);
            design.view_mut((block.start, 0), (count, p)).copy_from(&factor.solve_lower_triangular(&unknowns)?);
            if let Some(shared) = shared.get(n) {
                let scaled = DMatrix::from_diagonal(&scale) * shared;
                design.view_mut((block.start, p), (count, m)).copy_from(&factor.solve_lower_triangular(&scaled)?);
            }
            values.rows_mut(block.start, count).copy_from(&factor.solve_lower_triangular(&whitened)?);
        }
        let degrees_of_freedom = rows.checked_sub(p).filter(|rest| *rest > 0)?;
        let equations = LeastSquares::new(design, sizes.resize_vertically(p + m, 1.0));
        let chi_squared = equations.redundant(&values).norm_squared();
        // Of two sessions each is as far from the other.
        let farthest = if sessions.len() > 2 {
            farthest(&equations, &values.rows(0, rows).into_owned(), &blocks, degrees_of_freedom)
        } else {
            None
        };
        let any = |chance: f64| (sessions.len() as f64 * chance).min(1.0);
        let farthest = farthest.map(|(session, fall)| {
            let (rest, of_others) = ((chi_squared - fall).max(0.0), sessions.len() - 2);
            FarthestSession {
                session,
                probability: any(chi_squared_tail(fall, blocks[session].len())),
                probability_of_others: chi_squared_tail(rest, degrees_of_freedom - blocks[session].len()),
                probability_by_scatter: any(f_tail(fall * of_others as f64 / rest, 1.0, of_others as f64)),
            }
        });
        Some((Test::chi_squared(chi_squared, degrees_of_freedom), farthest))
    }
}

/// The equations of each session.
fn blocks(sessions: &[Estimates]) -> Vec<Range<usize>> {
    let mut end = 0;
    let block = |session: &Estimates| {
        let start = end;
        end += session.values.len();
        start..end
    };
    sessions.iter().map(block).collect()
}

/// The size of each unknown: its standard uncertainty in the first session that has it.
fn sizes(sessions: &[Estimates], quantities: &[Vec<usize>], p: usize) -> DVector<f64> {
    let mut sizes = DVector::repeat(p, 1.0);
    for (session, quantities) in sessions.iter().zip(quantities).rev() {
        for (i, &quantity) in quantities.iter().enumerate() {
            sizes[quantity] = session.covariance[(i, i)].sqrt();
        }
    }
    sizes
}

/// The session without which chi^2 falls most, and by how much: `r^T (E - Q Q^T)^-1 r` with its residuals `r` and its rows of the orthonormal
/// basis `Q`. A session that the others do not check is not among them.
fn farthest(
    equations: &LeastSquares,
    values: &DVector<f64>,
    blocks: &[Range<usize>],
    degrees_of_freedom: usize,
) -> Option<(usize, f64)> {
    let basis = equations.basis(values.len());
    let residuals = values - &basis * basis.tr_mul(values);
    let fall = |block: &Range<usize>| {
        let count = block.len();
        let (own, r) = (basis.rows(block.start, count), residuals.rows(block.start, count));
        Some(r.dot(&(DMatrix::identity(count, count) - own * own.transpose()).cholesky()?.solve(&r)))
    };
    let checked = blocks.iter().enumerate().filter(|(_, block)| block.len() < degrees_of_freedom);
    checked.filter_map(|(n, block)| Some((n, fall(block)?))).max_by(|(_, a), (_, b)| a.total_cmp(b))
}
