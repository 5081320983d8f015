//! The error model in other axes than those of the newtonometers, where a result is stated in such.

use centrical_session::{AxesParameter, AxesSummary, CalibrationResult};

use super::content::{Align, Block, Table};
use super::tables::{axis_titles, coverage};
use crate::evaluation::{expanded_of, symbol};
use crate::language::Language;

/// Bias, scale matrix and attitude with expanded uncertainties; nothing for a result in instrument axes alone.
pub(super) fn axes(result: &CalibrationResult, language: Language) -> Vec<Block> {
    let messages = language.messages();
    let Some(axes) = &result.axes else { return Vec::new() };
    let name = (messages.words.axes)(&axes.name);
    let mut blocks = vec![
        Block::heading(&format!("{}: {name}", messages.axes), 4),
        Block::paragraph(messages.axes_text),
        Block::Table(parameters(axes, language)),
        Block::paragraph(messages.axes_matrix),
        Block::Table(matrix(axes, language)),
    ];
    if let Some(positions) = axes.positions {
        blocks.push(Block::Note(format!("{} {positions}.", messages.axes_of_case)));
    }
    blocks
}

/// The quantities whose names have one or two digits: bias, scale matrix and turn. The other terms are those of instrument axes.
fn parameters(axes: &AxesSummary, language: Language) -> Table {
    let messages = language.messages();
    let columns = [
        (messages.parameter, 0.2, Align::Left),
        (messages.value, 0.45, Align::Right),
        (messages.coverage_and_degrees, 0.2, Align::Right),
        (messages.unit, 0.15, Align::Left),
    ];
    let shown = axes.parameters.iter().filter(|parameter| parameter.is_of_axes());
    Table::numbers(columns, shown.map(|parameter| row(parameter, language)))
}

fn row(parameter: &AxesParameter, language: Language) -> Vec<String> {
    let expanded = expanded_of(parameter.standard_uncertainty, parameter.degrees_of_freedom);
    vec![
        symbol(&parameter.name),
        language.plus_minus_scientific(parameter.value, expanded.uncertainty),
        coverage(&expanded, language),
        language.unit(&parameter.unit),
    ]
}

/// The rotation by its rows.
fn matrix(axes: &AxesSummary, language: Language) -> Table {
    let titles = axis_titles(language);
    let columns = [
        ("", 0.25, Align::Left),
        (&titles[0], 0.25, Align::Right),
        (&titles[1], 0.25, Align::Right),
        (&titles[2], 0.25, Align::Right),
    ];
    let rows = titles.iter().zip(&axes.matrix).map(|(title, row)| {
        let numbers = row.iter().map(|number| language.number(&format!("{number:.9}")));
        std::iter::once(title.clone()).chain(numbers).collect::<Vec<_>>()
    });
    Table::numbers(columns, rows.collect::<Vec<_>>())
}
