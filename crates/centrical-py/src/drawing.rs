//! Curves as the report draws them.

use centrical_report::plot::{Axis, Plot, Point, Series};
use pyo3::prelude::*;

/// Label, abscissae, ordinates, and the ends of the interval of each.
type Curve = (String, Vec<f64>, Vec<f64>, Vec<f64>, Vec<f64>);

/// A plot on logarithmic axes as SVG: markers with intervals, joined by lines. A point that has no place there is left out.
#[pyfunction]
pub fn draw_curves(title: String, x_label: String, y_label: String, curves: Vec<Curve>) -> String {
    let mut plot = Plot::new(title, Axis::log(x_label), Axis::log(y_label));
    for (label, x, y, lower, upper) in curves {
        let values = x.into_iter().zip(y).zip(lower.into_iter().zip(upper));
        let point = |((x, y), (low, high)): ((f64, f64), (f64, f64))| {
            if low.is_nan() || high.is_nan() { Point::new(x, y) } else { Point::new(x, y).with_interval(low, high) }
        };
        plot = plot.with(Series::line_and_markers(label, values.map(point).collect()));
    }
    plot.to_svg()
}
