//! Linear least squares `min |A x - b|` by Householder QR.
//!
//! The unknowns are counted in sizes of theirs, `x = S y` with a diagonal `S`, which takes their units out of the
//! condition number. With `A S = Q R` the solution is `S R^-1 Q^T b`, its covariance for errors of `b` of unit variance
//! `S R^-1 R^-T S`.
//!
//! Unknowns that few equations contain are eliminated with these first, group by group. A group takes all equations that contain its unknowns
//! `x_k`, and with them other unknowns `y`:
//!
//! `Q_k^T [A_k B_k b_k] = [R_k S_k u_k; 0 T_k d_k]`.
//!
//! The rows `T_k y = d_k` are equations of the unknowns left, as those that no group takes are; `x_k = R_k^-1 (u_k - S_k y)`. The time is
//! linear in groups.

use nalgebra::{DMatrix, DVector, Dyn, QR};

/// Equations of full rank, at least as many as unknowns, factored.
#[derive(Debug, Clone)]
pub struct LeastSquares {
    elimination: Elimination,
    /// Of the equations left by the elimination.
    qr: QR<f64, Dyn, Dyn>,
    r: DMatrix<f64>,
    /// Numbers of equations left, and of all.
    left: usize,
    rows: usize,
    sizes: DVector<f64>,
}

impl LeastSquares {
    /// Factors `A S`, the equations in units of the `sizes` of the unknowns.
    pub fn new(scaled: DMatrix<f64>, sizes: DVector<f64>) -> Self {
        Self::eliminating(&[], scaled, sizes)
    }

    /// Factors `A`, its columns scaled to unit length. `None` where they are dependent or more than the rows.
    pub(crate) fn of_columns(mut columns: DMatrix<f64>) -> Option<Self> {
        /// What rounding leaves of a column of unit length that others make up.
        const ROUNDING: f64 = 1e-12;
        let sizes = DVector::from_iterator(columns.ncols(), columns.column_iter().map(|column| 1.0 / column.norm()));
        columns.column_iter_mut().zip(&sizes).for_each(|(mut column, size)| column *= *size);
        let equations = (columns.nrows() >= columns.ncols()).then(|| Self::new(columns, sizes))?;
        equations.r.diagonal().iter().all(|length| length.abs() > ROUNDING).then_some(equations)
    }

    /// The same as [`Self::new`], and the unknowns of some groups are eliminated first.
    pub(crate) fn eliminating(groups: &[Own], scaled: DMatrix<f64>, sizes: DVector<f64>) -> Self {
        let rows = scaled.nrows();
        let (elimination, left) = Elimination::of(scaled, groups);
        let (left, qr) = (left.nrows(), left.qr());
        Self { elimination, r: qr.r(), qr, left, rows, sizes }
    }

    /// The solution for `b`; rows that it lacks at its end are zeros.
    pub fn solve(&self, b: DVector<f64>) -> DVector<f64> {
        self.step(b).0
    }

    /// The solution for `b`, and its length in standard uncertainties, all unknowns together.
    pub(crate) fn step(&self, b: DVector<f64>) -> (DVector<f64>, f64) {
        let rotated = self.rotated(DMatrix::from_columns(&[b]));
        let length = rotated.rows_range(..self.columns()).norm();
        (self.unknowns(&rotated).column(0).into_owned(), length)
    }

    /// `Q^T B`: the first rows, one per unknown, are what the unknowns follow; the others are what none of them can. Rows
    /// that `B` lacks at its end are zeros.
    pub fn rotated(&self, b: DMatrix<f64>) -> DMatrix<f64> {
        let mut rotated = self.elimination.rotated(b.resize_vertically(self.rows, 0.0));
        self.qr.q_tr_mul(&mut rotated.rows_mut(self.elimination.columns(), self.left));
        rotated
    }

    /// The solutions, column by column, for the first rows of a matrix [`LeastSquares::rotated`].
    pub fn unknowns(&self, rotated: &DMatrix<f64>) -> DMatrix<f64> {
        self.in_units(self.in_sizes(rotated))
    }

    /// The part of `b`, rotated, that no unknown can follow: its squares are those of the residuals. Rows that it lacks at
    /// its end are zeros.
    pub fn redundant(&self, b: &DVector<f64>) -> DVector<f64> {
        let rotated = self.rotated(DMatrix::from_columns(std::slice::from_ref(b)));
        rotated.column(0).rows_range(self.columns()..).into_owned()
    }

