//! Unknowns that few equations contain, eliminated with these by orthogonal factorisation.
//!
//! Of the equations `A x = b` a group takes all that contain its unknowns `x_k`, and other unknowns `y`:
//!
//! `Q_k^T [A_k B_k b_k] = [R_k S_k u_k; 0 T_k d_k]`.
//!
//! The rows `T_k y = d_k` are equations of the unknowns left, as those that no group takes are; `x_k = R_k^-1 (u_k - S_k y)`. The time is
//! linear in groups.

use nalgebra::{DMatrix, Dyn, QR};

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
