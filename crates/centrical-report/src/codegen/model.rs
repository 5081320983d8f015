//! What the files are made from, and their test vectors.

use centrical_compensate::{Compensation, Term, reading};
use centrical_session::OutputSummary;

use super::statement::{self, Language, harmless};

/// What the files are made from.
pub(super) struct Model<'a> {
    pub heading: &'a [String],
    /// Of the terms of the compensation.
    pub names: &'a [String],
    /// Largest reading of the calibration [m/s^2].
    pub calibrated: f64,
    pub output: Option<&'a OutputSummary>,
    pub compensation: &'a Compensation<Vec<Term>>,
}

impl Model<'_> {
    /// Fills what all templates have in common.
    pub fn fill(&self, template: &str, language: &dyn Language) -> String {
        let (linear, terms) = (self.compensation.linear(), self.compensation.terms());
        let row = |numbers: &[f64; 3]| numbers.map(|x| language.number(x)).join(", ");
        let rows = |text: String, name: &str, matrix: &[[f64; 3]; 3]| {
            (0..3).fold(text, |text, i| text.replace(&format!("@{name}_{}@", i + 1), &row(&matrix[i])))
        };
        let steps = self.compensation.certificate().newton_steps(0.5 * language.epsilon());
        let mut text = self
            .sections(template)
            .replace("@heading@", &self.heading(language.comment()))
            .replace("@calibrated@", &language.number(self.calibrated))
            .replace("@range@", &language.number(self.range()))
            .replace("@start_region@", &language.number(centrical_compensate::START_REGION))
            .replace("@edge@", &language.number(1.0 + 8.0 * language.epsilon()))
            .replace("@steps@", &steps.to_string())
            .replace("@coefficients@", &statement::coefficients(language, self.names, terms))
            .replace("@statements@", &statement::error_and_gain(language, self.names, terms))
            .replace("@bias@", &row(&linear.bias));
        text = rows(text, "inverse", &linear.inverse);
        if let Some(matrix) = self.compensation.axes() {
            text = rows(text, "axes", matrix);
        }
        if let Some(OutputSummary { unit, scale, bias }) = self.output {
            text = text.replace("@raw_unit@", &harmless(unit));
            text = text.replace("@raw_scale@", &row(scale)).replace("@raw_bias@", &row(bias));
        }
        text
    }

    /// A template without its sections, from a line `@if CONDITION@` to `@end@`, that do not hold: `raw` for a unit with raw output of its
    /// own, `axes` for specific forces in other axes than the newtonometers'.
    fn sections(&self, template: &str) -> String {
        let (has_raw, has_axes) = (self.output.is_some(), self.compensation.axes().is_some());
        let (mut kept, mut is_kept) = (String::new(), true);
        for line in template.split_inclusive('\n') {
            match line.trim_end() {
                "@if raw@" => is_kept = has_raw,
                "@if not raw@" => is_kept = !has_raw,
                "@if axes@" => is_kept = has_axes,
                "@if not axes@" => is_kept = !has_axes,
                "@end@" => is_kept = true,
                _ if is_kept => kept.push_str(line),
                _ => {}
            }
        }
        kept
    }

    /// Range of the compensation [m/s^2].
    fn range(&self) -> f64 {
        self.compensation.certificate().range
    }

    /// The heading as lines of comment.
    fn heading(&self, comment: &str) -> String {
        let lines: Vec<String> =
            self.heading.iter().map(|line| format!("{comment} {}", harmless(line)).trim_end().to_owned()).collect();
        lines.join("\n")
    }
}

/// A reading and its specific force [m/s^2].
struct Vector {
    reading: [f64; 3],
    f: [f64; 3],
}

/// How many lie inside the range, beside its eight corners and zero.
const INSIDE: usize = 15;

/// Rows `reading, f` of the test vectors, each written by `row`.
pub(super) fn vector_rows(model: &Model, language: &dyn Language, row: impl Fn(&str, &str) -> String) -> String {
    let three = |v: [f64; 3]| v.map(|x| language.number(x)).join(", ");
    vectors(model).iter().map(|v| row(&three(v.reading), &three(v.f))).collect::<Vec<_>>().join("\n")
}

/// A reading that must be refused: of half as much again as the range.
pub(super) fn outside_range(model: &Model, language: &dyn Language) -> String {
    reading(model.compensation.terms(), [1.5 * model.range(); 3]).map(|x| language.number(x)).join(", ")
}

fn vectors(model: &Model) -> Vec<Vector> {
    let corners = (0..8).map(|k| [4, 2, 1].map(|bit| if k & bit == 0 { 1.0 } else { -1.0 }));
    let inside = (1..=INSIDE).map(low_discrepancy);
    let points = std::iter::once([0.0; 3]).chain(corners).chain(inside);
    let readings = points.map(|u| reading(model.compensation.terms(), u.map(|u| u * EDGE * model.range())));
    // What the library makes of the rounded reading: to the last place what every language should.
    readings.filter_map(|r| model.compensation.apply(r).ok().map(|f| Vector { reading: r, f })).collect()
}

/// Corners lie this far out, so that in single precision they round to the inside.
const EDGE: f64 = 1.0 - 1e-6;

/// Point `k` of a sequence that fills the cube from -1 to 1 evenly: fractions of multiples of square roots.
fn low_discrepancy(k: usize) -> [f64; 3] {
    [2.0_f64, 3.0, 5.0].map(|x| 2.0 * (k as f64 * x.sqrt()).fract() - 1.0)
}