    /// The first `rows` rows of `Q`, an orthonormal basis of the columns.
    pub fn basis(&self, rows: usize) -> DMatrix<f64> {
        let (eliminated, left) = (self.elimination.columns(), self.qr.q());
        let mut basis = DMatrix::identity(self.rows, self.columns());
        basis.view_mut((eliminated, eliminated), left.shape()).copy_from(&left);
        self.elimination.turned_back(basis).rows(0, rows).into_owned()
    }

    /// Number of unknowns.
    pub fn columns(&self) -> usize {
        self.sizes.len()
    }

    /// `R` of the unknowns that are not eliminated, in units of the sizes.
    pub fn triangle(&self) -> &DMatrix<f64> {
        &self.r
    }

    /// `R^-1`, in units of the sizes.
    pub fn inverse(&self) -> DMatrix<f64> {
        self.in_sizes(&DMatrix::identity(self.columns(), self.columns()))
    }

    /// Principal directions of the covariance whose standard uncertainty, in sizes of the unknowns, is above a limit, and as long
    /// as it; the unknowns that are eliminated follow the others.
    pub fn wider_than(&self, limit: f64) -> Vec<DVector<f64>> {
        let svd = self.r.clone().svd(false, true);
        let Some(directions) = svd.v_t else { return Vec::new() };
        let pairs = svd.singular_values.iter().zip(directions.row_iter());
        let wide = pairs.filter(|(s, _)| **s * limit < 1.0).map(|(s, direction)| direction.transpose() / *s);
        let none = DMatrix::zeros(self.elimination.columns(), 1);
        wide.map(|d| self.elimination.completed(&none, DMatrix::from_columns(&[d])).column(0).into_owned()).collect()
    }

    /// Covariance of the solution for errors of `b` of unit variance.
    pub fn covariance(&self) -> DMatrix<f64> {
        let root = self.root();
        &root * root.transpose()
    }

    /// Standard uncertainties of the solution for errors of `b` of unit variance: lengths of the rows of `S R^-1`.
    pub fn standard_uncertainties(&self) -> Vec<f64> {
        self.inverse().row_iter().zip(self.sizes.iter()).map(|(row, size)| row.norm() * size).collect()
    }

    /// A root of the covariance, `S R^-1`.
    pub fn root(&self) -> DMatrix<f64> {
        self.in_units(self.inverse())
    }

    /// [`LeastSquares::unknowns`] in units of the sizes.
    fn in_sizes(&self, rotated: &DMatrix<f64>) -> DMatrix<f64> {
        let mut left = rotated.rows_range(self.elimination.columns()..self.columns()).into_owned();
        let solved = self.r.solve_upper_triangular_mut(&mut left);
        debug_assert!(solved, "the equations are of full rank");
        self.elimination.completed(rotated, left)
    }

    /// From units of the sizes to those of the unknowns, row by row.
    fn in_units(&self, mut rows: DMatrix<f64>) -> DMatrix<f64> {
        rows.row_iter_mut().zip(self.sizes.iter()).for_each(|(mut row, size)| row *= *size);
        rows
    }
}

/// The unknowns of a group by their columns, and the rows of all equations that contain them: as many or more. No other group takes
/// any of them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Own {
    pub columns: Vec<usize>,
    pub rows: Vec<usize>,
}

/// Equations without the unknowns of some groups.
#[derive(Debug, Clone)]
pub struct Elimination {
    groups: Vec<Group>,
    /// Columns of the unknowns left, rising.
    left: Vec<usize>,
    /// Rows in the order of what was rotated: `u` of all groups, the equations left, and those of no unknown.
    order: Vec<usize>,
    /// Number of unknowns eliminated.
    columns: usize,
}

#[derive(Debug, Clone)]
struct Group {
    own: Own,
    /// Of `[A_k B_k]`.
    qr: QR<f64, Dyn, Dyn>,
    r: DMatrix<f64>,
    s: DMatrix<f64>,
}

impl Elimination {
    /// Eliminates the unknowns of the groups from the rows `A`; the equations left, `T_k` among them.
    pub fn of(mut rows: DMatrix<f64>, groups: &[Own]) -> (Self, DMatrix<f64>) {
        let left = others(rows.ncols(), groups.iter().flat_map(|own| &own.columns));
        let columns = rows.ncols() - left.len();
        if columns == 0 {
            return (Self { groups: Vec::new(), left, order: Vec::new(), columns }, rows);
        }
        let groups: Vec<Group> = groups.iter().map(|own| Group::eliminated(own, &left, &mut rows)).collect();
        let solved = groups.iter().flat_map(|group| &group.own.rows[..group.own.columns.len()]);
        let surplus = groups.iter().flat_map(|group| group.own.rows.iter().skip(group.s.ncols() + group.r.ncols()));
        let remaining = others(rows.nrows(), solved.clone().chain(surplus.clone()));
        let order = solved.chain(&remaining).chain(surplus).copied().collect();
        let rows = rows.select_rows(&remaining).select_columns(&left);
        (Self { groups, left, order, columns }, rows)
    }

