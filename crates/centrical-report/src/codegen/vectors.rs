//! Test vectors: readings and the specific forces they come from.

use centrical_compensate::reading;

use super::model::Model;
use super::statement::Language;

/// A reading and its specific force [m/s^2].
struct Vector {
    reading: [f64; 3],
    f: [f64; 3],
}

/// How many lie inside the range, beside its eight corners and zero.
const INSIDE: usize = 15;

/// Rows `reading, f` of the test vectors, each written by `row`.
pub(super) fn rows(model: &Model, language: &dyn Language, row: impl Fn(&str, &str) -> String) -> String {
    let three = |v: [f64; 3]| v.map(|x| language.number(x)).join(", ");
    vectors(model).iter().map(|v| row(&three(v.reading), &three(v.f))).collect::<Vec<_>>().join("\n")
}

/// A reading that must be refused: of half as much again as the range.
pub(super) fn outside(model: &Model, language: &dyn Language) -> String {
    reading(model.plain, [1.5 * model.range(); 3]).map(|x| language.number(x)).join(", ")
}

fn vectors(model: &Model) -> Vec<Vector> {
    let corners = (0..8).map(|k| [4, 2, 1].map(|bit| if k & bit == 0 { 1.0 } else { -1.0 }));
    let inside = (1..=INSIDE).map(low_discrepancy);
    let points = std::iter::once([0.0; 3]).chain(corners).chain(inside);
    let readings = points.map(|u| reading(model.plain, u.map(|u| u * EDGE * model.range())));
    // What the library makes of the rounded reading: to the last place what every language should.
    readings.filter_map(|r| model.compensation.apply(r).ok().map(|f| Vector { reading: r, f })).collect()
}

/// Corners lie this far out, so that in single precision they round to the inside.
const EDGE: f64 = 1.0 - 1e-6;

/// Point `k` of a sequence that fills the cube from -1 to 1 evenly: fractions of multiples of square roots.
fn low_discrepancy(k: usize) -> [f64; 3] {
    [2.0_f64, 3.0, 5.0].map(|x| 2.0 * (k as f64 * x.sqrt()).fract() - 1.0)
}
