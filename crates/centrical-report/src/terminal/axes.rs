//! The error model in other axes as text for the terminal.

use centrical_session::{AxesParameter, CalibrationResult};

use super::screen::Screen;
use super::table::{Align, Cell, Table};
use crate::language::Language;
use crate::number::counted;

/// Micro-units in one.
const MICRO: f64 = 1e6;

/// Axes are near those of the newtonometers where no cosine is further from one: then the scale matrix is shown less the unit matrix.
const NEAR: f64 = 0.01;

/// Bias, scale matrix and attitude in the axes that the result is stated in, if in others than those of the newtonometers.
pub(super) fn axes(screen: &mut Screen, result: &CalibrationResult) {
    let Some(axes) = &result.axes else { return };
    let name = (Language::English.messages().words.axes)(&axes.name);
    screen.gap();
    screen.head("OTHER AXES", &format!("{name}: reading = bias + scale x f + non-linear terms as above"));
    let mut table = Table::new(2, &[(Align::Left, &["", "unit"]), (Align::Right, &["f1", "f2", "f3"])]);
    let cells = |stem: &str, less: [f64; 3], factor: f64| -> Vec<Cell> {
        let of_row = |p: &&AxesParameter| p.name.strip_prefix(stem).is_some_and(|index| index.len() == 1);
        let shown = axes.parameters.iter().filter(of_row).zip(less);
        shown.map(|(p, less)| Cell::estimate(factor, p.value - less, p.standard_uncertainty)).collect()
    };
    let is_near = axes.matrix.iter().enumerate().all(|(i, row)| 1.0 - row[i] < NEAR);
    for newtonometer in 0..3 {
        let (less, factor, name, unit) = if is_near {
            ([0, 1, 2].map(|axis| f64::from(u8::from(axis == newtonometer))), MICRO, "scale - E", "1e-6")
        } else {
            ([0.0; 3], 1.0, "scale matrix", "1")
        };
        let scale = cells(&format!("scale_{}", newtonometer + 1), less, factor);
        table.row([format!("{name}, {}", newtonometer + 1).into(), unit.into()].into_iter().chain(scale));
    }
    table.row([Cell::from("turn"), "urad".into()].into_iter().chain(cells("turn_", [0.0; 3], MICRO)));
    screen.table(table);
    screen.sentence(
        2,
        2,
        "Row i: newtonometer i. turn: rotation vector of the instrument axes from these; f: in these axes.",
    );
    if let Some(positions) = axes.positions {
        let scatter = counted(positions, "position");
        screen.sentence(
            2,
            2,
            &format!("The case: mean turn of {scatter}; the scatter of their seats is in the uncertainty."),
        );
    }
}