    /// Number of unknowns eliminated.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Columns of the unknowns left, rising.
    pub fn left(&self) -> &[usize] {
        &self.left
    }

    /// Right sides `B` of the equations as they are rotated: `u` of all groups, then those of the equations left, then what no
    /// unknown can follow.
    pub fn rotated(&self, mut b: DMatrix<f64>) -> DMatrix<f64> {
        for group in &self.groups {
            let mut block = b.select_rows(&group.own.rows);
            group.qr.q_tr_mul(&mut block);
            scatter(&mut b, &group.own.rows, &block);
        }
        if self.groups.is_empty() { b } else { b.select_rows(&self.order) }
    }

    /// The inverse of [`Elimination::rotated`] of columns that no unknown misses: zero in all rows that no unknown can follow. The time is
    /// linear in rows.
    pub fn turned_back(&self, rotated: DMatrix<f64>) -> DMatrix<f64> {
        if self.groups.is_empty() {
            return rotated;
        }
        let mut b = DMatrix::zeros(rotated.nrows(), rotated.ncols());
        scatter(&mut b, &self.order, &rotated);
        for group in &self.groups {
            let q = group.qr.q();
            let followed = b.select_rows(&group.own.rows[..q.ncols()]);
            let mut block = DMatrix::zeros(q.nrows(), b.ncols());
            // Column by column: a product of two matrices has other last digits on another processor.
            block
                .column_iter_mut()
                .zip(followed.column_iter())
                .for_each(|(mut column, v)| column.gemv(1.0, &q, &v, 0.0));
            scatter(&mut b, &group.own.rows, &block);
        }
        b
    }

    /// All unknowns, column by column: from `u`, the first rows of what was rotated, and the unknowns `y` left.
    pub fn completed(&self, u: &DMatrix<f64>, y: DMatrix<f64>) -> DMatrix<f64> {
        if self.groups.is_empty() {
            return y;
        }
        let mut x = DMatrix::zeros(self.columns + self.left.len(), y.ncols());
        scatter(&mut x, &self.left, &y);
        let mut first = 0;
        for Group { own, r, s, .. } in &self.groups {
            let mut of_group = u.rows(first, own.columns.len()) - s * &y;
            let solved = r.solve_upper_triangular_mut(&mut of_group);
            debug_assert!(solved, "the equations of a group determine its unknowns");
            scatter(&mut x, &own.columns, &of_group);
            first += own.columns.len();
        }
        x
    }
}

impl Group {
    /// Factors the equations of a group, and leaves `T_k` in the place of the last ones.
    fn eliminated(own: &Own, left: &[usize], rows: &mut DMatrix<f64>) -> Self {
        let (m, c) = (own.columns.len(), left.len());
        let columns: Vec<usize> = own.columns.iter().chain(left).copied().collect();
        let qr = rows.select_rows(&own.rows).select_columns(&columns).qr();
        let triangle = qr.r();
        for (i, row) in own.rows.iter().enumerate().take(triangle.nrows()).skip(m) {
            left.iter().enumerate().for_each(|(k, column)| rows[(*row, *column)] = triangle[(i, m + k)]);
        }
        let (r, s) = (triangle.view((0, 0), (m, m)).into_owned(), triangle.view((0, m), (m, c)).into_owned());
        Self { own: own.clone(), qr, r, s }
    }
}

/// Those of `0..count` that are not `taken`, rising.
fn others<'a>(count: usize, taken: impl Iterator<Item = &'a usize>) -> Vec<usize> {
    let mut is_taken = vec![false; count];
    taken.for_each(|index| is_taken[*index] = true);
    (0..count).filter(|index| !is_taken[*index]).collect()
}

/// Puts `rows` into their places.
fn scatter(all: &mut DMatrix<f64>, places: &[usize], rows: &DMatrix<f64>) {
    for (row, place) in rows.row_iter().zip(places) {
        all.set_row(*place, &row);
    }
}
