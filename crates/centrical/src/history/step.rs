//! A step between two sessions, as after a repair, in place of a slope.

use super::line::{Curve, Line};
use super::series::{Point, Series};

/// How many times as likely as a line a step has to be.
const ODDS: f64 = 20.0;

impl Series {
    /// Number of sessions before the step that explains the values better than a line in time, if there is one.
    ///
    /// A constant on either side of a step has two unknowns, as a line has. With the misfits `S` of both and `n` sessions of unknown scatter
    /// the step is `(S_line / S_step)^((n - 2)/2)` times as likely, over the `n - 1` places where it may be. Scatter below what the
    /// sessions state is chance: `S_step` counts as `n - 2` at least.
    pub fn step(&self) -> Option<usize> {
        let points = self.points();
        let count = points.len();
        let freedom = count.checked_sub(2).filter(|freedom| *freedom > 0)? as f64;
        let misfit = |points: &[Point], curve| Line::new(points, curve, 0.0).map(|line| line.misfit);
        let of_line = misfit(points, Curve::Line)?;
        let of_step = |place: usize| {
            let (before, after) = points.split_at(place);
            let both = misfit(before, Curve::Constant)? + misfit(after, Curve::Constant)?;
            Some((place, both.max(freedom)))
        };
        let (place, of_step) = (1..count).filter_map(of_step).min_by(|a, b| a.1.total_cmp(&b.1))?;
        let odds = (of_line / of_step).powf(0.5 * freedom) / (count - 1) as f64;
        (odds > ODDS).then_some(place)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;

    fn series(values: &[f64]) -> Series {
        let point = |(n, value): (usize, &f64)| Point { time: n as f64, value: *value, variance: 1.0 };
        let points: Vec<Point> = values.iter().enumerate().map(point).collect();
        Series::new(&points, &DMatrix::zeros(points.len(), 0)).unwrap()
    }

    /// A repair is a step where it was made; a drift and scatter are not.
    #[test]
    fn a_repair_is_a_step_and_a_drift_is_not() {
        assert_eq!(series(&[0.5, -0.5, 0.2, 25.0, 24.3, 25.6]).step(), Some(3));
        assert_eq!(series(&[0.5, -0.5, 0.2, 0.4, -0.1, 25.6]).step(), Some(5));
        assert_eq!(series(&[0.0, 5.2, 9.8, 15.1, 20.3, 24.9]).step(), None);
        assert_eq!(series(&[3.0, -8.0, 12.0, -2.0, 9.0, 25.0]).step(), None);
        assert_eq!(series(&[0.0, 25.0]).step(), None);
    }
}
