//! A quantity of one unit, session by session.

use nalgebra::DMatrix;

/// Its value in one session.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Time of the session [years].
    pub time: f64,
    /// Estimate.
    pub value: f64,
    /// Variance of the errors that belong to this session alone.
    pub variance: f64,
}

/// Its values in the order of time.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    points: Vec<Point>,
    /// Change of each value by each error that sessions share, at one standard uncertainty, `k x m`.
    shared: DMatrix<f64>,
}

impl Series {
    /// `points` with the changes that errors common to sessions make in each, a row for each point and a column for each
    /// independent error: type B of one station is not drawn anew in every session.
    ///
    /// `None` if the rows of `shared` are not as many as the points, or a number is not finite, or a variance not positive.
    pub fn new(points: &[Point], shared: &DMatrix<f64>) -> Option<Self> {
        let is_sound =
            |p: &Point| p.time.is_finite() && p.value.is_finite() && p.variance > 0.0 && p.variance.is_finite();
        let are_sound = points.iter().all(is_sound) && shared.iter().all(|change| change.is_finite());
        if shared.nrows() != points.len() || !are_sound {
            return None;
        }
        let mut order: Vec<usize> = (0..points.len()).collect();
        order.sort_by(|&i, &j| points[i].time.total_cmp(&points[j].time));
        Some(Self { points: order.iter().map(|&i| points[i]).collect(), shared: shared.select_rows(&order) })
    }

    /// The points, in the order of time.
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// Changes by the errors that some sessions share and others do not, as after a move to another station, `k x m`: what all share
    /// moves no scatter.
    pub(super) fn shared_by_some(&self) -> Option<DMatrix<f64>> {
        let is_of_some = |column: &usize| {
            let changes = self.shared.column(*column);
            let count = changes.iter().filter(|change| **change != 0.0).count();
            0 < count && count < changes.len()
        };
        let columns: Vec<usize> = (0..self.shared.ncols()).filter(is_of_some).collect();
        (!columns.is_empty()).then(|| self.shared.select_columns(&columns))
    }

    /// Variance that the common errors leave in `sum_i c_i y_i`.
    pub(super) fn shared_variance(&self, coefficients: &[f64]) -> f64 {
        let change =
            |column: nalgebra::DVectorView<f64>| -> f64 { column.iter().zip(coefficients).map(|(s, c)| s * c).sum() };
        self.shared.column_iter().map(|column| change(column).powi(2)).sum()
    }

    /// The value of session `j` less that of session `i`, and its standard uncertainty, without the component between sessions:
    /// what both share cancels.
    ///
    /// # Panics
    /// If `i` or `j` is not below the number of sessions.
    pub fn difference(&self, i: usize, j: usize) -> (f64, f64) {
        let mut coefficients = vec![0.0; self.points.len()];
        coefficients[i] -= 1.0;
        coefficients[j] += 1.0;
        let own = if i == j { 0.0 } else { self.points[i].variance + self.points[j].variance };
        let difference = self.points[j].value - self.points[i].value;
        (difference, (own + self.shared_variance(&coefficients)).sqrt())
    }
}
